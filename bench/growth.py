#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How CPU time and memory grow with the mesh, brick by brick: the table and the plot of docs/scale.md.

    bench/growth.py [build/release/bin/subvol] [--sizes 100,159,215] [--csv docs/scale/growth.csv] [--plot docs/scale/growth.png]
                    [--folder FOLDER]

For each size N the model `twist:N` (N³ cells) is written as bricks of a million cells, and `info`, `points`, `render` (512²,
the look `solid`, by the CPU) and `vdb` (800 voxels for 464 cells along an axis) go through them. CPU seconds (user and system) and the largest memory of each command
replace its row in the .csv file; the plot is of all rows there. 464, which has 10⁸ cells, needs 30 GB of disk and three quarters of
an hour. FOLDER is for what is written meanwhile.
"""
import argparse
import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path

COMMANDS = ("split", "info", "points", "render", "vdb")
FIELDS = ("command", "cells", "cpu_seconds", "peak_bytes", "bytes_written")


def size_of(folder, pattern):
    files = [file for path in folder.glob(pattern) for file in (path.iterdir() if path.is_dir() else [path])]
    return sum(file.stat().st_size for file in files)


def measured(program, folder, words, output):
    """CPU seconds, the largest memory and what is left on the disk."""
    running = subprocess.Popen([program, *map(str, words)], cwd=folder, stdout=subprocess.DEVNULL,
                               env={**os.environ, "TMPDIR": str(folder)})
    _, status, used = os.wait4(running.pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(map(str, words))}: ended with {os.waitstatus_to_exitcode(status)}")
    return {"cpu_seconds": round(used.ru_utime + used.ru_stime, 2), "peak_bytes": used.ru_maxrss * 1024,
            "bytes_written": size_of(folder, output) if output else 0}


def rows_of(program, size, folder):
    cells = size**3
    bricks = max(1, round(cells / 1e6))
    commands = {"split": (["split", f"model:twist:{size}", "-o", "t.bricks", "--bricks", bricks], "t.bricks"),
                "info": (["info", "t.bricks"], None),
                "points": (["points", "t.bricks", "-o", "t.ply"], "t.ply"),
                "render": (["render", "t.bricks", "-o", "t.png", "--size", "512x512", "--look", "solid", "--backend", "cpu"],
                           "t.png"),
                "vdb": (["vdb", "t.bricks", "-o", "t.vdb", "--resolution", round(size * 800 / 464)], "t*.vdb")}
    for command in COMMANDS:
        words, output = commands[command]
        yield {"command": command, "cells": cells, **measured(program, folder, [*words, "--quiet"], output)}
        if command == "points":
            (folder / "t.ply").unlink()


def plot(rows, path):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, (left, right) = pyplot.subplots(1, 2, figsize=(9, 3.6))
    for command, marker in zip(COMMANDS, "osD^v"):
        of_command = sorted((row for row in rows if row["command"] == command), key=lambda row: row["cells"])
        cells = [row["cells"] for row in of_command]
        left.loglog(cells, [row["cpu_seconds"] for row in of_command], marker=marker, label=command)
        right.loglog(cells, [row["peak_bytes"] / 1e6 for row in of_command], marker=marker, label=command)
    cells = sorted({row["cells"] for row in rows})
    first = max(row["cpu_seconds"] for row in rows if row["cells"] == cells[0])
    left.loglog(cells, [2 * first * c / cells[0] for c in cells], "k:", label="slope 1")
    left.set_ylabel("CPU seconds")
    right.set_ylabel("largest memory, MB")
    right.set_ylim(50, 5000)
    for axes in (left, right):
        axes.set_xlabel("cells")
        axes.grid(True, which="major", alpha=0.3)
    left.legend()
    figure.tight_layout()
    figure.savefig(path, dpi=100)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("program", nargs="?", default="build/release/bin/subvol")
    options.add_argument("--sizes", default="100,159,215")
    options.add_argument("--csv", default="docs/scale/growth.csv")
    options.add_argument("--plot", default="docs/scale/growth.png")
    options.add_argument("--folder")
    asked = options.parse_args()
    program, table = str(Path(asked.program).resolve()), Path(asked.csv)
    rows = []
    if table.exists():
        for row in csv.DictReader(table.open()):
            rows.append({"command": row["command"], "cpu_seconds": float(row["cpu_seconds"]),
                         **{key: int(row[key]) for key in ("cells", "peak_bytes", "bytes_written")}})
    for size in filter(None, asked.sizes.split(",")):
        with tempfile.TemporaryDirectory(dir=asked.folder) as folder:
            for row in rows_of(program, int(size), Path(folder)):
                rows = [old for old in rows if (old["command"], old["cells"]) != (row["command"], row["cells"])] + [row]
                print(row, flush=True)
    rows.sort(key=lambda row: (row["cells"], COMMANDS.index(row["command"])))
    table.parent.mkdir(parents=True, exist_ok=True)
    with table.open("w", newline="") as file:
        writer = csv.DictWriter(file, FIELDS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    plot(rows, asked.plot)


if __name__ == "__main__":
    main()
