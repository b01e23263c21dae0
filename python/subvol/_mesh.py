# SPDX-License-Identifier: Apache-2.0
"""Meshes: files, models, refinement."""
from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Optional

from . import _core
from ._arguments import Path, path_bytes, warn
from ._core import HexMesh
from ._progress import Progress, listening


def read_mesh(path: Path, *, other_cells: str = "split", weld: Optional[float] = None, sharp: Sequence[str] = ()) -> HexMesh:
    """Reads a mesh. The extension of the file name decides the format: .mesh .meshb .vtk .vtu .vts .vtr .vti .msh .xyz .p3d .e .exo

    other_cells: "split" (tetrahedra, prisms and pyramids become hexahedra, with a warning), "ignore" or "refuse"
    weld:        joins points no farther apart than this (world units; 0: at the same place)
    sharp:       names of groups of faces and edges that stay sharp (MEDIT, Gmsh)

    Warns (SubvolWarning) once for each thing left out, turned round or converted.
    Raises FileError if the file cannot be opened; InvalidInput, with file and line, if it is malformed.
    """
    mesh, said = _core.read_mesh(path_bytes(path), other_cells, weld, list(sharp))
    for text in said:
        warn(text)
    return mesh


def write_mesh(mesh: HexMesh, path: Path) -> None:
    """Writes `.vtu` (with all fields) or `.mesh` (geometry only). The file appears whole under its name or not at all.

    Raises InvalidInput for another extension, FileError if the file cannot be written.
    """
    for text in _core.write_mesh(path_bytes(path), mesh):
        warn(text)


def model(name: str, resolution: int = 0) -> HexMesh:
    """A generated mesh with its density: "pawn", "ball", "twist", "nozzle" and others (`models`).

    resolution: cells along the main direction, 2 to 512; 0 takes the default
    """
    return _core.make_model(name, resolution)


def models() -> dict[str, str]:
    """The names of the models, with a description."""
    return _core.list_models()


def subdivide(mesh: HexMesh, levels: int = 1, scheme: str = "mcq", *, tension: float = 1 / 16,
              crease_angle: Optional[float] = None, on_limit: bool = False, progress: Progress = None) -> HexMesh:
    """Refines a mesh: each level splits a cell into eight. Points and fields follow the scheme.

    levels:       0 to 10
    scheme:       "mcq" (through the control points), "cc" (Catmull-Clark), "bsxw", "linear"
    tension:      of mcq: 0 is linear; cubics are reproduced at 1/16
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees
    on_limit:     also move the points to the limit (those of mcq and linear lie on it)

    The children of cell c are 8c to 8c+7. The same bits for any number of threads.
    """
    with listening(progress) as listener:
        return _core.subdivide(mesh, levels, scheme, tension, crease_angle, on_limit, listener)


class Series:
    """The steps of a series: pairs of a time and a mesh, read one after the other.

    Until the library reads series itself, this is a list of mesh files: one, or several in the order of their steps.
    """

    def __init__(self, paths: Sequence[Path], times: Sequence[float]) -> None:
        self._paths = list(paths)
        self.times = list(times)

    def __len__(self) -> int:
        return len(self._paths)

    def __getitem__(self, step: int) -> HexMesh:
        return read_mesh(self._paths[step])

    def __iter__(self) -> Iterator[tuple[float, HexMesh]]:
        for time, path in zip(self.times, self._paths):
            yield time, read_mesh(path)

    def __repr__(self) -> str:
        return f"<subvol.Series: {len(self)} {'step' if len(self) == 1 else 'steps'}>"


def open_series(path: Path | Sequence[Path], times: Optional[Sequence[float]] = None) -> Series:
    """The steps of a mesh that moves: one file, or a list of files in the order of their steps.

    times: of the steps; without them their numbers, from 0
    """
    from ._errors import InvalidInput

    paths: list[Path] = list(path) if isinstance(path, Sequence) and not isinstance(path, (str, bytes)) else [path]
    steps = [float(t) for t in (range(len(paths)) if times is None else times)]
    if len(steps) != len(paths):
        raise InvalidInput(f"times: there are {len(steps)} for {len(paths)} files", "times", "one for each file")
    return Series(paths, steps)
