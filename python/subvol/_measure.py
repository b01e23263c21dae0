# SPDX-License-Identifier: Apache-2.0
"""Numbers and surfaces of the limit: values at places, integrals, slices, isosurfaces."""
from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import TET_SCHEMES, Path, clamped, in_order, needed, path_bytes, takes, warn
from ._core import HexMesh, RbfVolume
from ._errors import InvalidInput
from ._options import described, returns_by
from ._points import _selected
from ._progress import Progress, listening
from .reports import ApproximateReport, ControlMeshReport, MapReport, MendReport, ShapeReport, SurfaceReport


@dataclass(frozen=True)
class ProbeSamples:
    """fields: (n,) or (n,channels) by name, nan outside; gradients: by position, (n,3) or (n,channels,3); cells: (n,), -1 outside;
    parameters: (n,3) in the cell"""

    fields: dict[str, npt.NDArray[np.float64]]
    gradients: dict[str, npt.NDArray[np.float64]]
    cells: npt.NDArray[np.int64]
    parameters: npt.NDArray[np.float64]

    @property
    def inside(self) -> npt.NDArray[np.bool_]:
        """Whether each place is in the volume."""
        return np.asarray(self.cells >= 0)


@dataclass(frozen=True)
class PointsError:
    """of_points: (n,), of each kernel the largest difference near it, in the field's unit; max, rms: over all places that were compared;
    gaps: places in the volume that no kernel reaches"""

    of_points: npt.NDArray[np.float64]
    max: float
    rms: float
    gaps: int


@described
def points_error(volume: RbfVolume, mesh: HexMesh, field: Optional[str] = None, *, channel: int = 0, progress: Progress = None,
                 **options: Any) -> PointsError:
    """How far the sum of kernels is from the limit of a mesh near each kernel: an estimate, from nine places each.

    field:       of the mesh, as for `sample`
    channel:     of the kernels, which is compared with it
    {keywords}
    """
    mesh = _selected(mesh, field)
    with listening(progress) as listener:
        return PointsError(*_core.points_error(volume, mesh, next(iter(mesh.fields)), channel, listener, **options))


@described
@takes("field", "at")
def probe(mesh: HexMesh, *given: Any, field: Optional[str] = None, at: Optional[npt.ArrayLike] = None, levels: Optional[int] = None,
          clamp: Optional[str] = None, progress: Progress = None, **options: Any) -> ProbeSamples:
    """Fields of the limit, with their gradients, at places in the world: exact, not interpolated in cells.

    The volume of the schemes "tetoct" and "boxspline" is linear between the vertices of a level of tetrahedra (docs/schemes.md); cells
    are those tetrahedra, and there are no parameters (nan).

    field:       its name, or a quantity of fields, a vector's length; None: all fields as they are
    at:          (n,3), world
    levels:      of "tetoct" and "boxspline", 0 to 8; None: 2
    clamp:       "file": the fields stay in the range that they have in the file, also between its points
    {keywords}

    probe(mesh, at) and the name `places` for `at` still work, and warn.
    """
    if "places" in options:
        given = (*given, options.pop("places"))
    field, at = in_order("probe", given, {"field": field, "at": at}, ("at",))
    if at is None:
        raise InvalidInput("at: is missing", "at", "places (n,3) in the world, as in probe(mesh, field, at)")
    mesh = clamped(mesh, clamp)
    mesh = mesh if field is None else _selected(mesh, field)
    places = np.asarray(at)
    if levels is not None and options.get("scheme") not in TET_SCHEMES:
        raise InvalidInput("levels: the limit is probed, not a level", "levels", "None, or the scheme tetoct or boxspline")
    with listening(progress) as listener:
        found: dict[str, Any] = _core.probe(mesh, np.empty((0, 3)) if places.size == 0 else places, 2 if levels is None else levels,
                                            listener, **options)
    return ProbeSamples(**found)


