#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reads mesh files by VTK's readers, or by meshio where VTK has none, and prints their figures: a JSON object a line.

    bench/peers/mesh_figures.py < LIST

LIST has the path of a file a line. The figures of the last step: the peer; the number of cells with a volume, and how many of them are
curved or polyhedra; their volume, each as the trilinear map of its corners; the least and the greatest value of each array, of vectors
that of their lengths. `bench/readers.py` compares them with ours. Needs Debian's python3-vtk9 and python3-meshio.
"""
import contextlib
import importlib
import json
import os
import sys

import numpy as np

# The corners of the hexahedron that each kind of cell is, some of them repeated; VTK's and meshio's orders of corners are the same.
HEX_CORNERS = {"tetra": (0, 1, 2, 2, 3, 3, 3, 3), "hexahedron": range(8), "voxel": (0, 1, 3, 2, 4, 5, 7, 6),
               "wedge": (0, 1, 2, 2, 3, 4, 5, 5), "pyramid": (0, 1, 2, 3, 4, 4, 4, 4)}
VTK_KINDS = {10: "tetra", 11: "voxel", 12: "hexahedron", 13: "wedge", 14: "pyramid", 24: "tetra", 25: "hexahedron", 26: "wedge",
             27: "pyramid", 29: "hexahedron", 31: "wedge", 32: "wedge", 33: "hexahedron", 37: "pyramid", 71: "tetra", 72: "hexahedron",
             73: "wedge", 74: "pyramid", 78: "tetra", 79: "hexahedron", 80: "wedge"}
VTK_PRISMS = {15: 5, 16: 6}  # of five and six sides: the number of sides
POLYHEDRON = 42


def volume_of(points, corners):
    """The volume of trilinear maps: the integral of the Jacobian by Gauss's rule of two points in each direction, which is exact."""
    at = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
    place, total = points[corners], np.zeros(len(corners))
    gauss = (.5 - .5 / 3 ** .5, .5 + .5 / 3 ** .5)
    for r in gauss:
        for s in gauss:
            for t in gauss:
                u = np.array([r, s, t])
                factor = np.where(at == 1, u, 1 - u)
                slope = np.where(at == 1, 1., -1.)
                columns = [np.einsum("i,nij->nj", slope[:, k] * factor[:, (k + 1) % 3] * factor[:, (k + 2) % 3], place) for k in range(3)]
                total += np.einsum("nj,nj->n", columns[0], np.cross(columns[1], columns[2])) / 8
    return np.abs(total).sum()


class Figures:
    def __init__(self, peer):
        self.out = {"peer": peer, "cells": 0, "curved": 0, "polyhedra": 0, "volume": 0.0, "fields": {}}

    def add_cells(self, points, kind, cells, curved):
        if len(cells):
            corners = np.asarray(cells)[:, list(HEX_CORNERS[kind])]
            self.out["cells"] += len(cells)
            self.out["curved"] += len(cells) if curved else 0
            self.out["volume"] += float(volume_of(np.asarray(points, float), corners))

    def add_field(self, name, values):
        values = np.asarray(values)
        if values.dtype.kind not in "fiub" or values.ndim > 3 or not values.size:
            return
        values = values.astype(float).reshape(len(values), -1)
        size = values[:, 0] if values.shape[1] == 1 else np.sqrt((values ** 2).sum(1))
        size = size[np.isfinite(size)]
        if size.size:
            old = self.out["fields"].get(name, [np.inf, -np.inf])
            self.out["fields"][name] = [min(old[0], float(size.min())), max(old[1], float(size.max()))]


