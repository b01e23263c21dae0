# SPDX-License-Identifier: Apache-2.0
"""Subdivision volumes: hexahedral meshes refined, drawn as splats, turned into OpenVDB grids, and measured.

Arrays go in as they are: any real type, any strides. Arrays that come out of objects are read-only views that keep their object alive;
those that calls return are yours; dictionaries of objects refuse changes. Long calls release the GIL, stop at Ctrl-C, and take `progress`: True, or a function of a stage and a
fraction. Errors are `subvol.Error`; what was chosen or left out is warned about (`SubvolWarning`). docs/python.md says more.
"""
from . import _core
from ._colors import TransferFunction
from ._core import Camera, Field, HexMesh, Image, RbfVolume, Refinement, Study, StudyCase, StudyResults, gl_devices, set_threads
from ._errors import Cancelled, Error, FileError, InvalidInput, MissingCapability, SubvolWarning
from ._exchange import from_meshio, from_pyvista, from_vtk, to_meshio, to_pyvista, to_vtk
from ._fields import LimitSamples, as_field, evaluate, evaluate_limit
from ._measure import FoldCheck, PointsError, ProbeSamples, Slice, StreamlineSet, SurfaceMesh, approximate, approximate_series, check_folds, check_folds_between, control_mesh, fit_shape, map_fields, measure, mend_folds, points_error, probe, read_surface, slice, streamlines, surface
from ._mesh import Series, model, models, only, open_series, quantity, read_mesh, subdivide, warp, write_mesh, write_series, write_wavelets
from ._page import Page, page
from ._pictures import FieldComparison, ImageComparison, compare, compare_fields, compare_images, mesh_difference, read_image, render, write_image
from ._points import fit, kernels, read_points, reduce, sample, write_points
from ._studies import run_study, studies, study
from ._vdb import Grid, rasterize, read_vdb, sample_grid, write_usd, write_vdb

__version__: str = _core.__version__

for _class in (Camera, Field, HexMesh, Image, RbfVolume, Refinement, Study, StudyCase, StudyResults):
    _class.__module__ = "subvol"  # what pickles and messages call them
del _class

__all__ = [
    "Camera", "Cancelled", "Error", "Field", "FieldComparison", "FileError", "FoldCheck", "Grid", "HexMesh", "Image", "ImageComparison",
    "InvalidInput", "LimitSamples", "MissingCapability", "Page", "PointsError", "ProbeSamples", "RbfVolume", "Refinement", "Series",
    "Slice", "StreamlineSet", "Study", "StudyCase", "StudyResults", "SubvolWarning", "SurfaceMesh", "TransferFunction", "approximate", "approximate_series", "as_field", "check_folds", "check_folds_between", "compare",
    "compare_fields", "compare_images", "control_mesh", "evaluate", "evaluate_limit", "fit", "fit_shape", "from_meshio", "from_pyvista", "from_vtk", "gl_devices", "kernels",
    "map_fields", "measure", "mend_folds", "mesh_difference", "model", "models", "only", "open_series", "page", "points_error", "probe", "quantity", "rasterize", "read_image", "read_mesh", "read_points", "read_surface",
    "read_vdb", "reduce", "render", "run_study", "sample", "sample_grid", "set_threads", "slice", "streamlines", "studies", "study", "subdivide",
    "surface", "to_meshio", "to_pyvista", "to_vtk", "warp", "write_image", "write_mesh", "write_points", "write_series", "write_usd", "write_vdb", "write_wavelets",
]
