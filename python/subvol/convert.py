# SPDX-License-Identifier: Apache-2.0
"""Converts a mesh that meshio or VTK reads into a .vtu file: MED, Nastran, SU2, FLAC3D, LS-DYNA, Tecplot, Fluent, Gambit, MFIX and others.

    python3 -m subvol.convert model.med model.vtu [--format NAME] [--step K | --time T]

All cells are kept as they are. Prints what was converted, and warns about what is left out: sets, names of groups, values at Gauss points. Both
packages run in a child process, which may crash; it has 600 seconds. Needs Debian's python3-meshio, for MED python3-h5py, too, or python3-vtk9. Ends
with 2 if the file cannot be read, with 3 if a package is missing.
"""
from __future__ import annotations

import argparse
import os
import sys
import tempfile
import warnings
from typing import Optional

from . import _foreign
from ._arguments import warn
from ._errors import Error, InvalidInput, MissingCapability, SubvolWarning


def convert(source: str, target: str, file_format: Optional[str] = None, step: Optional[int] = None, time: Optional[float] = None) -> str:
    """Writes the file, which appears whole under its name or not at all. Returns what it has, as a sentence.

    file_format: meshio's name of the format; None: by the name of the file
    step, time:  of LS-DYNA and MFIX: the number of a step, or a time near it; None: the last step
    """
    if os.path.splitext(target)[1] != ".vtu":
        raise InvalidInput(f"{target}: meshes are converted to .vtu", target, "NAME.vtu")
    with tempfile.TemporaryDirectory(dir=os.path.dirname(os.path.abspath(target))) as folder:
        made = os.path.join(folder, os.path.basename(target))
        found = _foreign.convert(source, made, file_format, step, time)
        os.replace(made, target)
    for warning in found["warnings"]:
        warn(warning)
    steps = f"; step {found['step']} of 0 to {len(found['times']) - 1}, time {found['times'][found['step']]:g}" if len(found["times"]) > 1 else ""
    return f"{target}: {found['figures']}{steps}"


def main() -> int:
    parser = argparse.ArgumentParser(prog="python3 -m subvol.convert", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", metavar="MESH", help="a file that meshio or VTK reads")
    parser.add_argument("target", metavar="NAME.vtu", help="the file to write")
    parser.add_argument("--format", metavar="NAME", help="meshio's name of the format, such as ansys, nastran, avsucd (default: by the extension)")
    parser.add_argument("--step", metavar="K", type=int, help="of LS-DYNA and MFIX: the number of a step, from 0 (default: the last one)")
    parser.add_argument("--time", metavar="T", type=float, help="the step that is nearest to a time")
    arguments = parser.parse_args()
    with warnings.catch_warnings():
        warnings.simplefilter("always", SubvolWarning)
        warnings.showwarning = lambda message, *_: print(f"subvol.convert: warning: {message}", file=sys.stderr)
        try:
            print(convert(arguments.source, arguments.target, arguments.format, arguments.step, arguments.time))
        except (Error, OSError) as error:
            print(f"subvol.convert: {error}", file=sys.stderr)
            return 3 if isinstance(error, MissingCapability) else 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
