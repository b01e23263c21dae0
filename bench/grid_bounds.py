#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whether the bound of `vdb --error` holds: the true error at up to 10^5 voxel centres, against the limit.

    PYTHONPATH=build/release/python /usr/bin/python3 bench/grid_bounds.py build/release/bin/subvol MESH RESOLUTION [FIELD] ...

A mesh is a file or model:NAME:N. "-" for FIELD is the one that `vdb` takes, "=x*y" a field with these values at the control points.
Needs python3-openvdb.
"""
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import pyopenvdb
import subvol

MOST_PLACES = 100_000


def model(name):
    _, model, resolution = name.split(":")
    return subvol.model(model, int(resolution))


def voxels(path):
    """The grid of values, and of bounds: places in the world, values, bounds."""
    value, bound = sorted(pyopenvdb.readAll(str(path))[0], key=lambda grid: grid.name.endswith("_error"))[:2]
    index = np.array([item.min for item in value.iterOnValues()])
    values = np.array([item.value for item in value.iterOnValues()])
    found = bound.getConstAccessor()
    bounds = np.array([found.getValue(tuple(int(x) for x in at)) for at in index])
    world = np.array([value.transform.indexToWorld(tuple(float(x) for x in at)) for at in index])
    return value.name, world, values, bounds


def check(command, name, resolution, field, folder):
    path = pathlib.Path(folder) / "grid.vdb"
    chosen = [] if field == "-" else ["--density", field[1:]] if field[0] == "=" else ["--field", field]
    subprocess.run([command, "vdb", name, "-o", path, "--resolution", resolution, "--error", "--quiet", *chosen], check=True)
    grid, world, values, bounds = voxels(path)
    chosen = np.sort(np.random.default_rng(1).choice(len(values), min(MOST_PLACES, len(values)), replace=False))
    world, values, bounds = world[chosen], values[chosen], bounds[chosen]
    mesh = model(name) if name.startswith("model:") else subvol.read_mesh(name)
    if field[0] == "=":
        x, y, z = mesh.points.T
        mesh = subvol.HexMesh(mesh.points, mesh.cells, {grid: eval(field[1:], {"x": x, "y": y, "z": z, "sin": np.sin, "cos": np.cos})})
    elif mesh.fields[grid].ndim > 1:  # as `vdb` takes a vector
        mesh = subvol.HexMesh(mesh.points, mesh.cells, {grid: np.linalg.norm(mesh.fields[grid], axis=1)})
    found = subvol.probe(mesh, at=world)
    inside = found.inside
    exact = subvol.evaluate_limit(mesh, found.cells[inside], found.parameters[inside], tolerance=1e-9, max_levels=16)
    slope = found.gradients[grid][inside]
    limit = exact.fields[grid] + np.einsum("ij,ij->i", slope, world[inside] - exact.positions)
    error, bound = np.abs(values[inside] - limit), bounds[inside]
    size = np.ptp(mesh.fields[grid])
    beyond = error > bound
    wrong = error > 1e-12 * size  # where it is not, the ratio says nothing
    most = (error - bound).max() / size
    print(f"| {name} {grid} | {resolution} | {error.max() / size:.2e} | {np.sqrt(np.mean(error ** 2)) / size:.2e} | {bound.max() / size:.2e} |"
          f" {np.median(bound[wrong] / error[wrong]):.1f} | {np.count_nonzero(beyond)} of {len(error):,}"
          f"{f', by at most {most:.1e}' if beyond.any() else ''} |", flush=True)


def main(command, *rest):
    print("| | resolution | largest error | RMS | largest bound | bound / error, median | beyond the bound |\n" + "|---" * 7 + "|")
    with tempfile.TemporaryDirectory() as folder:
        for k in range(0, len(rest), 3):
            check(command, rest[k], rest[k + 1], rest[k + 2], folder)


if __name__ == "__main__":
    main(*sys.argv[1:])
