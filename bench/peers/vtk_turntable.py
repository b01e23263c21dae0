#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""VTK's projected tetrahedra along a turntable: CPU seconds of the first and of a later frame, 512 x 512.

    vtk_turntable.py MESH.vtu…

Needs python3-vtk9 and, for the windowless OpenGL of Debian's package, xvfb. Field (f), colours, opacities and camera are those of
bench/splat_sheets, which writes the meshes; hexahedra are split as vtkDataSetTriangleFilter does.
"""
import sys
import time

import vtk

SIZE, FRAMES, TURN = 512, 10, 36


def tetrahedra(mesh):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(mesh)
    reader.Update()
    reader.GetOutput().GetPointData().SetActiveScalars("f")
    tets = vtk.vtkDataSetTriangleFilter()
    tets.SetInputConnection(reader.GetOutputPort())
    tets.TetrahedraOnlyOn()
    tets.Update()
    return tets.GetOutput()


def volume_of(tets):
    low, high = tets.GetPointData().GetArray("f").GetRange()
    color, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    for value, rgb in [(low, (.27, 0, .33)), ((low + high) / 2, (.13, .57, .55)), (high, (.99, .91, .14))]:
        color.AddRGBPoint(value, *rgb)
    opacity.AddPoint(low, 0)
    opacity.AddPoint(high, .5)
    volume = vtk.vtkVolume()
    volume.SetMapper(vtk.vtkProjectedTetrahedraMapper())
    volume.GetMapper().SetInputData(tets)
    volume.GetProperty().SetColor(color)
    volume.GetProperty().SetScalarOpacity(opacity)
    volume.GetProperty().SetScalarOpacityUnitDistance(tets.GetLength() / 100)
    volume.GetProperty().SetInterpolationTypeToLinear()
    return volume


def window_of(volume):
    renderer = vtk.vtkRenderer()
    renderer.AddVolume(volume)
    renderer.SetBackground(0, 0, 0)
    camera = renderer.GetActiveCamera()
    center, length = volume.GetCenter(), volume.GetLength()
    camera.SetFocalPoint(center)
    camera.SetPosition([c + 1.93 * length * d / 1.536 for c, d in zip(center, (1, -1, .6))])
    camera.SetViewUp(0, 0, 1)
    camera.SetViewAngle(30)
    renderer.ResetCameraClippingRange()
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(SIZE, SIZE)
    window.AddRenderer(renderer)
    return window, camera


def cpu_seconds_of_frame(window):
    start = time.process_time()
    window.Render()
    window.WaitForCompletion()
    return time.process_time() - start


kept = []  # when the last window closes, the X server of xvfb-run ends
for mesh in sys.argv[1:]:
    window, camera = window_of(volume_of(tetrahedra(mesh)))
    kept.append(window)
    first, later = cpu_seconds_of_frame(window), []
    for _ in range(1, FRAMES):
        camera.Azimuth(360 / TURN)
        later.append(cpu_seconds_of_frame(window))
    print(f"{mesh}\t{first:.3f}\t{min(later):.3f}\t{sorted(later)[len(later) // 2]:.3f}", flush=True)
