# SPDX-License-Identifier: Apache-2.0
"""Values of fields at places: in the world, and in cells."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import field_name, needed
from ._core import Field, HexMesh, RbfVolume
from ._errors import InvalidInput
from ._options import described
from ._points import _selected
from ._progress import Progress, listening

def as_field(what: Union[HexMesh, RbfVolume, Field], field: Optional[str] = None, *, levels: Optional[int] = None, scheme: str = "mcq",
             progress: Progress = None) -> Field:
    """The field of a mesh's limit or of points as an object that is evaluated anywhere, many times.

    levels: of the trilinear cells that stand for the limit, which are faster; None: the limit itself, as `probe` has it,
            in about 1.5 kB of memory for each cell
    """
    if isinstance(what, Field):
        return what
    if isinstance(what, RbfVolume):
        names = list(what.values)
        if field is not None and field not in names:
            raise InvalidInput(f"field: there is no channel '{field}' (there are {', '.join(names)})", "field", ", ".join(names))
        return Field.of_points(what, 0 if field is None else names.index(field))
    mesh = _selected(needed(what, (HexMesh, RbfVolume, Field), "what"), field)
    name = next(iter(mesh.fields))
    with listening(progress) as listener:
        if levels is None:
            return Field.of_limit(mesh, name, scheme, True, listener)
        fine = _core.subdivide(mesh, True, listener, levels=levels, scheme=scheme)
        return Field.of_mesh(fine, name, listener)


def evaluate(what: Union[HexMesh, RbfVolume, Field], field: Optional[str] = None, at: npt.ArrayLike = (), *, levels: Optional[int] = None,
             scheme: str = "mcq", progress: Progress = None) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.bool_]]:
    """The values of a field at places in the world.

    at:     (n,3), world
    levels: as of `as_field`

    Returns the values (n,) in the field's unit, nan outside the volume, and whether each place is inside (n,). To evaluate more than
    once, make a field by `as_field` first. `evaluate_limit` takes places in cells.
    """
    field_name(field, "evaluate(what, field, at)")
    places = np.asarray(at)
    field_of = as_field(what, field, levels=levels, scheme=scheme, progress=progress)
    return field_of.values(np.empty((0, 3)) if places.size == 0 else places)


@dataclass(frozen=True)
class LimitSamples:
    """positions: (n,3) world; jacobians: (n,3,3): jacobians[i] @ d(u,v,w) = d(x,y,z); fields: (n,) or (n,channels) by name;
    derivatives: by u, v, w, (n,3) or (n,channels,3); report: how many values are exact, refined, unconverged"""

    positions: npt.NDArray[np.float64]
    jacobians: npt.NDArray[np.float64]
    fields: dict[str, npt.NDArray[np.float64]]
    derivatives: dict[str, npt.NDArray[np.float64]]
    report: dict[str, int]

    def gradients(self, field: str) -> npt.NDArray[np.float64]:
        """The gradient of a scalar field in the world, (n,3), per world length."""
        turned = np.linalg.solve(np.swapaxes(self.jacobians, 1, 2), self.derivatives[field][..., None])
        return np.asarray(turned[..., 0])


@described
def evaluate_limit(mesh: HexMesh, cells: npt.ArrayLike, uvw: npt.ArrayLike, *, progress: Progress = None, **options: Any) -> LimitSamples:
    """Positions, Jacobians and all fields of the limit at places in control cells.

    cells:       (n,) their numbers
    uvw:         (n,3) in [0,1]: u along corners 0-1, v along 0-3, w along 0-4
    {keywords}

    Raises InvalidInput if a cell does not exist or a place lies outside [0,1].
    """
    with listening(progress) as listener:
        found: dict[str, Any] = _core.evaluate_limit(mesh, cells, uvw, listener, **options)
    return LimitSamples(**found)
