#!/usr/bin/env python3
"""VTK's projected tetrahedra on the twisted block, beside twist_error: CPU-seconds a frame and the error.

    twist_error 40 512 FOLDER                                       # writes exact_smooth.exr there
    subvol model twist --resolution 40 -o twist.vtu
    oiiotool FOLDER/exact_smooth.exr --ch R,G,B -d uint16 -o exact.png
    xvfb-run -a /usr/bin/python3 bench/vtk_projected_tets.py twist.vtu exact.png

Needs python3-vtk9 and, for the windowless OpenGL of Debian's package, xvfb. The transfer function, camera and background are
twist_error's smooth ones.
"""
import sys
import time

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

SIZE = 512


def read_floats(path):
    reader = vtk.vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    values = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())
    return values.reshape(SIZE, SIZE, -1)[::-1, :, :3] / 65535


def volume_property():
    color, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    for value, rgb in [(-1, (.1, .2, .9)), (0, (.9, .9, .9)), (1, (.9, .2, .1))]:
        color.AddRGBPoint(value, *rgb)
    for value, alpha in [(-1, .30), (-.3, .05), (0, 0), (.3, .05), (1, .40)]:
        opacity.AddPoint(value, alpha)
    result = vtk.vtkVolumeProperty()
    result.SetColor(color)
    result.SetScalarOpacity(opacity)
    result.SetScalarOpacityUnitDistance(0.1)
    result.SetInterpolationTypeToLinear()
    return result


def main(mesh, exact):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(mesh)
    reader.Update()
    reader.GetOutput().GetPointData().SetActiveScalars("density")
    tets = vtk.vtkDataSetTriangleFilter()
    tets.SetInputConnection(reader.GetOutputPort())
    tets.TetrahedraOnlyOn()
    tets.Update()
    mapper = vtk.vtkProjectedTetrahedraMapper()
    mapper.SetInputConnection(tets.GetOutputPort())
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(volume_property())
    renderer = vtk.vtkRenderer()
    renderer.AddVolume(volume)
    renderer.SetBackground(0, 0, 0)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(2.6, -4.2, 2.0)
    camera.SetFocalPoint(-.55, 0, 0)
    camera.SetViewUp(0, 0, 1)
    camera.SetViewAngle(40)
    renderer.ResetCameraClippingRange()
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(SIZE, SIZE)
    window.AddRenderer(renderer)
    window.Render()
    best = 1e30
    for _ in range(5):
        camera.Azimuth(1e-6)  # else nothing is drawn again
        start = time.process_time()
        window.Render()
        window.WaitForCompletion()
        best = min(best, time.process_time() - start)
    pixels = vtk.vtkUnsignedCharArray()
    window.GetPixelData(0, 0, SIZE - 1, SIZE - 1, 1, pixels, 0)
    image = vtk_to_numpy(pixels).reshape(SIZE, SIZE, 3)[::-1] / 255
    rmse = numpy.sqrt(numpy.mean((image - read_floats(exact)) ** 2))
    print(f"vtkProjectedTetrahedraMapper {vtk.vtkVersion().GetVTKVersion()}: {tets.GetOutput().GetNumberOfCells()} tets, "
          f"{best:.2f} CPU-s a frame, rmse {rmse:.4f}")


main(*sys.argv[1:])
