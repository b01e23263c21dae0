# SPDX-License-Identifier: Apache-2.0
"""OpenVDB grids. The extension with OpenVDB is loaded by the first call that needs it."""
from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy.typing as npt

from . import _core
from ._arguments import Path, clamped, extension, needed, path_bytes, warn
from ._colors import TransferFunction
from ._core import HexMesh, RbfVolume
from ._errors import InvalidInput
from ._options import described
from ._progress import Progress, listening
from .reports import GridReport

if TYPE_CHECKING:
    from ._grids import Grid as Grid
else:
    class _LazyGrid(type):
        """The class Grid without OpenVDB, which is loaded when a grid is made: there is none before."""

        def __call__(cls, array: npt.ArrayLike, voxel_size: Optional[npt.ArrayLike] = None, origin: Optional[npt.ArrayLike] = None,
                     name: str = "density", *, transform: Optional[npt.ArrayLike] = None, level_set: bool = False,
                     background: Optional[float] = None) -> Any:
            from . import _grids

            return _grids.Grid(array, voxel_size, origin, name, transform=transform, level_set=level_set, background=background)

        def __instancecheck__(cls, x: Any) -> bool:
            import sys

            grids = sys.modules.get("subvol._grids")
            return grids is not None and isinstance(x, grids.Grid)

    class Grid(metaclass=_LazyGrid):
        """An OpenVDB grid, as `read_vdb` and `rasterize` return it: sparse voxels with values at their centres.

        Grid(array, voxel_size, origin) makes one of an array (nx, ny, nz) of real numbers, or (nx, ny, nz, 3) of vectors, which it
        copies as 32-bit floats: array[i, j, k] is the value at origin + voxel_size * (i, j, k), in the world. Voxels that are nan
        are not active: there is no value there.

        voxel_size: the edge of the voxels, or three for voxels that are no cubes
        origin:     the centre of voxel 0, 0, 0; None: (0, 0, 0)
        name:       of the grid in files
        transform:  in place of voxel_size and origin, (4, 4): the world place of array[i, j, k] is transform @ (i, j, k, 1)
        level_set:  the values are distances from a surface, below 0 inside
        background: of a level set, its largest distance: voxels that are as far are not active; None: the largest of the array

        `array()` returns a copy of the voxels in the box of the active ones, such an array of float32; a level set has no nan there.
        Its `shape`, `origin`, `voxel_size` (of cubes along the axes), `transform` and `background` are those that make the grid again.
        `values(at)` returns the values at places (n,3), trilinear, nan outside, and whether each is inside. `name`, `report`, `bounds`
        (of the active voxels' centres) and `frame` say what the grid is; `difference(other)` compares the voxels of two grids.
        """


def _with_fields(mesh: HexMesh, fields: Optional[Sequence[str]]) -> HexMesh:
    """The mesh with the fields to be written: scalars, vectors of three, lengths of others."""
    mesh = mesh.without_unused_points()
    if fields is None:
        chosen, said = _core.select_field(mesh, None)
        warn(said, 5)
        return chosen
    if isinstance(fields, str):
        fields = [fields]
    arrays = {}
    for name in fields:
        values = mesh.fields.get(name)
        if values is not None and values.ndim == 2 and values.shape[1] == 3:
            arrays[name] = values
        else:
            one, said = _core.select_field(mesh, name)
            warn(said, 5)
            arrays.update(one.fields)
    return HexMesh(mesh.points, mesh.cells, arrays, mesh.creases, mesh.sharp_faces)


_OF_POINTS = ("resolution", "voxel_size", "half")


def _make(what: Union[HexMesh, RbfVolume], path: Optional[bytes], fields: Optional[Sequence[str]], nano: bool, progress: Progress,
          clamp: Optional[str], options: dict[str, Any]) -> Any:
    from . import _grids

    what = clamped(needed(what, (HexMesh, RbfVolume), "what"), clamp)
    with listening(progress) as listener:
        if isinstance(what, RbfVolume):
            of_meshes = [name for name, value in {**options, "fields": fields}.items() if value and name not in _OF_POINTS]
            if of_meshes:
                raise InvalidInput(f"points: {', '.join(of_meshes)} are of meshes", "points", "all channels of points are summed")
            return _grids.rasterize_points(what, path, nano, listener, **options)
        mesh = clamped(_with_fields(what, fields), clamp)
        made, change, converged = _grids.rasterize(mesh, list(mesh.fields), path, nano, listener, **options)
    if not converged:
        warn(f"the finest level within limits still changed values by {change:.2g} of their range", 4)
    return made


@described
def rasterize(what: Union[HexMesh, RbfVolume], *, fields: Optional[Sequence[str]] = None, clamp: Optional[str] = None,
              progress: Progress = None, **options: Any) -> list[Grid]:
    """The grids that `write_vdb` writes, in memory.

    fields:      scalars become grids of floats, vectors grids of vectors; None: the most sensible scalar, said in a warning
    clamp:       "file": the fields stay in the range that they have in the file, also between its points
    {keywords}
    """
    made: list[Grid] = _make(what, None, fields, False, progress, clamp, options)
    return made


