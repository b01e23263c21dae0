# SPDX-License-Identifier: Apache-2.0
"""Subdivision volumes of pyvista's grids: after `import subvol.pyvista` every `pyvista.UnstructuredGrid` has `.subvol`.

    import pyvista, subvol.pyvista
    grid = pyvista.read("part.vtu")
    grid.subvol.render(field="Temp").write("part.png")
    plotter.add_mesh(grid.subvol.limit_surface())
    grid.subvol.to_vdb("part.vdb", resolution=400)
"""
from __future__ import annotations

import importlib
from typing import Any

import numpy as np

from . import from_vtk, render, surface, write_vdb
from ._arguments import Path
from ._core import HexMesh, Image
from .reports import GridReport

_pyvista: Any = importlib.import_module("pyvista")

class Subvol:
    """What `grid.subvol` is. Options are those of the package's calls of these names."""

    def __init__(self, grid: Any) -> None:
        self._grid = grid

    @property
    def mesh(self) -> HexMesh:
        """The grid as a mesh, made anew each time: the grid may have changed."""
        return from_vtk(self._grid)

    def render(self, **options: Any) -> Image:
        """`subvol.render`; the field is that of the grid's active scalars if none is named."""
        return render(self.mesh, **{"field": self._field(), **options})

    def limit_surface(self, **options: Any) -> Any:
        """`subvol.surface`: the boundary of the volume, unless isosurfaces are asked for by `iso`; with normals and all fields."""
        if "iso" not in options:
            options.setdefault("boundary", True)
        made = surface(self.mesh, **({"field": self._field()} if "iso" in options else {}), **options)
        triangles = np.insert(made.triangles.astype(np.int64), 0, 3, axis=1)
        polygons = _pyvista.PolyData(made.points, triangles.ravel())
        polygons.point_data["Normals"] = made.normals
        for name, values in made.fields.items():
            polygons.point_data[name] = values
        return polygons

    def to_vdb(self, path: Path, **options: Any) -> list[GridReport]:
        """`subvol.write_vdb`."""
        return write_vdb(self.mesh, path, **options)

    def _field(self) -> Any:
        name = self._grid.active_scalars_name
        return name if name in self._grid.point_data or name in self._grid.cell_data else None


_pyvista.UnstructuredGrid.subvol = property(Subvol)
