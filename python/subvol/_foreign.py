# SPDX-License-Identifier: Apache-2.0
"""Meshes in formats of other programs. `_foreign_file.py` converts them by meshio or VTK, in a child process, because both trust the files."""
from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from typing import Any, Optional

from . import _core, _foreign_file
from ._arguments import Path, path_bytes
from ._errors import Error, FileError, InvalidInput, MissingCapability

# The endings of the files that meshio or VTK read and the library does not, and whose files they are.
EXTENSIONS = {ending: row["program"] for row in _foreign_file.FORMATS for ending in row["endings"]}


def is_foreign(path: Path) -> bool:
    """Whether meshio or VTK has to read a file: by its name, and because the library does not know the contents."""
    return _foreign_file.row_of(os.fsdecode(path)) is not None and not _core.is_mesh_file(path_bytes(path))


def convert(source: Path, target: str, file_format: Optional[str] = None, step: Optional[int] = None, time: Optional[float] = None) -> dict[str, Any]:
    """Writes a .vtu file. Returns the object that the program prints, whose "warnings" begin with what read the file.

    file_format: meshio's name of the format; None: by the name of the file
    step, time:  which step; None: the last one
    """
    name = os.fsdecode(source)
    if not os.path.isfile(name):
        raise FileError("cannot be read: there is no such file", name)
    words = [sys.executable or "python3", _foreign_file.__file__, os.path.abspath(name), target]
    for option, value in (("--format", file_format), ("--step", step), ("--time", time)):
        if value is not None:
            words.append(f"{option}={value}")
    packages = os.pathsep.join(place for place in sys.path if place)  # what this process finds, the child finds
    done = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, env={**os.environ, "PYTHONPATH": packages}, check=False)
    try:
        found: dict[str, Any] = json.loads(done.stdout)
    except ValueError:
        how = f"by signal {-done.returncode}" if done.returncode < 0 else f"with exit code {done.returncode}"
        last = done.stderr.decode("utf-8", "replace").strip().rpartition("\n")[2]
        raise MissingCapability(f"{name}: Python ended {how} while it converted the file" + (f": {last}" if last else ""), name) from None
    if "message" in found:
        kind: type[Error] = {3: MissingCapability, 4: FileError}.get(done.returncode, InvalidInput)
        raise kind(f"{name}: {found['message']}", name, found["allowed"])
    found["warnings"].insert(0, f"read by {found['by']} ({found['program']}); {found['left']} not read")
    return found


def read_mesh(path: Path, options: dict[str, Any]) -> tuple[_core.HexMesh, list[str]]:
    """What the library reads of what meshio or VTK reads, and its warnings."""
    name = os.fsdecode(path)
    chosen: dict[str, Any] = {}
    if (_foreign_file.row_of(name) or {}).get("steps"):
        options = dict(options)
        chosen = {word: options.pop(word, None) for word in ("step", "time")}
    with tempfile.TemporaryDirectory() as folder:
        made = os.path.join(folder, "mesh.vtu")
        found = convert(path, made, **chosen)
        try:
            mesh, said = _core.read_mesh(path_bytes(made), **options)
        except InvalidInput as error:
            raise InvalidInput(str(error).replace(made, name), error.where.replace(made, name), error.allowed) from None
    if len(found["times"]) > 1 and all(value is None for value in chosen.values()):
        found["warnings"].append(f"the file has {len(found['times'])} steps; the last one is read")
    return mesh, [*found["warnings"], *said]
