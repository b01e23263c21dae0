# SPDX-License-Identifier: Apache-2.0
"""Pictures: the renderers, and the distance between two pictures or fields."""
from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import TET_SCHEMES, Path, clamped, needed, path_bytes, warn
from ._colors import TransferFunction, _camera_of, _light_of, _range_of
from ._core import Camera, Field, HexMesh, Image, RbfVolume
from ._errors import InvalidInput
from ._options import described
from ._fields import as_field
from ._points import _selected
from ._progress import Progress, listening
from ._vdb import Grid, sample_grid
from .reports import DifferenceReport

Drawable = Union[HexMesh, RbfVolume, Grid]


@described
def render(what: Drawable, *, method: str = "splat", camera: Union[None, str, Camera] = None, size: tuple[int, int] = (512, 512),
           field: Optional[str] = None, tf: Union[None, str, TransferFunction] = None,
           patch: Union[None, str, Sequence[str]] = None, part_opacity: Union[None, str, Sequence[str]] = None,
           ray_ends: Optional[npt.ArrayLike] = None,
           seeds: Union[None, str, Sequence[str], npt.ArrayLike] = None, clamp: Union[bool, str] = False, progress: Progress = None,
           **options: Any) -> Image:
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
    {keywords}

    clamp may also be "file": the fields stay in the range that they have in the file, also between its points.
    Cuts are rows of six numbers, each a list or an array. Returns an Image: `numpy.asarray(image)` is (height, width, 4) float32,
    linear, premultiplied, without a copy. Its `report` has counts and seconds.
    """
    if isinstance(what, Field):
        raise InvalidInput("what: a Field cannot be drawn; draw the mesh or the points that it is of", "what", "a mesh, points or a grid")
    if len(size) != 2 or not all(1 <= side <= _core.largest_side for side in size):
        raise InvalidInput(f"size: {size} is not a picture size", "size", f"width and height, 1 to {_core.largest_side}")
    what = clamped(what, clamp)
    options["clamp"] = clamp is True
    frame = np.array(what.frame) if isinstance(what, Grid) else None
    level_set = isinstance(what, Grid) and what.report["level_set"]  # the body within its surface
    if level_set and _core.draws_kernels(method) and (options.get("iso") or options.get("look") == "isosurface"):
        raise InvalidInput("look: a level set is drawn as the surface where its distance is 0 (without iso and look='isosurface')",
                           "look", "without iso and look='isosurface'")
    if isinstance(what, Grid) and _core.draws_kernels(method):
        what = sample_grid(what)
    needed(what, (HexMesh, RbfVolume, Grid), "what")
    given = {name: value for name, value in options.items() if value is not None and value is not False}
    color_field = options.get("color_field")
    patches = whole = None
    if patch is not None:
        if not isinstance(what, HexMesh):
            raise InvalidInput("patch: points and grids have no patches", "patch", "a mesh that was read from a file with patches")
        whole = what
        patches = _core.choose_patches(what, [patch] if isinstance(patch, str) else list(patch))
        what = patches.mesh
        if field is None:
            field, tf = "patch", tf or "categories"
    source = whole if patches is not None else what.without_unused_points() if isinstance(what, HexMesh) else None
    if "streamlines" in given or "glyphs" in given:
        _core.check_flow(given, method, isinstance(what, HexMesh) and given.get("scheme") not in TET_SCHEMES,
                         patches is None and part_opacity is None)
    if source is not None and patches is None and ("streamlines" in given or "glyphs" in given):
        length, thin = _core.flow_defaults(source, given)
        field, given = (length if field is None else field), {**given, **thin}
    mesh = _selected(what, field) if isinstance(what, HexMesh) else None
    other = _selected(what, color_field) if isinstance(what, HexMesh) and color_field is not None else None
    body, shown, colors, bounds = _body_of(what if mesh is None else mesh, other, patches, field, color_field, source, seeds)
    framed = what if mesh is None else mesh
    if part_opacity is not None:
        body, shown, bounds, framed = _parts_of(what, mesh, [part_opacity] if isinstance(part_opacity, str) else list(part_opacity),
                                                patches is not None, given)
    bounds = bounds if frame is None else frame
    light = _light_of(given, tf, (mesh is not None or level_set) and not options.get("shade"), shown, colors or shown, bounds)
    eye = _camera_of(light, given, camera, size, framed, bounds)
    with listening(progress) as listener:
        image = _core.render(body, method, eye, (int(size[0]), int(size[1])), ray_ends, light, given, listener)
    image.report["background"] = light.background
    for warning in image.report.get("warnings", []):
        warn(warning)
    return image


_Range = tuple[float, float]


def _body_of(what: Drawable, colors: Optional[HexMesh], patches: Optional[_core.Patches], field: Optional[str],
             color_field: Optional[str], source: Optional[HexMesh], seeds: object) -> tuple[_core.DrawnBody, _Range, Optional[_Range], npt.NDArray[Any]]:
    """What is drawn, the range of its field, that of the field of the colours if it is another, and its bounds."""
    if isinstance(what, HexMesh):
        if colors is not None and list(colors.fields) == list(what.fields):
            colors = None
        of_colors = None if colors is None else _range_of(next(iter(colors.fields.values())))
        bounds = what.bounds if patches is None else np.stack([what.points.min(0), what.points.max(0)])
        return _core.DrawnBody(mesh=what, colors=colors, patches=patches, source=source, seeds=seeds), _range_of(next(iter(what.fields.values()))), of_colors, bounds
    if isinstance(what, RbfVolume):
        names = list(what.values)
        channels = [_channel(names, field)]
        if color_field is not None:
            channels.append(_channel(names, color_field))
        ranges = [_range_of(what.values[names[channel]]) for channel in channels]
        return _core.DrawnBody(points=what, channels=channels, seeds=seeds), ranges[0], ranges[1] if len(ranges) > 1 else None, _core.frame_of(what)
    about = what.report
    return _core.DrawnBody(voxels=what.voxels(), seeds=seeds), (about["min"], about["max"]), None, np.array(what.frame)


def _parts_of(what: Drawable, mesh: Optional[HexMesh], texts: list[str], patches: bool,
              given: dict[str, Any]) -> tuple[_core.DrawnBody, _Range, npt.NDArray[Any], HexMesh]:
    """Translucent parts and the rest: what is drawn, the range of its field, its bounds, and the points that a view frames."""
    def refuse(reason: str, allowed: str) -> InvalidInput:
        return InvalidInput(f"part_opacity: {reason} ({allowed})", "part_opacity", allowed)

    if "color_field" in given:
        raise refuse("is of parts of a volume in the colours of one field", "without color_field")
    if given.get("look", "solid") != "solid" or "opacity" in given or "opacity_unit" in given or "iso" in given or given.get("shade"):
        raise refuse("is of the surfaces of a solid", "look='solid' without opacity")
    if not isinstance(what, HexMesh) or mesh is None:
        raise refuse("needs a mesh of hexahedra", "a mesh")
    if given.get("scheme") in TET_SCHEMES:
        raise refuse("needs the limit of hexahedra", "another scheme")
    if patches:
        raise refuse("is of parts of a volume, and patch draws faces alone", "without patch")
    parts, warning = _core.translucent_parts(mesh, what, texts, given)
    if warning:
        warn(warning)
    rest = parts.rest.without_unused_points() if len(parts.rest.cells) else parts.rest
    values, points = parts.values, parts.points
    if len(rest.cells):
        values = np.concatenate([next(iter(rest.fields.values())), values])
        points = np.concatenate([rest.points, points])
    return _core.DrawnBody(mesh=rest, parts=parts, source=mesh), _range_of(values), np.stack([points.min(0), points.max(0)]), _core.only_points(points)


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


def write_image(image: Union[Image, npt.ArrayLike], path: Path, background: Union[None, str, Sequence[float]] = None) -> None:
    """Writes `.exr` (linear floats, with the depth if there is one), `.png` (8 bits over the background, linear rgb; with alpha over
    "none"), `.jpg` or `.webp`."""
    _as_image(image).write(path_bytes(path), background)


def _as_image(given: Union[Image, npt.ArrayLike]) -> Image:
    return given if isinstance(given, Image) else Image(given)


class ImageComparison:
    """Differences over red, green and blue of all pixels, for a peak of 1: mse, rmse, mae, max, psnr (infinite for equal pictures).

    Parts of pictures (`Image.data_window`) are compared where they overlap.
    ssim and flip, and their maps (height, width), are computed when they are asked for: ssim is that of [ssim2004] on the luminance of
    8-bit sRGB, as scikit-image computes it; ssim_linear the mean of linear red, green and blue; flip is at 67.02 pixels per degree.
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

    @cached_property
    def ssim_linear(self) -> float:
        return _core.ssim_linear(self._test, self._reference)

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
    """Differences of two fields at random places of the reference, in the field's unit: l1, l2, linf; linf_at: the place of the largest;
    gradient_rmse per world length;
    samples: places where both have a value; uncovered: places where only the reference has one; coverage: the share of the first.

    The differences are over the places where both have a value, so a coverage below 1 says that they are about a part of the reference;
    of fields without a place in common they are nan."""

    def __init__(self, figures: dict[str, Any]) -> None:
        self.l1: float = figures["l1"]
        self.l2: float = figures["l2"]
        self.linf: float = figures["linf"]
        self.linf_at: tuple[float, float, float] = figures["linf_at"]
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
    """The distance between two fields: of meshes (their limit, by curved pieces, as the command does), of points, or given as Field.

    Both are compared where both have a value: see `coverage` of the result. gradients=False: gradient_rmse is nan."""
    with listening(progress) as listener:
        def field_of(what: Union[HexMesh, RbfVolume, Field]) -> Field:
            if not isinstance(what, HexMesh):
                return as_field(what, field)
            mesh = _selected(what, field)
            return Field.of_limit(mesh, next(iter(mesh.fields)), "mcq", False, listener)

        a, b = field_of(test), field_of(reference)
        return FieldComparison(_core.compare_fields(a, b, samples, seed, gradients, listener))


@described
def mesh_difference(test: HexMesh, reference: HexMesh, *, progress: Progress = None, **options: Any) -> tuple[HexMesh, DifferenceReport]:
    """The first mesh with test - reference of each field that both have, at its points, as `subvol compare A B -o FILE` writes it.

    Values of the reference are those of its limit at the points, or those of its own points if both meshes have the same points and
    cells. The report has same_points, whether that is so; outside, the number of points outside the reference, which get the
    value of its nearest place, and outside_distance, how far the farthest is; and for each of fields max, at and point: the largest
    difference and where it is.

    {keywords}
    """
    with listening(progress) as listener:
        return _core.mesh_difference(needed(test, HexMesh, "test"), needed(reference, HexMesh, "reference"), listener, **options)


def compare(test: Any, reference: Any, **options: Any) -> Any:
    """`compare_fields` of meshes, points and Fields; `compare_images` of pictures and arrays."""
    kinds = (HexMesh, RbfVolume, Field)
    if isinstance(test, kinds) != isinstance(reference, kinds):
        raise InvalidInput("compare: one of the two is a picture, the other a field", "compare", "two pictures or two fields")
    return compare_fields(test, reference, **options) if isinstance(test, kinds) else compare_images(test, reference, **options)
