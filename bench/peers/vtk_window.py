# SPDX-License-Identifier: Apache-2.0
"""What scripts that draw with VTK share: meshes as tetrahedra, volumes, windows without a screen, and the time of a frame.

Needs python3-vtk9 and, for the windowless OpenGL of Debian's package, xvfb.
"""
import time

import vtk


def tetrahedra(mesh, field):
    """The cells of a .vtu file, split as vtkDataSetTriangleFilter does, with a field of its points."""
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(mesh)
    reader.Update()
    reader.GetOutput().GetPointData().SetActiveScalars(field)
    tets = vtk.vtkDataSetTriangleFilter()
    tets.SetInputConnection(reader.GetOutputPort())
    tets.TetrahedraOnlyOn()
    tets.Update()
    return tets.GetOutput()


def volume_of(mapper, colors, opacities, unit):
    """A volume with colours (value, rgb) and opacities (value, alpha) over a length of `unit`."""
    color, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    for value, rgb in colors:
        color.AddRGBPoint(value, *rgb)
    for value, alpha in opacities:
        opacity.AddPoint(value, alpha)
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper)
    volume.GetProperty().SetColor(color)
    volume.GetProperty().SetScalarOpacity(opacity)
    volume.GetProperty().SetScalarOpacityUnitDistance(unit)
    volume.GetProperty().SetInterpolationTypeToLinear()
    return volume


def window_of(volume, size, position, target, angle):
    """A window of size x size pixels, and its camera; up is z."""
    renderer = vtk.vtkRenderer()
    renderer.AddVolume(volume)
    renderer.SetBackground(0, 0, 0)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(position)
    camera.SetFocalPoint(target)
    camera.SetViewUp(0, 0, 1)
    camera.SetViewAngle(angle)
    renderer.ResetCameraClippingRange()
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(size, size)
    window.AddRenderer(renderer)
    return window, camera


def cpu_seconds_of_frame(window):
    start = time.process_time()
    window.Render()
    window.WaitForCompletion()
    return time.process_time() - start
