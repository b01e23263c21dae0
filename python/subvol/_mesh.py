# SPDX-License-Identifier: Apache-2.0
"""Meshes: files, models, refinement."""
from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Optional

import numpy as np
import numpy.typing as npt

from . import _core, _foreign
from ._arguments import Path, clamped, path_bytes, warn
from ._core import HexMesh
from ._errors import InvalidInput
from ._options import described
from ._progress import Progress, listening
from .reports import SeriesReport, WaveletReport


@described
def read_mesh(path: Path, *, clamp: Optional[str] = None, **options: Any) -> HexMesh:
    """Reads a mesh. The contents and the extension decide the format; docs/formats.md has the list. Formats that the library does not
    read but meshio or VTK do (MED, Nastran, Tecplot, LS-DYNA, Fluent and others) are read by these in a child process, without their sets.

    The names of the file are in `mesh.patches`, by name (n,2): a cell and its side, u=0, u=1, v=0, v=1, w=0 or w=1, and in
    `mesh.sets`, by name (n,): cells, and in `mesh.node_sets`, by name (n,): points. `warp`, `only`, `subdivide` and `write_mesh` keep them.

    clamp:       "file": the fields stay in the range that they have in the file, also between its points
    {keywords}

    Warns (SubvolWarning) once for each thing left out, turned round or converted.
    Raises FileError if the file cannot be opened; InvalidInput, with file and line, if it is malformed; MissingCapability if meshio or
    VTK is needed and not installed.
    """
    mesh, said = _foreign.read_mesh(path, options) if _foreign.is_foreign(path) else _core.read_mesh(path_bytes(path), **options)
    for text in said:
        warn(text)
    return clamped(mesh, clamp)


def write_mesh(mesh: HexMesh, path: Path) -> None:
    """Writes `.vtu` or `.vtkhdf` (with all fields, patches and sets), `.msh` of Gmsh (with most of them), `.inp` of Abaqus and CalculiX (with patches and sets) or `.mesh` (geometry only). The file appears whole under its name or not at all.

    Raises InvalidInput for another extension, FileError if the file cannot be written.
    """
    for text in _core.write_mesh(path_bytes(path), mesh):
        warn(text)


@described
def write_wavelets(mesh: HexMesh, path: Path, tolerance: float = 1e-3, *, progress: Progress = None,
                   **options: Any) -> WaveletReport:
    """Writes a mesh that is the refinement of a coarser one as control values and rounded details (`.svw`); `read_mesh` reads it.

    {keywords}

    Returns figures: levels, coarse_cells, cells, bytes, inverted_cells, and arrays: by name ("" are the points) coefficients, kept, rms, max.
    Raises InvalidInput if the mesh has no coarser one; FileError if the file cannot be written.
    """
    with listening(progress) as listener:
        return _core.write_wavelets(path_bytes(path), mesh, listener, tolerance=tolerance, **options)


def model(name: str, resolution: int = 0) -> HexMesh:
    """A generated mesh with its density: "pawn", "ball", "twist", "nozzle" and others (`models`).

    resolution: cells along the main direction, 2 to 512; 0 takes the default
    """
    mesh: Any = _core.make_model(name, resolution)
    mesh.is_model = True
    return mesh  # type: ignore[no-any-return]


def models() -> dict[str, str]:
    """The names of the models, with a description."""
    return _core.list_models()


@described
def subdivide(mesh: HexMesh, levels: int = 1, scheme: str = "mcq", *, on_limit: bool = False, progress: Progress = None,
              **options: Any) -> HexMesh:
    """Refines a mesh: each level splits a cell into eight. Points and fields follow the scheme.

    The cells of "tetoct" and "boxspline", which refine tetrahedra as tetrahedra, come back in hexahedra, whose linear volume is theirs.
    The children of cell c are 8c to 8c+7, but of these two. The same bits for any number of threads.

    on_limit:    also move the points to the limit (those of mcq and linear lie on it); of "tetoct" and "boxspline" the limit that
                 passes through the points and values of the mesh
    {keywords}
    """
    with listening(progress) as listener:
        return _core.subdivide(mesh, on_limit, listener, levels=levels, scheme=scheme, **options)


def quantity(mesh: HexMesh, source: str) -> npt.NDArray[np.float64]:
    """A quantity at the points of a mesh: (n,) or (n,channels).

    source: a field by its name, a component such as "U.x" or "S.xy", or what is computed from fields: "mises(S)", "principal1(S)",
            "length(U)", "grad(T)", "div(U)", "(T-293)/620"; docs/quantities.md has all. Calls with `field` take the same words.

    Derivatives are those of the limit of the scheme mcq. Raises InvalidInput with the position of what is wrong.
    """
    return _core.quantity(mesh, source)


