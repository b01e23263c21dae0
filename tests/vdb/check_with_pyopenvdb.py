#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks a .vdb file through OpenVDB's Python module against values at voxel centres.

check_with_pyopenvdb.py FILE.vdb FILE.json

The JSON file holds {"points": [[x, y, z], ...], "grids": {"NAME": [v, [vx, vy, vz] or null, ...], ...}}; null means that the
voxel is not active. Exit status: 0 all agree, 1 some do not, 77 no module (skipped).
"""
import json
import sys

try:
    import pyopenvdb
except ImportError:
    print("skipped: the module pyopenvdb (package python3-openvdb) is missing")
    sys.exit(77)

# Relative to the largest number of the grid of 32-bit floats; each value is rounded a few times.
TOLERANCE = 1e-6


def components(value):
    return list(value) if isinstance(value, (list, tuple)) else [value]


def mismatch(accessor, transform, point, expected, largest):
    index = transform.worldToIndex(tuple(point))
    voxel = tuple(round(i) for i in index)
    if max(abs(i - v) for i, v in zip(index, voxel)) > 1e-6:
        return f"{point} is no voxel centre: index {index}"
    value, active = accessor.probeValue(voxel)
    if active != (expected is not None):
        return f"{point}: active is {active}, expected {expected}"
    if not active:
        return None
    found, wanted = components(value), components(expected)
    if len(found) != len(wanted) or max(abs(a - b) for a, b in zip(found, wanted)) > TOLERANCE * largest:
        return f"{point}: {value}, expected {expected}"
    return None


def check_grid(path, name, points, values):
    """The number of voxels that are wrong."""
    if not points or len(points) != len(values):
        raise SystemExit(f"{name}: {len(points)} points and {len(values)} values")
    grid = pyopenvdb.read(path, name)
    accessor = grid.getConstAccessor()
    known = [v for v in values if v is not None]
    largest = max(abs(c) for v in known for c in components(v))
    found = [mismatch(accessor, grid.transform, p, v, largest) for p, v in zip(points, values)]
    wrong = [text for text in found if text]
    for text in wrong[:10]:
        print(f"{name}: {text}")
    print(f"{name}: {len(points)} voxels, {len(known)} active, {len(wrong)} wrong")
    return len(wrong)


def main(vdb_path, json_path):
    with open(json_path, encoding="utf-8") as file:
        reference = json.load(file)
    names = {grid.name for grid in pyopenvdb.readAllGridMetadata(vdb_path)}
    if names != set(reference["grids"]):
        raise SystemExit(f"{vdb_path}: the grids are {sorted(names)}")
    wrong = sum(check_grid(vdb_path, name, reference["points"], values) for name, values in reference["grids"].items())
    return 1 if wrong else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2]))
