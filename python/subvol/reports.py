# SPDX-License-Identifier: Apache-2.0
"""The types of the dictionaries that calls return, for type checkers and editors: `from subvol.reports import VolumeMeasure`.

At run time they are plain dictionaries. tests/python/reports_test.py holds each of these types against what its call returns.
"""
from __future__ import annotations

from typing import TypedDict

import numpy as np
import numpy.typing as npt

__all__ = ["ApproximateReport", "ControlMeshReport", "DifferenceReport", "FieldError", "FieldMeasure", "FoldFigures", "GridReport", "MapReport", "MendReport", "MeshReport", "PartMeasure",
           "PatchMeasure", "ReduceReport", "SeriesReport", "ShapeError", "ShapeReport", "SurfaceReport", "VolumeMeasure", "WaveletReport"]

Place = tuple[float, float, float]


class FieldFigures(TypedDict):
    """Of a field over a volume or a patch, by `measure`; file_ figures are those of the cells as they were given."""

    integral: float
    mean: float
    min: float
    min_at: Place
    max: float
    max_at: Place
    extreme_error: float
    file_integral: float
    file_mean: float
    file_min: float
    file_min_at: Place
    file_max: float
    file_max_at: Place


class FieldMeasure(FieldFigures):
    """Of a field over a volume, by `measure`."""

    histogram: npt.NDArray[np.float64]


class PartMeasure(TypedDict):
    """Of a set of cells, by `measure`."""

    cells: int
    volume: float
    error: float
    file_volume: float
    fields: dict[str, FieldMeasure]


class VolumeMeasure(PartMeasure):
    """Of a mesh, by `measure`."""

    parts: dict[str, PartMeasure]


class _Flux(TypedDict, total=False):
    flux: float
    throughput: float
    file_flux: float
    file_throughput: float


class PatchMeasure(_Flux):
    """Of a patch, by `measure(patch=)`; the flow only with `flux`."""

    name: str
    faces: int
    area: float
    error: float
    file_area: float
    normal: Place
    fields: dict[str, FieldFigures]


class MeshReport(TypedDict):
    """By `HexMesh.report`."""

    points: int
    points_used: int
    cells: int
    edges: int
    faces: int
    boundary_faces: int
    interior_edges: int
    interior_edge_valence: dict[int, int]
    singular_nodes: int
    inverted_cells: int
    degenerate_cells: int
    min_scaled_jacobian: float
    nonmanifold_edges: int
    nonmanifold_points: int
    nonmanifold_faces: int
    volume: float
    bounds: npt.NDArray[np.float64]


class SurfaceReport(TypedDict):
    """Of `SurfaceMesh.report`."""

    area: float
    volume: float
    watertight: bool
    euler: int
    components: int
    min_angle: float
    deviation: float
    converged: bool
    level: int
    collapsed: int


class GridReport(TypedDict):
    """Of `Grid.report`, and by `write_vdb`."""

    name: str
    kind: str
    level_set: bool
    active_voxels: int
    voxel_size: float
    bytes: int
    min: float
    max: float


class FieldError(TypedDict):
    """Of a field, by `approximate`."""

    rms: float
    rms_boundary: float
    max: float
    max_at: list[float]
    range: float
    rms_between: float
    max_between: float
    max_between_at: list[float]
    beyond: float


class _Placements(TypedDict, total=False):
    placements: int


class ApproximateReport(_Placements):
    """By `approximate` and `approximate_series`; placements only by the second."""

    samples: int
    between: int
    outside: int
    snapped: int
    unseen: int
    undecided: int
    iterations: int
    refined: int
    continuous: bool
    fields: dict[str, FieldError]


class MapReport(TypedDict):
    """By `map_fields`."""

    outside: int
    farthest_world: float
    farthest_at: list[float]


class ShapeError(TypedDict):
    """The distance of a boundary from a surface, by `fit_shape`."""

    rms: float
    max: float
    max_at: list[float]
    covered_rms: float
    covered_max: float
    hole_part: float
    reached_part: float
    missed_rms: float
    missed_max: float
    missed_at: list[float]


class FoldCells(TypedDict):
    """Numbers of cells by what is known of them."""

    proved: int
    folded: int
    undecided: int
    irregular: int


class FoldSamples(TypedDict):
    """What was sampled in undecided cells."""

    cells: int
    places: int
    folded: int
    least: float


class _UndecidedKinds(TypedDict, total=False):
    undecided_kinds: dict[str, int]