def warp(mesh: HexMesh, field: str, factor: Optional[float] = 1) -> HexMesh:
    """The mesh with its points moved by a vector field times a factor. None: the longest displacement becomes a tenth of the diagonal."""
    return _core.warp(mesh, field, factor)


def only(mesh: HexMesh, *regions: str, levels: int = 0) -> HexMesh:
    """The cells that lie in all of some regions, as a mesh of its own. Edges where it is cut out are creases, unless it goes on smoothly
    there in the whole; so its own limit is near to what these cells are in the limit of the whole. A warning says if it is off by
    more than 1 % of its size or volume near the cut. `measure(only=)` takes the part out of the whole itself.

    regions: "box:x0,y0,z0,x1,y1,z1", "sphere:x,y,z,r", "half:px,py,pz,nx,ny,nz" (cells by their centres; a plane's normal points into
             the half), "set:A,B": the cells of `mesh.sets`, "nodes:A": those that have a point of `mesh.node_sets`, "where:T>500": a quantity that is not 0 at half of a cell's corners
             or more, or "fold:folded,open": the cells with these verdicts of `check_folds`
    levels:  0 to 4: the most that the cells are refined in the whole before they are taken (each level makes 8 of one, up to 200,000):
             until places near the cut are within 0.1 % of the part's size of where they are in the limit of the whole, by the
             scheme mcq, and fields within 1 % of their range
    """
    part, warning = _core.only(mesh, list(regions), levels)
    warn(warning)
    return part


class Series:
    """The steps of a series: pairs of a time and a mesh. Each is read when it is asked for, so that one is in memory at a time."""

    def __init__(self, steps: Sequence[tuple[Path, Optional[int]]], times: Sequence[float]) -> None:
        self._steps = list(steps)
        self.times = list(times)

    def __len__(self) -> int:
        return len(self._steps)

    def __getitem__(self, step: int) -> HexMesh:
        path, number = self._steps[step]
        return read_mesh(path, step=number)

    def __iter__(self) -> Iterator[tuple[float, HexMesh]]:
        for time, (path, number) in zip(self.times, self._steps):
            yield time, read_mesh(path, step=number)

    def __repr__(self) -> str:
        return f"<subvol.Series: {len(self)} {'step' if len(self) == 1 else 'steps'}>"


def open_series(path: Path | Sequence[Path], times: Optional[Sequence[float]] = None) -> Series:
    """The steps of a mesh that moves: a file with steps (.pvd, .vtu.series, Exodus II, OpenFOAM), or a list of mesh files.

    times: of the files of a list; without them their numbers, from 0

    Raises InvalidInput if a file is malformed or the times are not one for each file; FileError if it cannot be opened.
    """
    if not isinstance(path, Sequence) or isinstance(path, (str, bytes)):
        found = _core.series_times(path_bytes(path))
        if times is not None:
            raise InvalidInput("times: the file has its own", "times", "none, or a list of files")
        return Series([(path, step) for step in range(len(found))], found)
    given = [float(t) for t in (range(len(path)) if times is None else times)]
    if len(given) != len(path):
        raise InvalidInput(f"times: there are {len(given)} for {len(path)} files", "times", "one for each file")
    return Series([(file, None) for file in path], given)


@described
def write_series(series: Series | Sequence[HexMesh] | HexMesh, path: Path, *, times: Optional[Sequence[float]] = None,
                 progress: Progress = None, **options: Any) -> SeriesReport:
    """Writes the steps of a series, or one mesh, in few bytes (`.svw`); `open_series` and `read_mesh` read them. Points and cells keep
    their order; what changes from step to step is stored.

    times: of a list of meshes; without them their numbers, from 0

    {keywords}

    Returns figures: steps, key_steps, meshes (how often the cells are stored), points, cells, bytes, mesh_bytes, max (the largest error of all
    fields), point_max, inverted_cells, and arrays, a list: name ("" are the points), channels, steps, bytes (about), max, exact (values that are
    kept as they are). Steps are read twice, those that fit into 256 MB once. Raises InvalidInput if an option is out of range; FileError if the file cannot be written.
    """
    if isinstance(series, Series):
        if times is not None:
            raise InvalidInput("times: the series has its own", "times", "none, or a list of meshes")
        given = series.times
    else:
        if isinstance(series, HexMesh):
            series = [series]
        given = [float(t) for t in (range(len(series)) if times is None else times)]
        if len(given) != len(series):
            raise InvalidInput(f"times: there are {len(given)} for {len(series)} meshes", "times", "one for each mesh")
    steps = series
    with listening(progress) as listener:
        return _core.write_series(path_bytes(path), given, lambda k: steps[k], listener, **options)
