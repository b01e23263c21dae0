# SPDX-License-Identifier: Apache-2.0
# Made by: python3 -c 'from subvol import _options; _options.print_stubs()'
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Optional, Union, overload

import numpy.typing as npt

from ._colors import TransferFunction
from ._core import Camera, Field, HexMesh, Image, RbfVolume, Refinement, Study, StudyCase, StudyResults, gl_devices, set_threads
from ._errors import Cancelled, Error, FileError, InvalidInput, MissingCapability, SubvolWarning
from ._exchange import from_meshio, from_pyvista, to_meshio, to_pyvista, to_vtk
from ._fields import LimitSamples, as_field, evaluate
from ._measure import FoldCheck, PointsError, ProbeSamples, Slice, StreamlineSet, SurfaceMesh, map_fields, read_surface
from ._mesh import Series, model, models, only, open_series, quantity, warp, write_mesh
from ._page import Page
from ._pictures import FieldComparison, ImageComparison, compare, compare_fields, compare_images, read_image, write_image
from ._points import kernels, read_points
from ._studies import run_study, studies, study
from ._vdb import Grid, read_vdb, sample_grid, write_usd
from ._arguments import Kernel, Path
from ._pictures import Drawable
from ._progress import Progress
from .reports import ApproximateReport, ControlMeshReport, DifferenceReport, FieldError, FieldMeasure, FoldFigures, GridReport, MapReport, MendReport, MeshReport, PartMeasure, PatchMeasure, ReduceReport, SeriesReport, ShapeError, ShapeReport, SurfaceReport, VolumeMeasure, WaveletReport

__version__: str

def approximate(
    onto: HexMesh, samples: Union[HexMesh, npt.ArrayLike], fields: Optional[Mapping[str, npt.ArrayLike]] = None, *,
    scheme: str = 'mcq', tension: float = 0.0625, crease_angle: Optional[Union[float, str]] = None, levels: int = 2,
    reach: float = 0.01, smoothing: float = 0.0, iterations: int = 200, clamp: bool = False, refine: int = 0,
    tolerance: float = 0.001, progress: Progress = None
) -> tuple[HexMesh, ApproximateReport]:
    """Fits fields of a control mesh so that its limit is as near to samples as it can be, by least squares.

    onto: the control mesh; samples: a mesh whose points and fields are the data, or places (n,3) with values in `fields`. The fields of a
    mesh are known between its points, too: where these are too few for the control mesh, more places are sampled.
    Returns the control mesh with the fitted fields, and a report: samples, between (places between the points of the data), outside,
    snapped, unseen, undecided (control points that samples hardly decide, where no error is known), iterations, refined, continuous (the
    data is a mesh), and for each of fields rms, rms_boundary (nan without samples in cells at the boundary), max, max_at and range; rms_between, max_between and max_between_at, the
    distance from the data between the samples, or from the nearest sample if the data is not a mesh; and beyond, how far the limit leaves
    the range of the data.

    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    levels:      how finely the limit is interpolated where the samples are: between its points on level L [1 to 4]
    reach:       samples outside count at the nearest place up to R times the box's diagonal away [0 to 1]
    smoothing:   the weight of the differences along edges: for samples with noise [0 to 1e+06]
    iterations:  the most steps of the search [1 to 100000]
    clamp:       keep control values within the range of the samples
    refine:      refine the control mesh up to N times, where the samples are not met within tolerance [0 to 6]
    tolerance:   an error that is good enough, as a part of the range [0 to 1; with refine]
    """

def approximate_series(
    onto: HexMesh, steps: Iterable[Union[HexMesh, tuple[float, HexMesh]]], *, scheme: str = 'mcq',
    tension: float = 0.0625, crease_angle: Optional[Union[float, str]] = None, levels: int = 2, reach: float = 0.01,
    smoothing: float = 0.0, iterations: int = 200, clamp: bool = False, progress: Progress = None
) -> Iterator[tuple[HexMesh, ApproximateReport]]:
    """Fits the steps of a series one after the other, as `approximate` does: for each the control mesh with its fields, and the report.

    onto: the control mesh of all steps; steps: meshes whose fields are the data, as of `open_series`, each taken when its turn
    comes. While their points stay the same, their places in the limit are found once; `placements` of a report says how often they
    were so far. The pairs of a time and a mesh that `open_series` gives are taken as they are.

    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    levels:      how finely the limit is interpolated where the samples are: between its points on level L [1 to 4]
    reach:       samples outside count at the nearest place up to R times the box's diagonal away [0 to 1]
    smoothing:   the weight of the differences along edges: for samples with noise [0 to 1e+06]
    iterations:  the most steps of the search [1 to 100000]
    clamp:       keep control values within the range of the samples
    """

def check_folds(
    mesh: HexMesh, *, scheme: str = 'mcq', tension: float = 0.0625, crease_angle: Optional[Union[float, str]] = None,
    levels: int = 5, irregular_levels: int = 2, tests: int = 1000, progress: Progress = None
) -> FoldCheck:
    """Decides for the limit of each cell whether it folds: with a proof that it does not, or a place where it does.

    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    levels:      cut a cell into eight parts up to L times where a test does not decide [0 to 8]
    irregular_levels: refine cells near irregular edges up to L times [0 to 6]
    tests:       the most tests of a cell [1 to 1000000]
    """

def check_folds_between(
    before: HexMesh, after: HexMesh, *, scheme: str = 'mcq', tension: float = 0.0625,
    crease_angle: Optional[Union[float, str]] = None, levels: int = 5, irregular_levels: int = 2, tests: int = 1000,
    time_levels: int = 5, progress: Progress = None
) -> FoldCheck:
    """Decides for each cell whether its limit folds at any time while all points move straight from one mesh to another of the same
    cells. `open` is the part of the cell and of the time that is not decided; nothing is sampled.

    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    levels:      cut a cell into eight parts up to L times where a test does not decide [0 to 8]
    irregular_levels: refine cells near irregular edges up to L times [0 to 6]
    tests:       the most tests of a cell [1 to 1000000]
    time_levels: halve the time between two steps up to L times where that does not decide [0 to 10]
    """