@described
def write_vdb(what: Union[HexMesh, RbfVolume, Grid, Sequence[Grid]], path: Path, *, fields: Optional[Sequence[str]] = None,
              nano: bool = False, clamp: Optional[str] = None, progress: Progress = None, **options: Any) -> list[GridReport]:
    """Writes the limit of a mesh, sums of kernels, or grids as `.vdb`: cubic voxels, values at their centres, active inside the volume.

    fields:      scalars become grids of floats, vectors grids of vectors; None: the most sensible scalar, said in a warning
    nano:        also writes `.nvdb`
    clamp:       "file": the fields stay in the range that they have in the file, also between its points
    {keywords}

    Returns the grids' reports: name, kind, active_voxels, voxel_size, min, max, bytes. The file appears whole or not at all.
    """
    from . import _grids

    if extension(path) != ".vdb":
        raise InvalidInput(f"{path!s}: has an unknown extension (.vdb)", str(path), ".vdb")
    if not isinstance(what, (HexMesh, RbfVolume)):
        if options or fields is not None or clamp is not None:
            raise InvalidInput("what: grids are written as they are", "what", "a mesh or points")
        grids = [what] if isinstance(what, Grid) else list(what)
        _grids.write(path_bytes(path), grids, nano)
        return [grid.report for grid in grids]
    made: list[GridReport] = _make(what, path_bytes(path), fields, nano, progress, clamp, options)
    if made[0]["active_voxels"] == 0:
        warn(f'the grid "{made[0]["name"]}" is empty: no voxel centre lies inside')
    return made


def read_vdb(path: Path, names: Union[None, str, Sequence[str]] = None) -> list[Grid]:
    """The grids of a `.vdb` file.

    names: of the grids to read, of floats, vectors, integers or masks; None: all grids of floats

    Raises InvalidInput if a grid is not there, or no grid has floats; FileError if the file cannot be read.
    """
    from . import _grids

    if names is None:
        return _grids.read_vdb(path_bytes(path))
    contents = _grids.read_vdb_contents(path_bytes(path))
    present = [grid.name for grid in contents]
    chosen = [names] if isinstance(names, str) else list(names)
    for name in chosen:
        if name not in present:
            raise InvalidInput(f"{path!s}: has no grid '{name}' (it has {', '.join(present) or 'none'})", str(path), ", ".join(present))
    return [grid for name in chosen for grid in contents if grid.name == name]


def write_usd(what: Union[Path, RbfVolume, Sequence[Union[Path, RbfVolume]]], path: Path, *, codes: Optional[Sequence[float]] = None,
              tf: Union[None, str, TransferFunction] = None, opacity_unit: Optional[float] = None, up: str = "z") -> None:
    """Writes OpenUSD text (`.usda`): a Volume with a field for each grid of floats of `.vdb` files, which are named relative to it; or
    kernels as a ParticleField3DGaussianSplat, with their values as attributes subvol:value:NAME.

    what:         a `.vdb` file or kernels, or one of either for each time code, with the same grids or channels
    codes:        the time codes; None: 0, 1, …
    tf:           the colour map: a name, or a TransferFunction; None: viridis over the values of the first grid or channel
    opacity_unit: of volumes, the distance that its opacities are for; None: 1/100 of the diagonal, as in pictures
    up:           the axis of the data that is up, which the stage says: "y" or "z"

    Raises InvalidInput for another extension, another axis, no grids, or codes that are not one for each step and ascending; FileError.
    """
    steps: list[Any] = list(what) if isinstance(what, (list, tuple)) else [what]
    times = [float(code) for code in (range(len(steps)) if codes is None else codes)]
    function = tf if isinstance(tf, TransferFunction) else TransferFunction(tf or "viridis")
    if steps and all(isinstance(step, RbfVolume) for step in steps):
        if opacity_unit is not None:
            raise InvalidInput("opacity_unit: is of volumes; the opacities of splats are those of the colour map", "opacity_unit")
        ends = [values for step in steps for values in list(step.values.values())[:1] if len(values)]
        low, high = min(float(each.min()) for each in ends), max(float(each.max()) for each in ends)
        _core.write_usd_splats(path_bytes(path), steps, times, function.knots(low, high), up)
        return
    grids: list[str] = []
    boxes, lows, highs = [], [], []
    for step in steps:  # one after the other: the grids of a long series need not fit into memory together
        contents = read_vdb(step)
        names = [grid.name for grid in contents]
        grids = grids or names
        if names != grids:
            raise InvalidInput(f"{step!s}: has other grids than {steps[0]!s}", str(step), ", ".join(grids))
        boxes.append(contents[0].frame)
        lows.append(contents[0].report["min"])
        highs.append(contents[0].report["max"])
    knots = function.knots(min(lows, default=0.0), max(highs, default=1.0))
    unit = opacity_unit
    if unit is None and boxes:
        unit = sum((b - a) ** 2 for a, b in zip(*boxes[0])) ** 0.5 / 100
    _core.write_usd(path_bytes(path), grids, [path_bytes(step) for step in steps], times, boxes, knots, 1.0 if unit is None else unit, up)


def sample_grid(grid: Grid, spacing: float = 0, progress: Progress = None) -> RbfVolume:
    """The active voxels of a grid as kernels; spacing: their distance (world), in whole voxels."""
    from . import _grids

    with listening(progress) as listener:
        return _grids.sample(grid, spacing, listener)[0]
