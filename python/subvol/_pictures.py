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
           shade: bool = False, shadows: bool = False, ambient_occlusion: Optional[float] = None, lod: Optional[float] = None,
           samples: Optional[int] = None, sheets: Optional[int] = None, levels: Optional[int] = None, scheme: Optional[str] = None,
           tension: Optional[float] = None, crease_angle: Optional[float] = None, per_edge: Optional[int] = None,
           seconds: Optional[float] = None, order: Optional[str] = None, image_tolerance: Optional[float] = None,
           backend: Optional[str] = None, device: Optional[int] = None, clip: Planes = None,
           clip_box: Optional[Sequence[float]] = None, slice: Planes = None, around: bool = False, progress: Progress = None) -> Image:
    """Draws a mesh, points or a grid: the picture of `subvol render` with the same options, bit for bit.

    A keyword that has no effect with the method is refused; docs/pictures.md has the table.

    method:       "splat" (kernels), "sheets" (the same by OpenGL sheet buffers), "footprints" (kernels coloured first, as
                  Westover did), "tets" (rays through tetrahedra), "pt" (tetrahedra projected by OpenGL), "dense" (rays through the
                  limit's cells), "grid" (rays through voxels)
    view:         the side to look from: +x -x +y -y +z -z iso
    camera:       instead: a Camera, or text as of --camera
    size:         width and height in pixels
    color_field:  takes the colours from this field; opacities stay those of `field` (kernels only)
    tf:           a TransferFunction or its name; None: viridis over the field's range
    opacity_unit: the world distance that opacities are for; None: 1/100 of the bounding box's diagonal
    look:         "solid" (opaque and lit; what a mesh without tf, opacity_unit and shade gets), "volume", "xray" or "isosurface"
    shade:        lit surfaces of equal value (kernels only)
    shadows:      the volume shadows itself from the light at the upper left (splat only)
    ambient_occlusion: > 0: darkens hollows that are narrower than this part of the bounding box's diagonal, at most 1 (splat only)
    lod:          > 0: kernels are merged as long as they are narrower than so many pixels; pt with order "havs": the fraction of
                  the inner faces that is drawn
    samples:      n x n rays or places for each pixel, 1 to 16; None: 2 for solids, else 1
    sheets:       planes over the volume's depth; None: as many as the kernels need (splat and sheets)
    levels:       draw the trilinear cells of this level; None: 1 for tets and pt, the limit for the others
    scheme:       "mcq" (None), "cc", "bsxw" or "linear"; tension: of mcq, None: 1/16
    per_edge:     kernels for each cell edge; None: 1
    seconds:      a time limit (splat, sheets and pt)
    order:        how pt sorts: "topological" (None), "centroid", "lists" or "havs"
    image_tolerance: of dense without levels: draw level after level until the picture changes by less
    backend:      where to splat: "auto" (None), "gl" or "cpu"
    device:       the OpenGL device's number in gl_devices()
    clip:         planes that cut the volume open, each (px, py, pz, nx, ny, nz): what lies on the normal's side goes. One or several
    clip_box:     (x0, y0, z0, x1, y1, z1): what lies outside goes
    slice:        planes that are drawn alone, opaque and coloured by value. One or several
    around:       draw the volume around the slices too

    Returns an Image: `numpy.asarray(image)` is (height, width, 4) float32, linear, premultiplied, without a copy. Its `report` has
    counts and seconds.
    """
    check_numbers(0, opacity_unit=opacity_unit)
    if isinstance(what, Field):
        raise InvalidInput("what: a Field cannot be drawn; draw the mesh or the points that it is of", "what", "a mesh, points or a grid")
    if len(size) != 2 or not (1 <= size[0] <= 65536 and 1 <= size[1] <= 65536):
        raise InvalidInput(f"size: {size} is not a picture size", "size", "width and height, 1 to 65536")
    if isinstance(what, Grid) and _core.draws_kernels(method):
        what = sample_grid(what)
    if not isinstance(what, (HexMesh, RbfVolume, Grid)):
        raise TypeError(f"render() takes a HexMesh, RbfVolume or Grid, not {type(what).__name__}")
    keywords = {"color_field": color_field, "look": look, "shade": shade, "shadows": shadows, "ambient_occlusion": ambient_occlusion,
                "lod": lod, "samples": samples, "sheets": sheets, "levels": levels, "scheme": scheme, "tension": tension,
                "crease_angle": crease_angle, "per_edge": per_edge, "seconds": seconds, "order": order,
                "image_tolerance": image_tolerance, "backend": backend, "device": device, "clip": _planes_of(clip, "clip"),
                "clip_box": _box_of(clip_box), "slice": _planes_of(slice, "slice"), "around": around}
    given = {name: value for name, value in keywords.items() if value is not None and value is not False and value != []}
    kind = _look_of(look, isinstance(what, HexMesh) and not shade, tf, opacity_unit)

    mesh = _selected(what, field) if isinstance(what, HexMesh) else None
    other = _selected(what, color_field) if isinstance(what, HexMesh) and color_field is not None else None
    body, shown, colors, bounds = _body_of(what if mesh is None else mesh, other, field, color_field)
    knots = _knots_of(tf, kind, *shown)
    if colors is not None:
        knots = _core.Knots(_knots_of(tf, kind, *colors).color, knots.opacity)
    unit = opacity_unit or _core.look_opacity_unit(kind, bounds)
    framed = _core.framed_points(mesh, kind, knots, unit) if mesh is not None else None
    eye = _camera_of(view, camera, bounds, framed, size, ortho)
    own_opacity = opacity_unit is not None or (isinstance(tf, TransferFunction) and tf.opacity is not None)
    with listening(progress) as listener:
        image = _core.render(body, method, eye, (int(size[0]), int(size[1])), _core.PictureLight(kind, knots, unit, own_opacity), given,
                             listener)
    image.report["background"] = _core.look_background(kind)
    for warning in image.report.get("warnings", []):
        warn(warning)
    return image


_Range = tuple[float, float]


def _body_of(what: Drawable, colors: Optional[HexMesh], field: Optional[str],
             color_field: Optional[str]) -> tuple[_core.DrawnBody, _Range, Optional[_Range], npt.NDArray[Any]]:
    """What is drawn, the range of its field, that of the field of the colours if it is another, and its bounds."""
    if isinstance(what, HexMesh):
        if colors is not None and list(colors.fields) == list(what.fields):
            colors = None
        of_colors = None if colors is None else _range_of(next(iter(colors.fields.values())))
        return _core.DrawnBody(mesh=what, colors=colors), _range_of(next(iter(what.fields.values()))), of_colors, what.bounds
    if isinstance(what, RbfVolume):
        names = list(what.values)
        channels = [_channel(names, field)]
        if color_field is not None:
            channels.append(_channel(names, color_field))
        ranges = [_range_of(what.values[names[channel]]) for channel in channels]
        return _core.DrawnBody(points=what, channels=channels), ranges[0], ranges[1] if len(ranges) > 1 else None, what.bounds
    about = what.report
    half = about["voxel_size"] / 2
    return _core.DrawnBody(voxels=what.voxels()), (about["min"], about["max"]), None, np.array(what.bounds) + [[-half], [half]]


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
