# SPDX-License-Identifier: Apache-2.0
"""Volumes as radial basis functions, and their kernels."""
from __future__ import annotations

import json
import math
import os
import zipfile
import zlib
from typing import Any, Optional

import numpy as np

from . import _core
from ._arguments import TET_SCHEMES, Path, clamped, extension, path_bytes, warn
from ._core import Camera, HexMesh, RbfVolume
from ._errors import FileError, InvalidInput
from ._options import described
from ._progress import Progress, listening
from .reports import ReduceReport


def _selected(mesh: HexMesh, field: Optional[str]) -> HexMesh:
    """The mesh with the one field that is sampled or drawn, and without unused points: as the command has it."""
    chosen, said = _core.select_field(mesh.without_unused_points() if len(mesh.cells) else mesh, field)
    warn(said, 4)
    return clamped(chosen, "file") if getattr(mesh, "clamped", False) else chosen


@described
def sample(mesh: HexMesh, field: Optional[str] = None, per_edge: int = 1, *, footprint: Optional[Camera] = None,
           footprint_size: tuple[int, int] = (512, 512), levels: Optional[int] = None, clamp: Optional[str] = None,
           progress: Progress = None, **options: Any) -> RbfVolume:
    """Samples the limit of a mesh into kernels: one for each control point, or more.

    field:       its name; a vector's length is taken, "name.k" is channel k; None: the most sensible scalar, said in a warning
    footprint:   instead of per_edge: at most 1.5 pixels apart as this camera sees them in a picture of `footprint_size`
    levels:      sample the trilinear cells of this level instead of the limit; with the schemes "tetoct" and "boxspline", which
                 have one kernel at each point of a level of tetrahedra, that level (None: 1)
    clamp:       "file": the fields stay in the range that they have in the file, also between its points
    {keywords}
    """
    chosen = _selected(clamped(mesh, clamp), field)
    if options.get("scheme") in TET_SCHEMES:
        return _sample_tets(chosen, footprint, levels, progress, {"per_edge": per_edge, **options})
    if levels is not None:
        chosen = _core.subdivide(chosen, True, None, levels=levels, **{key: options.pop(key, None) for key in _OF_SCHEMES})
        options = {**options, "scheme": "linear", "boundary_levels": 0}
    with listening(progress) as listener:
        volume, flat, error = _core.sample(chosen, footprint, footprint_size, listener, per_edge=per_edge, **options)
    _warn_of_flat(flat, 4)
    if error > (options.get("tolerance") or math.inf):
        warn("the tolerance was not reached with 64 samples per cell edge")
    return volume


_OF_SCHEMES = ("scheme", "tension", "crease_angle")


def _warn_of_flat(points: int, level: int) -> None:
    if points > 0:
        warn(f"{points} points lie where cells are flat; their kernels were thickened", level)


def _sample_tets(mesh: HexMesh, footprint: Optional[Camera], levels: Optional[int], progress: Progress, options: dict[str, Any]) -> RbfVolume:
    """One kernel at each point of a level of tetrahedra."""
    of_level = {key: options.pop(key, None) for key in _OF_SCHEMES}
    others = {key: value for key, value in options.items() if key not in ("correction", "kernel")}
    usual = {key: default for key, _, default, _, _ in _core.keywords["sample"]}
    if footprint is not None or any(value is not None and value != usual.get(key) for key, value in others.items()):
        raise InvalidInput("the schemes of tetrahedra have one kernel at each point of a level", "scheme", "levels makes more of them")
    with listening(progress) as listener:
        fine = _core.subdivide(mesh, True, listener, levels=1 if levels is None else levels, **of_level)
        volume, flat = _core.sample_tets(fine, listener, **{key: options[key] for key in options.keys() - others.keys()})
    _warn_of_flat(flat, 5)
    return volume


@described
def reduce(mesh: HexMesh, field: Optional[str] = None, rmse: float = 0.01, *, progress: Progress = None,
           **options: Any) -> tuple[RbfVolume, ReduceReport]:
    """Approximates a field with as few kernels as a root mean square error of `rmse` needs.

    {keywords}

    Returns the volume and a report: points, samples, rounds, rmse, validation (at independent samples), reached.
    """
    chosen = _selected(mesh, field)
    with listening(progress) as listener:
        return _core.reduce(chosen, next(iter(chosen.fields)), listener, rmse=rmse, **options)


@described
def fit(shape: str = "gaussian", scheme: str = "mcq", *, level: int = 5, **options: Any) -> tuple[dict[str, Any], dict[str, float]]:
    """The kernel of a shape that is nearest to the basis function of a scheme, and its errors (mse, rmse, mae, max).

    shape:       gaussian, scaled_gaussian, bc, cardinal, wendland_c2, wendland_c4, gaussians, separable_gaussian, separable_table
    level:       the basis function is sampled at (2^level)^3 places per lattice cell, 0 to 7
    {keywords}
    """
    kernel, errors = _core.fit(shape, scheme, level, **options)
    return json.loads(kernel), errors


def kernels() -> dict[str, dict[str, Any]]:
    """The kernels that have a name."""
    return {name: json.loads(_core.named_kernel(name)) for name in _core.kernel_names()}


def _read_npz(path: Path) -> RbfVolume:
    name = os.fsdecode(path)
    arrays = "the arrays of `write_points`: centers, frames, channels, values, gradients, moments, kernel, boundary_points, boundary_triangles"
    if not os.path.isfile(name):
        raise FileError("cannot be read: there is no such file", name)
    try:
        with np.load(name, allow_pickle=False) as file:
            channels = [label.decode("utf-8") for label in file["channels"].tolist()]
            values, gradients, moments, hessians = (dict(zip(channels, file[key])) if key in file or key == "values" else {}
                                                    for key in ("values", "gradients", "moments", "hessians"))
            return RbfVolume(file["centers"], file["frames"], values, gradients, moments, hessians, kernel=file["kernel"].item().decode("utf-8"),
                             boundary=(file["boundary_points"], file["boundary_triangles"]))
    except (KeyError, AttributeError, TypeError, UnicodeDecodeError, zipfile.BadZipFile, zlib.error, EOFError) as error:
        raise InvalidInput(f"{name}: is not a .npz of kernels: {error}", name, arrays) from None
    except ValueError as error:
        raise InvalidInput(f"{name}: {error}", name, arrays) from None


def read_points(path: Path) -> RbfVolume:
    """Reads the files of `write_points`: .ply, .vtp, .svk, .vdb, .npz."""
    if extension(path) == ".npz":
        return _read_npz(path)
    if extension(path) == ".vdb":
        from . import _grids

        return _grids.read_points(path_bytes(path))
    return _core.read_points(path_bytes(path))


@described
def write_points(volume: RbfVolume, path: Path, **options: Any) -> None:
    """Writes points as .ply, .vtp (ParaView), .svk (with levels of detail), .vdb (Houdini) or .npz (numpy), and as
    .glb the splats that viewers of glTF draw. Numbers are exact: reading gives the same bits, but of the positions in .vdb; .glb is not read.
    docs/formats.md has the arrays of a .npz.

    {keywords}
    """
    if extension(path) in (".vdb", ".svk", ".npz") and any(options.values()):
        raise InvalidInput("only .ply files have it", next(key for key, value in options.items() if value))
    if extension(path) == ".glb" and options.get("ascii"):
        raise InvalidInput("only .ply files have it", "ascii")
    if extension(path) == ".vdb":
        from . import _grids

        _grids.write_points(path_bytes(path), volume)
    else:
        _core.write_points(path_bytes(path), volume, **options)