def add_vtk(figures, data):
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
    if data is None:
        return
    if data.IsA("vtkCompositeDataSet"):
        blocks = data.NewIterator()
        blocks.InitTraversal()
        while not blocks.IsDoneWithTraversal():
            add_vtk(figures, blocks.GetCurrentDataObject())
            blocks.GoToNextItem()
        return
    if not data.IsA("vtkDataSet"):
        return
    if not data.IsA("vtkUnstructuredGrid"):
        to_grid = vtk.vtkAppendFilter()
        to_grid.AddInputData(data)
        to_grid.Update()
        data = to_grid.GetOutput()
    if not data.GetNumberOfCells() or not data.GetPoints():
        return
    ghost = data.GetCellData().GetArray("vtkGhostType")
    ghost = vtk_to_numpy(ghost) & (1 | 8 | 32) if ghost is not None else None
    points, types = vtk_to_numpy(data.GetPoints().GetData()), vtk_to_numpy(data.GetCellTypesArray())
    ends = vtk_to_numpy(data.GetCells().GetOffsetsArray())
    nodes = vtk_to_numpy(data.GetCells().GetConnectivityArray())
    has_volume = False
    for kind in np.unique(types):
        chosen = np.flatnonzero((types == kind) & (ghost == 0 if ghost is not None else True))
        if kind in VTK_KINDS:
            needed = max(HEX_CORNERS[VTK_KINDS[kind]]) + 1
            corners = nodes[ends[:-1][chosen][:, None] + np.arange(needed)]
            figures.add_cells(points, VTK_KINDS[kind], corners, kind > 20)
            has_volume = True
        elif kind in VTK_PRISMS:
            sides = VTK_PRISMS[kind]
            corners = nodes[ends[:-1][chosen][:, None] + np.arange(2 * sides)]
            for k in range(1, sides - 1):
                figures.add_cells(points, "wedge", corners[:, [0, k, k + 1, sides, sides + k, sides + k + 1]], False)
            figures.out["cells"] -= len(chosen) * (sides - 3)
            figures.out["polyhedra"] += len(chosen)
            has_volume = True
        elif kind == POLYHEDRON:
            sizes = vtk.vtkCellSizeFilter()
            sizes.SetInputData(data)
            sizes.Update()
            volumes = vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray("Volume"))
            figures.out["cells"] += len(chosen)
            figures.out["polyhedra"] += len(chosen)
            figures.out["volume"] += float(np.abs(volumes[chosen]).sum())
            has_volume = True
    for source in (data.GetPointData(), data.GetCellData()):
        for k in range(source.GetNumberOfArrays() if has_volume else 0):
            array = source.GetArray(k)
            if array is not None and array.GetName() and array.GetDataType() != vtk.VTK_STRING:
                figures.add_field(array.GetName(), vtk_to_numpy(array))


def vtk_reader(path):
    """The reader of a file, its steps and all arrays chosen; None if VTK has none in Python."""
    import vtk
    end, name = os.path.splitext(path)[1].lower(), str(path)
    if end in (".vtu", ".vts", ".vtr", ".vti", ".pvtu", ".pvts", ".pvtr", ".pvti", ".vtm", ".vth", ".vthb"):
        kinds = {".vtu": vtk.vtkXMLUnstructuredGridReader, ".vts": vtk.vtkXMLStructuredGridReader, ".vtr": vtk.vtkXMLRectilinearGridReader,
                 ".vti": vtk.vtkXMLImageDataReader, ".pvtu": vtk.vtkXMLPUnstructuredGridReader, ".pvts": vtk.vtkXMLPStructuredGridReader,
                 ".pvtr": vtk.vtkXMLPRectilinearGridReader, ".pvti": vtk.vtkXMLPImageDataReader, ".vtm": vtk.vtkXMLMultiBlockDataReader,
                 ".vth": vtk.vtkXMLUniformGridAMRReader, ".vthb": vtk.vtkXMLUniformGridAMRReader}
        reader = kinds[end]()
        if end.startswith(".vth"):
            reader.SetMaximumLevelsToReadByDefault(0)
    elif end == ".vtk":
        reader = vtk.vtkDataSetReader()
        for switch in ("Scalars", "Vectors", "Normals", "Tensors", "TCoords", "Fields", "ColorScalars"):
            getattr(reader, f"ReadAll{switch}On")()
    elif end in (".e", ".exo", ".ex2", ".g", ".exii", ".gen") or ".e." in os.path.basename(name):
        reader = vtk.vtkExodusIIReader()
        reader.SetFileName(name)
        reader.UpdateInformation()
        reader.SetApplyDisplacements(False)
        reader.SetGenerateObjectIdCellArray(False)
        for kind in (reader.NODAL, reader.ELEM_BLOCK):
            for k in range(reader.GetNumberOfObjectArrays(kind)):
                reader.SetObjectArrayStatus(kind, reader.GetObjectArrayName(kind, k), 1)
        for k in range(reader.GetNumberOfObjects(reader.ELEM_BLOCK)):
            reader.SetObjectStatus(reader.ELEM_BLOCK, k, 1)
    elif end == ".case":
        reader = vtk.vtkGenericEnSightReader()
        reader.SetCaseFileName(name)
    elif end in (".vtkhdf", ".hdf"):
        reader = vtk.vtkHDFReader()
    elif end == ".foam":
        reader = vtk.vtkOpenFOAMReader()
        reader.SkipZeroTimeOff()
        reader.DecomposePolyhedraOff()
        reader.CreateCellToPointOff()
    elif end == ".cgns":
        reader = vtk.vtkCGNSReader()
        reader.SetFileName(name)
        reader.UpdateInformation()
        reader.EnableAllBases()
        reader.EnableAllPointArrays()
        reader.EnableAllCellArrays()
    else:
        return None
    if hasattr(reader, "SetFileName"):
        reader.SetFileName(name)
    return reader


