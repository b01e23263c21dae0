# SPDX-License-Identifier: Apache-2.0
"""Pictures: the renderers, and the distance between two pictures or fields."""
from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import Path, check_numbers, path_bytes, warn
from ._colors import TransferFunction, _camera_of, _is_lit, _knots_of, _look_of, _range_of
from ._core import Camera, Field, HexMesh, Image, RbfVolume
from ._errors import InvalidInput
from ._fields import as_field
from ._points import _selected
from ._progress import Progress, listening
from ._vdb import Grid, sample_grid

Drawable = Union[HexMesh, RbfVolume, Grid]
Planes = Union[None, Sequence[float], Sequence[Sequence[float]], npt.ArrayLike]  # six numbers each: a point and the normal


def _planes_of(planes: Planes, name: str) -> list[list[float]]:
    """A plane or several as lists of six numbers."""
    if planes is None:
        return []
    rows = np.atleast_2d(np.asarray(planes, dtype=float))
    if rows.ndim != 2 or rows.shape[1] != 6:
        raise InvalidInput(f"{name}: a plane is six numbers, a point and the normal", name, "(px, py, pz, nx, ny, nz)")
    return [[float(number) for number in row] for row in rows]


def _box_of(box: Optional[Sequence[float]]) -> Optional[list[float]]:
    if box is None:
        return None
    corners = np.asarray(box, dtype=float).ravel()
    if corners.shape != (6,):
        raise InvalidInput("clip_box: a box is six numbers, the lower and the upper corner", "clip_box", "(x0, y0, z0, x1, y1, z1)")
    return [float(number) for number in corners]


