# SPDX-License-Identifier: Apache-2.0
"""A page that draws a volume in a browser, also in a notebook."""
from __future__ import annotations

import html
import os
from typing import Any, Optional, Union

import numpy as np

from . import _core
from ._arguments import Path, clamped, needed
from ._colors import TransferFunction, _camera_of, _light_of, _range_of
from ._core import Camera, HexMesh, RbfVolume
from ._errors import InvalidInput
from ._options import described
from ._points import _selected, sample
from ._progress import Progress, listening
from ._vdb import Grid, sample_grid


class Page:
    """One HTML file that needs no network. A notebook shows it: the volume can be turned there.

    html:   the file's text
    report: bytes, points, kept (kernels in the page), bits, triangles, rmse and max_error (in the field's unit)
    """

    def __init__(self, text: str, report: dict[str, Any]) -> None:
        self.html = text
        self.report = report

    def write(self, path: Path) -> None:
        """Writes the page; the file appears whole or not at all. A file that is replaced leaves its permissions to it."""
        name = os.fsdecode(path)
        if not name.endswith(".html"):
            raise InvalidInput(f"{name}: a page is a .html file", name, ".html")
        _core.write_text(name, self.html)

    def _repr_html_(self) -> str:
        return ('<iframe style="width:100%;height:640px;border:0" sandbox="allow-scripts" title="volume" '
                f'srcdoc="{html.escape(self.html)}"></iframe>')

    def __repr__(self) -> str:
        return f"<subvol.Page: {self.report['bytes']:,} bytes, {self.report['kept']:,} kernels>"


@described
def page(mesh: Union[HexMesh, Grid], field: Optional[str] = None, *, per_edge: int = 1, camera: Union[None, str, Camera] = None,
         tf: Union[None, str, TransferFunction] = None, title: str = "", unit: str = "", max_bytes: int = 24_000_000, scheme: str = "mcq",
         clamp: Union[bool, str] = False, progress: Progress = None, **options: Any) -> Page:
    """A page of a field of a mesh, or of the body within the surface of a level set: as `subvol page`.

    unit:        of the field, for the legend
    max_bytes:   kernels are rounded, then merged, until the page fits
    tf may also be a TransferFunction, camera a Camera, clamp "file": the field stays in the range that it has in the file, also between
    its points. The look isosurface is not drawn in pages.
    {keywords}
    """
    needed(mesh, (HexMesh, Grid), "mesh")
    mesh = clamped(mesh, clamp)
    options["clamp"] = clamp is True
    if isinstance(mesh, Grid):
        if not mesh.report["level_set"]:
            raise InvalidInput("mesh: the grid is fog, which has no boundary (a mesh or a level set)", "mesh", "a mesh or a level set")
        volume, skin = sample_grid(mesh, 0, progress), None
        chosen: Union[HexMesh, RbfVolume] = volume
        name = next(iter(volume.values))
        shown = _range_of(volume.values[name])
        bounds = np.array(mesh.frame)
    else:
        chosen = _selected(mesh, field)
        name = next(iter(chosen.fields))
        shown = _range_of(chosen.fields[name])
        bounds = chosen.bounds
        volume, skin = sample(chosen, name, per_edge, scheme=scheme, progress=progress), _core.skin(chosen, scheme, 1 / 16, None, None)
    low, high = shown
    light = of_volume = _light_of(options, tf, True, shown, shown, bounds)
    if light.look == "solid":  # opacities are those of the look volume, which readers can choose
        of_volume = _light_of({**options, "look": "volume"}, tf, True, shown, shown, bounds)
    knots = _core.Knots(light.knots.color, of_volume.knots.opacity)  # a body whose values are all the same is plain
    eye = _camera_of(light, options, camera, (512, 512), chosen, bounds)
    with listening(progress) as listener:
        text, report = _core.page(volume, skin, knots, unit, low, high, light.look, eye, options.get("up", "z"), of_volume.opacity_unit, light.background,
                                  title or name, "a mesh in Python", max_bytes, listener)
    return Page(text, report)