@described
@returns_by("patch", {"None": "VolumeMeasure", "str": "PatchMeasure", "Union[list[str], tuple[str, ...]]": "list[PatchMeasure]"})
def measure(mesh: HexMesh, *, only: Union[str, Sequence[str]] = (), patch: Union[str, Sequence[str], None] = None,
            flux: Optional[str] = None, clamp: Optional[str] = None, progress: Progress = None, **options: Any) -> Any:
    """The volume of the limit, and of each field its integral, mean, extremes with their places, and histogram.

    Returns cells, volume, error (an estimate of how far off the volume is, as a part of it, and each mean, as a part of its field's
    range), and fields: a dictionary by name of integral, mean, min, min_at, max, max_at, extreme_error (how far beyond these the limit
    may go), histogram (the volume in each of `bins` equal intervals from min to max); and parts: the same of each set of `mesh.sets`, which
    may have cells in common. file_volume, file_mean, file_integral, file_min, file_min_at and so on are those of the cells as they were
    given; a warning says where the limit has more than 1 % more or less volume, or leaves a field's range by more than 1 %.

    only:        a region, or several of which all hold, as of `only`; parts of space are cut exactly out of the limit, and cells are
                 measured where they lie in the limit of the whole mesh
    patch:       a patch of the boundary, of `mesh.patches`: returns name, faces, area, normal (its integral), error, and fields: by name
                 integral, mean, min, min_at, max, max_at, extreme_error, and file_ figures. Several: a list of these. Regions choose whole
                 cells then
    flux:        with `patch`, a vector such as "U" or "grad(T)": also flux, its flow out through the patch, and throughput, without sign
    clamp:       "file": the fields stay in the range that they have in the file, also between its points
    {keywords}
    """
    of_model = getattr(mesh, "is_model", False)
    mesh = clamped(mesh, clamp)
    if patch is not None:
        names = [patch] if isinstance(patch, str) else list(patch)
        left = mesh if not only else _core.only(mesh, [only] if isinstance(only, str) else list(only), 2)[0]
        with listening(progress) as listener:
            patches = _core.measure_patches(left, names, flux, listener, **options)
        return patches[0] if isinstance(patch, str) else patches
    if flux is not None:
        raise InvalidInput("flux: goes through a patch", "flux", "patch=NAME with it")
    with listening(progress) as listener:
        found: dict[str, Any] = _core.measure(mesh, [only] if isinstance(only, str) else list(only), listener, **options)
    for said in found.pop("warnings"):
        if not of_model:  # the limit of a model is what is meant
            warn(said)
    return found


@described
def approximate(onto: HexMesh, samples: Union[HexMesh, npt.ArrayLike], fields: Optional[Mapping[str, npt.ArrayLike]] = None, *,
                progress: Progress = None, **options: Any) -> tuple[HexMesh, ApproximateReport]:
    """Fits fields of a control mesh so that its limit is as near to samples as it can be, by least squares.

    onto: the control mesh; samples: a mesh whose points and fields are the data, or places (n,3) with values in `fields`. The fields of a
    mesh are known between its points, too: where these are too few for the control mesh, more places are sampled.
    Returns the control mesh with the fitted fields, and a report: samples, between (places between the points of the data), outside,
    snapped, unseen, undecided (control points that samples hardly decide, where no error is known), iterations, refined, continuous (the
    data is a mesh), and for each of fields rms, rms_boundary (nan without samples in cells at the boundary), max, max_at and range; rms_between, max_between and max_between_at, the
    distance from the data between the samples, or from the nearest sample if the data is not a mesh; and beyond, how far the limit leaves
    the range of the data.

    {keywords}
    """
    with listening(progress) as listener:
        if isinstance(samples, HexMesh):
            return _core.approximate(onto, samples, samples.fields if fields is None else fields, listener, **options)
        return _core.approximate(onto, samples, fields or {}, listener, **options)


def map_fields(onto: HexMesh, data: HexMesh, *, progress: Progress = None) -> tuple[HexMesh, MapReport]:
    """The fields of one mesh at the points of another: trilinear in the cells of the data as they are, without a limit and without a fit.

    Points outside of the data have the values of the nearest place of its boundary; a warning says how many there are, and the report has
    outside, farthest_world (the largest distance) and farthest_at.
    """
    with listening(progress) as listener:
        mapped, report = _core.map_fields(onto, data, listener)
    if report["outside"]:
        warn(f"{report['outside']} of {len(onto.points)} points lie outside of the data, at most {report['farthest_world']:.4g} from it: "
             "they have the values of its nearest place")
    return mapped, report


