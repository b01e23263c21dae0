#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Isosurfaces of ours and of VTK's contour filter: triangles, CPU-seconds, distance to the limit, area.

    PYTHONPATH=build/release/python /usr/bin/python3 bench/peers/vtk_contours.py MESH[:FIELD] ...

A mesh is a file or model:NAME:N. A field that the file does not have is a formula of x, y and z, such as sin(x/10)+z/40. The isovalue is at
60 % of the field's range. VTK contours the mesh as it is, and refined and
moved to the limit, until it has more triangles than ours. Its seconds are those of the filter alone, ours those of the whole call.
The distance is that of the triangles' middles, by the limit's value and gradient there, in parts of the longest side. Needs python3-vtk9.
"""
import sys
import time

import numpy as np
import subvol
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy

PART_OF_RANGE = .6
MOST_LEVELS = 3


def model(name):
    _, model, resolution = name.split(":")
    return subvol.model(model, int(resolution))


def read(name):
    name, _, field = name.partition(":") if not name.startswith("model:") else (name, "", "")
    mesh = model(name) if name.startswith("model:") else subvol.read_mesh(name)
    if field and field not in mesh.fields:
        known = {word: getattr(np, word) for word in ("sin", "cos", "exp", "sqrt")}
        values = eval(field, {"__builtins__": {}}, {**known, **dict(zip("xyz", mesh.points.T))})
        mesh, field = subvol.HexMesh(mesh.points, mesh.cells, {"f": np.asarray(values, float)}), "f"
    return mesh, field or next(name for name, values in mesh.fields.items() if values.ndim == 1)


def as_vtk(mesh, field):
    cells = np.hstack([np.full((len(mesh.cells), 1), 8), mesh.cells]).astype(np.int64)
    array = vtk.vtkCellArray()
    array.SetCells(len(mesh.cells), numpy_to_vtkIdTypeArray(cells.ravel(), deep=True))
    points = vtk.vtkPoints()
    points.SetDataTypeToDouble()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(mesh.points), deep=True))
    grid = vtk.vtkUnstructuredGrid()
    grid.SetPoints(points)
    grid.SetCells(vtk.VTK_HEXAHEDRON, array)
    values = numpy_to_vtk(np.ascontiguousarray(mesh.fields[field]), deep=True)
    values.SetName(field)
    grid.GetPointData().SetScalars(values)
    return grid


def contour(mesh, field, iso):
    """Points, triangles, seconds."""
    cut = vtk.vtkContourFilter()
    cut.SetInputData(as_vtk(mesh, field))
    cut.SetValue(0, iso)
    cut.ComputeNormalsOff()
    begin = time.process_time()
    cut.Update()
    seconds = time.process_time() - begin
    found = cut.GetOutput()
    triangles = vtk_to_numpy(found.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return vtk_to_numpy(found.GetPoints().GetData()).astype(float), triangles, seconds


def describe(name, mesh, field, iso, points, triangles, seconds):
    middles = points[triangles].mean(axis=1)
    found = subvol.probe(mesh, at=middles)
    inside = found.inside
    slope = np.linalg.norm(found.gradients[field], axis=1)
    far = np.abs(found.fields[field] - iso)[inside] / np.maximum(slope[inside], 1e-300)
    far = far / np.ptp(mesh.points, axis=0).max()
    corners = points[triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
    print(f"| {name} | {len(triangles):,} | {seconds:.2f} | {np.sqrt(np.mean(far ** 2)):.1e} | {np.quantile(far, .999):.1e} | {area:.5g} | "
          f"{np.count_nonzero(~inside):,} |", flush=True)


def main(names):
    print("| | triangles | CPU-s | RMS | 99.9 % below | area | outside |\n|---|---|---|---|---|---|---|")
    for name in names:
        mesh, field = read(name)
        values = mesh.fields[field]
        iso = values.min() + PART_OF_RANGE * np.ptp(values)
        begin = time.process_time()
        ours = subvol.surface(mesh, field, iso)
        seconds = time.process_time() - begin
        describe(f"{name}: ours", mesh, field, iso, ours.points, ours.triangles, seconds)
        for level in range(MOST_LEVELS + 1):
            begin = time.process_time()
            fine = subvol.subdivide(mesh, level, on_limit=True) if level else mesh
            refining = time.process_time() - begin
            points, triangles, seconds = contour(fine, field, iso)
            describe(f"VTK, level {level} (refined in {refining:.2f} s)", mesh, field, iso, points, triangles, seconds)
            if len(triangles) > len(ours.triangles):
                break


if __name__ == "__main__":
    main(sys.argv[1:])
