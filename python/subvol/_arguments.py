# SPDX-License-Identifier: Apache-2.0
"""What several calls do with their arguments."""
from __future__ import annotations

import inspect
import os
import warnings
from collections.abc import Callable, Mapping
from typing import Any, Optional, TypeVar, Union

from ._errors import InvalidInput, SubvolWarning

Path = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]
Kernel = Union[str, Mapping[str, Any]]
Kind = TypeVar("Kind")
Call = TypeVar("Call", bound=Callable[..., Any])

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


def takes(*names: str) -> Callable[[Call], Call]:
    """A call whose `*given` are these arguments, which may also be given by name: its signature says so. See `in_order`."""
    def with_names(call: Call) -> Call:
        signature = inspect.signature(call)
        own = dict(signature.parameters)
        listed = [own.pop(name).replace(kind=inspect.Parameter.POSITIONAL_OR_KEYWORD) for name in names]
        del own["given"]
        parameters = list(own.values())
        call.__signature__ = signature.replace(parameters=[parameters[0], *listed, *parameters[1:]])  # type: ignore[attr-defined]
        return call

    return with_names


def in_order(call: str, given: tuple[Any, ...], named: dict[str, Any], was: tuple[str, ...]) -> list[Any]:
    """The arguments after the first of a call, which takes a field and then places or values. The order that it had before still
    works, and warns: what it had in place of a field is no name.

    given: by position; named: by name, in their order, None where they are not; was: the names in the old order
    """
    now = ", ".join(["mesh", *named])
    before = dict(zip(was, given))
    old = len(given) > 0 and (given[0] is None and isinstance(before.get("field"), str) or not isinstance(given[0], (str, type(None))))
    names = was if old else tuple(named)
    if len(given) > len(names):
        raise TypeError(f"{call}({now}) takes {len(named) + 1} arguments by position, not {len(given) + 1}")
    for name, value in zip(names, given):
        if named[name] is not None:
            raise TypeError(f"{call}: {name} is given twice; write {call}({now})")
        named[name] = value
    field_name(named["field"], f"{call}({now})")
    if old:
        order = ", ".join(["mesh", *was])
        warnings.warn(f"{call}({order}) will go: write {call}({now}), or name the arguments", DeprecationWarning, stacklevel=3)
    return list(named.values())


def field_name(field: Any, call: str) -> Optional[str]:
    """The name of a field, or None. call: how it is written, as "evaluate(what, field, at)"."""
    if field is not None and not isinstance(field, str):
        raise TypeError(f"field: a name is needed, not {type(field).__name__}; write {call}")
    return field


def warn(text: str, level: int = 3) -> None:
    """Warns on behalf of the function that called ours."""
    if text:
        warnings.warn(text, SubvolWarning, stacklevel=level)
