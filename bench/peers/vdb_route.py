#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""From a mesh to a .vdb file by VTK, numpy and pyopenvdb, and by our command: CPU-seconds, wall time, peak memory, and their ratios.

    bench/peers/vdb_route.py [build folder = build/release] [N = 40] [voxels a side = 200 400]

The twisted block. VTK's voxels are boxes, so many a side as asked for; ours are cubes: the same number along the longest side,
and so many that as many are active as of VTK's. Needs the program `subvol`, Debian's python3-vtk9 and python3-openvdb. Both
routes start from the mesh's file and end with the grid's. Measure on an idle machine.
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import time


def vtk_route(mesh, side, output):
    import numpy
    import pyopenvdb
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(mesh)
    resample = vtk.vtkResampleToImage()
    resample.SetInputConnection(reader.GetOutputPort())
    resample.SetSamplingDimensions(side, side, side)
    resample.Update()
    image = resample.GetOutput()

    def array_of(name):
        return vtk_to_numpy(image.GetPointData().GetArray(name)).reshape(side, side, side).transpose(2, 1, 0)

    values = array_of("density").astype(numpy.float32)
    values[array_of("vtkValidPointMask") == 0] = 0
    grid = pyopenvdb.FloatGrid()
    grid.copyFromArray(values)
    grid.name = "density"
    spacing = image.GetSpacing()
    grid.transform = pyopenvdb.createLinearTransform([[spacing[0], 0, 0, 0], [0, spacing[1], 0, 0], [0, 0, spacing[2], 0],
                                                      [*image.GetOrigin(), 1]])
    pyopenvdb.write(output, grids=[grid])


def measured(command):
    start = time.monotonic()
    process = subprocess.Popen([str(part) for part in command], stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"vdb_route.py: {command[0]} ended with {process.returncode}")
    return {"cpu": usage.ru_utime + usage.ru_stime, "wall": time.monotonic() - start, "mb": usage.ru_maxrss / 1024}


def print_active_voxels(file):
    import pyopenvdb
    print(pyopenvdb.read(file, "density").activeVoxelCount())


def active_voxels(file):
    """In its own process: a program's peak memory includes that of the process that starts it."""
    return int(subprocess.run([sys.executable, __file__, "--count", file], stdout=subprocess.PIPE, check=True).stdout)


def row(name, figures, file, reference):
    ratios = " | ".join(f"{reference[key] / figures[key]:.1f}" for key in ("cpu", "wall", "mb"))
    print(f"| {name} | {active_voxels(file) / 1e6:.2f} | {figures['cpu']:.2f} | {figures['wall']:.2f} | {figures['mb']:.0f} | "
          f"{file.stat().st_size / 1e6:.1f} | {ratios} |", flush=True)


def main(build="build/release", n="40", *sides):
    subvol = pathlib.Path(build) / "bin" / "subvol"
    print("| | active voxels, M | CPU-s | wall, s | peak, MB | file, MB | VTK's CPU by this | its wall | its memory |\n"
          "|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        mesh, theirs, ours = (pathlib.Path(folder) / name for name in ("twist.vtu", "theirs.vdb", "ours.vdb"))
        measured([subvol, "model", "twist", "--resolution", n, "-o", mesh, "--quiet"])
        for side in sides or ("200", "400"):
            reference = measured([sys.executable, __file__, "--vtk", mesh, side, theirs])
            row(f"VTK, numpy, pyopenvdb, {side}", reference, theirs, reference)
            resolution = int(side)
            for _ in range(2):
                figures = measured([subvol, "vdb", mesh, "-o", ours, "--resolution", resolution, "--levels", "0", "--quiet"])
                row(f"subvol, {resolution}", figures, ours, reference)
                resolution = round(resolution * (active_voxels(theirs) / active_voxels(ours)) ** (1 / 3))


if sys.argv[1:2] == ["--vtk"]:
    vtk_route(sys.argv[2], int(sys.argv[3]), sys.argv[4])
elif sys.argv[1:2] == ["--count"]:
    print_active_voxels(sys.argv[2])
else:
    main(*sys.argv[1:])
