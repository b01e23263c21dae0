# SPDX-License-Identifier: Apache-2.0
"""Meshes of meshio, VTK and pyvista. These are imported when a call needs them."""
from __future__ import annotations

import importlib
from typing import Any

import numpy as np

from . import _core
from ._arguments import warn
from ._core import HexMesh
from ._errors import InvalidInput
from ._options import described

_VTK_HEXAHEDRON, _VTK_POLYHEDRON = 12, 42


def _fields(arrays: Any, points: int) -> dict[str, Any]:
    """Real numbers with a row for each point; others are left out."""
    fields, left_out = {}, []
    for name, given in arrays.items():
        values = np.asarray(given)
        values = values.reshape(len(values), -1) if values.ndim > 2 else values
        if values.dtype.kind in "iuf" and len(values) == points:
            fields[str(name)] = values
        else:
            left_out.append(str(name))
    if left_out:
        warn(f"arrays that are no real numbers at points were left out: {', '.join(left_out)}", 4)
    return fields


def from_meshio(mesh: Any) -> HexMesh:
    """The hexahedra of a `meshio.Mesh` with its point data. Warns about cells of other kinds, which are left out."""
    blocks = [np.asarray(block.data) for block in mesh.cells if block.type == "hexahedron"]
    others = sorted({block.type for block in mesh.cells if block.type != "hexahedron"})
    if not blocks:
        raise InvalidInput(f"the meshio mesh has no hexahedra (it has {', '.join(others) or 'no cells'})", "meshio", "hexahedron cells")
    if others:
        warn(f"cells that are no hexahedra were left out: {', '.join(others)}")
    points = np.asarray(mesh.points)
    return HexMesh(points, np.concatenate(blocks), _fields(mesh.point_data, len(points)))


def _at_points(mesh: HexMesh) -> dict[str, Any]:
    return {name: values for name, values in mesh.fields.items() if name not in mesh.cell_fields}


def to_meshio(mesh: HexMesh) -> Any:
    """A `meshio.Mesh` with all fields, those at cells at the cells. The points are this mesh's memory, and read-only."""
    meshio = importlib.import_module("meshio")
    at_cells = {name: [values] for name, values in mesh.cell_fields.items()}
    return meshio.Mesh(mesh.points, [("hexahedron", mesh.cells)], point_data=_at_points(mesh), cell_data=at_cells)


def from_pyvista(grid: Any) -> HexMesh:
    """The hexahedra of a `pyvista.UnstructuredGrid` with its point data; other grids are cast to one."""
    if not hasattr(grid, "cells_dict"):
        grid = grid.cast_to_unstructured_grid()
    cells = grid.cells_dict
    others = sorted(int(kind) for kind in cells if kind != _VTK_HEXAHEDRON)
    if _VTK_HEXAHEDRON not in cells:
        raise InvalidInput("the pyvista grid has no hexahedra", "pyvista", "cells of type 12")
    if others:
        warn(f"cells that are no hexahedra were left out: VTK types {', '.join(map(str, others))}")
    points = np.asarray(grid.points)
    return HexMesh(points, np.asarray(cells[_VTK_HEXAHEDRON]), _fields(grid.point_data, len(points)))


def to_pyvista(mesh: HexMesh) -> Any:
    """A `pyvista.UnstructuredGrid` with all fields, those at cells at the cells."""
    pyvista = importlib.import_module("pyvista")
    grid = pyvista.UnstructuredGrid({_VTK_HEXAHEDRON: mesh.cells.astype(np.int64)}, mesh.points)
    for name, values in _at_points(mesh).items():
        grid.point_data[name] = values
    for name, values in mesh.cell_fields.items():
        grid.cell_data[name] = values
    return grid


