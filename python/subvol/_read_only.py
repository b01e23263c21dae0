# SPDX-License-Identifier: Apache-2.0
"""Dictionaries that properties make anew each time they are asked for."""
from __future__ import annotations

from typing import Any, NoReturn, TypeVar

Value = TypeVar("Value")


class ReadOnlyDict(dict[str, Value]):
    """A dictionary that refuses changes, which would be lost without a word: the object that it is of does not change. Copies of it,
    pickled ones too, are plain dictionaries."""

    def __init__(self, items: dict[str, Value], of: str, instead: str = "") -> None:
        super().__init__(items)
        self._refusal = f"{of} cannot be changed" + (f"; {instead}" if instead else "")

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        raise TypeError(self._refusal)

    __setitem__ = __delitem__ = __ior__ = clear = pop = popitem = setdefault = update = _refuse  # type: ignore[assignment]

    def __reduce_ex__(self, _: Any) -> tuple[type[dict[str, Value]], tuple[dict[str, Value]]]:
        return dict, (dict(self),)

    def __copy__(self) -> dict[str, Value]:
        return dict(self)
