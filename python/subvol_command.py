# SPDX-License-Identifier: Apache-2.0
"""The command `subvol`, which a wheel has beside the package: `subvol …` and `python -m subvol …` become it. A module of its own, as it needs
neither numpy nor the library."""
import os
import signal
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
PLACES = ["subvol/bin/subvol", "../bin/subvol", "../../../bin/subvol"]  # of a wheel, of the build folder, of Debian's packages


def main() -> None:
    program = next((path for path in (os.path.join(HERE, place) for place in PLACES) if os.path.isfile(path)), None)
    if program is None:
        sys.exit(_lacking("the command is not installed: Debian has it in the package subvol"))
    for name in ("SIGPIPE", "SIGXFSZ"):  # which Python ignores, and so would what it becomes
        signal.signal(getattr(signal, name), signal.SIG_DFL)
    try:
        os.execv(program, ["subvol", *sys.argv[1:]])
    except OSError as error:
        sys.exit(_lacking(f"{program} cannot be run: {error.strerror}"))


def _lacking(what: str) -> int:
    print(f"subvol: {what}", file=sys.stderr)
    return 3