@described
def from_vtk(grid: Any, **options: Any) -> HexMesh:
    """The mesh of a `vtkUnstructuredGrid`, as `read_mesh` makes it of a file with this grid: tetrahedra, prisms, pyramids and polyhedra
    are split, curved cells followed, ghost cells dropped, values at cells moved to the points, creases and sharp faces tagged, patches
    and sets of cells found.

    {keywords}

    Warns (SubvolWarning) once for each thing left out, turned round or converted.
    """
    support = importlib.import_module("vtkmodules.util.numpy_support")
    if not hasattr(grid, "GetCellTypesArray"):
        raise InvalidInput(f"from_vtk() takes a vtkUnstructuredGrid, not {type(grid).__name__}", "grid")
    if grid.GetNumberOfCells() == 0:
        raise InvalidInput("the VTK grid has no cells", "grid")
    cells, types = grid.GetCells(), support.vtk_to_numpy(grid.GetCellTypesArray())
    faces, face_ends = _faces_of(grid, types)
    arrays = []
    for data, at_cells in ((grid.GetPointData(), False), (grid.GetCellData(), True)):
        given = [(data.GetArrayName(k), data.GetArray(k)) for k in range(data.GetNumberOfArrays())]
        arrays += [(name or "unnamed", at_cells, support.vtk_to_numpy(values)) for name, values in given if values is not None]
    data = grid.GetFieldData()
    known = [data.GetArray(k) for k in range(data.GetNumberOfArrays()) if _core.is_vtk_field_array(data.GetArrayName(k) or "")]
    field_arrays = [(values.GetName(), support.vtk_to_numpy(values)) for values in known if values is not None]
    if others := [name for name, numbers in field_arrays if numbers.dtype.kind not in "iu"]:
        warn(f"arrays of field data that are no whole numbers were left out: {', '.join(others)}")
        field_arrays = [(name, numbers) for name, numbers in field_arrays if name not in others]
    mesh, said = _core.from_vtk(support.vtk_to_numpy(grid.GetPoints().GetData()), types, support.vtk_to_numpy(cells.GetOffsetsArray())[1:],
                                support.vtk_to_numpy(cells.GetConnectivityArray()), faces, face_ends, arrays,
                                field_arrays, **options)
    for text in said:
        warn(text)
    return mesh


def _faces_of(grid: Any, types: Any) -> tuple[list[int], list[int]]:
    """The faces of polyhedra as VTK lists them, and where those of each cell end; nothing if there are none."""
    if _VTK_POLYHEDRON not in types:
        return [], []
    ids = importlib.import_module("vtkmodules.vtkCommonCore").vtkIdList()
    faces: list[int] = []
    ends = []
    for cell, kind in enumerate(types):
        if kind == _VTK_POLYHEDRON:
            grid.GetFaceStream(cell, ids)
            faces += [ids.GetId(k) for k in range(ids.GetNumberOfIds())]
        ends.append(len(faces))
    return faces, ends


def to_vtk(mesh: HexMesh) -> Any:
    """A `vtkUnstructuredGrid` with all fields, and creases, sharp faces, patches and sets of cells and nodes as `.vtu` files have them (docs/formats.md).

    Its points and fields are this mesh's memory: nothing may write to them.
    """
    support = importlib.import_module("vtkmodules.util.numpy_support")
    model = importlib.import_module("vtkmodules.vtkCommonDataModel")
    points = importlib.import_module("vtkmodules.vtkCommonCore").vtkPoints()
    points.SetData(support.numpy_to_vtk(mesh.points))
    corners = mesh.cells.view(np.int32).ravel()
    cells = model.vtkCellArray()
    ends = np.arange(0, len(corners) + 1, 8, dtype=np.int32)
    cells.SetData(support.numpy_to_vtk(ends, deep=True), support.numpy_to_vtk(corners, deep=True))  # VTK keeps neither array
    grid = model.vtkUnstructuredGrid()
    grid.SetPoints(points)
    grid.SetCells(_VTK_HEXAHEDRON, cells)
    for data, fields in ((grid.GetPointData(), _at_points(mesh)), (grid.GetCellData(), mesh.cell_fields)):
        for name, values in fields.items():
            array = support.numpy_to_vtk(values)
            array.SetName(name)
            data.AddArray(array)
    named: dict[str, Any] = {**_core.vtk_field_arrays(mesh), **_core.vtk_set_arrays(mesh)}
    for name, numbers in named.items():
        array = support.numpy_to_vtk(numbers, deep=True)
        array.SetName(name)
        (grid.GetFieldData() if _core.is_vtk_field_array(name) else grid.GetCellData()).AddArray(array)
    for name, inside in _core.vtk_node_arrays(mesh).items():
        array = support.numpy_to_vtk(inside, deep=True)
        array.SetName(name)
        grid.GetPointData().AddArray(array)
    return grid
