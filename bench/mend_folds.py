#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Mends meshes whose limit folds, and prints what became of each: boxes with overshoot, inverted cells and noise, a ball with moved
points at its irregular edges, and files.

    PYTHONPATH=build/release/python bench/mend_folds.py --boundary-move .5 part.vtu
"""
import argparse
import resource
import sys
from collections.abc import Iterator

import numpy as np
import subvol


def box(side: int) -> "subvol.HexMesh":
    """Unit cells, `side` points along each edge."""
    grid = np.stack(np.meshgrid(*[np.arange(float(side))] * 3, indexing="ij"), -1)
    number = np.arange(side**3).reshape([side] * 3)
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = [number[i:side - 1 + i, j:side - 1 + j, k:side - 1 + k].ravel() for i, j, k in corners]
    return subvol.HexMesh(grid.reshape(-1, 3), np.stack(cells, 1))


def moved(mesh: "subvol.HexMesh", ways: np.ndarray) -> "subvol.HexMesh":
    return subvol.HexMesh(mesh.points + ways, mesh.cells)


def pushed(mesh: "subvol.HexMesh", places: list[tuple[float, ...]], way: tuple[float, ...]) -> "subvol.HexMesh":
    """The points nearest to some places, moved."""
    ways = np.zeros_like(mesh.points)
    for place in places:
        ways[np.argmin(np.linalg.norm(mesh.points - place, axis=1))] = way
    return moved(mesh, ways)


def made() -> Iterator[tuple[str, "subvol.HexMesh"]]:
    plain = box(8)
    x, y, z = plain.points.T
    inside = (y > 1.5) & (y < 5.5) & (z > 1.5) & (z < 5.5)
    zero = np.zeros_like(x)
    for amount in (.8, .9):
        ways = np.where(inside & (x == 3), amount, np.where(inside & (x == 5), -amount, 0))
        yield f"overshoot {amount}", moved(plain, np.stack([ways, zero, zero], 1))
    yield "a point pushed out of its cells", pushed(plain, [(3, 3, 3)], (1.4, .2, .1))
    yield "three points pushed", pushed(plain, [(2, 2, 2), (4, 4, 4), (5, 2, 4)], (1.1, -.8, .3))
    yield "a point of a side pushed along it", pushed(plain, [(3, 3, 0)], (1.2, 0, 0))
    rng = np.random.default_rng(5)
    for amount in (.3, .4):
        yield f"noise {amount}", moved(plain, rng.uniform(-amount, amount, plain.points.shape))
    ball = subvol.model("ball", 4)
    size = (np.ptp(ball.points, axis=0).prod() / len(ball.cells)) ** (1 / 3)
    cells = np.bincount(ball.cells.ravel())
    middle = np.linalg.norm(ball.points, axis=1) < .7 * np.linalg.norm(ball.points, axis=1).max()
    irregular = np.flatnonzero((cells != 8) & middle)[::7]
    ways = np.zeros_like(ball.points)
    ways[irregular] = rng.uniform(-.7 * size, .7 * size, (irregular.size, 3))
    yield "a ball, moved at irregular edges", moved(ball, ways)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="*")
    parser.add_argument("--boundary-move", type=float, default=.1)
    parser.add_argument("--tests", type=int, default=1000)
    arguments = parser.parse_args()
    print(f"{'mesh':34} {'cells':>7} {'folded':>7} {'open':>5} → {'folded':>6} {'open':>5} {'irreg.':>6} {'moved':>6} {'by':>6} {'boundary':>8} "
          f"{'rounds':>6} {'CPU s':>7}")
    meshes = [*made(), *((file.split("/")[-1], subvol.read_mesh(file)) for file in arguments.files)]
    left = 0
    for name, mesh in meshes:
        begin = resource.getrusage(resource.RUSAGE_SELF)
        _, check, report = subvol.mend_folds(mesh, boundary_move=arguments.boundary_move, tests=arguments.tests)
        end = resource.getrusage(resource.RUSAGE_SELF)
        seconds = end.ru_utime + end.ru_stime - begin.ru_utime - begin.ru_stime
        after = np.bincount(check.verdicts, minlength=4)
        left += len(report["left"])
        print(f"{name:34} {len(mesh.cells):7} {report['folded']:7} {report['open']:5} → {after[1]:6} {after[2]:5} {after[3]:6} {report['moved']:6} "
              f"{report['farthest_edges']:6.3g} {report['boundary_edges']:8.3g} {report['rounds']:6} {seconds:7.1f}", flush=True)
        for cell in report["left"][:3]:
            print(f"    cell {cell['cell']}: {cell['reason']}")
    sys.exit(1 if left else 0)


if __name__ == "__main__":
    main()
