#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""VTK's projected tetrahedra along a turntable: CPU seconds of the first and of a later frame, 512 x 512.

    vtk_turntable.py MESH.vtu…

Field (f), colours, opacities and camera are those of bench/splat_sheets, which writes the meshes. Needs what vtk_window needs.
"""
import sys

import vtk
from vtk_window import cpu_seconds_of_frame, tetrahedra, volume_of, window_of

SIZE, FRAMES, TURN = 512, 10, 36


def scene_of(tets):
    low, high = tets.GetPointData().GetArray("f").GetRange()
    mapper = vtk.vtkProjectedTetrahedraMapper()
    mapper.SetInputData(tets)
    volume = volume_of(mapper, [(low, (.27, 0, .33)), ((low + high) / 2, (.13, .57, .55)), (high, (.99, .91, .14))],
                       [(low, 0), (high, .5)], tets.GetLength() / 100)
    center, distance = volume.GetCenter(), 1.93 * volume.GetLength() / 1.536
    return window_of(volume, SIZE, [c + distance * d for c, d in zip(center, (1, -1, .6))], center, 30)


def main(meshes):
    kept = []  # when the last window closes, the X server of xvfb-run ends
    for mesh in meshes:
        window, camera = scene_of(tetrahedra(mesh, "f"))
        kept.append(window)
        first, later = cpu_seconds_of_frame(window), []
        for _ in range(1, FRAMES):
            camera.Azimuth(360 / TURN)
            later.append(cpu_seconds_of_frame(window))
        print(f"{mesh}\t{first:.3f}\t{min(later):.3f}\t{sorted(later)[len(later) // 2]:.3f}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
