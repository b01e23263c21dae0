# SPDX-License-Identifier: Apache-2.0
"""Studies: cases from a description, run by a function, each kept as it ends."""
from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any, Union

from . import _core
from ._arguments import Path, extension, path_bytes
from ._core import Study, StudyCase, StudyResults


def studies() -> dict[str, str]:
    """The names of the built-in studies, with their titles."""
    return _core.list_studies()


def study(what: Union[Path, Mapping[str, Any]]) -> Study:
    """A study: the name of a built-in one, a file (.json), or the contents of such a file as a dictionary (docs/studies.md).

    Raises InvalidInput with the place in the description.
    """
    if isinstance(what, Mapping):
        return _core.parse_study(json.dumps(what))
    if extension(what):
        return _core.read_study(path_bytes(what))
    return _core.built_in_study(path_bytes(what).decode())


def run_study(what: Study, work: Callable[[StudyCase], Mapping[str, float]], folder: Path, *, fresh: bool = False) -> StudyResults:
    """Runs the cases that an earlier run in this folder has not finished, one after the other.

    work: takes a case (its `values` say what to do) and returns its metrics; an exception is the case's failure, and the run goes on
    """
    return _core.run_study(what, lambda case: dict(work(case)), path_bytes(folder), fresh)
