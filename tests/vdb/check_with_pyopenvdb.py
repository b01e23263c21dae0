#!/usr/bin/env python3
"""Checks a .vdb file through OpenVDB's Python module against values at voxel centres.

check_with_pyopenvdb.py FILE.vdb FILE.json

The JSON file holds {"points": [[x, y, z], ...], "values": [v or null, ...]}; null means that the voxel is not active. The
first float grid of the file is taken. Exit status: 0 all agree to 1e-6 relative, 1 some do not, 77 no module (skipped).
"""
import json
import sys

try:
    import pyopenvdb
except ImportError:
    print("skipped: the module pyopenvdb (package python3-openvdb) is missing")
    sys.exit(77)

TOLERANCE = 1e-6  # relative: the grid holds 32-bit floats


def first_float_grid(path):
    for grid in pyopenvdb.readAllGridMetadata(path):
        if isinstance(grid, pyopenvdb.FloatGrid):
            return pyopenvdb.read(path, grid.name)
    raise SystemExit(f"{path}: no float grid")


def mismatch(accessor, transform, point, expected):
    index = transform.worldToIndex(tuple(point))
    voxel = tuple(round(i) for i in index)
    if max(abs(i - v) for i, v in zip(index, voxel)) > 1e-6:
        return f"{point} is no voxel centre: index {index}"
    value, active = accessor.probeValue(voxel)
    if active != (expected is not None):
        return f"{point}: active is {active}, expected {expected}"
    if active and abs(value - expected) > TOLERANCE * abs(expected):
        return f"{point}: {value}, expected {expected}"
    return None


def main(vdb_path, json_path):
    with open(json_path, encoding="utf-8") as file:
        reference = json.load(file)
    points, values = reference["points"], reference["values"]
    if not points or len(points) != len(values):
        raise SystemExit(f"{json_path}: {len(points)} points and {len(values)} values")
    grid = first_float_grid(vdb_path)
    accessor = grid.getConstAccessor()
    found = [mismatch(accessor, grid.transform, p, v) for p, v in zip(points, values)]
    wrong = [text for text in found if text]
    for text in wrong[:10]:
        print(text)
    active = sum(v is not None for v in values)
    print(f"{grid.name}: {len(points)} voxels, {active} active, {len(wrong)} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2]))
