#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the commands cost a cell on different meshes: the table and the plot of docs/scale.md.

    bench/costs.py MESH… [--program build/release/bin/subvol] [--csv docs/scale/costs.csv] [--plot docs/scale/costs.png]

Each command runs with its own defaults, on one mesh after the other, pictures by the CPU. CPU seconds (user and system) and the largest memory of the
whole command, reading included; what fails ends the run.
"""
import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

FIELDS = ("command", "mesh", "cells", "cpu_seconds", "peak_bytes")
COMMANDS = {
    "info": ["info", "MESH"],
    "points": ["points", "MESH", "-o", "p.ply"],
    "vdb": ["vdb", "MESH", "--resolution", "128", "-o", "v.vdb"],
    "splats": ["render", "MESH", "--backend", "cpu", "-o", "s.png"],
    "tets": ["render", "MESH", "--method", "tets", "-o", "t.png"],
    "dense": ["render", "MESH", "--method", "dense", "-o", "d.png"],
    "surface": ["surface", "MESH", "--boundary", "-o", "b.stl"],
    "slice": ["slice", "MESH", "--plane", "CENTRE,0,0,1", "-o", "c.png"],
    "statistics": ["probe", "MESH", "--stats"],
}


def measured(program, words, folder):
    """CPU seconds and the largest memory."""
    running = subprocess.Popen([program, *words, "--quiet"], cwd=folder, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(running.pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(words)}: ended with {os.waitstatus_to_exitcode(status)}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss * 1024


def rows_of(program, mesh, folder):
    about = json.loads(subprocess.run([program, "info", mesh, "--json"], capture_output=True, check=True).stdout)
    low, high = about["bounds"]
    centre = ",".join(repr((a + b) / 2) for a, b in zip(low, high))
    for command, words in COMMANDS.items():
        filled = [word.replace("MESH", mesh).replace("CENTRE", centre) for word in words]
        seconds, peak = measured(program, filled, folder)
        yield {"command": command, "mesh": Path(mesh).stem, "cells": about["cells"], "cpu_seconds": round(seconds, 2),
               "peak_bytes": peak}


def plot(rows, path):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, (left, right) = pyplot.subplots(1, 2, figsize=(10, 4.2), sharex=True)
    for command, marker in zip(COMMANDS, "osD^v<>Pd"):
        of_command = sorted((row for row in rows if row["command"] == command), key=lambda row: row["cells"])
        cells = [row["cells"] for row in of_command]
        left.loglog(cells, [1e6 * max(row["cpu_seconds"], 0.01) / row["cells"] for row in of_command], marker + "-", markersize=4,
                    linewidth=0.7, label=command)
        right.loglog(cells, [row["peak_bytes"] / row["cells"] for row in of_command], marker + "-", markersize=4, linewidth=0.7)
    left.set_ylabel("CPU, µs a cell")
    right.set_ylabel("largest memory, bytes a cell")
    for axes in (left, right):
        axes.set_xlabel("cells of the mesh")
        axes.grid(True, which="major", alpha=0.3)
    left.legend(ncol=2, fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=100)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("meshes", nargs="+", metavar="MESH")
    options.add_argument("--program", default="build/release/bin/subvol")
    options.add_argument("--csv", default="docs/scale/costs.csv")
    options.add_argument("--plot", default="docs/scale/costs.png")
    asked = options.parse_args()
    program = str(Path(asked.program).resolve())
    rows = []
    for mesh in asked.meshes:
        with tempfile.TemporaryDirectory() as folder:
            for row in rows_of(program, mesh if mesh.startswith("model:") else str(Path(mesh).resolve()), Path(folder)):
                rows.append(row)
                print(row, flush=True)
    with open(asked.csv, "w", newline="") as file:
        writer = csv.DictWriter(file, FIELDS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    plot(rows, asked.plot)


if __name__ == "__main__":
    main()
