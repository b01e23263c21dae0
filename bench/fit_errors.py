#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whether the errors that `approximate` reports hold: random meshes, fields and samples.

    PYTHONPATH=build/release/python bench/fit_errors.py [--cases 100] [--list]

Each case fits a field to samples, and evaluates the limit again by `probe` and `evaluate_limit`, which do not share the fit's matrix. A
column has the largest quotient of an error that was found and the one that was reported; above 1.01 it is an error that was too small.
"""
import argparse

import numpy as np
import subvol


def box(n, dice, bend=0.):
    """nx × ny × nz cells over a unit box, points moved by `bend` of a cell."""
    axes = [np.arange(k + 1) for k in n]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    number = lambda i, j, k: (i * (n[1] + 1) + j) * (n[2] + 1) + k
    i, j, k = (a.ravel() for a in np.meshgrid(*[np.arange(m) for m in n], indexing="ij"))
    corners = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    cells = np.stack([number(i + a, j + b, k + c) for a, b, c in corners], 1)
    return subvol.HexMesh((grid + bend * dice.uniform(-.5, .5, grid.shape)) / np.max(n), cells)


def control_mesh(dice, kind):
    if kind == "box":
        return box(dice.integers(1, 9, 3), dice)
    if kind == "bent":
        return box(dice.integers(2, 8, 3), dice, .5)
    if kind == "O-grid":
        return subvol.model("ball", resolution=int(dice.integers(2, 5)))
    return subvol.model(str(dice.choice(["pawn", "twist", "nozzle"])), resolution=int(dice.integers(3, 7)))


def function(dice):
    kind = dice.choice(["constant", "linear", "wave", "front", "peak"])
    a, b, at = dice.normal(size=3), dice.normal(size=3), dice.uniform(size=3)
    scale, offset = 10**dice.uniform(-6, 6), 10**dice.uniform(-3, 3)
    of = {"constant": lambda x: 0 * x[:, 0], "linear": lambda x: x @ a, "wave": lambda x: np.sin(4 * x @ a) * np.cos(3 * x @ b),
          "front": lambda x: np.tanh(20 * ((x - at) @ a)), "peak": lambda x: np.exp(-20 * np.sum((x - at)**2, 1))}[kind]
    return kind, lambda x: scale * (of(x) + offset)


def samples_of(dice, kind, mesh):
    """Places, or a mesh."""
    low, high = mesh.points.min(0), mesh.points.max(0)
    size = high - low
    count = {"dense": 60 * len(mesh.cells), "sparse": max(5, len(mesh.cells) // 2), "one": 1}.get(kind, 8 * len(mesh.cells))
    places = low + size * dice.uniform(0, 1, (count, 3))
    if kind == "clustered":
        places = low + size * (.5 + .05 * dice.normal(size=(count, 3)))
    elif kind == "one side":
        places[:, 0] = low[0] + .4 * (places[:, 0] - low[0])
    elif kind == "repeated":
        places = np.repeat(places[:max(5, count // 8)], 8, axis=0)
    elif kind == "outside":
        places = low + size * dice.uniform(-.3, 1.3, (count, 3))
    elif kind == "one":
        places = mesh.points[mesh.cells[0]].mean(0, keepdims=True)
    elif kind in ("coarser mesh", "finer mesh", "long cells"):
        n = {"coarser mesh": dice.integers(1, 4, 3), "finer mesh": dice.integers(9, 15, 3), "long cells": np.array([2, 14, 11])}[kind]
        data = box(n, dice)
        return subvol.HexMesh(low + size * data.points * np.max(n) / n, data.cells)
    return places


KINDS = ["dense", "sparse", "clustered", "one side", "repeated", "outside", "one", "coarser mesh", "finer mesh", "long cells"]


def case(number):
    dice = np.random.default_rng(number)
    kind, mesh_kind = KINDS[number % len(KINDS)], ["box", "bent", "O-grid", "model"][number // len(KINDS) % 4]
    mesh = control_mesh(dice, mesh_kind)
    scheme = ["mcq", "mcq", "linear", "cc"][int(dice.integers(4))]
    name, of = function(dice)
    data = samples_of(dice, kind, mesh)
    is_mesh = isinstance(data, subvol.HexMesh)
    places = data.points if is_mesh else data
    values = of(places)
    if name not in ("constant", "linear") and dice.random() < .4:
        values = values + .1 * np.ptp(values) * dice.uniform(-1, 1, len(values))
    if is_mesh:
        data = subvol.HexMesh(data.points, data.cells, {"f": values})
    try:
        fitted, report = subvol.approximate(mesh, data, None if is_mesh else {"f": values}, scheme=scheme)
    except subvol.Error as error:
        return dict(kind=kind, skipped=str(error))
    said = report["fields"]["f"]
    tiny = 1e-9 * max(np.abs(values).max(), 1e-300)
    diagonal = np.linalg.norm(mesh.points.max(0) - mesh.points.min(0))
    there = subvol.probe(fitted, at=places, scheme=scheme, reach=.01 * diagonal)
    inside = there.inside
    off = np.abs(there.fields["f"][inside] - values[inside])
    row = dict(kind=kind, mesh=mesh_kind, field=name, scheme=scheme, undecided=report["undecided"], points=len(mesh.points))
    row["at samples"] = off.max(initial=0) / (said["max"] + tiny)
    row["rms"] = np.sqrt(np.mean(off**2)) / (said["rms"] + tiny) if off.size and not is_mesh else 0
    row["between"] = 0
    if is_mesh:
        cells = dice.integers(0, len(data.cells), 4000).astype(np.uint32)
        exact = subvol.evaluate_limit(data, cells, dice.random((4000, 3)), scheme="linear" if scheme == "linear" else "mcq")
        found = subvol.probe(fitted, at=exact.positions, scheme=scheme)
        apart = np.abs(found.fields["f"] - exact.fields["f"])[found.inside]
        row["between"] = apart.max(initial=0) / (max(said["max"], said["max_between"]) + tiny)
    limit = subvol.evaluate_limit(fitted, dice.integers(0, len(mesh.cells), 8000).astype(np.uint32), dice.random((8000, 3)), scheme=scheme)
    of_limit, kept = limit.fields["f"], values[inside] if inside.any() else values
    beyond = max(kept.min() - of_limit.min(), of_limit.max() - kept.max(), 0)
    row["range"] = beyond / (said["beyond"] + tiny)
    row["beyond"] = said["beyond"] / max(np.ptp(kept), tiny)
    row["linear"] = np.abs(of_limit - of(limit.positions)).max() / np.abs(values).max() if name in ("constant", "linear") and len(places) > 4 else 0
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=100)
    parser.add_argument("--list", action="store_true", help="print each case")
    asked = parser.parse_args()
    rows = [case(number) for number in range(asked.cases)]
    columns = ["at samples", "rms", "between", "range", "beyond", "linear"]
    print(f"{'samples':14}{'cases':>6}" + "".join(f"{column:>12}" for column in columns))
    for kind in KINDS + ["all"]:
        chosen = [row for row in rows if kind in ("all", row["kind"])]
        fitted = [row for row in chosen if "skipped" not in row]
        print(f"{kind:14}{len(fitted):6}" + "".join(f"{max((row[c] for row in fitted), default=0):12.3g}" for c in columns))
    for row in rows:
        if asked.list or "skipped" in row or any(row[c] > 1.01 for c in columns[:4]):
            print(row)


if __name__ == "__main__":
    main()
