# SPDX-License-Identifier: Apache-2.0
"""Runs the command that SUBVOL_COMMAND names; shared by the tests of this folder."""

import json
import os
import pty
import resource
import subprocess
import tempfile
import time
import unittest
from dataclasses import dataclass
from pathlib import Path

COMMAND = os.environ["SUBVOL_COMMAND"]

# A sanitized program is slow and reserves terabytes of addresses, so bounds on time and memory do not apply to it.
SANITIZED = "-fsanitize" in os.environ.get("SUBVOL_FLAGS", "")

# One mesh of one cell: MEDIT, counted from 1.
CUBE = """MeshVersionFormatted 2
Dimension 3
Vertices
8
0 0 0 0
1 0 0 0
1 1 0 0
0 1 0 0
0 0 1 0
1 0 1 0
1 1 1 0
0 1 1 0
Hexahedra
1
1 2 3 4 5 6 7 {last} 0
End
"""


# The coordinates x and z as fields of one cell.
X_AND_Z = """# vtk DataFile Version 3.0
a cell with two fields
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 8 double
0 0 0  1 0 0  1 1 0  0 1 0  0 0 1  1 0 1  1 1 1  0 1 1
CELLS 1 9
8 0 1 2 3 4 5 6 7
CELL_TYPES 1
12
POINT_DATA 8
SCALARS x double 1
LOOKUP_TABLE default
0 1 1 0 0 1 1 0
SCALARS z double 1
LOOKUP_TABLE default
0 0 0 0 1 1 1 1
"""

# Two scalars and a vector on one cell.
TWO_FIELDS = """# vtk DataFile Version 3.0
two
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 8 float
0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1
CELLS 1 9
8 0 1 2 3 4 5 6 7
CELL_TYPES 1
12
POINT_DATA 8
SCALARS Temp float 1
LOOKUP_TABLE default
293 313 313 293 293 313 313 293
SCALARS Pres float 1
LOOKUP_TABLE default
0 0 0 0 2000 2000 2000 2000
VECTORS V float
1 0 0 1 0 0 1 0 0 1 0 0 0 0 2 0 0 2 0 0 2 0 0 2
"""

# Only against a command that hangs: twenty times what the longest one takes on a quiet machine.
HANGS_AFTER = 3000


@dataclass
class Run:
    code: int
    out: str
    err: str
    seconds: float = 0
    peak_mib: float = 0

    def json(self):
        return json.loads(self.out)


def on_cpu(options):
    """What lets splats be drawn by the CPU, as the methods are that draw something else: these do not have the option."""
    return [] if "--method" in options else ["--backend", "cpu"]


def subvol(*arguments, folder=None):
    done = subprocess.run([COMMAND, *map(str, arguments)], cwd=folder, capture_output=True, text=True, timeout=HANGS_AFTER)
    return Run(done.returncode, done.stdout, done.stderr)


def subvol_measured(*arguments, folder=None, max_seconds=None, max_mib=None):
    """As `subvol`, with the seconds and the peak memory of this one process, which is ended if it exceeds the limits."""

    def limit():
        if max_seconds and not SANITIZED:
            resource.setrlimit(resource.RLIMIT_CPU, (max_seconds, max_seconds))
        if max_mib and not SANITIZED:  # only of what it allocates: the libraries alone need more addresses
            resource.setrlimit(resource.RLIMIT_DATA, (max_mib << 20, max_mib << 20))

    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+", errors="replace") as err:
        start = time.monotonic()
        process = subprocess.Popen([COMMAND, *map(str, arguments)], cwd=folder, stdout=out, stderr=err,
                                   preexec_fn=limit)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        seconds = time.monotonic() - start
        out.seek(0)
        err.seek(0)
        return Run(process.returncode, out.read(), err.read(), seconds, usage.ru_maxrss / 1024)


def children(pid):
    """The processes that a process has started and that still run."""
    try:
        tasks = Path(f"/proc/{pid}/task").glob("*/children")
        return [int(child) for task in tasks for child in task.read_text().split()]
    except OSError:  # it ends just now
        return []


def wait_for_end(pids):
    """Returns when none of these processes runs any longer; they need not be children of this one."""
    while not all(has_ended(pid) for pid in pids):
        time.sleep(0.01)


def has_ended(pid):
    """Whether a process is gone, or waits for its parent to take note."""
    try:
        return "\nState:\tZ" in Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return True


def start_and_wait_for_progress(*arguments, folder):
    """Starts the command on a terminal of its own and returns the process and the terminal once it shows progress."""
    terminal, end = pty.openpty()
    process = subprocess.Popen([COMMAND, *map(str, arguments)], cwd=folder, stdout=subprocess.DEVNULL, stderr=end)
    os.close(end)
    os.read(terminal, 1)
    return process, terminal


class InFolder(unittest.TestCase):
    """A test with its own folder. It fails with the message of the command."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def run_ok(self, *arguments):
        done = subvol(*arguments, folder=self.folder)
        self.assertEqual(done.code, 0, f"subvol {' '.join(map(str, arguments))}: {done.err}")
        return done

    def files(self):
        return sorted(path.name for path in self.folder.iterdir())