@described
def approximate_series(onto: HexMesh, steps: Iterable[Union[HexMesh, tuple[float, HexMesh]]], *, progress: Progress = None,
                       **options: Any) -> Iterator[tuple[HexMesh, ApproximateReport]]:
    """Fits the steps of a series one after the other, as `approximate` does: for each the control mesh with its fields, and the report.

    onto: the control mesh of all steps; steps: meshes whose fields are the data, as of `open_series`, each taken when its turn
    comes. While their points stay the same, their places in the limit are found once; `placements` of a report says how often they
    were so far. The pairs of a time and a mesh that `open_series` gives are taken as they are.

    {keywords}
    """
    approximator = _core.Approximator(onto, **options)

    def fitted() -> Iterator[tuple[HexMesh, ApproximateReport]]:
        for k, step in enumerate(steps):
            mesh = needed(step[1] if isinstance(step, tuple) and len(step) == 2 else step, HexMesh, f"steps[{k}]")
            with listening(progress) as listener:
                made = approximator.fit(mesh, mesh.fields, listener)
            yield made

    return fitted()


def read_surface(path: Path) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
    """The points (n,3) and triangles (m,3) of an .stl, .obj, .ply or .glb file. Polygons become fans of triangles."""
    points, triangles = _core.read_surface(path_bytes(path))
    return points, triangles


@described
def fit_shape(mesh: HexMesh, points: npt.ArrayLike, triangles: npt.ArrayLike, *, progress: Progress = None,
              **options: Any) -> tuple[HexMesh, ShapeReport]:
    """Moves control points so that the boundary of the limit lies on a surface of triangles, by least squares.

    points, triangles: (n,3) and (m,3), as `read_surface` and `surface` have them.
    Returns the mesh, and a report: before and after, the distances of the boundary from the surface (rms, max, max_at; covered_rms and
    covered_max without places over holes, which are hole_part of its area) and of the surface from the boundary (missed_rms, missed_max,
    missed_at), rounds, moved_world, volume_world, folds (verdict, cells, open_volume, sampled), mended, folded_cells, inverted_cells, open_edges and
    open_length (of the surface), and warnings if something is wrong.

    {keywords}
    """
    with listening(progress) as listener:
        fitted, report = _core.fit_shape(mesh, points, triangles, listener, **options)
        return fitted, report


def _placed(voxel_size: Optional[npt.ArrayLike], origin: Optional[npt.ArrayLike], transform: Optional[npt.ArrayLike]) -> npt.NDArray[np.float64]:
    """The transform (4,4) of voxels, from itself or from the others."""
    if transform is not None:
        placed = np.asarray(transform, np.float64)
        if voxel_size is not None or origin is not None or placed.shape != (4, 4) or not np.array_equal(placed[3], [0, 0, 0, 1]):
            raise InvalidInput("transform: places no voxels ((4, 4) numbers whose last row is 0, 0, 0, 1, without voxel_size and origin)",
                               "transform", "(4, 4) numbers")
        return placed
    placed = np.eye(4)
    size = np.asarray(1.0 if voxel_size is None else voxel_size, np.float64)
    first = np.zeros(3) if origin is None else np.asarray(origin, np.float64)
    if size.shape not in ((), (3,)) or not (size > 0).all():
        raise InvalidInput("voxel_size: is not the size of a voxel (its edge in the world, above 0, or three of them)", "voxel_size", "above 0")
    if first.shape != (3,):
        raise InvalidInput("origin: is not a place (three numbers: the centre of voxel 0, 0, 0)", "origin", "three numbers")
    placed[:3, :3] *= size
    placed[:3, 3] = first
    return placed


