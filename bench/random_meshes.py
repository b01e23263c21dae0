#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Random meshes, and what is said of their limits against refinement alone: errors beside integrals, and cells proved not to fold.

    PYTHONPATH=build/release/python /usr/bin/python3 bench/random_meshes.py --meshes 200

Blocks, fans of 3 to 8 cells, O-grids, rings, and boxes without some of their cells, bent by up to .4 of an edge, some with creases, with one to
three fields, under all schemes. No evaluator of the limit is used: integrals are those of triquadratic pieces between the vertices of a level,
determinants those of central differences across refined cells.
"""
import argparse

import numpy as np
import subvol

CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
SIDES = [(0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7)]


def block(sides):
    points = np.stack(np.meshgrid(*[np.arange(n + 1.0) for n in sides], indexing="ij"), -1).reshape(-1, 3)
    number = np.arange(len(points)).reshape([n + 1 for n in sides])
    cells = [number[tuple(slice(a, n + a) for a, n in zip(corner, sides))].ravel() for corner in CORNERS]
    return points, np.stack(cells, 1)


def extruded(quads, points, layers, height=1.0):
    quads, points, count = np.array(quads), np.array(points), len(points)
    return (np.concatenate([np.c_[points, np.full(count, height * k)] for k in range(layers + 1)]),
            np.concatenate([np.c_[quads + count * k, quads + count * (k + 1)] for k in range(layers)]))


def fan(valence, width, layers):
    """Sectors of width² quads around a point."""
    numbers, points = {}, []

    def number(sector, i, j):
        name = (0, 0, 0) if i == j == 0 else ((sector + 1) % valence, j, 0) if i == 0 else (sector, i, j)
        if name not in numbers:
            a, b = (2 * np.pi * (sector + k) / valence for k in (0, 1))
            numbers[name] = len(points)
            points.append(i * np.array([np.cos(a), np.sin(a)]) + j * np.array([np.cos(b), np.sin(b)]))
        return numbers[name]

    quads = [[number(s, i, j), number(s, i + 1, j), number(s, i + 1, j + 1), number(s, i, j + 1)]
             for s in range(valence) for i in range(width) for j in range(width)]
    return extruded(quads, points, layers)


def ring(count, width, layers):
    angles = 2 * np.pi * np.arange(count) / count
    points = [(1 + r) * np.array([np.cos(a), np.sin(a)]) for a in angles for r in range(width + 1)]
    row = width + 1
    quads = [[i * row + r, i * row + r + 1, (i + 1) % count * row + r + 1, (i + 1) % count * row + r] for i in range(count) for r in range(width)]
    return extruded(quads, points, layers)


def o_grid(core, rings, layers):
    square = np.stack(np.meshgrid(*[np.linspace(-.45, .45, core + 1)] * 2, indexing="ij"), -1).reshape(-1, 2)
    number = np.arange(len(square)).reshape(core + 1, core + 1)
    points = list(square)
    quads = [[number[i, j], number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]] for i in range(core) for j in range(core)]
    around = np.concatenate([number[:-1, 0], number[-1, :-1], number[:0:-1, -1], number[0, :0:-1]])
    last = around
    for r in range(1, rings + 1):
        first = len(points)
        points += [(1 - r / rings) * square[p] + 1.2 * r / rings * square[p] / np.linalg.norm(square[p]) for p in around]
        new = first + np.arange(len(around))
        quads += np.stack([last, new, np.roll(new, -1), np.roll(last, -1)], 1).tolist()
        last = new
    return extruded(quads, points, layers, .5)


def castle(rng):
    points, cells = block([rng.integers(2, 5)] * 3)
    cells = cells[rng.random(len(cells)) < rng.uniform(.35, .8)]
    used, inverse = np.unique(cells if len(cells) else block([1, 1, 1])[1], return_inverse=True)
    return points[used], inverse.reshape(-1, 8)


def hull_edges(cells):
    sides = np.concatenate([cells[:, side] for side in SIDES])
    _, first, count = np.unique(np.sort(sides, 1), axis=0, return_index=True, return_counts=True)
    hull = sides[first[count == 1]]
    return np.unique(np.sort(np.stack([hull, np.roll(hull, -1, 1)], -1).reshape(-1, 2), 1), axis=0)


def random_mesh(seed):
    """A mesh, and a scheme for it."""
    rng = np.random.default_rng(seed)
    points, cells = [lambda: block(rng.integers(1, 6, 3)), lambda: fan(rng.choice([3, 5, 6, 7, 8]), rng.integers(1, 3), rng.integers(1, 4)),
                     lambda: o_grid(*rng.integers(1, 4, 3)), lambda: ring(rng.integers(3, 9), rng.integers(1, 3), rng.integers(1, 4)),
                     lambda: castle(rng)][seed % 5]()
    edge = min(np.linalg.norm(points[cells[:, 0]] - points[cells[:, k]], axis=1).min() for k in (1, 3, 4))
    points = points + rng.uniform(-.5, .5, points.shape) * rng.choice([0, .05, .15, .25, .4]) * edge
    edges = hull_edges(cells)
    creases = edges[rng.random(len(edges)) < rng.choice([0, .1, .3])]
    at = (points - points.mean(0)) / np.ptp(points, axis=0).max()
    fields = {"linear": at @ rng.normal(size=3), "square": (at @ rng.normal(size=3))**2,
              "wave": np.sin(6 * at[:, 0] + 2) * np.cos(5 * at[:, 1]) + at[:, 2]**3, "noise": rng.normal(size=len(points)),
              "spike": (np.arange(len(points)) == rng.integers(len(points))).astype(float)}
    taken = rng.permutation(list(fields))[:rng.integers(1, 4)]
    mesh = subvol.HexMesh(points, cells.astype(np.uint32), {name: fields[name] for name in taken}, creases if len(creases) else None)
    return mesh, str(rng.choice(["mcq", "mcq", "cc", "bsxw", "linear"]))


def quadratic(t):
    return np.array([(2 * t - 1) * (t - 1), 4 * t * (1 - t), t * (2 * t - 1)]), np.array([4 * t - 3, 4 - 8 * t, 4 * t - 1])


def gauss_points():
    """The weights of the Gauss points, and what takes 27 nodes to their values and to their derivatives: (27,), (27,27), (27,27,3)."""
    line = [(w, *quadratic(t)) for t, w in ((.5 - .15**.5, 5 / 18), (.5, 8 / 18), (.5 + .15**.5, 5 / 18))]
    product = lambda a, b, c: np.einsum("k,j,i->kji", c, b, a).ravel()
    points = [(wu * wv * ww, product(u, v, w), np.stack([product(du, v, w), product(u, dv, w), product(u, v, dw)], 1))
              for wu, u, du in line for wv, v, dv in line for ww, w, dw in line]
    weights, values, slopes = zip(*points)
    return np.array(weights), np.stack(values, 1), np.stack(slopes, 1)


def nodes_of(cells):
    """27 nodes, u fastest, of each group of eight children."""
    number = {tuple(corner): k for k, corner in enumerate(CORNERS)}
    groups, nodes = cells.reshape(-1, 8, 8), []
    for n in range(27):
        at = np.array([n % 3, n // 3 % 3, n // 9])
        child = np.minimum(at, 1)
        nodes.append(groups[:, number[tuple(child)], number[tuple(at - child)]])
    return np.stack(nodes, 1)


def integrals(mesh, scheme, level, origins):
    """The volume, and of each field the integral without its origin."""
    fine = subvol.subdivide(mesh, level, scheme, on_limit=True)
    points, sums = np.asarray(fine.points), np.zeros(1 + len(origins))
    values = [np.asarray(fine.fields[name]) - origin for name, origin in origins.items()]
    weights, to_values, to_slopes = gauss_points()
    for nodes in np.array_split(nodes_of(fine.cells.astype(int)), len(fine.cells) // 80_000 + 1):
        at = points[nodes] - points[nodes[:, :1]]
        x, y, z = ((at[:, :, d] @ to_slopes.reshape(27, -1)).reshape(-1, 27, 3) for d in range(3))
        volumes = weights * (x * np.cross(y, z)).sum(2)
        sums += [volumes.sum(), *((volumes * (field[nodes] @ to_values)).sum() for field in values)]
    return sums


def check_measure(mesh, scheme):
    """The largest error of the volume and the means, how much of it is not known, and the error that is said."""
    fields = {name: np.asarray(values) for name, values in mesh.fields.items()}
    origins = {name: (values.min() + values.max()) / 2 for name, values in fields.items()}
    ranges = [max(float(np.ptp(values)), 1e-300) for values in fields.values()]
    level = 4 if len(mesh.cells) < 64 else 3
    coarse, fine = (integrals(mesh, scheme, n, origins) for n in (level - 1, level))
    exact, unknown = fine + (fine - coarse) / 4, np.abs(fine - coarse) / 4  # each level leaves a fifth of its change, or less
    found = subvol.measure(mesh, scheme=scheme)
    means = [found["fields"][name]["mean"] - origin for name, origin in origins.items()]
    off = np.abs([found["volume"] / exact[0] - 1, *((means - exact[1:] / exact[0]) / ranges)])
    return off.max(), (unknown / abs(exact[0]) / [1, *ranges]).max(), found["error"]


def determinants(mesh, scheme, level):
    """By control cells: in the middle of each refined cell, as a part of the mean."""
    fine = subvol.subdivide(mesh, level, scheme, on_limit=True)
    at = np.asarray(fine.points)[fine.cells.astype(int)]
    across = [(at[:, CORNERS[:, a] == 1].mean(1) - at[:, CORNERS[:, a] == 0].mean(1)) for a in range(3)]
    found = np.einsum("ij,ij->i", across[0], np.cross(across[1], across[2])).reshape(len(mesh.cells), -1)
    return found / np.abs(found).mean()


def check_folds(mesh, scheme):
    """How many cells are proved, how many of these have a negative determinant, how many are folded, and how many places of these are not."""
    check = subvol.check_folds(mesh, scheme=scheme, tests=100)
    proved = check.verdicts == 0
    negative = proved & (determinants(mesh, scheme, 3).min(1) < 0)
    if negative.any():
        negative &= determinants(mesh, scheme, 4).min(1) < 0
    there = np.linalg.det(subvol.evaluate_limit(mesh, check.cells, check.parameters, scheme=scheme).jacobians) if len(check.cells) else np.zeros(0)
    return proved.sum(), negative.sum(), len(check.cells), (there >= 0).sum()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--meshes", type=int, default=200)
    parser.add_argument("--first", type=int, default=0, help="seed")
    arguments = parser.parse_args()
    measured, folds = [], np.zeros(4, int)
    for seed in range(arguments.first, arguments.first + arguments.meshes):
        mesh, scheme = random_mesh(seed)
        measured.append(check_measure(mesh, scheme))
        folds += check_folds(mesh, scheme)
        off, unknown, said = measured[-1]
        if off > said + unknown + 1e-13:
            print(f"mesh {seed} ({scheme}): off by {off:.2g} of what may be {unknown:.1g} wrong, said {said:.2g}", flush=True)
    off, unknown, said = np.array(measured).T
    known = off > 3 * unknown + 1e-12
    outside = int((off > said + unknown + 1e-13).sum())
    print(f"{len(off)} meshes, {outside} farther off than said; said / true in {known.sum()} that are known well enough: "
          f"median {np.median(said[known] / off[known]):.1f}" if known.any() else f"{len(off)} meshes, {outside} farther off than said")
    print(f"{folds[0]} cells proved, {folds[1]} of them falsely; {folds[2]} folded, {folds[3]} of their places not confirmed by evaluate_limit")
    raise SystemExit(1 if outside or folds[1] or folds[3] else 0)


if __name__ == "__main__":
    main()
