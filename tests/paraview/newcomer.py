# SPDX-License-Identifier: Apache-2.0
"""What docs/paraview.md shows first: a mesh, its field, the representation, a picture. Arguments: the mesh, the picture."""
import sys

from paraview.simple import *  # noqa: F403 (as people write it)

mesh = OpenDataFile(sys.argv[1])  # noqa: F405
view = CreateRenderView(ViewSize=[600, 500])  # noqa: F405
shown = Show(mesh, view)  # noqa: F405
ColorBy(shown, ("POINTS", mesh.PointData[0].Name))  # noqa: F405
if "Subdivision splats" not in shown.GetProperty("Representation").Available:
    sys.exit("the plugin is not loaded")
shown.SetRepresentationType("Subdivision splats")
ResetCamera(view)  # noqa: F405
SaveScreenshot(sys.argv[2], view)  # noqa: F405