@described
def control_mesh(points: Union[npt.ArrayLike, Mapping[str, tuple[npt.ArrayLike, npt.ArrayLike]]], triangles: Optional[npt.ArrayLike] = None, *,
                 voxel_size: Optional[npt.ArrayLike] = None, origin: Optional[npt.ArrayLike] = None, transform: Optional[npt.ArrayLike] = None,
                 progress: Progress = None, **options: Any) -> tuple[HexMesh, ControlMeshReport]:
    """A mesh of hexahedra whose limit fills a closed surface of triangles, or several materials: with a surface each, or the labels of voxels.

    points, triangles: (n,3) and (m,3), as `read_surface` and `surface` have them; either side may be outside. Of several materials
    `points` alone, by name: `{"bone": (points, triangles), "skin": read_surface("skin.stl")}`. A place in more than one has the
    material of the surface that encloses least; `mesh.sets` has the cells of each. Or `points` alone as an array (nx,ny,nz) of
    integers: the labels of voxels, 0 outside, of which each becomes a material.
    voxel_size: of labels, the edge of the voxels, or three for voxels that are no cubes; None: 1
    origin:     of labels, the centre of voxel 0, 0, 0; None: (0, 0, 0)
    transform:  of labels, in place of voxel_size and origin, (4, 4): the world place of label [i, j, k] is transform @ (i, j, k, 1)
    Returns the mesh, whose patch `lid` has the sides over holes, and a report as of `fit_shape`, with parts (that are not joined), added, side_world, enclosed_world,
    min_scaled_jacobian, lid_sides, of materials name, cells, volume_world and enclosed_world, of labels name, label, voxels, voxels_world
    (their volume) and enclosed_world (by the smooth surface), and surface:
    walls (closed parts), united (that cross others), cavities, cavities_alike (with the orientation of the wall around them), copies,
    sheets and turned triangles, one_sided and many_edges.

    {keywords}
    """
    if not isinstance(points, Mapping) and triangles is None:
        labels = np.asarray(points)
        if labels.ndim == 3 and labels.dtype.kind in "iu":
            wrong = (labels < 0) | (labels > 2147483647)
            if wrong.any():
                at = tuple(int(i) for i in np.unravel_index(wrong.argmax(), wrong.shape))
                raise InvalidInput(f"labels: voxel {at} has the label {labels[at]} (0 outside, and labels from 1 to 2147483647)", "labels", "1 to 2147483647")
            placed = _placed(voxel_size, origin, transform)
            with listening(progress) as listener:
                mesh, report = _core.control_mesh_of_labels(np.ascontiguousarray(labels, np.int64), placed, listener, **options)
                return mesh, report
        if labels.ndim == 3:
            raise InvalidInput(f"labels: are of the type {labels.dtype} (an array (nx,ny,nz) of integers)", "labels", "integers")
    for name, value in (("voxel_size", voxel_size), ("origin", origin), ("transform", transform)):
        if value is not None:
            raise InvalidInput(f"{name}: has no effect on surfaces (an array (nx,ny,nz) of labels)", name, "None")
    if isinstance(points, Mapping):
        if triangles is not None:
            raise InvalidInput("triangles: have no effect beside surfaces by name", "triangles", "none")
        surfaces = [(name, *surface) for name, surface in points.items()]
    elif triangles is None:
        raise InvalidInput("triangles: there are none", "triangles", "(m,3) corners, or surfaces by name for points")
    else:
        surfaces = [("", points, triangles)]
    with listening(progress) as listener:
        mesh, report = _core.control_mesh(surfaces, listener, **options)
        return mesh, report


@dataclass(frozen=True)
class FoldCheck:
    """verdicts: (cells,) 0 proved, 1 folded, 2 open, 3 irregular; open: (cells,), the part of each cell that is not decided; of the
    folded cells, in their order: cells, parameters (n,3), positions (n,3), determinants (n,), sampled (n,): found by sampling, where
    no test decided, and times (n,): between two meshes from 0 to 1, else 0; tests: in all; places: that were sampled in undecided cells; least: the least determinant there beside the mean"""

    verdicts: npt.NDArray[np.uint8]
    open: npt.NDArray[np.float64]
    cells: npt.NDArray[np.int64]
    parameters: npt.NDArray[np.float64]
    positions: npt.NDArray[np.float64]
    determinants: npt.NDArray[np.float64]
    sampled: npt.NDArray[np.bool_]
    times: npt.NDArray[np.float64]
    tests: int
    places: int
    least: float

    @property
    def verdict(self) -> str:
        """ "sound", "folded" or "undecided"."""
        return "folded" if self.cells.size else "undecided" if np.any(self.verdicts) else "sound"