def render(what: Drawable, *, method: str = "splat", view: str = "iso", camera: Union[None, str, Camera] = None, ortho: bool = False,
           size: tuple[int, int] = (512, 512), field: Optional[str] = None, color_field: Optional[str] = None,
           tf: Union[None, str, TransferFunction] = None, opacity_unit: Optional[float] = None, look: Optional[str] = None,
           shade: bool = False, shadows: bool = False, ambient_occlusion: float = 0, lod: float = 0, samples: Optional[int] = None,
           sheets: int = 0, levels: Optional[int] = None, scheme: str = "mcq",
           tension: float = 1 / 16, crease_angle: Optional[float] = None, per_edge: int = 1, seconds: Optional[float] = None,
           order: str = "topological", image_tolerance: float = 1e-3, backend: str = "auto", device: Optional[int] = None,
           clip: Planes = None, clip_box: Optional[Sequence[float]] = None, slice: Planes = None, around: bool = False,
           progress: Progress = None) -> Image:
    """Draws a mesh, points or a grid: the picture of `subvol render` with the same options, bit for bit.

    method:       "splat" (kernels), "sheets" (the same by OpenGL sheet buffers), "footprints" (kernels coloured first, as
                  Westover did), "tets" (rays through tetrahedra), "pt" (tetrahedra projected by OpenGL), "dense" (rays through the
                  limit's cells), "grid" (rays through voxels)
    view:         the side to look from: +x -x +y -y +z -z iso
    camera:       instead: a Camera, or text as of --camera
    size:         width and height in pixels
    tf:           a TransferFunction or its name; None: viridis over the field's range
    opacity_unit: the world distance that opacities are for; None: 1/100 of the bounding box's diagonal
    look:         "solid" (opaque and lit; what a mesh without tf, opacity_unit and shade gets), "volume", "xray" or "isosurface"
    shade:        lit surfaces of equal value (splats only)
    shadows:      the volume shadows itself from the light at the upper left (splats only)
    ambient_occlusion: > 0: darkens hollows that are narrower than this part of the bounding box's diagonal, at most 1 (splats only)
    lod:          > 0: kernels are merged as long as they are narrower than so many pixels (splats only)
    samples:      n x n rays or places for each pixel, 1 to 16; None: 2 for solids, else 1
    levels:       draw the trilinear cells of this level; None: 1 for tets and pt, the limit for the others
    seconds:      a time limit (splat and pt)
    clip:         planes that cut the volume open, each (px, py, pz, nx, ny, nz): what lies on the normal's side goes. One or several
    clip_box:     (x0, y0, z0, x1, y1, z1): what lies outside goes
    slice:        planes that are drawn alone, opaque and coloured by value. One or several
    around:       draw the volume around the slices too

    Returns an Image: `numpy.asarray(image)` is (height, width, 4) float32, linear, premultiplied, without a copy. Its `report` has
    counts and seconds.
    """
    check_numbers(tension=tension)
    check_numbers(0, opacity_unit=opacity_unit, ambient_occlusion=ambient_occlusion, crease_angle=crease_angle, seconds=seconds,
                  image_tolerance=image_tolerance)
    if method not in ("splat", "sheets", "footprints", "tets", "pt", "dense", "grid"):
        raise InvalidInput(f"method: '{method}' is not known (splat, sheets, footprints, tets, pt, dense or grid)", "method",
                           "splat, sheets, footprints, tets, pt, dense or grid")
    if isinstance(what, Field):
        raise InvalidInput("what: a Field cannot be drawn; draw the mesh or the points that it is of", "what", "a mesh, points or a grid")
    if len(size) != 2 or not (1 <= size[0] <= 65536 and 1 <= size[1] <= 65536):
        raise InvalidInput(f"size: {size} is not a picture size", "size", "width and height, 1 to 65536")
    splats = method in ("splat", "sheets", "footprints")
    if isinstance(what, HexMesh):
        body = True
    elif isinstance(what, (RbfVolume, Grid)):
        body = False
        if isinstance(what, Grid) and splats:
            what = sample_grid(what)
        if isinstance(what, RbfVolume) and not splats:
            raise InvalidInput(f"method: points can only be splatted, not drawn by {method}", "method", "splat or sheets")
        if isinstance(what, Grid) and method != "grid":
            raise InvalidInput(f"method: a grid has no cells for {method}", "method", "grid, splat or sheets")
    else:
        raise TypeError(f"render() takes a HexMesh, RbfVolume or Grid, not {type(what).__name__}")
    if body and method == "grid":
        raise InvalidInput("method: a mesh has no voxels", "method", "subvol.rasterize makes a grid of it")
    if not splats and shade:
        raise InvalidInput(f"shade: method {method} draws without light", "shade", "splat or sheets")
    if (shadows or ambient_occlusion) and method != "splat":
        raise InvalidInput(f"shadows, ambient_occlusion: method {method} draws without them (splat does)", "shadows", "splat")
    if not 0 <= lod < float("inf"):
        raise InvalidInput(f"lod: {lod} is not a number of pixels", "lod", "0 or more")
    if lod and not (splats and seconds is None):
        raise InvalidInput("lod: merged kernels are drawn by splat and sheets, without a time limit", "lod", "splat or sheets, without seconds")
    if seconds is not None and (shadows or ambient_occlusion):
        raise InvalidInput("seconds: pictures within a time have no shadows", "seconds", "without shadows and ambient_occlusion")
    if seconds is not None and method not in ("splat", "sheets", "pt"):
        raise InvalidInput(f"seconds: method {method} has no time limit", "seconds", "splat, sheets or pt")
    kind = _look_of(look, body and not shade, tf, opacity_unit)
    solid, lit = kind == _core.Look.solid, _is_lit(kind)
    if lit and not splats and not solid:
        raise InvalidInput(f"look: method {method} lights the boundary only", "look", "solid")
    many = samples if samples is not None else 2 if solid else 1

    channel, color_channel = 0, None
    if isinstance(what, HexMesh):
        mesh = _selected(what, field)
        values = next(iter(mesh.fields.values()))
        low, high = _range_of(values)
        bounds = mesh.bounds
    elif isinstance(what, RbfVolume):
        names = list(what.values)
        channel = _channel(names, field)
        if color_field is not None:
            color_channel = _channel(names, color_field)
        low, high = _range_of(what.values[names[channel]])
        bounds = what.bounds
    else:
        about = what.report
        low, high = about["min"], about["max"]
        half = about["voxel_size"] / 2
        bounds = np.array(what.bounds) + [[-half], [half]]
    knots = _knots_of(tf, kind, low, high)
    if color_channel is not None and isinstance(what, RbfVolume):
        other = _knots_of(tf, kind, *_range_of(what.values[names[color_channel]]))
        knots = _core.Knots(other.color, knots.opacity)
    unit = opacity_unit or _core.look_opacity_unit(kind, bounds)
    framed = _core.framed_points(mesh, kind, knots, unit) if isinstance(what, HexMesh) else None
    eye = _camera_of(view, camera, bounds, framed, size, ortho)
    scene = _core.Scene(eye, (int(size[0]), int(size[1])), knots, unit, _planes_of(clip, "clip"), _box_of(clip_box),
                        _planes_of(slice, "slice"), bool(around))
    way = backend if method == "splat" else method

    with listening(progress) as listener:
        if isinstance(what, RbfVolume):
            image = _core.splat(what, scene, way, device, many, sheets, channel, color_channel, shade or lit, shadows, ambient_occlusion, lod, None,
                                listener)
        elif isinstance(what, Grid):
            image = _core.grid(what.voxels(), scene, many, listener)
        elif splats and seconds is not None:
            image = _core.splat_in_time(mesh, scene, seconds, scheme, way, device, many, sheets, shade or lit, listener)
        elif splats:
            volume = _sampled(mesh, levels, scheme, tension, crease_angle, per_edge, listener)
            own_opacity = isinstance(tf, TransferFunction) and tf.opacity is not None
            painted = solid and levels is None and opacity_unit is None and sheets == 0 and per_edge == 1 and not own_opacity
            skin = _core.skin(mesh, scheme, tension, crease_angle, None) if painted and not (shadows or ambient_occlusion) else None
            image = _core.splat(volume, scene, way, device, many, sheets, 0, None, shade or lit, shadows, ambient_occlusion, lod, skin,
                                listener)
        else:
            name = next(iter(mesh.fields))
            if method == "dense":
                image = _core.dense(mesh, name, scene, scheme, tension, crease_angle, levels, image_tolerance, many, listener)
            else:
                level = 1 if levels is None else levels
                fine = _core.subdivide(mesh, level, scheme, tension, crease_angle, True, listener)
                if method == "tets":
                    image = _core.tets(fine, name, scene, many, listener)
                else:
                    image = _core.projected(fine, name, scene, order, device, many, seconds, listener)
            if lit:
                image = _core.lit(image, _core.skin(mesh, scheme, tension, crease_angle, levels), scene, many)
    image.report["method"] = method
    image.report["background"] = _core.look_background(kind)
    lost = image.report.get("lost_rays", 0)
    if lost:
        warn(f"{lost} rays were lost inside the mesh")
    return image


