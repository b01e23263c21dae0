# SPDX-License-Identifier: Apache-2.0
"""What several calls do with their arguments."""
from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from typing import Any, TypeVar, Union

from ._errors import InvalidInput, SubvolWarning

Path = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]
Kernel = Union[str, Mapping[str, Any]]
Kind = TypeVar("Kind")

TET_SCHEMES = ("tetoct", "boxspline")  # of tetrahedra as tetrahedra


def path_bytes(path: Path) -> bytes:
    """The name of a file as the system has it."""
    name = os.fsencode(path)
    if b"\0" in name:
        raise InvalidInput(f"{path!r}: has a zero byte", repr(path), "the name of a file")
    return name


def extension(path: Path) -> str:
    return os.path.splitext(os.fsdecode(path))[1].lower()


def needed(given: Any, kinds: Union[type[Kind], tuple[type[Any], ...]], what: str) -> Kind:
    """What was given, if it is of one of these classes. `what` is its name: "steps[1]"."""
    if not isinstance(given, kinds):
        names = [kind.__name__ for kind in (kinds if isinstance(kinds, tuple) else (kinds,))]
        words = ", ".join(f"{'an' if name == 'RbfVolume' else 'a'} {name}" for name in names)
        raise TypeError(f"{what}: {' or '.join(words.rsplit(', ', 1))} is needed, not {type(given).__name__}")
    return given  # type: ignore[no-any-return]


def clamped(what: Kind, clamp: Union[None, bool, str]) -> Kind:
    """A mesh whose fields stay in the range of the file if `clamp` is "file", as `--clamp file` of the command; others as they are."""
    if clamp is None or isinstance(clamp, bool):
        return what
    if clamp != "file":
        raise InvalidInput(f"clamp: '{clamp}' is unknown (file)", "clamp", "file")
    from . import _core

    if not isinstance(what, _core.HexMesh):
        raise InvalidInput("clamp: 'file' is of the fields of a mesh", "clamp", "a mesh")
    bounded: Any = _core.bounded(what)
    bounded.clamped = True  # so that quantities of its fields stay in their range, too
    return bounded  # type: ignore[no-any-return]


def warn(text: str, level: int = 3) -> None:
    """Warns on behalf of the function that called ours."""
    if text:
        warnings.warn(text, SubvolWarning, stacklevel=level)
