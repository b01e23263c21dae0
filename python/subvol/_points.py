# SPDX-License-Identifier: Apache-2.0
"""Volumes as radial basis functions, and their kernels."""
from __future__ import annotations

import json
from typing import Any, Optional

from . import _core
from ._arguments import TET_SCHEMES, Kernel, Path, check_numbers, extension, kernel_json, path_bytes, warn
from ._core import Camera, HexMesh, RbfVolume
from ._errors import InvalidInput
from ._progress import Progress, listening


def _selected(mesh: HexMesh, field: Optional[str]) -> HexMesh:
    """The mesh with the one field that is sampled or drawn, and without unused points: as the command has it."""
    chosen, said = _core.select_field(mesh.without_unused_points(), field)
    warn(said, 4)
    return chosen


def sample(mesh: HexMesh, field: Optional[str] = None, per_edge: int = 1, *, centers: bool = False, spacing: float = 0,
           tolerance: float = 0, footprint: Optional[Camera] = None, footprint_size: tuple[int, int] = (512, 512), levels: Optional[int] = None,
           scheme: str = "mcq", tension: float = 1 / 16, crease_angle: Optional[float] = None, correction: str = "second",
           values: str = "scheme", kernel: Kernel = "compact", boundary_levels: Optional[int] = None,
           progress: Progress = None) -> RbfVolume:
    """Samples the limit of a mesh into kernels: one for each control point, or more.

    field:      its name; a vector's length is taken, "name.k" is channel k; None: the most sensible scalar, said in a warning
    per_edge:   sample intervals per cell edge, 1 to 64
    centers:    also one in the middle of each small cell between them: twice as many kernels, about a third of the error
    spacing:    instead: a world length that intervals do not exceed
    tolerance:  instead: as many intervals as an error below this needs, in the field's unit
    footprint:  instead: at most 1.5 pixels apart as this camera sees them in a picture of `footprint_size`
    levels:     sample the trilinear cells of this level instead of the limit
    scheme:     also "tetoct", "boxspline": one kernel at each point of a level of tetrahedra, of `levels` (None: 1)
    correction: what a kernel has beside its value: "none", "gradient", "second", "full"
    values:     between control points: "scheme", "cubic" or "paper"
    """
    chosen = _selected(mesh, field)
    if scheme in TET_SCHEMES:
        check_numbers(tension=tension)
        check_numbers(0, spacing=spacing, tolerance=tolerance, crease_angle=crease_angle)
        if per_edge != 1 or centers or spacing > 0 or tolerance > 0 or footprint is not None or values != "scheme":
            raise InvalidInput("the schemes of tetrahedra have one kernel at each point of a level", "scheme", "levels makes more of them")
        with listening(progress) as listener:
            fine = _core.subdivide(chosen, 1 if levels is None else levels, scheme, tension, crease_angle, True, listener)
            volume, flat = _core.sample_tets(fine, correction, kernel_json(kernel), listener)
        if flat > 0:
            warn(f"{flat} points lie where cells are flat; their kernels were thickened")
        return volume
    if levels is not None:
        chosen = _core.subdivide(chosen, levels, scheme, tension, crease_angle, True, None)
        scheme, boundary_levels = "linear", 0
    with listening(progress) as listener:
        volume, flat, error = _core.sample(chosen, footprint, footprint_size, listener, scheme=scheme, tension=tension,
                                           crease_angle=crease_angle, per_edge=per_edge, centers=centers, spacing=spacing,
                                           tolerance=tolerance, correction=correction, values=values, kernel=kernel_json(kernel),
                                           boundary_levels=boundary_levels)
    if flat > 0:
        warn(f"{flat} points lie where cells are flat; their kernels were thickened")
    if tolerance > 0 and error > tolerance:
        warn("the tolerance was not reached with 64 samples per cell edge")
    return volume


def reduce(mesh: HexMesh, field: Optional[str] = None, rmse: float = 0.01, *, kernel: Kernel = "compact", overlap: float = 1,
           max_points: int = 1_000_000, move: bool = False, scheme: str = "mcq",
           progress: Progress = None) -> tuple[RbfVolume, dict[str, Any]]:
    """Approximates a field with as few kernels as a root mean square error of `rmse` needs (in the field's unit).

    move: kernels are also moved and resized: about half as many, ten times as slow

    Returns the volume and a report: points, samples, rounds, rmse, validation (at independent samples), reached.
    """
    chosen = _selected(mesh, field)
    with listening(progress) as listener:
        volume, report = _core.reduce(chosen, next(iter(chosen.fields)), scheme, listener, rmse=rmse, kernel=kernel_json(kernel),
                                      overlap=overlap, max_points=max_points, move=move)
    return volume, report


def fit(shape: str = "gaussian", scheme: str = "mcq", *, level: int = 5, extent: float = 2,
        terms: int = 2) -> tuple[dict[str, Any], dict[str, float]]:
    """The kernel of a shape that is nearest to the basis function of a scheme, and its errors (mse, rmse, mae, max).

    shape: gaussian, scaled_gaussian, bc, cardinal, wendland_c2, wendland_c4, gaussians, separable_gaussian, separable_table
    level: the basis function is sampled at (2^level)^3 places per lattice cell, 0 to 7
    """
    kernel, errors = _core.fit(shape, scheme, level, extent=extent, terms=terms)
    return json.loads(kernel), errors


def kernels() -> dict[str, dict[str, Any]]:
    """The kernels that have a name."""
    return {name: json.loads(_core.named_kernel(name)) for name in _core.kernel_names()}


def read_points(path: Path) -> RbfVolume:
    """Reads the files of `write_points`: .ply, .vtp, .svk, .vdb."""
    if extension(path) == ".vdb":
        from . import _grids

        return _grids.read_points(path_bytes(path))
    return _core.read_points(path_bytes(path))


def write_points(volume: RbfVolume, path: Path, *, ascii: bool = False, splats: bool = False, up: Optional[str] = None) -> None:
    """Writes points as .ply, .vtp (ParaView), .svk (with levels of detail) or .vdb (Houdini). Numbers are exact: reading gives
    the same bits, but of the positions in .vdb.

    ascii:  .ply: text instead of binary numbers
    splats: .ply: also for viewers of Gaussian splats
    up:     with splats: the axis that these viewers show at the top, "x", "y" or "z"; None: z
    """
    if up is not None and not splats:
        raise InvalidInput("up: turns what viewers of splats read; all else keeps its place", "up", "with splats=True")
    if extension(path) in (".vdb", ".svk") and (ascii or splats):
        raise InvalidInput("only .ply files have it", "ascii" if ascii else "splats")
    if extension(path) == ".vdb":
        from . import _grids

        _grids.write_points(path_bytes(path), volume)
    else:
        _core.write_points(path_bytes(path), volume, ascii=ascii, splats=splats, up=up)
