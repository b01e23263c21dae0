#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The picture of a study's case by VTK, for the method `file` of studies (docs/studies.md).

    vtk_study.py mesh.vtu FIELD camera.json WIDTHxHEIGHT map.json UNIT picture.pfm [--rays]

The camera is a file of references/cameras, or the report of `subvol render --json`; the map is a ParaView colour map that the study
names as its transfer function, UNIT its opacity_unit. Tetrahedra are projected; with --rays Bunyk's ray caster integrates them. Beside
the picture its camera is written. VTK blends colours as they stand, in 8 bits a channel: they are given as linear ones, and the picture
is a file of linear floats. Needs what vtk_window needs.
"""
import json
import shutil
import sys
from pathlib import Path

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy
from vtk_window import tetrahedra, volume_of, window_of


def linear(channel):
    return channel / 12.92 if channel <= .04045 else ((channel + .055) / 1.055) ** 2.4


def functions_of(file):
    """Colours and opacities of the first map in a file of ParaView's: between its points colours are linear in sRGB, as there."""
    first = json.loads(Path(file).read_text())
    first = first[0] if isinstance(first, list) else first
    knots = numpy.array(first["RGBPoints"], dtype=float).reshape(-1, 4)
    values = numpy.unique(numpy.concatenate([numpy.linspace(a, b, 65) for a, b in zip(knots[:-1, 0], knots[1:, 0])]))
    channels = [numpy.interp(values, knots[:, 0], knots[:, k]) for k in (1, 2, 3)]
    points = first["Points"]
    return ([(value, [linear(c) for c in rgb]) for value, *rgb in zip(values, *channels)],
            [(points[i], points[i + 1]) for i in range(0, len(points), 4)])


def mapper_of(rays):
    if not rays:
        return vtk.vtkProjectedTetrahedraMapper()
    mapper = vtk.vtkUnstructuredGridVolumeRayCastMapper()
    mapper.SetRayCastFunction(vtk.vtkUnstructuredGridBunykRayCastFunction())
    mapper.SetRayIntegrator(vtk.vtkUnstructuredGridPreIntegration())
    mapper.SetAutoAdjustSampleDistances(0)
    mapper.SetImageSampleDistance(1)
    return mapper


def main(mesh, field, camera_file, size, colors, unit, picture, rays=None):
    width, height = map(int, size.split("x"))
    eye = json.loads(Path(camera_file).read_text())
    eye = eye.get("camera", eye)
    mapper = mapper_of(rays == "--rays")
    mapper.SetInputData(tetrahedra(mesh, field))
    window, camera = window_of(volume_of(mapper, *functions_of(colors), float(unit)), max(width, height), eye["eye"], eye["target"],
                               eye.get("fovy_deg", 30))
    window.SetSize(width, height)
    camera.SetViewUp(eye["up"])
    if "ortho_height" in eye:
        camera.ParallelProjectionOn()
        camera.SetParallelScale(eye["ortho_height"] / 2)
    window.GetRenderers().GetFirstRenderer().ResetCameraClippingRange()
    window.Render()
    pixels = vtk.vtkUnsignedCharArray()
    window.GetPixelData(0, 0, width - 1, height - 1, 1, pixels, 0)
    values = vtk_to_numpy(pixels).reshape(height, width, 3).astype("<f4") / 255  # rows from the bottom, as .pfm has them
    Path(picture).write_bytes(f"PF\n{width} {height}\n-1.0\n".encode() + values.tobytes())
    shutil.copyfile(camera_file, Path(picture).with_suffix(".json"))


if __name__ == "__main__":
    main(*sys.argv[1:])
