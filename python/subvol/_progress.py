# SPDX-License-Identifier: Apache-2.0
"""The argument `progress` of long calls."""
from __future__ import annotations

import contextlib
import importlib
import sys
from collections.abc import Callable, Iterator
from typing import Optional, Union

Listener = Callable[[str, float], object]
Progress = Union[None, bool, Listener]


@contextlib.contextmanager
def listening(progress: Progress) -> Iterator[Optional[Listener]]:
    """None or False: nothing is shown. True: a bar by tqdm, or lines on standard error if it is not installed. A function is called
    with a stage and its fraction in [0,1], on the thread that made the call; an exception in it cancels the work and is raised."""
    if progress is None or progress is False:
        yield None
    elif progress is True:
        try:
            tqdm = importlib.import_module("tqdm.auto").tqdm
        except ImportError:
            yield _Lines()
            return
        with tqdm(total=1.0, bar_format="{desc}: {percentage:3.0f}%|{bar}| {elapsed}", leave=False) as bar:
            def show(stage: str, fraction: float) -> None:
                bar.set_description_str(stage, refresh=False)
                bar.n = fraction
                bar.refresh()

            yield show
    else:
        yield progress


class _Lines:
    """One line for each stage."""

    def __init__(self) -> None:
        self.stage = ""

    def __call__(self, stage: str, fraction: float) -> None:
        if stage != self.stage:
            print(f"subvol: {stage}", file=sys.stderr)
            self.stage = stage
