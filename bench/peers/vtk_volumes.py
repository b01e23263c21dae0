#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""VTK's volume mappers on the twisted block: CPU-seconds of the first and of a later frame, and the error.

    vtk_volumes.py twist.vtu exact.f32

Needs python3-vtk9 and, for the windowless OpenGL of Debian's package, xvfb. Camera, transfer function and background are those
of peers_ours. VTK draws 8 bits a channel: .001 of the error.
"""
import sys
import time

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

FRAMES = 3


def ray_caster(integrator):
    mapper = vtk.vtkUnstructuredGridVolumeRayCastMapper()
    mapper.SetRayCastFunction(vtk.vtkUnstructuredGridBunykRayCastFunction())
    mapper.SetRayIntegrator(integrator)
    mapper.SetAutoAdjustSampleDistances(0)  # all pixels in every frame
    mapper.SetImageSampleDistance(1)
    return mapper


def z_sweep():
    mapper = vtk.vtkUnstructuredGridVolumeZSweepMapper()
    mapper.SetAutoAdjustSampleDistances(0)
    mapper.SetImageSampleDistance(1)
    return mapper


MAPPERS = [
    ("projected tetrahedra", vtk.vtkProjectedTetrahedraMapper),
    ("ray caster (Bunyk)", lambda: ray_caster(vtk.vtkUnstructuredGridPreIntegration())),
    ("ray caster (Bunyk), linear integrator", lambda: ray_caster(vtk.vtkUnstructuredGridLinearRayIntegrator())),
    ("ZSweep", z_sweep),
]


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


def tetrahedra(mesh):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(mesh)
    reader.Update()
    reader.GetOutput().GetPointData().SetActiveScalars("density")
    tets = vtk.vtkDataSetTriangleFilter()
    tets.SetInputConnection(reader.GetOutputPort())
    tets.TetrahedraOnlyOn()
    tets.Update()
    return tets.GetOutput()


def window_of(mapper, size):
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
    window.SetSize(size, size)
    window.AddRenderer(renderer)
    return window, camera


def cpu_seconds_of_frame(window):
    start = time.process_time()
    window.Render()
    window.WaitForCompletion()
    return time.process_time() - start


def picture(window, size):
    pixels = vtk.vtkUnsignedCharArray()
    window.GetPixelData(0, 0, size - 1, size - 1, 1, pixels, 0)
    return vtk_to_numpy(pixels).reshape(size, size, 3)[::-1] / 255


def main(mesh, exact_file):
    exact = numpy.fromfile(exact_file, numpy.float32)
    size = round((exact.size / 3) ** .5)
    exact = exact.reshape(size, size, 3)
    tets = tetrahedra(mesh)
    windows = []  # kept: when the last window closes, the X server of xvfb-run ends
    for name, make in MAPPERS:
        mapper = make()
        mapper.SetInputData(tets)
        window, camera = window_of(mapper, size)
        windows.append(window)
        first, later = cpu_seconds_of_frame(window), 1e30
        for _ in range(1, FRAMES):
            camera.Azimuth(1e-6)  # otherwise nothing is drawn again
            later = min(later, cpu_seconds_of_frame(window))
        rmse = numpy.sqrt(numpy.mean((picture(window, size) - exact) ** 2))
        print(f"VTK {vtk.vtkVersion().GetVTKVersion()} {name}\t{first:.2f}\t{later:.2f}\t{rmse:.5f}", flush=True)


main(*sys.argv[1:])