def read_by_vtk(path):
    reader = vtk_reader(path)
    if reader is None:
        return None
    failed = []
    reader.AddObserver("ErrorEvent", lambda *_: failed.append(1))
    reader.GetExecutive().AddObserver("ErrorEvent", lambda *_: failed.append(1))
    reader.UpdateInformation()
    if path.lower().endswith(".foam"):
        reader.EnableAllCellArrays()
        reader.DisableAllPatchArrays()
        reader.SetPatchArrayStatus("internalMesh", 1)
    steps = reader.GetOutputInformation(0).Get(reader.GetExecutive().TIME_STEPS())
    if steps:
        reader.UpdateTimeStep(steps[-1])
    reader.Update()
    if failed:
        return {"peer": "VTK", "error": "VTK's reader reports an error"}
    figures = Figures("VTK")
    data = reader.GetOutputDataObject(0)
    add_vtk(figures, data)
    return figures.out


def read_by_meshio(path):
    import meshio
    figures = Figures("meshio")
    mesh = meshio.read(path)
    curved = {"tetra10": "tetra", "hexahedron20": "hexahedron", "hexahedron27": "hexahedron", "wedge15": "wedge", "wedge18": "wedge",
              "pyramid13": "pyramid", "pyramid14": "pyramid", "hexahedron24": "hexahedron", "hexahedron64": "hexahedron",
              "hexahedron125": "hexahedron", "tetra20": "tetra", "tetra35": "tetra"}
    for block in mesh.cells:
        kind = curved.get(block.type, block.type)
        if kind in HEX_CORNERS and len(block.data):
            figures.add_cells(mesh.points, kind, block.data, block.type in curved)
    for name, values in mesh.point_data.items():
        figures.add_field(name, values)
    for name, blocks in mesh.cell_data.items():
        for values in blocks:
            figures.add_field(name, values)
    return figures.out


def figures_of(path):
    try:
        return read_by_vtk(path) or read_by_meshio(path)
    except BaseException as error:  # meshio ends Python for some files
        return {"peer": "meshio", "error": f"{type(error).__name__}: {error}"[:200]}


def main():
    """A child process for each file, because readers may end with it. The packages are loaded once, before."""
    for package in "vtk", "vtk.util.numpy_support", "meshio":
        with contextlib.suppress(ImportError):
            importlib.import_module(package)
    for path in map(str.strip, sys.stdin):
        read_end, write_end = os.pipe()
        child = os.fork()
        if child == 0:
            os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
            os.dup2(2, 1)
            os.write(write_end, json.dumps(figures_of(path)).encode())
            os._exit(0)
        os.close(write_end)
        with os.fdopen(read_end, "rb") as pipe:
            text = pipe.read()
        os.waitpid(child, 0)
        print(json.dumps({"file": path, **(json.loads(text) if text else {"peer": "VTK", "error": "its reader ends the process"})}), flush=True)


if __name__ == "__main__":
    main()