@described
def check_folds(mesh: HexMesh, *, progress: Progress = None, **options: Any) -> FoldCheck:
    """Decides for the limit of each cell whether it folds: with a proof that it does not, or a place where it does.

    {keywords}
    """
    with listening(progress) as listener:
        return FoldCheck(**_core.check_folds(mesh, listener, **options))


@described
def check_folds_between(before: HexMesh, after: HexMesh, *, progress: Progress = None, **options: Any) -> FoldCheck:
    """Decides for each cell whether its limit folds at any time while all points move straight from one mesh to another of the same
    cells. `open` is the part of the cell and of the time that is not decided; nothing is sampled.

    {keywords}
    """
    with listening(progress) as listener:
        return FoldCheck(**_core.check_folds_between(before, after, listener, **options))


@described
def mend_folds(mesh: HexMesh, *, progress: Progress = None, **options: Any) -> tuple[HexMesh, FoldCheck, MendReport]:
    """Moves control points, as little as it can, until the limit is proved not to fold.

    Returns the mesh, what `check_folds` finds of it, and a report: folded and open cells before, moved points, farthest_edges and
    boundary_edges (the longest way of a point, and of one of the boundary, in its shortest edges), rounds, and the cells that are left, with reasons.

    {keywords}
    """
    with listening(progress) as listener:
        mended, check, report = _core.mend_folds(mesh, listener, **options)
        return mended, FoldCheck(**check), report


@dataclass(frozen=True)
class Slice:
    """field: its name; values: (height,width), nan outside; gradients: (height,width,3); cells: (height,width), -1 outside; the place of
    values[row, column] is origin + column * right + row * down; min, min_at, max, max_at: the extremes of the limit on the plane, also
    between these places; area and mean: of what the plane cuts; file_area, file_mean, file_min,
    file_min_at, file_max, file_max_at: those of the cells as they were given"""

    field: str
    values: npt.NDArray[np.float64]
    gradients: npt.NDArray[np.float64]
    cells: npt.NDArray[np.int64]
    origin: npt.NDArray[np.float64]
    right: npt.NDArray[np.float64]
    down: npt.NDArray[np.float64]
    min: float
    min_at: tuple[float, float, float]
    max: float
    max_at: tuple[float, float, float]
    file_min: float
    file_min_at: tuple[float, float, float]
    file_max: float
    file_max_at: tuple[float, float, float]
    area: float
    mean: float
    file_area: float
    file_mean: float


@described
@takes("field", "point", "normal")
def slice(mesh: HexMesh, *given: Any, field: Optional[str] = None, point: Optional[Sequence[float]] = None,
          normal: Optional[Sequence[float]] = None, clamp: Optional[str] = None, progress: Progress = None, **options: Any) -> Slice:
    """A field of the limit where a plane cuts it, seen from where the normal points.

    field:       its name, or a quantity of fields; None: the most sensible scalar, said in a warning
    point, normal: a place of the plane, and its direction, three numbers each
    clamp:       "file": the fields stay in the range that they have in the file, also between its points
    {keywords}

    slice(mesh, point, normal, field) still works, and warns.
    """
    field, point, normal = in_order("slice", given, {"field": field, "point": point, "normal": normal}, ("point", "normal", "field"))
    if point is None or normal is None:
        raise InvalidInput("point, normal: a plane has both", "point", "three numbers each, as in slice(mesh, field, point, normal)")
    chosen = _selected(clamped(mesh, clamp), field)
    with listening(progress) as listener:
        found: dict[str, Any] = _core.slice(chosen, next(iter(chosen.fields)), [float(x) for x in point], [float(x) for x in normal], listener,
                                            **options)
    return Slice(**found)


@dataclass(frozen=True)
class SurfaceMesh:
    """points: (n,3); triangles: (m,3); normals: (n,3), from exact gradients; fields, gradients: at the points, by name; report: area,
    volume, watertight, euler, components, min_angle (degrees), deviation (world), converged, level"""

    points: npt.NDArray[np.float64]
    triangles: npt.NDArray[np.int64]
    normals: npt.NDArray[np.float64]
    fields: dict[str, npt.NDArray[np.float64]]
    gradients: dict[str, npt.NDArray[np.float64]]
    report: SurfaceReport


