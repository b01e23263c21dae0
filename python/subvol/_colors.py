# SPDX-License-Identifier: Apache-2.0
"""Colours, opacities and the camera of a picture; what they are without arguments is the same as without options of the command."""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import Path, path_bytes
from ._core import Camera, HexMesh, RbfVolume


class TransferFunction:
    """Colours and opacities of the values of a field.

    name:    viridis, plasma, inferno, cividis, turbo, coolwarm, grey, bone, xray, isosurface, surface or constant; or a colour-map
             file of ParaView (.json)
    range:   the values that the map covers; None: the range of the field that is drawn (a file keeps its own values)
    opacity: pairs (value, opacity), linear in between, or text as "0%:0,50%:.2"; None: those of the map
    map:     the name of one of several maps in a file
    """

    def __init__(self, name: Path = "viridis", range: Optional[tuple[float, float]] = None,
                 opacity: Union[None, str, npt.ArrayLike] = None, *, map: str = "") -> None:
        self.name = name
        self.map = map
        self.range: Optional[tuple[float, float]] = None
        if range is not None:
            low, high = range
            self.range = (float(low), float(high))
        self.opacity = opacity
        self._color: Optional[npt.NDArray[np.float64]] = None
        # Mistakes are found here, not when a picture is drawn.
        self.knots(*(self.range or (0.0, 1.0)))

    @staticmethod
    def from_knots(color: npt.ArrayLike, opacity: npt.ArrayLike) -> TransferFunction:
        """color: (n,4): value and linear rgb in [0,1]; opacity: (m,2): value and opacity. Values ascend."""
        rows = np.array(color, float)
        _core.Knots(rows, np.asarray(opacity))
        function = TransferFunction(opacity=np.array(opacity, float))
        function._color = rows
        function.name = "knots"
        return function

    def knots(self, low: float, high: float) -> _core.Knots:
        """The function over the range of a field; of no effect if it has a range of its own."""
        low, high = self.range or (low, high)
        if self._color is not None:
            assert self.opacity is not None
            return _core.Knots(self._color, self.opacity)
        import os

        name = os.fsdecode(self.name)
        if os.path.splitext(name)[1] or os.path.dirname(name):
            knots = _core.read_transfer_function(path_bytes(self.name), self.map)
            if self.range is not None:
                knots = _core.stretched(knots, low, high)
        else:
            knots = _core.preset(name, low, high)
        if self.opacity is None:
            return knots
        alphas = _core.parse_opacity(self.opacity, low, high) if isinstance(self.opacity, str) else self.opacity
        return _core.Knots(knots.color, alphas)

    def legend(self, title: str = "", low: float = 0, high: float = 1, width: int = 360) -> str:
        """A colour bar with ticks and the opacities, as SVG."""
        low, high = self.range or (low, high)
        return _core.legend_svg(self.knots(low, high), title, low, high, width)

    def _repr_svg_(self) -> str:
        return self.legend()

    def __repr__(self) -> str:
        over = "" if self.range is None else f", {self.range[0]:g} to {self.range[1]:g}"
        return f"<subvol.TransferFunction: {self.name!s}{over}>"


def _range_of(values: npt.NDArray[Any]) -> tuple[float, float]:
    return float(values.min()), float(values.max())


def _light_of(given: dict[str, Any], tf: Union[None, str, TransferFunction], has_boundary: bool, shown: tuple[float, float],
              colors: tuple[float, float], bounds: npt.NDArray[Any]) -> _core.PictureLight:
    """The look and the colours of a picture. given: keywords of all kinds; shown, colors: the ranges of the fields of both"""
    chosen = {name: given.get(name) for name in ("look", "iso", "opacity_unit", "clamp", "range", "opacity", "log", "symlog", "bands", "below", "above")}
    if isinstance(tf, TransferFunction):
        return _core.PictureLight(chosen, tf.knots, tf.opacity is not None, has_boundary, shown, colors, bounds)
    return _core.PictureLight({**chosen, "tf": tf}, None, False, has_boundary, shown, colors, bounds)


def _camera_of(light: _core.PictureLight, given: dict[str, Any], camera: Union[None, str, Camera], size: tuple[int, int],
               body: object, bounds: npt.NDArray[Any]) -> Camera:
    """body: what is visible of a mesh or of points is framed by a named view; of others the box"""
    if not isinstance(camera, (str, type(None), Camera)):
        raise TypeError(f"camera: a Camera or text is needed, not {type(camera).__name__}")
    chosen = {name: given.get(name) for name in ("view", "fit", "ortho")}
    text = camera.text if isinstance(camera, Camera) else camera
    mesh = body if isinstance(body, HexMesh) else None
    return light.camera({**chosen, "camera": text}, size, mesh, body if isinstance(body, RbfVolume) else None, bounds)
