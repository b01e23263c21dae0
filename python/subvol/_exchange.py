# SPDX-License-Identifier: Apache-2.0
"""Meshes of meshio and pyvista. These are imported when a call needs them."""
from __future__ import annotations

import importlib
from typing import Any

import numpy as np

from ._arguments import warn
from ._core import HexMesh
from ._errors import InvalidInput

_VTK_HEXAHEDRON = 12


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


def to_meshio(mesh: HexMesh) -> Any:
    """A `meshio.Mesh` with all fields. The points are this mesh's memory, and read-only."""
    meshio = importlib.import_module("meshio")
    return meshio.Mesh(mesh.points, [("hexahedron", mesh.cells)], point_data=dict(mesh.fields))


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
    """A `pyvista.UnstructuredGrid` with all fields."""
    pyvista = importlib.import_module("pyvista")
    grid = pyvista.UnstructuredGrid({_VTK_HEXAHEDRON: mesh.cells.astype(np.int64)}, mesh.points)
    for name, values in mesh.fields.items():
        grid.point_data[name] = values
    return grid