@dataclass(frozen=True)
class StreamlineSet:
    """Line i has the points from offsets[i] to offsets[i + 1]. points: (n,3); times: (n,), 0 at the seed and negative before it; fields,
    gradients: at the points, by name; offsets: (lines + 1,); seeds: (lines,), the number of each line's seed; ends: (first, last) of each
    line: why they are its ends, "boundary", "still", "length", "time", "steps", or "seed"; outside: numbers of seeds without a line;
    report: streamlines with count, points, length, outside, ends"""

    points: npt.NDArray[np.float64]
    times: npt.NDArray[np.float64]
    fields: dict[str, npt.NDArray[np.float64]]
    gradients: dict[str, npt.NDArray[np.float64]]
    offsets: npt.NDArray[np.int64]
    seeds: npt.NDArray[np.int64]
    ends: list[tuple[str, str]]
    outside: npt.NDArray[np.int64]
    report: dict[str, Any]


@described
def streamlines(mesh: HexMesh, vector: str, seeds: Union[None, str, Sequence[str], npt.ArrayLike] = None, *, path: Optional[Path] = None,
                clamp: Optional[str] = None, progress: Progress = None, **options: Any) -> StreamlineSet:
    """Streamlines of a vector field of the limit, such as "U" or "grad(T)", by Dormand and Prince's method.

    seeds:       places (n,3); or texts: "at:x,y,z", "line:x0,y0,z0,x1,y1,z1", "disk:x,y,z,nx,ny,nz,r", "sphere:x,y,z,r",
                 "box:x0,y0,z0,x1,y1,z1"; None: the middles of cells
    path:        also write them: .vtp, .csv
    clamp:       "file": the fields stay in the range that they have in the file, also between its points
    {keywords}
    """
    mesh = clamped(mesh, clamp)
    with listening(progress) as listener:
        found: dict[str, Any] = _core.streamlines(mesh, vector, seeds, None if path is None else os.fsdecode(path), listener, **options)
    for said in found["report"].pop("warnings", []):
        warn(said)
    return StreamlineSet(**found)


@described
@takes("field", "iso")
def surface(mesh: HexMesh, *given: Any, field: Optional[str] = None, iso: Union[float, Sequence[float], None] = None, boundary: Optional[bool] = None,
            path: Optional[Path] = None, origin: Optional[npt.ArrayLike] = None, clamp: Optional[str] = None, progress: Progress = None,
            **options: Any) -> SurfaceMesh:
    """Isosurfaces of a field of the limit, and its boundary, as triangles.

    field:       its name, or a quantity of fields; None: the most sensible scalar, said in a warning
    iso:         a value, or several; None: the boundary alone
    path:        also write it: .ply, .stl, .vtp, .obj, .glb, .vtkhdf
    origin:      the file's points are relative to this place (3,): .stl rounds to 32-bit floats; None: (0, 0, 0)
    clamp:       "file": the fields stay in the range that they have in the file, also between its points
    {keywords}

    surface(mesh, iso, field) still works, and warns.
    """
    field, iso = in_order("surface", given, {"field": field, "iso": iso}, ("iso", "field"))
    place = np.zeros(3) if origin is None else np.asarray(origin, dtype=float)
    if place.shape != (3,) or not np.isfinite(place).all():
        raise InvalidInput("origin: a place in the world is needed", "origin", "three finite numbers")
    if origin is not None and path is None:
        raise InvalidInput("origin: no file is written", "origin", "with path")
    isos = [] if iso is None else [float(value) for value in np.atleast_1d(np.asarray(iso, dtype=float))]
    chosen = _selected(clamped(mesh, clamp), field)
    with listening(progress) as listener:
        found: dict[str, Any] = _core.surface(chosen, next(iter(chosen.fields)), isos, None if path is None else os.fsdecode(path), list(place), listener,
                                              boundary=not isos if boundary is None else boundary, **options)
    collapsed = found["report"]["collapsed"]
    if collapsed > 0:
        warn(f"{collapsed} of {len(found['triangles'])} triangles lose a side, as .stl rounds coordinates to 32-bit floats: an origin near "
             "the body writes them relative to it, .ply keeps all digits")
    return SurfaceMesh(**found)
