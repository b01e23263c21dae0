# SPDX-License-Identifier: Apache-2.0
"""Runs the command in shares, as parts of the work and as processes of MPI; for the tests of this folder."""

import json
import os
import shutil
import subprocess
import unittest
from pathlib import Path

from command import COMMAND, InFolder, children, has_ended, subvol, wait_for_end, on_cpu

COUNTS = (1, 2, 7)  # 3 and 4, too, in bench/equality.py
BALL = "model:ball:4"
MPIRUN = shutil.which("mpirun")
AS_ROOT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
WIDTH, HEIGHT = 96, 80  # tiles have 32×32 pixels: three columns, and three rows, the last one cut
PICTURE = ["--size", f"{WIDTH}x{HEIGHT}", "--backend", "cpu", "--quiet"]


def picture(options):
    size = [] if "--size" in options else PICTURE[:2]
    return [*size, *on_cpu(options), "--quiet", *options]


SURFACES = [[*options, "--tolerance", "1e-2"] for options in (
    [], ["--iso", "0.3", "--color-field", "density"], ["--iso", "0.1", "--iso", "0.4", "--cap", "--crease-angle", "40"])]


def without_times(report):
    for key in ("seconds", "peak_bytes", "input", "output", "ranks", "bytes_sent", "peak_bytes_of_ranks", "parts"):
        report.pop(key, None)
    return report


def in_ranks(count, *words):
    """The words that start a program in processes of MPI."""
    return [MPIRUN, "--oversubscribe", "-n", str(count), *map(str, words)]


# Where a rank has failed, Debian's mpirun may never end: it waits for a lock of its own in PMIx_server_finalize.
PATIENCE_S = 20


def run_in_ranks(folder, count, *words):
    """Runs a program in processes of MPI to the end; once more if all of them have ended but mpirun does not."""
    for _ in range(5):
        run = subprocess.Popen(in_ranks(count, *words), cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=AS_ROOT)
        for _ in range(40):
            started = children(run.pid)
            over = bool(started) and all(has_ended(pid) for pid in started)
            try:
                out, err = run.communicate(timeout=PATIENCE_S)
                return subprocess.CompletedProcess(run.args, run.returncode, out, err)
            except subprocess.TimeoutExpired:
                if over:
                    break
        run.kill()
        run.communicate()
    raise AssertionError("mpirun does not end")


def end_of(run, ranks):
    """Waits for the ranks, then for mpirun; returns what it said on a pipe."""
    wait_for_end(ranks)
    try:
        return run.communicate(timeout=PATIENCE_S)
    except subprocess.TimeoutExpired:
        run.kill()
        return run.communicate()


def rank_of(pid):
    """Nothing if mpirun has not made it a rank yet."""
    try:
        for setting in Path(f"/proc/{pid}/environ").read_bytes().split(b"\0"):
            if setting.startswith(b"OMPI_COMM_WORLD_RANK="):
                return int(setting.split(b"=")[1])
    except OSError:
        pass
    return None


class Shared(InFolder):
    def parts(self, verb, source, extension, count, *options):
        """The names of the parts of a share each."""
        names = []
        for part in range(1, count + 1):
            name = f"p{part}of{count}{extension}"
            self.run_ok(verb, source, "-o", name, "--part", f"{part}/{count}", *options)
            names.append(name)
        return names

    def bytes_of(self, name):
        return (self.folder / name).read_bytes()

    def grids(self, name):
        return [(g["name"], g["active_voxels"], g["hash"]) for g in self.run_ok("info", name, "--json").json()["grids"]]

    def refused(self, *arguments):
        run = subvol(*arguments, folder=self.folder)
        self.assertEqual(run.code, 2, run.err)
        self.assertEqual(len(run.err.strip().splitlines()), 1, run.err)
        return run.err

    def figures(self, count, source):
        """The figures of shares, joined."""
        names = []
        for part in range(1, count + 1):
            names.append(f"p{part}.json")
            figures = self.run_ok("info", source, "--json", "--part", f"{part}/{count}").out
            (self.folder / names[-1]).write_text(figures)
        self.run_ok("join", *names, "-o", "joined.json")
        return without_times(json.loads((self.folder / "joined.json").read_text()))


@unittest.skipUnless(MPIRUN, "mpirun is not installed")
class WithRanks(Shared):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        probe = cls.mpirun(2, "info", "model:ball:2", "--json")
        if probe.returncode == 3:
            raise unittest.SkipTest("this build is without MPI: " + probe.stderr.strip())

    @staticmethod
    def mpirun(count, *arguments, folder=None):
        return run_in_ranks(folder, count, COMMAND, *arguments)

    def ranks(self, count, *arguments):
        done = self.mpirun(count, *arguments, folder=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done