def _sampled(mesh: HexMesh, levels: Optional[int], scheme: str, tension: float, crease_angle: Optional[float], per_edge: int,
             listener: Any) -> RbfVolume:
    boundary_levels = None
    if levels is not None:
        mesh = _core.subdivide(mesh, levels, scheme, tension, crease_angle, True, listener)
        scheme, boundary_levels = "linear", 0
    return _core.sample(mesh, None, (512, 512), listener, scheme=scheme, tension=tension, crease_angle=crease_angle, per_edge=per_edge,
                        boundary_levels=boundary_levels)[0]


def _channel(names: list[str], field: Optional[str]) -> int:
    if field is None:
        return 0
    if field not in names:
        raise InvalidInput(f"field: there is no channel '{field}' (there are {', '.join(names)})", "field", ", ".join(names))
    return names.index(field)


def read_image(path: Path) -> Image:
    """Reads a picture of any common format as linear premultiplied floats. Of a part of a larger picture it has the pixels of the part;
    `data_window` and `display_window` say where they are."""
    return _core.read_image(path_bytes(path))


def write_image(image: Union[Image, npt.ArrayLike], path: Path, background: Optional[Sequence[float]] = None) -> None:
    """Writes `.exr` (linear floats, with the depth if there is one) or `.png` (8 bits over the background, linear rgb)."""
    _as_image(image).write(path_bytes(path), background)


def _as_image(given: Union[Image, npt.ArrayLike]) -> Image:
    return given if isinstance(given, Image) else Image(given)


