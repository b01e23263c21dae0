#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How CPU time and memory of `approximate`, `check` and `check --mend` grow with the mesh: the tables of docs/approximate.md and docs/folds.md.

    PYTHONPATH=build/release/python bench/fit_growth.py [build/release/bin/subvol] [--sizes 21,46,99] [--folder FOLDER]

For each size N the model `twist:N` gets the values of itself, refined once, and as many scattered samples of a front as it has
points, and four times as many; it is checked, and mended where some of its points are pushed out of their cells. FOLDER is for what is
written meanwhile.
"""
import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import subvol


def measured(program, folder, *words):
    """CPU seconds and the largest memory in MB."""
    running = subprocess.Popen([program, *map(str, words), "--quiet"], cwd=folder, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(running.pid, 0)
    if os.waitstatus_to_exitcode(status) > 1:  # 1: folds, some of which are left
        sys.exit(f"{' '.join(map(str, words))}: ended with {os.waitstatus_to_exitcode(status)}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def write_samples(mesh, count, path):
    """Values of a front at random places of the limit."""
    dice = np.random.default_rng(1)
    cells = np.sort(dice.integers(0, len(mesh.cells), count)).astype(np.uint32)
    x = subvol.evaluate_limit(mesh, cells, dice.random((count, 3)), tolerance=1e-5).positions
    front = np.tanh(20 * (x[:, 0] - .1)) + np.sin(5 * x[:, 1]) * x[:, 2]
    np.savetxt(path, np.column_stack([x, front]), fmt="%.9g", delimiter=",", header="x,y,z,front", comments="")


def write_pushed(mesh, path):
    """The mesh with one of 2,000 inner points pushed by .9 of an edge: its cells fold."""
    points = mesh.points.copy()
    edges = np.linalg.norm(points[mesh.cells[:, 1]] - points[mesh.cells[:, 0]], axis=1)
    inner = np.setdiff1d(np.arange(len(points)), np.flatnonzero(np.bincount(mesh.cells.ravel()) < 8))
    chosen = np.random.default_rng(2).choice(inner, max(1, len(points) // 2000), replace=False)
    points[chosen, 0] += .9 * np.median(edges)
    subvol.write_mesh(subvol.HexMesh(points, mesh.cells), path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", default="build/release/bin/subvol")
    parser.add_argument("--sizes", default="21,46,99")
    parser.add_argument("--only", default="refined,scattered,four,check,mend", help="some of these")
    parser.add_argument("--folder")
    asked = parser.parse_args()
    program = str(Path(asked.program).resolve())
    print(f"{'work':10} {'cells':>9} {'points':>9} {'samples':>9} {'CPU s':>9} {'MB':>7} {'us/cell':>9} {'kB/cell':>8}")
    for size in map(int, asked.sizes.split(",")):
        model, mesh = f"model:twist:{size}", subvol.model("twist", resolution=size)
        cells, points = len(mesh.cells), len(mesh.points)
        for work in asked.only.split(","):
            with tempfile.TemporaryDirectory(dir=asked.folder) as folder:
                samples, made = 0, Path(folder) / "made.csv"
                if work == "refined":
                    made, samples = made.with_suffix(".vtu"), (2 * size + 1)**3
                    measured(program, folder, "subdivide", model, "-o", made, "--levels", 1)
                elif work in ("scattered", "four"):
                    samples = points * (4 if work == "four" else 1)
                    write_samples(mesh, samples, made)
                elif work == "mend":
                    made = made.with_suffix(".vtu")
                    write_pushed(mesh, made)
                words = {"check": ["check", model], "mend": ["check", made, "--mend", "-o", "mended.vtu"]}.get(
                    work, ["approximate", made, "--onto", model, "-o", "fitted.vtu"])
                seconds, megabytes = measured(program, folder, *words)
            print(f"{work:10} {cells:9} {points:9} {samples:9} {seconds:9.2f} {megabytes:7.0f} {1e6 * seconds / cells:9.1f} "
                  f"{1e3 * megabytes / cells:8.2f}", flush=True)


if __name__ == "__main__":
    main()