def control_mesh(
    points: Union[npt.ArrayLike, Mapping[str, tuple[npt.ArrayLike, npt.ArrayLike]]],
    triangles: Optional[npt.ArrayLike] = None, *, voxel_size: Optional[npt.ArrayLike] = None,
    origin: Optional[npt.ArrayLike] = None, transform: Optional[npt.ArrayLike] = None, scheme: str = 'mcq',
    tension: float = 0.0625, crease_angle: Optional[Union[float, str]] = None, cells: int = 24,
    max_cells: int = 2000000, rounds: int = 15, refine: int = 0, tolerance: float = 0.25, sharp_angle: float = 40.0,
    keep_folds: bool = False, boundary_move: float = 0.2, label: Sequence[str] = (), smooth: int = 40,
    progress: Progress = None
) -> tuple[HexMesh, ControlMeshReport]:
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

    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    cells:       cells along the longest side of the surface's box [2 to 1000]
    max_cells:   the most cells that may be made [1 to 1000000000]
    rounds:      how often the points are drawn to the nearest places of the surface; up to 20 times more where cells stay
                 flat or the limit folds [1 to 100]
    refine:      divide cells into 27 up to N times, where the boundary is not met within tolerance [0 to 3]
    tolerance:   a distance that is near enough, as a part of a cell's side [0 to 10; with refine]
    sharp_angle: edges of the surface that are bent by more become creases of the mesh (180: none) [1 to 180]
    keep_folds:  leave the points where they are if the limit folds
    boundary_move: points of the boundary may move by this part of their shortest edge where the limit folds [0 to 10; not
                 with keep_folds]
    label:       of labels: one that becomes a material, and the name of its set (label_N without one); all others are
                 outside. Without this option all labels become materials
    smooth:      of labels: rounds of smoothing, in which no point leaves the place between its voxels (0: their steps) [0
                 to 1000]
    """

def evaluate_limit(
    mesh: HexMesh, cells: npt.ArrayLike, uvw: npt.ArrayLike, *, scheme: str = 'mcq', tension: float = 0.0625,
    crease_angle: Optional[Union[float, str]] = None, tolerance: float = 1e-06, max_levels: int = 10,
    progress: Progress = None
) -> LimitSamples:
    """Positions, Jacobians and all fields of the limit at places in control cells.

    cells:       (n,) their numbers
    uvw:         (n,3) in [0,1]: u along corners 0-1, v along 0-3, w along 0-4
    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    tolerance:   what is not exact is refined until two levels differ by less: of the diagonal and of each field's range [0
                 or more]
    max_levels:  refinement ends there in any case [2 to 20]

    Raises InvalidInput if a cell does not exist or a place lies outside [0,1].
    """

def fit(
    shape: str = 'gaussian', scheme: str = 'mcq', *, level: int = 5, extent: float = 2.0, terms: int = 2,
    sign_slip: bool = False
) -> tuple[dict[str, Any], dict[str, float]]:
    """The kernel of a shape that is nearest to the basis function of a scheme, and its errors (mse, rmse, mae, max).

    shape:       gaussian, scaled_gaussian, bc, cardinal, wendland_c2, wendland_c4, gaussians, separable_gaussian, separable_table
    level:       the basis function is sampled at (2^level)^3 places per lattice cell, 0 to 7
    extent:      the distance at which bc and cardinal end [0.001 to 3]
    terms:       number of gaussians in a sum [1 to 6]
    sign_slip:   fit bc with the sign error of the paper's fits in the inner cubic coefficient
    """

def fit_shape(
    mesh: HexMesh, points: npt.ArrayLike, triangles: npt.ArrayLike, *, scheme: str = 'mcq', tension: float = 0.0625,
    crease_angle: Optional[Union[float, str]] = None, shape_rounds: int = 10, stiffness: float = 0.01,
    keep_folds: bool = False, boundary_move: float = 0.2, progress: Progress = None
) -> tuple[HexMesh, ShapeReport]:
    """Moves control points so that the boundary of the limit lies on a surface of triangles, by least squares.

    points, triangles: (n,3) and (m,3), as `read_surface` and `surface` have them.
    Returns the mesh, and a report: before and after, the distances of the boundary from the surface (rms, max, max_at; covered_rms and
    covered_max without places over holes, which are hole_part of its area) and of the surface from the boundary (missed_rms, missed_max,
    missed_at), rounds, moved_world, volume_world, folds (verdict, cells, open_volume, sampled), mended, folded_cells, inverted_cells, open_edges and
    open_length (of the surface), and warnings if something is wrong.

    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    shape_rounds: look for the nearest places and move the points up to N times [1 to 1000]
    stiffness:   how much neighbours move together: more for surfaces with noise [1e-06 to 1e+06]
    keep_folds:  leave the points where they are if the limit folds
    boundary_move: points of the boundary may move by this part of their shortest edge where the limit folds [0 to 10; not
                 with keep_folds]
    """

def from_vtk(
    grid: Any, *, other_cells: str = 'split', weld: Optional[float] = None, curved: Union[float, str] = '5e-06',
    cell_values: str = 'auto', crease_angle: Union[float, str] = 'auto'
) -> HexMesh:
    """The mesh of a `vtkUnstructuredGrid`, as `read_mesh` makes it of a file with this grid: tetrahedra, prisms, pyramids and polyhedra
    are split, curved cells followed, ghost cells dropped, values at cells moved to the points, creases and sharp faces tagged, patches
    and sets of cells found.

    other_cells: what to do with tetrahedra, prisms and pyramids: split (all cells, into hexahedra), ignore, refuse [split,
                 ignore, refuse]
    weld:        join points of a file whose distance is at most D; 0: those at the same place [0 or more]
    curved:      split curved hexahedra into smaller ones, to within this part T of the mesh's size from their true shape,
                 and 400 T of the fields' ranges; corners: use nothing but their corners [corners]
    cell_values: what values at cells are: fit (the volume follows the cells' means without waves; the default for
                 OpenFOAM), mean (values at points, of the cells around each; the default for all others), exact (the volume
                 has the cells' means), constant (as they are, in each cell; the default for integers, such as materials),
                 auto [auto, fit, mean, exact, constant]
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none; auto: those that bend by
                 more than 40, and on round bodies of few cells by more than 60, unless the file has creases [auto, none]

    Warns (SubvolWarning) once for each thing left out, turned round or converted.
    """

@overload
def measure(
    mesh: HexMesh, *, only: Union[str, Sequence[str]] = (), patch: None = None, flux: Optional[str] = None,
    clamp: Optional[str] = None, scheme: str = 'mcq', tension: float = 0.0625,
    crease_angle: Optional[Union[float, str]] = None, tolerance: float = 0.0001, bins: int = 32,
    progress: Progress = None
) -> VolumeMeasure: ...

@overload
def measure(
    mesh: HexMesh, *, only: Union[str, Sequence[str]] = (), patch: str, flux: Optional[str] = None,
    clamp: Optional[str] = None, scheme: str = 'mcq', tension: float = 0.0625,
    crease_angle: Optional[Union[float, str]] = None, tolerance: float = 0.0001, bins: int = 32,
    progress: Progress = None
) -> PatchMeasure: ...

@overload
def measure(
    mesh: HexMesh, *, only: Union[str, Sequence[str]] = (), patch: Union[list[str], tuple[str, ...]],
    flux: Optional[str] = None, clamp: Optional[str] = None, scheme: str = 'mcq', tension: float = 0.0625,
    crease_angle: Optional[Union[float, str]] = None, tolerance: float = 0.0001, bins: int = 32,
    progress: Progress = None
) -> list[PatchMeasure]:
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
    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    tolerance:   of the volume as a part of it, of means and extremes as parts of each field's range [more than 0, at most
                 1]
    bins:        intervals of the histogram [1 to 100000]
    """

def mend_folds(
    mesh: HexMesh, *, scheme: str = 'mcq', tension: float = 0.0625, crease_angle: Optional[Union[float, str]] = None,
    levels: int = 5, irregular_levels: int = 2, tests: int = 1000, boundary_move: float = 0.1, rounds: int = 10,
    progress: Progress = None
) -> tuple[HexMesh, FoldCheck, MendReport]:
    """Moves control points, as little as it can, until the limit is proved not to fold.

    Returns the mesh, what `check_folds` finds of it, and a report: folded and open cells before, moved points, farthest_edges and
    boundary_edges (the longest way of a point, and of one of the boundary, in its shortest edges), rounds, and the cells that are left, with reasons.

    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    levels:      cut a cell into eight parts up to L times where a test does not decide [0 to 8]
    irregular_levels: refine cells near irregular edges up to L times [0 to 6]
    tests:       the most tests of a cell [1 to 1000000]
    boundary_move: points of the boundary may move by this part of their shortest edge [0 to 10]
    rounds:      move points and check again up to N times [1 to 50]
    """

def mesh_difference(
    test: HexMesh, reference: HexMesh, *, scheme: str = 'mcq', tension: float = 0.0625,
    crease_angle: Optional[Union[float, str]] = None, progress: Progress = None
) -> tuple[HexMesh, DifferenceReport]:
    """The first mesh with test - reference of each field that both have, at its points, as `subvol compare A B -o FILE` writes it.

    Values of the reference are those of its limit at the points, or those of its own points if both meshes have the same points and
    cells. The report has same_points, whether that is so; outside, the number of points outside the reference, which get the
    value of its nearest place, and outside_distance, how far the farthest is; and for each of fields max, at and point: the largest
    difference and where it is.

    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    """

def page(
    mesh: Union[HexMesh, Grid], field: Optional[str] = None, *, per_edge: int = 1,
    camera: Union[None, str, Camera] = None, tf: Union[None, str, TransferFunction] = None, title: str = '',
    unit: str = '', max_bytes: int = 24000000, scheme: str = 'mcq', clamp: Union[bool, str] = False,
    look: Optional[str] = None, opacity_unit: Optional[float] = None, range: Optional[str] = None,
    opacity: Optional[str] = None, iso: Optional[Union[float, str]] = None, log: bool = False,
    symlog: Optional[float] = None, bands: Optional[int] = None, below: Optional[str] = None,
    above: Optional[str] = None, view: str = 'iso', up: str = 'z', fit: bool = False, ortho: bool = False,
    progress: Progress = None
) -> Page:
    """A page of a field of a mesh, or of the body within the surface of a level set: as `subvol page`.

    unit:        of the field, for the legend
    max_bytes:   kernels are rounded, then merged, until the page fits
    tf may also be a TransferFunction, camera a Camera, clamp "file": the field stays in the range that it has in the file, also between
    its points. The look isosurface is not drawn in pages.
    look:        solid (opaque and lit; the default for meshes without opacity and opacity_unit), volume (opacity 0 to .5
                 over the range, black behind; otherwise the default), xray (on white) or isosurface (five lit surfaces)
                 [solid, volume, xray, isosurface]
    tf:          colour map over the field's range: viridis (default), plasma, inferno, cividis, turbo, coolwarm, jet,
                 rainbow, desaturated, blackbody, grey, bone, xray, isosurface, surface, constant or categories (integers);
                 or a ParaView colour-map JSON file (FILE.json:NAME for one of several in it) [viridis, plasma, inferno,
                 cividis, turbo, coolwarm, grey, bone, jet, rainbow, desaturated, blackbody, xray, isosurface, surface,
                 constant, categories]
    opacity_unit: the world distance over which an opacity acts (default: 1/100 of the bounding box's diagonal; 1/4 for xray
                 of a body without a field) [more than 0]
    clamp:       show values beyond the field's range, where interpolating schemes overshoot, as its ends
    range:       the range that the colour map and the percentages of opacity cover: MIN,MAX, per cents of the field's range
                 such as 10%,90%, or field (default: the field's range; a map from a file keeps its own values)
    opacity:     opacities instead of those of tf, linear in between: at values of the field or per cent of its range, such
                 as 0%:0,50%:.2,100%:.9; of a solid: of its surface
    iso:         lit surfaces of these values, or per cents of the field's range: look isosurface with these instead of its
                 five [not with opacity]
    log:         spread the colour map by the logarithm of the values, which are above 0
    symlog:      spread the colour map logarithmically on both sides of 0, linearly within C [more than 0; not with log]
    bands:       cut the colour map into N colours [1 to 1000]
    below:       the colour of values below the range: #rrggbb, three numbers or a name (default: that of its end)
    above:       the colour of values above the range (default: that of its end)
    camera:      ex,ey,ez,tx,ty,tz,ux,uy,uz,fovy (eye, target, up, vertical field of view in degrees), or a JSON file with
                 eye, target, up, fovy_deg or ortho_height
    view:        the side to look from: +x -x +y -y +z -z iso, front (-y) back left right top bottom [+x, -x, +y, -y, +z,
                 -z, iso, front, back, left, right, top, bottom; not with camera]
    up:          the axis of the data that is up, in iso, front and all other views: x, y or z [x, y, z; not with camera]
    fit:         move the camera along its line of sight until the whole box is in the picture
    ortho:       use an orthographic camera, as high as the box needs or as the JSON file's ortho_height
    """

def points_error(
    volume: RbfVolume, mesh: HexMesh, field: Optional[str] = None, *, channel: int = 0, scheme: str = 'mcq',
    tension: float = 0.0625, crease_angle: Optional[Union[float, str]] = None, progress: Progress = None
) -> PointsError:
    """How far the sum of kernels is from the limit of a mesh near each kernel: an estimate, from nine places each.

    field:       of the mesh, as for `sample`
    channel:     of the kernels, which is compared with it
    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    """

def probe(
    mesh: HexMesh, field: Optional[str] = None, at: Optional[npt.ArrayLike] = None, *, levels: Optional[int] = None,
    clamp: Optional[str] = None, scheme: str = 'mcq', tension: float = 0.0625,
    crease_angle: Optional[Union[float, str]] = None, reach: float = 0.0, progress: Progress = None
) -> ProbeSamples:
    """Fields of the limit, with their gradients, at places in the world: exact, not interpolated in cells.

    The volume of the schemes "tetoct" and "boxspline" is linear between the vertices of a level of tetrahedra (docs/schemes.md); cells
    are those tetrahedra, and there are no parameters (nan).

    field:       its name, or a quantity of fields, a vector's length; None: all fields as they are
    at:          (n,3), world
    levels:      of "tetoct" and "boxspline", 0 to 8; None: 2
    clamp:       "file": the fields stay in the range that they have in the file, also between its points
    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear; of
                 tetrahedra as tetrahedra: tetoct, boxspline [mcq, cc, bsxw, linear, tetoct, boxspline]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    reach:       places outside, at most this far from the boundary, get the values of its nearest point [0 or more]

    probe(mesh, at) and the name `places` for `at` still work, and warn.
    """

def rasterize(
    what: Union[HexMesh, RbfVolume], *, fields: Optional[Sequence[str]] = None, clamp: Optional[str] = None,
    scheme: str = 'mcq', tension: float = 0.0625, crease_angle: Optional[Union[float, str]] = None,
    voxel_size: Optional[float] = None, resolution: int = 200, half: bool = False, cell_ids: bool = False,
    mask: bool = False, coverage: bool = False, levels: Optional[int] = None, sdf: Optional[str] = None,
    half_width: float = 3.0, progress: Progress = None
) -> list[Grid]:
    """The grids that `write_vdb` writes, in memory.

    fields:      scalars become grids of floats, vectors grids of vectors; None: the most sensible scalar, said in a warning
    clamp:       "file": the fields stay in the range that they have in the file, also between its points
    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    voxel_size:  edge of a voxel in world units [more than 0]
    resolution:  voxels along the longest side of the bounding box [1 to 1048576; not with voxel_size]
    half:        store floats in 16 bits
    cell_ids:    also write a grid: the number of the control cell
    mask:        also write a grid: a mask of the volume
    coverage:    also write a grid: the part of each voxel that the volume fills
    levels:      the trilinear cells of this level instead of the limit [0 to 10]
    sdf:         also write a level set, named NAME or sdf: the distance to the boundary, negative inside, in a narrow band
    half_width:  the band's reach to either side, in voxels [1 to 1000; with sdf]
    """

def read_mesh(
    path: Path, *, clamp: Optional[str] = None, other_cells: str = 'split', weld: Optional[float] = None,
    curved: Union[float, str] = '5e-06', cell_values: str = 'auto', patch_values: str = 'normal',
    step: Optional[int] = None, time: Optional[float] = None, blocks: Sequence[str] = (), sharp: Sequence[str] = (),
    mesh: str = '', crease_angle: Union[float, str] = 'auto'
) -> HexMesh:
    """Reads a mesh. The contents and the extension decide the format; docs/formats.md has the list. Formats that the library does not
    read but meshio or VTK do (MED, Nastran, Tecplot, LS-DYNA, Fluent and others) are read by these in a child process, without their sets.

    The names of the file are in `mesh.patches`, by name (n,2): a cell and its side, u=0, u=1, v=0, v=1, w=0 or w=1, and in
    `mesh.sets`, by name (n,): cells, and in `mesh.node_sets`, by name (n,): points. `warp`, `only`, `subdivide` and `write_mesh` keep them.

    clamp:       "file": the fields stay in the range that they have in the file, also between its points
    other_cells: what to do with tetrahedra, prisms and pyramids: split (all cells, into hexahedra), ignore, refuse [split,
                 ignore, refuse]
    weld:        join points of a file whose distance is at most D; 0: those at the same place [0 or more]
    curved:      split curved hexahedra into smaller ones, to within this part T of the mesh's size from their true shape,
                 and 400 T of the fields' ranges; corners: use nothing but their corners [corners]
    cell_values: what values at cells are: fit (the volume follows the cells' means without waves; the default for
                 OpenFOAM), mean (values at points, of the cells around each; the default for all others), exact (the volume
                 has the cells' means), constant (as they are, in each cell; the default for integers, such as materials),
                 auto [auto, fit, mean, exact, constant]
    patch_values: what OpenFOAM has on patches of the boundary: normal (points there get it, but of vectors at walls only
                 the component along the normal: integrals over the volume hardly change; not with cell_values exact), meet
                 (vectors at walls get all of it, such as a velocity of 0), ignore [meet, normal, ignore]
    step:        a step of a series, from 0 (default: the last one) [0 to 1000000000]
    time:        the step of a series whose time is nearest to this [not with step]
    blocks:      the named parts of the mesh to read (info lists them; default: all)
    sharp:       a group of the file whose faces inside the mesh and edges are kept sharp: a physical group of Gmsh by its
                 name or number, a reference of MEDIT, or Ridges (repeatable)
    mesh:        of a .frd file of CalculiX, the deck that it has the results of: its sets of elements and surfaces become
                 sets and patches
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none; auto: those that bend by
                 more than 40, and on round bodies of few cells by more than 60, unless the file has creases [auto, none]

    Warns (SubvolWarning) once for each thing left out, turned round or converted.
    Raises FileError if the file cannot be opened; InvalidInput, with file and line, if it is malformed; MissingCapability if meshio or
    VTK is needed and not installed.
    """

def reduce(
    mesh: HexMesh, field: Optional[str] = None, rmse: float = 0.01, *, kernel: Kernel = 'compact', overlap: float = 1.0,
    max_points: int = 1000000, move: bool = False, scheme: str = 'mcq', progress: Progress = None
) -> tuple[RbfVolume, ReduceReport]:
    """Approximates a field with as few kernels as a root mean square error of `rmse` needs.

    rmse:        the root mean square error, in the field's unit [more than 0]
    kernel:      the kernel of the points
    overlap:     1 is the overlap of uniform samples [0.7 to 2]
    max_points:  no more kernels than these
    move:        also move and resize the kernels: about half as many, ten times as slow
    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]

    Returns the volume and a report: points, samples, rounds, rmse, validation (at independent samples), reached.
    """

def render(
    what: Drawable, *, method: str = 'splat', camera: Union[None, str, Camera] = None,
    size: tuple[int, int] = (512, 512), field: Optional[str] = None, tf: Union[None, str, TransferFunction] = None,
    patch: Union[None, str, Sequence[str]] = None, part_opacity: Union[None, str, Sequence[str]] = None,
    ray_ends: Optional[npt.ArrayLike] = None, seeds: Union[None, str, Sequence[str], npt.ArrayLike] = None,
    clamp: Union[bool, str] = False, scheme: str = 'mcq', tension: float = 0.0625,
    crease_angle: Optional[Union[float, str]] = None, levels: Optional[int] = None, per_edge: int = 1,
    spacing: float = 0.0, tolerance: float = 0.0, centers: bool = False, values: str = 'scheme',
    kernel: Kernel = 'compact', value_kernel: Kernel = 'paper_bc', correction: str = 'second', backend: str = 'auto',
    device: Optional[int] = None, sheets: int = 0, shadows: bool = False, ambient_occlusion: float = 0.0,
    samples: Optional[int] = None, image_tolerance: Optional[float] = None, order: str = 'topological',
    kbuffer: int = 6, lod: Optional[float] = None, seconds: Optional[float] = None, shade: bool = False,
    color_field: Optional[str] = None, clip: Optional[npt.ArrayLike] = None, clip_box: Optional[npt.ArrayLike] = None,
    slice: Optional[npt.ArrayLike] = None, around: bool = False, look: Optional[str] = None,
    opacity_unit: Optional[float] = None, range: Optional[str] = None, opacity: Optional[str] = None,
    iso: Optional[Union[float, str]] = None, log: bool = False, symlog: Optional[float] = None,
    bands: Optional[int] = None, below: Optional[str] = None, above: Optional[str] = None, view: str = 'iso',
    up: str = 'z', fit: bool = False, ortho: bool = False, streamlines: str = '', seed_count: int = 30,
    stream_direction: str = 'both', stream_length: Optional[float] = None, stream_time: Optional[float] = None,
    stream_tolerance: float = 1e-06, stream_step: float = 0.01, tube_radius: float = 0.003, glyphs: str = '',
    glyph_count: int = 400, glyph_size: float = 0.06, progress: Progress = None
) -> Image:
    """Draws a mesh, points or a grid: the picture of `subvol render` with the same options, bit for bit.

    A keyword that has no effect with the method is refused; docs/pictures.md has the table. None leaves the default.

    method:      "splat" (kernels), "sheets" (the same by OpenGL sheet buffers), "footprints" (kernels coloured first, as
                 Westover did), "tets" (rays through tetrahedra), "pt" (tetrahedra projected by OpenGL), "dense" (rays through the
                 limit's cells), "grid" (rays through voxels)
    size:        width and height in pixels
    field:       what is drawn; tf may also be a TransferFunction, camera a Camera
    patch:       patches of `mesh.patches` that are drawn alone, or "all"; coloured by patch, or by `field`
    part_opacity: opacities of parts of a solid, such as "casing=.2" (a set of cells) or "half:0,0,0,1,0,0=.3" (a region as of `only`), or
                 several; 0 leaves a part out
    ray_ends:    (height, width) eye depths at which the rays of each pixel end, as where they meet something opaque that another
                 program draws; infinity: they do not. Not with method="footprints"
    seeds:       where the streamlines of `streamlines` start, as for `subvol.streamlines`. The body is thin then, unless its look or
                 opacities are chosen or it is cut
    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    levels:      draw the refined mesh of this level (default for tets and pt: 1, if large 0; others: the limit) [0 to 10]
    per_edge:    sample intervals per cell edge; 1 is one kernel per control point [1 to 64]
    spacing:     distance between samples in world units, instead of per_edge; for a grid, rounded to whole voxels (default:
                 one kernel per voxel) [more than 0; not with per_edge]
    tolerance:   instead: as many samples as an error of the field below E needs, in the field's unit [more than 0; not with
                 per_edge, spacing]
    centers:     also a kernel in the middle of each small cell between the samples: twice as many kernels, about a third of
                 the error
    values:      values between control points: scheme (exact), cubic (Catmull-Rom), paper (weighted mean) [scheme, cubic,
                 paper]
    kernel:      the kernel of the points; see `subvol fit --kernels`
    value_kernel: the kernel that weighs the values of control points [with values='paper']
    correction:  the derivatives of the field that kernels carry: none, gradient, second, full [none, gradient, second,
                 full]
    backend:     where to splat: auto (default: a GPU, else the CPU), gl, cpu [auto, gl, cpu]
    device:      the OpenGL device's number in `info --gl` (default: the first GPU) [0 to 1000; not with backend='cpu']
    sheets:      splat: number of planes over the volume's depth (default: as many as the kernels need for tolerance_image)
                 [2 to 65536]
    shadows:     splat: the volume shadows itself from the light at the upper left
    ambient_occlusion: splat: darken hollows that are narrower than this part of the box's diagonal, such as .1 [0 to 1]
    samples:     n x n rays per pixel (default 1; 2 for look solid) [1 to 16]
    image_tolerance: how far colours may be off: splat and sheets take as many sheets as that needs (default .001); dense,
                 without levels, draws level after level until the picture changes by less [more than 0; not with levels;
                 not with sheets]
    order:       pt: how the tetrahedra are sorted: topological (by shared faces), centroid, lists (one per pixel) or havs
                 (faces by centroid, then a k-buffer per pixel) [topological, centroid, lists, havs]
    kbuffer:     havs: entries of the k-buffer [1 to 65536; with order='havs']
    lod:         splat: merge kernels as long as they are narrower than so many pixels, such as 2 (default 0: never); havs:
                 the fraction of the interior faces that is drawn (default 1) [0 or more]
    seconds:     the best picture within this time; splat: first coarse, then with the mesh sampled for the view; pt: first
                 the faces of the boundary, then more and more of those inside; kernels follow from the time then, not from
                 levels, reduce, threshold or footprint [more than 0; not with order, lod]
    shade:       splat: light on surfaces of equal value, from the eye and from the upper left [not with look='solid' or
                 'isosurface']
    color_field: splat: take the colours from this field; opacities stay those of field
    clip:        cut away what lies on the side of this plane to which its normal points: a point and the normal
                 (repeatable)
    clip_box:    cut away what lies outside this box: its lower and its upper corner
    slice:       draw the volume on this plane alone, opaque and in the colours of its values: a point and the normal
                 (repeatable)
    around:      draw the volume around the slices too, as look says [with slice]
    look:        solid (opaque and lit; the default for meshes without opacity and opacity_unit), volume (opacity 0 to .5
                 over the range, black behind; otherwise the default), xray (on white) or isosurface (five lit surfaces)
                 [solid, volume, xray, isosurface]
    tf:          colour map over the field's range: viridis (default), plasma, inferno, cividis, turbo, coolwarm, jet,
                 rainbow, desaturated, blackbody, grey, bone, xray, isosurface, surface, constant or categories (integers);
                 or a ParaView colour-map JSON file (FILE.json:NAME for one of several in it) [viridis, plasma, inferno,
                 cividis, turbo, coolwarm, grey, bone, jet, rainbow, desaturated, blackbody, xray, isosurface, surface,
                 constant, categories]
    opacity_unit: the world distance over which an opacity acts (default: 1/100 of the bounding box's diagonal; 1/4 for xray
                 of a body without a field) [more than 0]
    clamp:       show values beyond the field's range, where interpolating schemes overshoot, as its ends
    range:       the range that the colour map and the percentages of opacity cover: MIN,MAX, per cents of the field's range
                 such as 10%,90%, or field (default: the field's range; a map from a file keeps its own values)
    opacity:     opacities instead of those of tf, linear in between: at values of the field or per cent of its range, such
                 as 0%:0,50%:.2,100%:.9; of a solid: of its surface
    iso:         lit surfaces of these values, or per cents of the field's range: look isosurface with these instead of its
                 five [not with opacity]
    log:         spread the colour map by the logarithm of the values, which are above 0
    symlog:      spread the colour map logarithmically on both sides of 0, linearly within C [more than 0; not with log]
    bands:       cut the colour map into N colours [1 to 1000]
    below:       the colour of values below the range: #rrggbb, three numbers or a name (default: that of its end)
    above:       the colour of values above the range (default: that of its end)
    camera:      ex,ey,ez,tx,ty,tz,ux,uy,uz,fovy (eye, target, up, vertical field of view in degrees), or a JSON file with
                 eye, target, up, fovy_deg or ortho_height
    view:        the side to look from: +x -x +y -y +z -z iso, front (-y) back left right top bottom [+x, -x, +y, -y, +z,
                 -z, iso, front, back, left, right, top, bottom; not with camera]
    up:          the axis of the data that is up, in iso, front and all other views: x, y or z [x, y, z; not with camera]
    fit:         move the camera along its line of sight until the whole box is in the picture
    ortho:       use an orthographic camera, as high as the box needs or as the JSON file's ortho_height
    streamlines: draw streamlines of this vector as tubes, in the colours of the field that is shown, which is the length of
                 the vector unless one is named
    seed_count:  how many seeds: of each text that says where they are, or of middles of cells [1 to 100000; with
                 streamlines]
    stream_direction: follow the field both ways, forward or backward [both, forward, backward; with streamlines]
    stream_length: no streamline is longer to either side of its seed (default: two diagonals of the body) [more than 0;
                 with streamlines]
    stream_time: nor does it take longer [more than 0; with streamlines]
    stream_tolerance: the error of a step along a streamline, as a part of the diagonal [more than 0, at most 0.01; with
                 streamlines]
    stream_step: no step along a streamline is longer, as a part of the diagonal [1e-05 to 0.5; with streamlines]
    tube_radius: the radius of the tubes that show streamlines, as a part of the diagonal [1e-05 to 0.1; with streamlines]
    glyphs:      draw arrows along this vector, as long as it is large, in middles of cells that stand for as much volume
                 each
    glyph_count: the number of arrows, at most one in each cell [1 to 1000000; with glyphs]
    glyph_size:  the length of the longest arrow, as a part of the diagonal [0.0001 to 1; with glyphs]

    clamp may also be "file": the fields stay in the range that they have in the file, also between its points.
    Cuts are rows of six numbers, each a list or an array. Returns an Image: `numpy.asarray(image)` is (height, width, 4) float32,
    linear, premultiplied, without a copy. Its `report` has counts and seconds.
    """

def sample(
    mesh: HexMesh, field: Optional[str] = None, per_edge: int = 1, *, footprint: Optional[Camera] = None,
    footprint_size: tuple[int, int] = (512, 512), levels: Optional[int] = None, clamp: Optional[str] = None,
    scheme: str = 'mcq', tension: float = 0.0625, crease_angle: Optional[Union[float, str]] = None,
    spacing: float = 0.0, tolerance: float = 0.0, centers: bool = False, values: str = 'scheme',
    kernel: Kernel = 'compact', value_kernel: Kernel = 'paper_bc', correction: str = 'second',
    boundary_levels: Optional[int] = None, progress: Progress = None
) -> RbfVolume:
    """Samples the limit of a mesh into kernels: one for each control point, or more.

    field:       its name; a vector's length is taken, "name.k" is channel k; None: the most sensible scalar, said in a warning
    footprint:   instead of per_edge: at most 1.5 pixels apart as this camera sees them in a picture of `footprint_size`
    levels:      sample the trilinear cells of this level instead of the limit; with the schemes "tetoct" and "boxspline", which
                 have one kernel at each point of a level of tetrahedra, that level (None: 1)
    clamp:       "file": the fields stay in the range that they have in the file, also between its points
    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    per_edge:    sample intervals per cell edge; 1 is one kernel per control point [1 to 64]
    spacing:     distance between samples in world units, instead of per_edge; for a grid, rounded to whole voxels (default:
                 one kernel per voxel) [more than 0; not with per_edge]
    tolerance:   instead: as many samples as an error of the field below E needs, in the field's unit [more than 0; not with
                 per_edge, spacing]
    centers:     also a kernel in the middle of each small cell between the samples: twice as many kernels, about a third of
                 the error
    values:      values between control points: scheme (exact), cubic (Catmull-Rom), paper (weighted mean) [scheme, cubic,
                 paper]
    kernel:      the kernel of the points; see `subvol fit --kernels`
    value_kernel: the kernel that weighs the values of control points [with values='paper']
    correction:  the derivatives of the field that kernels carry: none, gradient, second, full [none, gradient, second,
                 full]
    boundary_levels: refinements of the boundary surface (default: so that its quads are half a sample interval wide) [0 to
                 6]
    """

def slice(
    mesh: HexMesh, field: Optional[str] = None, point: Optional[Sequence[float]] = None,
    normal: Optional[Sequence[float]] = None, *, clamp: Optional[str] = None, scheme: str = 'mcq',
    tension: float = 0.0625, crease_angle: Optional[Union[float, str]] = None, resolution: int = 512,
    progress: Progress = None
) -> Slice:
    """A field of the limit where a plane cuts it, seen from where the normal points.

    field:       its name, or a quantity of fields; None: the most sensible scalar, said in a warning
    point, normal: a place of the plane, and its direction, three numbers each
    clamp:       "file": the fields stay in the range that they have in the file, also between its points
    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    resolution:  places along the longer side [2 to 20000]

    slice(mesh, point, normal, field) still works, and warns.
    """

def streamlines(
    mesh: HexMesh, vector: str, seeds: Union[None, str, Sequence[str], npt.ArrayLike] = None, *,
    path: Optional[Path] = None, clamp: Optional[str] = None, scheme: str = 'mcq', tension: float = 0.0625,
    crease_angle: Optional[Union[float, str]] = None, seed_count: int = 30, stream_direction: str = 'both',
    stream_length: Optional[float] = None, stream_time: Optional[float] = None, stream_tolerance: float = 1e-06,
    stream_step: float = 0.01, progress: Progress = None
) -> StreamlineSet:
    """Streamlines of a vector field of the limit, such as "U" or "grad(T)", by Dormand and Prince's method.

    seeds:       places (n,3); or texts: "at:x,y,z", "line:x0,y0,z0,x1,y1,z1", "disk:x,y,z,nx,ny,nz,r", "sphere:x,y,z,r",
                 "box:x0,y0,z0,x1,y1,z1"; None: the middles of cells
    path:        also write them: .vtp, .csv
    clamp:       "file": the fields stay in the range that they have in the file, also between its points
    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    seed_count:  how many seeds: of each text that says where they are, or of middles of cells [1 to 100000]
    stream_direction: follow the field both ways, forward or backward [both, forward, backward]
    stream_length: no streamline is longer to either side of its seed (default: two diagonals of the body) [more than 0]
    stream_time: nor does it take longer [more than 0]
    stream_tolerance: the error of a step along a streamline, as a part of the diagonal [more than 0, at most 0.01]
    stream_step: no step along a streamline is longer, as a part of the diagonal [1e-05 to 0.5]
    """

def subdivide(
    mesh: HexMesh, levels: int = 1, scheme: str = 'mcq', *, on_limit: bool = False, tension: float = 0.0625,
    crease_angle: Optional[Union[float, str]] = None, progress: Progress = None
) -> HexMesh:
    """Refines a mesh: each level splits a cell into eight. Points and fields follow the scheme.

    The cells of "tetoct" and "boxspline", which refine tetrahedra as tetrahedra, come back in hexahedra, whose linear volume is theirs.
    The children of cell c are 8c to 8c+7, but of these two. The same bits for any number of threads.

    on_limit:    also move the points to the limit (those of mcq and linear lie on it); of "tetoct" and "boxspline" the limit that
                 passes through the points and values of the mesh
    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear; of
                 tetrahedra as tetrahedra: tetoct, boxspline [mcq, cc, bsxw, linear, tetoct, boxspline]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    levels:      number of refinements [0 to 10]
    """

def surface(
    mesh: HexMesh, field: Optional[str] = None, iso: Union[float, Sequence[float], None] = None, *,
    boundary: Optional[bool] = None, path: Optional[Path] = None, origin: Optional[npt.ArrayLike] = None,
    clamp: Optional[str] = None, scheme: str = 'mcq', tension: float = 0.0625,
    crease_angle: Optional[Union[float, str]] = None, cap: bool = False, tolerance: float = 0.001, max_level: int = 6,
    progress: Progress = None
) -> SurfaceMesh:
    """Isosurfaces of a field of the limit, and its boundary, as triangles.

    field:       its name, or a quantity of fields; None: the most sensible scalar, said in a warning
    iso:         a value, or several; None: the boundary alone
    path:        also write it: .ply, .stl, .vtp, .obj, .glb, .vtkhdf
    origin:      the file's points are relative to this place (3,): .stl rounds to 32-bit floats; None: (0, 0, 0)
    clamp:       "file": the fields stay in the range that they have in the file, also between its points
    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    boundary:    the boundary of the volume (the default without iso)
    cap:         close each isosurface with the part of the boundary where the field is at least its value [with iso]
    tolerance:   how far triangles may lie from the limit, as a part of the longest side of the box [more than 0, at most 1]
    max_level:   refine no further [1 to 8]

    surface(mesh, iso, field) still works, and warns.
    """

def write_points(
    volume: RbfVolume, path: Path, *, ascii: bool = False, splats: bool = False, up: str = 'z'
) -> None:
    """Writes points as .ply, .vtp (ParaView), .svk (with levels of detail), .vdb (Houdini) or .npz (numpy), and as
    .glb the splats that viewers of glTF draw. Numbers are exact: reading gives the same bits, but of the positions in .vdb; .glb is not read.
    docs/formats.md has the arrays of a .npz.

    ascii:       .ply: write text instead of binary numbers
    splats:      .ply: also for viewers of Gaussian splats; the boundary is then in a file beside it; .glb has splats alone
    up:          with splats: the axis that these viewers show at the top: x, y or z [x, y, z; with splats]
    """

def write_series(
    series: Series | Sequence[HexMesh] | HexMesh, path: Path, *, times: Optional[Sequence[float]] = None,
    max_error: float = 0.001, max_point_error: Optional[float] = None, key_steps: int = 10, progress: Progress = None
) -> SeriesReport:
    """Writes the steps of a series, or one mesh, in few bytes (`.svw`); `open_series` and `read_mesh` read them. Points and cells keep
    their order; what changes from step to step is stored.

    times: of a list of meshes; without them their numbers, from 0

    max_error:   the most error of each value, in parts of the field's range in all steps [more than 0, at most 1]
    max_point_error: the same for the coordinates of points, in parts of the mesh's longest side (default: a tenth of
                 max_error, and less where cells would be inverted) [more than 0, at most 1]
    key_steps:   every K steps one that does not depend on others: no more are decoded to read one [1 to 1000]

    Returns figures: steps, key_steps, meshes (how often the cells are stored), points, cells, bytes, mesh_bytes, max (the largest error of all
    fields), point_max, inverted_cells, and arrays, a list: name ("" are the points), channels, steps, bytes (about), max, exact (values that are
    kept as they are). Steps are read twice, those that fit into 256 MB once. Raises InvalidInput if an option is out of range; FileError if the file cannot be written.
    """

def write_vdb(
    what: Union[HexMesh, RbfVolume, Grid, Sequence[Grid]], path: Path, *, fields: Optional[Sequence[str]] = None,
    nano: bool = False, clamp: Optional[str] = None, scheme: str = 'mcq', tension: float = 0.0625,
    crease_angle: Optional[Union[float, str]] = None, voxel_size: Optional[float] = None, resolution: int = 200,
    half: bool = False, cell_ids: bool = False, mask: bool = False, coverage: bool = False,
    levels: Optional[int] = None, sdf: Optional[str] = None, half_width: float = 3.0, progress: Progress = None
) -> list[GridReport]:
    """Writes the limit of a mesh, sums of kernels, or grids as `.vdb`: cubic voxels, values at their centres, active inside the volume.

    fields:      scalars become grids of floats, vectors grids of vectors; None: the most sensible scalar, said in a warning
    nano:        also writes `.nvdb`
    clamp:       "file": the fields stay in the range that they have in the file, also between its points
    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    crease_angle: keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without
                 creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60) [none]
    voxel_size:  edge of a voxel in world units [more than 0]
    resolution:  voxels along the longest side of the bounding box [1 to 1048576; not with voxel_size]
    half:        store floats in 16 bits
    cell_ids:    also write a grid: the number of the control cell
    mask:        also write a grid: a mask of the volume
    coverage:    also write a grid: the part of each voxel that the volume fills
    levels:      the trilinear cells of this level instead of the limit [0 to 10]
    sdf:         also write a level set, named NAME or sdf: the distance to the boundary, negative inside, in a narrow band
    half_width:  the band's reach to either side, in voxels [1 to 1000; with sdf]

    Returns the grids' reports: name, kind, active_voxels, voxel_size, min, max, bytes. The file appears whole or not at all.
    """

def write_wavelets(
    mesh: HexMesh, path: Path, tolerance: float = 0.001, *, scheme: str = 'mcq', tension: float = 0.0625,
    point_tolerance: Optional[float] = None, levels: int = 6, progress: Progress = None
) -> WaveletReport:
    """Writes a mesh that is the refinement of a coarser one as control values and rounded details (`.svw`); `read_mesh` reads it.

    scheme:      mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear [mcq,
                 cc, bsxw, linear]
    tension:     of mcq: 0 is linear; 1/16 reproduces cubics [0 to 0.125; with scheme='mcq']
    tolerance:   the most root mean square error of each field, in parts of its range [more than 0, at most 1]
    point_tolerance: the same for the points, in parts of the mesh's longest side (default: a tenth of the tolerance of
                 fields, and less where cells would be inverted) [more than 0, at most 1]
    levels:      the most levels of wavelets [1 to 10]

    Returns figures: levels, coarse_cells, cells, bytes, inverted_cells, and arrays: by name ("" are the points) coefficients, kept, rms, max.
    Raises InvalidInput if the mesh has no coarser one; FileError if the file cannot be written.
    """

__all__ = [
    "Camera", "Cancelled", "Error", "Field", "FieldComparison", "FileError", "FoldCheck", "Grid", "HexMesh", "Image", "ImageComparison",
    "InvalidInput", "LimitSamples", "MissingCapability", "Page", "PointsError", "ProbeSamples", "RbfVolume", "Refinement", "Series",
    "Slice", "StreamlineSet", "Study", "StudyCase", "StudyResults", "SubvolWarning", "SurfaceMesh", "TransferFunction", "approximate", "approximate_series", "as_field", "check_folds", "check_folds_between", "compare",
    "compare_fields", "compare_images", "control_mesh", "evaluate", "evaluate_limit", "fit", "fit_shape", "from_meshio", "from_pyvista", "from_vtk", "gl_devices", "kernels",
    "map_fields", "measure", "mend_folds", "mesh_difference", "model", "models", "only", "open_series", "page", "points_error", "probe", "quantity", "rasterize", "read_image", "read_mesh", "read_points", "read_surface",
    "read_vdb", "reduce", "render", "run_study", "sample", "sample_grid", "set_threads", "slice", "streamlines", "studies", "study", "subdivide",
    "surface", "to_meshio", "to_pyvista", "to_vtk", "warp", "write_image", "write_mesh", "write_points", "write_series", "write_usd", "write_vdb", "write_wavelets",
]