class ImageComparison:
    """Differences over red, green and blue of all pixels, for a peak of 1: mse, rmse, mae, max, psnr (infinite for equal pictures).

    Parts of pictures (`Image.data_window`) are compared where they overlap.
    ssim and flip, and their maps (height, width), are computed when they are asked for.
    """

    def __init__(self, test: Image, reference: Image) -> None:
        self._test, self._reference = _core.common_pixels(test, reference)
        figures = _core.compare_images(self._test, self._reference)
        self.mse = figures["mse"]
        self.rmse = figures["rmse"]
        self.mae = figures["mae"]
        self.max = figures["max"]
        self.psnr = figures["psnr"]

    @cached_property
    def _ssim(self) -> tuple[float, npt.NDArray[np.float32]]:
        return _core.ssim(self._test, self._reference)

    @cached_property
    def _flip(self) -> tuple[float, npt.NDArray[np.float32]]:
        return _core.flip(self._test, self._reference)

    @property
    def ssim(self) -> float:
        return self._ssim[0]

    @property
    def flip(self) -> float:
        return self._flip[0]

    @property
    def ssim_map(self) -> npt.NDArray[np.float32]:
        return self._ssim[1]

    @property
    def flip_map(self) -> npt.NDArray[np.float32]:
        return self._flip[1]

    def heatmap(self, scale: float = 0) -> Image:
        """The largest difference of each pixel in the colours of inferno, with a legend; scale 0: up to the largest."""
        return _core.heatmap(self._test, self._reference, scale)

    def __repr__(self) -> str:
        return f"<subvol.ImageComparison: rmse {self.rmse:.3g}, psnr {self.psnr:.2f} dB>"


class FieldComparison:
    """Differences of two fields at random places of the reference, in the field's unit: l1, l2, linf; gradient_rmse per world length;
    samples: places where both have a value; uncovered: places where only the reference has one; coverage: the share of the first.

    The differences are over the places where both have a value, so a coverage below 1 says that they are about a part of the reference;
    of fields without a place in common they are nan."""

    def __init__(self, figures: dict[str, Any]) -> None:
        self.l1: float = figures["l1"]
        self.l2: float = figures["l2"]
        self.linf: float = figures["linf"]
        self.gradient_rmse: float = figures["gradient_rmse"]
        self.samples: int = figures["samples"]
        self.uncovered: int = figures["uncovered"]
        self.coverage: float = figures["coverage"]

    def __repr__(self) -> str:
        return f"<subvol.FieldComparison: l2 {self.l2:.3g}, linf {self.linf:.3g}, {self.samples} of {self.samples + self.uncovered} places>"


def compare_images(test: Union[Image, npt.ArrayLike], reference: Union[Image, npt.ArrayLike]) -> ImageComparison:
    """The distance between two pictures of the same size: Images, or arrays of linear floats (height, width, 3 or 4).

    Images of files with parts of one picture (crops) are compared where they overlap; if they do not, InvalidInput is raised."""
    return ImageComparison(_as_image(test), _as_image(reference))


def compare_fields(test: Union[HexMesh, RbfVolume, Field], reference: Union[HexMesh, RbfVolume, Field], field: Optional[str] = None,
                   *, samples: int = 100_000, seed: int = 0, gradients: bool = True, progress: Progress = None) -> FieldComparison:
    """The distance between two fields: of meshes (their limit), of points, or given as Field.

    Both are compared where both have a value: see `coverage` of the result. gradients=False: gradient_rmse is nan."""
    a, b = as_field(test, field), as_field(reference, field)
    with listening(progress) as listener:
        return FieldComparison(_core.compare_fields(a, b, samples, seed, gradients, listener))


def compare(test: Any, reference: Any, **options: Any) -> Any:
    """`compare_fields` of meshes, points and Fields; `compare_images` of pictures and arrays."""
    kinds = (HexMesh, RbfVolume, Field)
    if isinstance(test, kinds) != isinstance(reference, kinds):
        raise InvalidInput("compare: one of the two is a picture, the other a field", "compare", "two pictures or two fields")
    return compare_fields(test, reference, **options) if isinstance(test, kinds) else compare_images(test, reference, **options)
