#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How seconds a frame and memory grow with the number of kernels: the table at the end of docs/scale.md.

    bench/frames.py [build/release/bin/subvol] [--sizes 21,46,99,215] [--csv docs/scale/frames.csv] [--folder FOLDER]

For each size N the kernels of the model `twist:N`, one for each of its (N + 1)³ control points, are drawn by the CPU at 512² from a fixed distance: one picture,
and a turn of five. CPU seconds (user and system) of the first frame with what is read before it, of each later one, and the largest memory. 215 needs 4 GB.
"""
import argparse
import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path

FIELDS = ("kernels", "first_cpu_seconds", "frame_cpu_seconds", "peak_bytes")
TURN = 5


def measured(program, words):
    """CPU seconds and the largest memory."""
    running = subprocess.Popen([program, *words, "--quiet"], stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(running.pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(words)}: ended with {os.waitstatus_to_exitcode(status)}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss * 1024


def row_of(program, size, folder):
    points = str(folder / "t.ply")
    measured(program, ["points", f"model:twist:{size}", "-o", points])
    draw = ["render", points, "-o", str(folder / "t.png"), "--size", "512x512", "--backend", "cpu"]
    first, peak = measured(program, draw)
    turn, _ = measured(program, [*draw, "--turntable", str(TURN)])
    return {"kernels": (size + 1) ** 3, "first_cpu_seconds": round(first, 2),
            "frame_cpu_seconds": round((turn - first) / (TURN - 1), 3), "peak_bytes": peak}


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("program", nargs="?", default="build/release/bin/subvol")
    options.add_argument("--sizes", default="21,46,99,215")
    options.add_argument("--csv", default="docs/scale/frames.csv")
    options.add_argument("--folder")
    asked = options.parse_args()
    rows = []
    for size in asked.sizes.split(","):
        with tempfile.TemporaryDirectory(dir=asked.folder) as folder:
            rows.append(row_of(str(Path(asked.program).resolve()), int(size), Path(folder)))
            print(rows[-1], flush=True)
    with open(asked.csv, "w", newline="") as file:
        writer = csv.DictWriter(file, FIELDS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    main()
