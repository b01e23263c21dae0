# SPDX-License-Identifier: Apache-2.0
"""Meshes in formats of other programs, read by meshio, which is imported when a call needs it."""
from __future__ import annotations

import contextlib
import importlib
import io
import os
import tempfile
from typing import Any, Optional

import numpy as np

from . import _core
from ._arguments import Path, extension, path_bytes, warn
from ._errors import FileError, InvalidInput, MissingCapability

# The files that meshio reads and the library does not: extension, and what it is of.
EXTENSIONS = {".med": "Salome", ".bdf": "Nastran", ".nas": "Nastran", ".fem": "Nastran", ".su2": "SU2", ".f3grid": "FLAC3D", ".avs": "AVS UCD",
              ".dato": "Permas", ".post": "Permas", ".dat": "Tecplot", ".tec": "Tecplot", ".ele": "TetGen", ".node": "TetGen", ".ugrid": "UGRID",
              ".vol": "Netgen", ".mdpa": "Kratos", ".xml": "Dolfin", ".h5m": "MOAB", ".hmf": "HMF"}
_KINDS_WITH_VOLUME = ("tetra", "hexahedron", "wedge", "pyramid")


def is_foreign(path: Path) -> bool:
    """Whether meshio has to read a file: by its extension, and because the library does not know the contents."""
    return extension(path) in EXTENSIONS and not _core.is_mesh_file(path_bytes(path))


def read(path: Path, file_format: Optional[str] = None) -> Any:
    """A `meshio.Mesh`. file_format: meshio's name of the format; None: by the extension."""
    name = os.fsdecode(path)
    if not os.path.isfile(name):
        raise FileError("cannot be read: there is no such file", name)
    try:
        meshio = importlib.import_module("meshio")
        with contextlib.redirect_stdout(io.StringIO()) as said:  # it prints what is wrong, and may end Python
            return meshio.read(name, file_format=file_format)
    except ImportError as error:
        package = "python3-h5py" if error.name == "h5py" else "python3-meshio"
        raise MissingCapability(f"{name}: {error.name} is not installed", name, f"Debian has it as {package}") from error
    except (Exception, SystemExit) as error:
        reason = str(error) if isinstance(error, Exception) and str(error) else " ".join(said.getvalue().split()) or type(error).__name__
        raise InvalidInput(f"{name}: meshio cannot read it: {reason}", name, "the format that the extension names, or file_format") from error


def _numbers(values: Any) -> bool:
    return np.asarray(values).dtype.kind in "iufb" and np.asarray(values).ndim in (1, 2)


def prepared(mesh: Any) -> Any:
    """The mesh with what a .vtu file holds: points in three dimensions and arrays of numbers. Warns about everything that is left out."""
    if mesh.points.shape[1] < 3:
        mesh.points = np.column_stack([mesh.points, np.zeros((len(mesh.points), 3 - mesh.points.shape[1]))])
    arrays = [name for name, values in mesh.point_data.items() if not _numbers(values)]
    for name in arrays:
        del mesh.point_data[name]
    for name, blocks in list(mesh.cell_data.items()):
        same = all(block is not None and _numbers(block) for block in blocks) and len({np.shape(block)[1:] for block in blocks}) == 1
        if not same:
            arrays.append(name)
            del mesh.cell_data[name]
    sets = [*mesh.point_sets, *mesh.cell_sets]
    families = [name for tags in ("point_tags", "cell_tags") for names in (getattr(mesh, tags, None) or {}).values() for name in names]
    for what, names in (("array", arrays), ("set", sets), ("group", families)):
        if names:
            some = ", ".join(f'"{name}"' for name in names[:5]) + (", …" if len(names) > 5 else "")
            warn(f"{len(names)} {what}{'s' if len(names) > 1 else ''} left out ({some})", 6)
    mesh.point_sets, mesh.cell_sets, mesh.field_data = {}, {}, {}
    return mesh


def write_vtu(mesh: Any, path: str) -> None:
    meshio = importlib.import_module("meshio")
    found = prepared(mesh)
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            meshio.write(path, found, file_format="vtu")
    except (Exception, SystemExit) as error:
        raise InvalidInput(f"{path}: meshio cannot write the mesh: {type(error).__name__}: {error}", path) from error


def read_mesh(path: Path, options: dict[str, Any]) -> tuple[_core.HexMesh, list[str]]:
    """What the library reads of what meshio reads, and its warnings."""
    name = os.fsdecode(path)
    with tempfile.TemporaryDirectory() as folder:
        made = os.path.join(folder, "mesh.vtu")
        write_vtu(read(path), made)
        try:
            mesh, said = _core.read_mesh(path_bytes(made), **options)
        except InvalidInput as error:
            raise InvalidInput(str(error).replace(made, name), error.where.replace(made, name), error.allowed) from None
    return mesh, [f"read by meshio ({EXTENSIONS[extension(path)]}); sets and steps are not read", *said]


def figures(mesh: Any) -> str:
    """"8 points, 1 hexahedron; fields T, U": what was converted."""
    counts: dict[str, int] = {}
    for block in mesh.cells:
        counts[block.type] = counts.get(block.type, 0) + len(block.data)
    fields = ", ".join(map(str, [*mesh.point_data, *mesh.cell_data]))
    cells = ", ".join(f"{count:,} {kind}" for kind, count in counts.items())
    return f"{len(mesh.points):,} points, {cells}" + (f"; fields {fields}" if fields else "")


def has_volume(mesh: Any) -> bool:
    return any(block.type.startswith(_KINDS_WITH_VOLUME) and len(block.data) for block in mesh.cells)
