# SPDX-License-Identifier: Apache-2.0
"""Keywords that the library describes: the signatures and docstrings of calls that take them, and the stubs of the package.

`python3 -c 'from subvol import _options; _options.print_stubs()'` prints `__init__.pyi`, in which type checkers and editors read the same.
"""
from __future__ import annotations

import inspect
import textwrap
from collections.abc import Callable
from typing import Any, TypeVar

from . import _core, reports

_Call = TypeVar("_Call", bound=Callable[..., Any])
_HERE = "{keywords}"  # where a docstring has them
_WIDTH = 120

described_calls: dict[str, Callable[..., Any]] = {}


def described(call: _Call) -> _Call:
    """A call whose `**options` are the keywords that the library describes under its name."""
    described_calls[call.__name__] = call
    keywords = _core.keywords[call.__name__]
    given = inspect.signature(call)
    own = [p for p in given.parameters.values() if p.kind != p.VAR_KEYWORD]
    more = [inspect.Parameter(key, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=kind)
            for key, kind, default, _, _ in keywords if key not in given.parameters]
    if own[-1].name == "progress":
        more.append(own.pop())
    call.__signature__ = given.replace(parameters=own + more)  # type: ignore[attr-defined]
    call.__doc__ = inspect.cleandoc(call.__doc__ or "").replace(_HERE, "\n".join(_entry(*keyword) for keyword in keywords))
    return call


def returns_by(parameter: str, results: dict[str, str]) -> Callable[[_Call], _Call]:
    """A call whose result depends on the type of a parameter: the stubs have an overload for each. results: by that type"""
    def with_results(call: _Call) -> _Call:
        call.overloads = (parameter, results)  # type: ignore[attr-defined]
        return call

    return with_results


def _entry(key: str, _kind: str, _default: object, meaning: str, conditions: list[str]) -> str:
    """What a docstring says of a keyword; its type and default are in the signature."""
    text = meaning + (f" [{'; '.join(conditions)}]" if conditions else "")
    return textwrap.fill(f"{key + ':':<12} {text}", _WIDTH, subsequent_indent=" " * 13, break_on_hyphens=False)


def stubs() -> str:
    """The text of `__init__.pyi`: the imports of `__init__.py`, and the described calls."""
    import pathlib
    import re

    package = pathlib.Path(__file__).with_name("__init__.py").read_text()
    imports = re.findall(r"^from \.(\w*) import (.+)$", package, re.M)
    text = ["# SPDX-License-Identifier: Apache-2.0", "# Made by: python3 -c 'from subvol import _options; _options.print_stubs()'", "from collections.abc import Iterable, Iterator, Mapping, Sequence",
            "from typing import Any, Optional, Union, overload", "", "import numpy.typing as npt", ""]
    for module, names in imports:
        kept = [name for name in names.split(", ") if name not in described_calls]
        if kept and module:
            text.append(f"from .{module} import {', '.join(kept)}")
    text += ["from ._arguments import Kernel, Path", "from ._pictures import Drawable", "from ._progress import Progress",
             f"from .reports import {', '.join(reports.__all__)}", "", "__version__: str"]
    for name, call in sorted(described_calls.items()):
        for head in _heads(call)[:-1]:
            text += ["", "@overload", f"def {name}{head}: ..."]
        text += ["", *(["@overload"] if len(_heads(call)) > 1 else []), f"def {name}{_heads(call)[-1]}:", textwrap.indent(f'"""{call.__doc__}\n"""', "    ", lambda line: bool(line.strip()))]
    names = re.search(r"^__all__ = \[\n.*?^\]$", package, re.M | re.S)
    assert names is not None
    return "\n".join([*text, "", str(names[0]), ""])


def _heads(call: Callable[..., Any]) -> list[str]:
    """The parameters and the result of a call, or of each of its overloads: all but the first need the parameter."""
    signature = inspect.signature(call)
    name, results = getattr(call, "overloads", ("", {}))
    if not results:
        return [_head(signature)]
    heads = []
    for kind, result in results.items():
        parameters = [p if p.name != name else p.replace(annotation=kind, default=p.default if kind == "None" else p.empty)
                      for p in signature.parameters.values()]
        heads.append(_head(signature.replace(parameters=parameters, return_annotation=result)))
    return heads


def _head(signature: inspect.Signature) -> str:
    """The parameters and the result, in lines."""
    stars, parts = False, []
    for p in signature.parameters.values():
        if p.kind == p.KEYWORD_ONLY and not stars:
            stars = True
            parts.append("*")
        default = "" if p.default is p.empty else f" = {p.default!r}"
        parts.append(f"{p.name}: {p.annotation}{default}")
    inside = textwrap.fill(", ".join(part.replace(" ", "\0") for part in parts), _WIDTH, initial_indent="    ", subsequent_indent="    ",
                           break_long_words=False, break_on_hyphens=False)
    return "(\n" + inside.replace("\0", " ") + f"\n) -> {signature.return_annotation}"


def print_stubs() -> None:
    print(stubs(), end="")
