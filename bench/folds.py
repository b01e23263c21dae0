#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks meshes for folds, and looks for cells that are proved falsely: determinants at random places, by refinement alone.

    PYTHONPATH=build/release/python bench/folds.py --probes 10000000 model:twist:12 box:0.3 mesh.vtu
"""
import argparse
import resource

import numpy as np
import subvol

TOLERANCE = 2e-3  # of determinants by refinement, as parts of the mean volume of a cell


def mesh_of(name: str) -> "subvol.HexMesh":
    """A file, a model, or box:A, a box of unit cells whose points are off by up to A."""
    if name.startswith("model:"):
        words = name.split(":")
        return subvol.model(words[1], resolution=int(words[2])) if len(words) > 2 else subvol.model(words[1])
    if not name.startswith("box:"):
        return subvol.read_mesh(name)
    side = 8
    grid = np.stack(np.meshgrid(*[np.arange(float(side))] * 3, indexing="ij"), -1)
    amount = float(name[4:])
    points = grid + np.random.default_rng(5).uniform(-amount, amount, grid.shape)
    number = np.arange(side**3).reshape([side] * 3)
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = [number[i:side - 1 + i, j:side - 1 + j, k:side - 1 + k].ravel() for i, j, k in corners]
    return subvol.HexMesh(points.reshape(-1, 3), np.stack(cells, 1))


def determinants(mesh: "subvol.HexMesh", cells: np.ndarray, places: np.ndarray, tolerance: float) -> np.ndarray:
    return np.linalg.det(subvol.evaluate_limit(mesh, cells, places, tolerance=tolerance).jacobians)


def least(mesh: "subvol.HexMesh", proved: np.ndarray, probes: int) -> float:
    """The least determinant at places of proved cells, by cells of mean volume.

    A tenth of the places looks for the cells with the least determinants. Of the others half are in the hundredth of the cells
    where these were least; half of the places have each parameter at or near an end. What is below zero is evaluated again with
    another tolerance."""
    rng, worst, step = np.random.default_rng(1), np.inf, 1_000_000
    size = np.ptp(mesh.points, axis=0).prod() / len(mesh.cells)
    smallest = np.full(len(mesh.cells), np.inf)
    for begin in range(0, probes, step):
        count = min(step, probes - begin)
        weakest = proved[np.argsort(smallest[proved], kind="stable")][:max(1, len(proved) // 100)]
        cells = rng.choice(proved, count)
        if begin >= probes // 10:
            cells[:count // 2] = rng.choice(weakest, count // 2)
        cells.sort()
        places = rng.random((count, 3))
        near_end = rng.random(count) < .5
        ends = np.abs(rng.integers(0, 2, (count, 3)) - rng.choice([0, 1e-3, 1e-2, .1], (count, 3)))
        places[near_end] = np.where(rng.random((count, 3)) < .7, ends, places)[near_end]
        found = determinants(mesh, cells, places, 1e-5)
        below = found < 0
        if below.any():
            found[below] = determinants(mesh, cells[below], places[below], 1e-9)
        np.minimum.at(smallest, cells, found)
        worst = min(worst, float(found.min()) / size)
    return worst


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("meshes", nargs="+")
    parser.add_argument("--probes", type=int, default=100_000)
    arguments = parser.parse_args()
    print(f"{'mesh':32} {'cells':>8} {'proved':>8} {'folded':>7} {'open':>6} {'irreg.':>7} {'volume':>9} {'tests':>6} {'CPU s':>7} {'least':>9} {'probing':>8}")
    wrong = 0
    for name in arguments.meshes:
        mesh = mesh_of(name)
        begin = resource.getrusage(resource.RUSAGE_SELF)
        check = subvol.check_folds(mesh)
        end = resource.getrusage(resource.RUSAGE_SELF)
        seconds = end.ru_utime + end.ru_stime - begin.ru_utime - begin.ru_stime
        counts = np.bincount(check.verdicts, minlength=4)
        proved = np.flatnonzero(check.verdicts == 0)
        worst = least(mesh, proved, arguments.probes) if proved.size and arguments.probes else np.nan
        probed = resource.getrusage(resource.RUSAGE_SELF)
        probing = probed.ru_utime + probed.ru_stime - end.ru_utime - end.ru_stime
        wrong += worst < -TOLERANCE
        print(f"{name.split('/')[-1]:32} {len(mesh.cells):8} {counts[0]:8} {counts[1]:7} {counts[2]:6} {counts[3]:7} {check.open.sum():9.4g} "
              f"{check.tests / len(mesh.cells):6.2f} {seconds:7.2f} {worst:9.3g} {probing:8.1f}", flush=True)
    raise SystemExit(1 if wrong else 0)


if __name__ == "__main__":
    main()
