# SPDX-License-Identifier: Apache-2.0
"""A picture by pvbatch, with any number of ranks: a volume with an opaque slice in it. Arguments: the plugin, the picture."""
import os
import sys

from paraview import simple

simple.LoadPlugin(sys.argv[1], remote=False, ns=vars(simple))
source = simple.XMLUnstructuredGridReader(FileName=[os.path.join(os.path.dirname(sys.argv[2]), "ball.vtu")])
view = simple.CreateRenderView()
view.ViewSize = [300, 260]
view.OrientationAxesVisibility = 0
view.UseColorPaletteForBackground = 0
view.Background = [0, 0, 0]
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [5, -7, 4], [0.1, 0, 0], [0, 0, 1]
shown = simple.Show(source, view)
simple.ColorBy(shown, ("POINTS", "heat"))
shown.SetRepresentationType("Subdivision splats")
shown.ScalarOpacityUnitDistance = 0.4
cut = simple.Show(simple.Slice(source, SliceType="Plane"), view)
cut.ColorArrayName = [None, ""]
simple.SaveScreenshot(sys.argv[2], view, ImageResolution=[300, 260])
