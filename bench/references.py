#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Hashes of small results of every kind: kernels, grids, pictures, surfaces, control meshes and figures of built-in models.

    bench/references.py [build/release/bin/subvol] [--only NAME,...] [--write FILE | --against FILE]

Prints a line with a hash for each result; about a CPU minute. A change that should keep all bits is shown to do so by the file
that --write made of the build before it: --against prints what differs and ends with 1.
"""
import argparse
import hashlib
import json
import math
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from equality import Runner

PICTURE = ["--size", "96x80"]
# name: the words of the command; {} is the file that is hashed, or without it what --json prints
RESULTS = {
    "points": "points model:ball:6 -o {}.ply",
    "points paper": "points model:twist:6 --values paper --centers -o {}.vtp",
    "points reduced": "points model:ball:6 --reduce 0.02 -o {}.ply",
    "points moved": "points model:ball:4 --reduce 0.05 --refine -o {}.ply",
    "points merged": "points model:ball:6 --merge 0.01 -o {}.ply",
    "levels of detail": "points model:ball:6 -o {}.svk",
    "wavelets": "compress refined.vtu --wavelet-tolerance 1e-3 -o {}.svw",
    "compressed": "compress refined.vtu --max-error 1e-3 -o {}.svw",
    "refined mcq": "subdivide model:twist:4 -o {}.vtu",
    "refined cc": "subdivide model:ball:4 --scheme cc -o {}.vtu",
    "refined bsxw": "subdivide model:ball:4 --scheme bsxw -o {}.vtu",
    "grid": "vdb model:ball:6 --resolution 40 -o {}.vdb",
    "grid of points": "vdb ball.ply --resolution 40 -o {}.vdb",
    "splats": "render model:ball:6 --backend cpu -o {}.exr",
    "splats of points": "render ball.ply --backend cpu -o {}.exr",
    "tetrahedra": "render model:twist:4 --method tets -o {}.exr",
    "dense": "render model:ball:4 --method dense -o {}.exr",
    "isosurface": "surface model:ball:6 --iso 0.3 --cap --boundary --tolerance 3e-3 -o {}.obj",
    "slice": "slice model:twist:4 -o {}.csv",
    "fitted fields": "approximate model:ball:6 --onto model:ball:4 -o {}.vtu",
    "fitted samples": "approximate samples.csv --onto model:ball:4 --smoothing 1e-3 -o {}.vtu",
    "fitted shape": "approximate bean.obj --shape --onto model:ball:4 -o {}.vtu",
    "filled surface": "mesh bean.obj --cells 8 -o {}.vtu",
    "mended": "check folded.mesh --mend -o {}.vtu",
    "cell means": "points cells.vtk --cell-values exact -o {}.ply",
    "figures": "info model:twist:6 --json",
    "integrals": "probe model:ball:6 --stats --json",
    "distance": "compare model:ball:6 model:ball:4 --json",
    "pictures' distance": "compare ball.exr balls.exr --json",
}
UNSTEADY = re.compile(r'"[^"]*(seconds|bytes|memory|version|threads|time)[^"]*": *[^,}\]]+')  # in JSON


def write_inputs(runner):
    """Fields at places, a closed surface, cells with values, a mesh that folds; and results that others begin with."""
    folder = runner.folder
    places = [(math.cos(k), math.sin(1.7 * k), math.sin(0.9 * k + 1)) for k in range(3000)]
    (folder / "samples.csv").write_text("x,y,z,wave\n" + "".join(
        f"{.5 * x:.9f},{.5 * y:.9f},{.5 * z:.9f},{math.sin(3 * x) + y * z:.9f}\n" for x, y, z in places))
    rows, around = 16, 24
    lines = ["v 0 0 1", "v 0 0 -1"]
    for i in range(1, rows):
        for j in range(around):
            a, b = math.pi * i / rows, 2 * math.pi * j / around
            r = math.sin(a) * (1 + .2 * math.cos(3 * a))
            lines.append(f"v {r * math.cos(b) + .3 * math.cos(a) ** 2:.9f} {.8 * r * math.sin(b):.9f} {math.cos(a):.9f}")
    at = lambda i, j: 3 + (i - 1) * around + j % around
    for j in range(around):
        lines += [f"f 1 {at(1, j)} {at(1, j + 1)}", f"f 2 {at(rows - 1, j + 1)} {at(rows - 1, j)}"]
        for i in range(1, rows - 1):
            lines += [f"f {at(i, j)} {at(i + 1, j)} {at(i + 1, j + 1)}", f"f {at(i, j)} {at(i + 1, j + 1)} {at(i, j + 1)}"]
    (folder / "bean.obj").write_text("\n".join(lines) + "\n")
    n = 6
    values = [f"{math.sin(i + 2 * j) + k * k / 9:.9f}" for k in range(n) for j in range(n) for i in range(n)]
    (folder / "cells.vtk").write_text(
        f"# vtk DataFile Version 3.0\nc\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS {n + 1} {n + 1} {n + 1}\n"
        f"ORIGIN 0 0 0\nSPACING 1 1 1\nCELL_DATA {n ** 3}\nSCALARS c double 1\nLOOKUP_TABLE default\n" + "\n".join(values) + "\n")
    runner.run("model", "ball", "--resolution", "4", "-o", "whole.mesh")
    words = (folder / "whole.mesh").read_text().split("\n")
    first = words.index("Vertices") + 2
    inner = first + int(words[first - 1]) // 2  # a point in the middle goes beyond its neighbours
    words[inner] = " ".join(f"{float(x) + .45:.9f}" for x in words[inner].split()[:3]) + " 0"
    (folder / "folded.mesh").write_text("\n".join(words))
    runner.run("subdivide", "model:twist:4", "-o", "refined.vtu")
    runner.run("points", "model:ball:6", "-o", "ball.ply")
    runner.run("render", "model:ball:6", "-o", "ball.exr", "--backend", "cpu", *PICTURE)
    runner.run("render", "ball.ply", "-o", "balls.exr", "--backend", "cpu", *PICTURE)


def numbers_of(text):
    """What --json printed, without times and bytes."""
    return UNSTEADY.sub("", re.sub(r'"(seconds|timings)": *\{[^}]*\}', "", text))


def hash_of(runner, words):
    if "{}" not in words:
        return hashlib.sha256(numbers_of(runner.run(*words.split())).encode()).hexdigest()[:12]
    name = re.search(r"\{\}(\.\w+)", words)
    words = words.replace("{}", "result")
    runner.run(*words.split(), *(PICTURE if words.startswith("render") else []))
    return runner.hash_of("result" + name[1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", default="build/release/bin/subvol")
    parser.add_argument("--only", default="", metavar="NAME,...")
    parser.add_argument("--write", type=Path, metavar="FILE")
    parser.add_argument("--against", type=Path, metavar="FILE")
    arguments = parser.parse_args()
    names = [name for name in arguments.only.split(",") if name] or list(RESULTS)
    before = json.loads(arguments.against.read_text()) if arguments.against else {}
    with tempfile.TemporaryDirectory() as folder:
        runner = Runner(arguments.program, folder)
        write_inputs(runner)
        hashes = {}
        for name in names:
            hashes[name] = hash_of(runner, RESULTS[name])
            other = name in before and before[name] != hashes[name]
            print(f"{name:20} {hashes[name]}" + (f"   was {before[name]}" if other else ""), flush=True)
    if arguments.write:
        arguments.write.write_text(json.dumps(hashes, indent=1) + "\n")
    return int(any(before.get(name, value) != value for name, value in hashes.items()))


if __name__ == "__main__":
    sys.exit(main())
