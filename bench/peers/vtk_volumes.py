#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""VTK's volume mappers on the twisted block: CPU-seconds of the first and of a later frame, and the error.

    vtk_volumes.py twist.vtu exact.f32

Camera, transfer function and background are those of peers_ours. VTK draws 8 bits a channel: .001 of the error. Needs what
vtk_window needs.
"""
import sys

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy
from vtk_window import cpu_seconds_of_frame, tetrahedra, volume_of, window_of

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


def scene_of(mapper, size):
    volume = volume_of(mapper, [(-1, (.1, .2, .9)), (0, (.9, .9, .9)), (1, (.9, .2, .1))],
                       [(-1, .30), (-.3, .05), (0, 0), (.3, .05), (1, .40)], .1)
    return window_of(volume, size, (2.6, -4.2, 2.0), (-.55, 0, 0), 40)


def picture(window, size):
    pixels = vtk.vtkUnsignedCharArray()
    window.GetPixelData(0, 0, size - 1, size - 1, 1, pixels, 0)
    return vtk_to_numpy(pixels).reshape(size, size, 3)[::-1] / 255


def main(mesh, exact_file):
    exact = numpy.fromfile(exact_file, numpy.float32)
    size = round((exact.size / 3) ** .5)
    exact = exact.reshape(size, size, 3)
    tets = tetrahedra(mesh, "density")
    windows = []  # kept: when the last window closes, the X server of xvfb-run ends
    for name, make in MAPPERS:
        mapper = make()
        mapper.SetInputData(tets)
        window, camera = scene_of(mapper, size)
        windows.append(window)
        first, later = cpu_seconds_of_frame(window), 1e30
        for _ in range(1, FRAMES):
            camera.Azimuth(1e-6)  # otherwise nothing is drawn again
            later = min(later, cpu_seconds_of_frame(window))
        rmse = numpy.sqrt(numpy.mean((picture(window, size) - exact) ** 2))
        print(f"VTK {vtk.vtkVersion().GetVTKVersion()} {name}\t{first:.2f}\t{later:.2f}\t{rmse:.5f}", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
