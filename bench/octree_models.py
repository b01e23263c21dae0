#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Control meshes of `subvol mesh` beside the hexahedral meshes of HybridOctree_Hex (github.com/CMU-CBML/HybridOctree_Hex).

usage: octree_models.py CHECKOUT [--subvol build/release/bin/subvol] [--part .25] [--cells 32] [--only NAME...] [--rows FILE]

CHECKOUT has "input boundaries/*_tri.raw" and "our results/*.vtk". Where their mesh is there, ours has at most that part of its cells; where
it is not, --cells along the longest side. Distances are root mean squares of the boundary from the surface in percent of the diagonal of
the surface's box, both by the same rule: of their mesh that of its straight cells. One JSON object a surface is appended to the file of
rows, whose surfaces are left out; then the table of all rows is printed. Needs the Python module (PYTHONPATH=build/release/python)."""

import argparse
import json
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np

import subvol

NEIGHBORS = np.array([[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]])


def scaled_jacobians(mesh):
    """Of each cell the least over its corners."""
    corners = np.asarray(mesh.points)[np.asarray(mesh.cells)]
    edges = corners[:, NEIGHBORS] - corners[:, :, None]
    edges /= np.maximum(np.sqrt((edges**2).sum(-1, keepdims=True)), 1e-300)
    return np.einsum("ckd,ckd->ck", edges[:, :, 0], np.cross(edges[:, :, 1], edges[:, :, 2])).min(axis=1)


def raw_surface(path):
    """Points and triangles of a .raw file, whose first line has their numbers."""
    words = path.read_text().split()
    points, triangles = int(words[0]), int(words[1])
    places = np.array(words[2:2 + 3 * points], float).reshape(-1, 3)
    return places, np.array(words[2 + 3 * points:2 + 3 * (points + triangles)], np.int64).reshape(-1, 3)


def as_they_scale(points):
    """In the cube of side 100 in which HybridOctree_Hex writes its meshes."""
    low, high = points.min(axis=0), points.max(axis=0)
    side = (high - low).max()
    return (points - (low + high - side) / 2) * (100 / side)


def figures_of(mesh, report, diagonal):
    quality = scaled_jacobians(mesh)
    return {"cells": len(mesh.cells), "least": float(quality.min()), "mean": float(quality.mean()), "rms": 100 * report["rms"] / diagonal,
            "max": 100 * report["max"] / diagonal, "missed_rms": 100 * report["missed_rms"] / diagonal}


def theirs(path, points, triangles):
    try:
        mesh = subvol.read_mesh(path)
    except (subvol.Error, OSError):
        return None
    points = as_they_scale(points)
    _, report = subvol.fit_shape(mesh, points, triangles, scheme="linear", shape_rounds=1, keep_folds=True)
    return figures_of(mesh, report["before"], np.linalg.norm(np.ptp(points, axis=0)))


def ours(command, surface, cells, folder, diagonal):
    """The figures and the exit code, or what was said."""
    made = f"{folder}/made.vtu"
    process = subprocess.Popen([command, "mesh", surface, "-o", made, "--cells", str(cells), "--json"], stdout=subprocess.PIPE,
                               stderr=subprocess.DEVNULL, text=True)
    report = json.loads(process.stdout.read())
    _, status, use = os.wait4(process.pid, 0)
    if "error" in report:
        return {"said": report["error"]["message"]}
    row = figures_of(subvol.read_mesh(made), report["after"], diagonal)
    folds = report["folds"]["cells"]
    return row | {"along": cells, "exit_code": os.waitstatus_to_exitcode(status), "folded": folds["folded"],
                  "undecided": folds["undecided"], "inverted": len(report["inverted_cells"]), "missed_max": report["after"]["missed_max"] / report["side_world"],
                  "warnings": report["warnings"], "cpu_s": use.ru_utime + use.ru_stime}


def ours_within(command, surface, most, folder, diagonal):
    """With at most so many cells, and nearly as many: their number grows with the cube of that along a side."""
    along = 16
    while True:
        row = ours(command, surface, along, folder, diagonal)
        if "said" in row:
            return row
        better = int(along * (most / row["cells"])**(1 / 3))
        if row["cells"] <= most and better <= along * 1.06:
            return row
        along = max(2, better if better != along else along - 1)


def table(rows):
    print("| surface | cells | least | mean | boundary | their cells | least | mean | boundary | exit code | folded | CPU s |\n" + 12 * "|---" + "|")
    for row in rows:
        own, other = row["ours"], row["theirs"]
        if "said" in own:
            print(f"| {row['name']} | {own['said']} |")
            continue
        beside = f"{other['cells']:,} | {other['least']:.2f} | {other['mean']:.2f} | {other['rms']:.4f}" if other else "not there | | | "
        print(f"| {row['name']} | {own['cells']:,} | {own['least']:.2f} | {own['mean']:.2f} | {own['rms']:.4f} | {beside} "
              f"| {own['exit_code']} | {own['folded']} | {own['cpu_s']:.0f} |")
    made = [row for row in rows if "said" not in row["ours"]]
    beside = [row for row in made if row["theirs"]]
    print(f"\n{len(made)} surfaces: least scaled Jacobian >= .3: {sum(row['ours']['least'] >= .3 for row in made)}, <= 0 with exit code 0: "
          f"{sum(row['ours']['least'] <= 0 and row['ours']['exit_code'] == 0 for row in made)}, exit code 1: "
          f"{sum(row['ours']['exit_code'] == 1 for row in made)}, above 60 CPU s: {sum(row['ours']['cpu_s'] > 60 for row in made)}; "
          f"nearer than theirs: {sum(row['ours']['rms'] <= row['theirs']['rms'] for row in beside)} of {len(beside)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkout", type=Path)
    parser.add_argument("--subvol", default="build/release/bin/subvol")
    parser.add_argument("--part", type=float, default=.25)
    parser.add_argument("--cells", type=int, default=32)
    parser.add_argument("--only", nargs="*")
    parser.add_argument("--rows", type=Path, default=Path("octree_models.jsonl"))
    given = parser.parse_args()
    known = [json.loads(line) for line in given.rows.read_text().splitlines()] if given.rows.exists() else []
    for path in sorted(given.checkout.glob("input boundaries/*_tri.raw"), key=lambda path: path.stat().st_size):
        name = path.name.removesuffix("_tri.raw")
        if any(row["name"] == name for row in known) or (given.only and name not in given.only):
            continue
        points, triangles = raw_surface(path)
        diagonal = np.linalg.norm(np.ptp(points, axis=0))
        other = theirs(given.checkout / "our results" / f"{name}.vtk", points, triangles)
        with tempfile.TemporaryDirectory() as folder:
            surface = f"{folder}/{name}.obj"
            with open(surface, "w") as file:
                file.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist())
                file.writelines(f"f {a} {b} {c}\n" for a, b, c in (triangles + 1).tolist())
            own = (ours_within(given.subvol, surface, int(given.part * other["cells"]), folder, diagonal) if other else
                   ours(given.subvol, surface, given.cells, folder, diagonal))
        known.append({"name": name, "ours": own, "theirs": other})
        with given.rows.open("a") as file:
            file.write(json.dumps(known[-1]) + "\n")
    table(known)


if __name__ == "__main__":
    main()