class FoldFigures(_UndecidedKinds):
    """Whether a limit folds, by `fit_shape` and `control_mesh`."""

    verdict: str
    cells: FoldCells
    open_volume: float
    sampled: FoldSamples


class _Warnings(TypedDict, total=False):
    warnings: list[str]


class ShapeReport(_Warnings):
    """By `fit_shape`."""

    open_edges: int
    open_length: float
    before: ShapeError
    after: ShapeError
    rounds: int
    moved_world: float
    volume_world: float
    folds: FoldFigures
    mended: int
    folded_cells: list[int]
    inverted_cells: list[int]


class SharpCurves(TypedDict):
    """The sharp edges of a surface that `control_mesh` followed."""

    corners: int
    missed_corners: int
    curves: int
    missed: int
    length_world: float
    missed_length_world: float
    creases: int
    rms: float
    max: float


class Features(TypedDict):
    """The parts of a surface's features that a mesh by `control_mesh` has."""

    points: float
    curves: float
    surfaces: float


class SurfaceBodies(TypedDict):
    """What a surface is made of, by `control_mesh`."""

    walls: int
    united: int
    cavities: int
    cavities_alike: int
    copies: int
    sheets: int
    turned: int
    one_sided: int
    many_edges: int


class ThinParts(TypedDict):
    """Parts of a body thinner than 1.5 cells, which `control_mesh` looks for if its mesh is not as it should be."""

    part: float
    thickness_world: float
    at: list[float]


class _EnclosedMaterial(TypedDict, total=False):
    enclosed_world: float  # by its surface, without the materials within; if it has no holes and crosses none that encloses less


class Material(_EnclosedMaterial):
    """A material of a mesh by `control_mesh`; volume_world: that its limit fills."""

    name: str
    cells: int
    volume_world: float


class Label(TypedDict):
    """A label of voxels by `control_mesh`; voxels_world: the volume of its voxels, enclosed_world: by its smooth surface."""

    name: str
    label: int
    voxels: int
    voxels_world: float
    enclosed_world: float


class _Enclosed(TypedDict, total=False):
    enclosed_world: float  # if the surface has no holes and no parts cross
    materials: list[Material]  # if there are several
    labels: list[Label]  # of voxels
    thin: ThinParts  # if the mesh is not as it should be


class ControlMeshReport(ShapeReport, _Enclosed):
    """By `control_mesh`."""

    parts: int
    added: int
    refined: int
    divided: int
    side_world: float
    lid_sides: int
    sharp: SharpCurves
    features: Features
    min_scaled_jacobian: float
    surface: SurfaceBodies


class CellLeft(TypedDict):
    """A cell that `mend_folds` could not prove, and why."""

    cell: int
    reason: str


class _PlaceOfDifference(TypedDict, total=False):
    point: int
    cell: int  # of a field at cells


class LargestDifference(_PlaceOfDifference):
    """Of a field, by `mesh_difference`."""

    max: float
    at: list[float]


class DifferenceReport(TypedDict):
    """By `mesh_difference`."""

    same_points: bool
    outside: int
    outside_distance: float
    fields: dict[str, LargestDifference]


class MendReport(TypedDict):
    """By `mend_folds`."""

    folded: int
    open: int
    moved: int
    farthest_edges: float
    boundary_edges: float
    rounds: int
    work: int
    budget: int
    left: list[CellLeft]


class Validation(TypedDict):
    """Errors at independent samples, by `reduce`."""

    rmse: float
    max: float
    uncovered: int


class ReduceReport(TypedDict):
    """By `reduce`."""

    points: int
    samples: int
    rounds: int
    rmse: float
    validation: Validation
    reached: bool


class WaveletArray(TypedDict):
    """Of the points or a field, by `write_wavelets`."""

    coefficients: int
    kept: int
    rms: float
    max: float


class WaveletReport(TypedDict):
    """By `write_wavelets`."""

    levels: int
    coarse_cells: int
    cells: int
    bytes: int
    inverted_cells: int
    arrays: dict[str, WaveletArray]


class SeriesArray(TypedDict):
    """Of the points or a field, by `write_series`."""

    name: str
    channels: int
    steps: int
    bytes: int
    max: float
    exact: int


class SeriesReport(TypedDict):
    """By `write_series`."""

    steps: int
    key_steps: int
    meshes: int
    points: int
    cells: int
    bytes: int
    mesh_bytes: int
    max: float
    point_max: float
    inverted_cells: int
    arrays: list[SeriesArray]
