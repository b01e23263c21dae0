# SPDX-License-Identifier: Apache-2.0
"""Converts a mesh that meshio reads into a .vtu file, which the command reads: MED, Nastran, SU2, FLAC3D, Ansys and others.

    python3 -m subvol.convert model.med model.vtu [--format NAME]

All cells are kept as they are. Prints what was converted, and warns about what is left out: sets, names of groups, values at Gauss points.
Needs Debian's python3-meshio, for MED python3-h5py, too. Ends with 2 if the file cannot be read, with 3 if a package is missing.
"""
from __future__ import annotations

import argparse
import os
import sys
import tempfile
import warnings
from typing import Optional

from . import _foreign
from ._errors import Error, InvalidInput, MissingCapability, SubvolWarning


def convert(source: str, target: str, file_format: Optional[str] = None) -> str:
    """Writes the file, which appears whole under its name or not at all. Returns what it has, as a sentence."""
    if os.path.splitext(target)[1] != ".vtu":
        raise InvalidInput(f"{target}: meshes are converted to .vtu", target, "NAME.vtu")
    mesh = _foreign.read(source, file_format)
    if not _foreign.has_volume(mesh):
        raise InvalidInput(f"{source}: there are no cells with a volume: {_foreign.figures(mesh)}", source)
    with tempfile.TemporaryDirectory(dir=os.path.dirname(os.path.abspath(target))) as folder:
        made = os.path.join(folder, os.path.basename(target))
        _foreign.write_vtu(mesh, made)
        os.replace(made, target)
    return f"{target}: {_foreign.figures(mesh)}"


def main() -> int:
    parser = argparse.ArgumentParser(prog="python3 -m subvol.convert", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", metavar="MESH", help="a file that meshio reads")
    parser.add_argument("target", metavar="NAME.vtu", help="the file to write")
    parser.add_argument("--format", metavar="NAME", help="meshio's name of the format, such as ansys, nastran, avsucd (default: by the extension)")
    arguments = parser.parse_args()
    with warnings.catch_warnings():
        warnings.simplefilter("always", SubvolWarning)
        warnings.showwarning = lambda message, *_: print(f"subvol.convert: warning: {message}", file=sys.stderr)
        try:
            print(convert(arguments.source, arguments.target, arguments.format))
        except (Error, OSError) as error:
            print(f"subvol.convert: {error}", file=sys.stderr)
            return 3 if isinstance(error, MissingCapability) else 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
