# SPDX-License-Identifier: Apache-2.0
"""Allocations that fail within calls of the module: each ends with an exception, and the interpreter lives on.

The test starts an interpreter with the library of tests/cli/fail_calls.cpp, which calls functions again and again while one
allocation of C++ fails, at most SUBVOL_FAILED_CALLS times each (default: 4)."""
import ctypes
import os
import subprocess
import sys
import warnings

import subvol

LIBRARY = os.environ.get("SUBVOL_FAIL_CALLS", "")
MOST = int(os.environ.get("SUBVOL_FAILED_CALLS", "2"))


def calls():
    ball = subvol.model("ball", resolution=2)
    points = subvol.sample(ball)
    grid = subvol.rasterize(ball, resolution=8)
    return {
        "model": lambda: subvol.model("ball", resolution=2),
        "subdivide": lambda: subvol.subdivide(ball, levels=1),
        "write_mesh": lambda: subvol.write_mesh(ball, "a.vtu"),
        "read_mesh": lambda: subvol.read_mesh("a.vtu"),
        "probe": lambda: subvol.probe(ball, "density", [[0, 0, 0]]),
        "measure": lambda: subvol.measure(ball),
        "surface": lambda: subvol.surface(ball, iso=0.3),
        "sample": lambda: subvol.sample(ball),
        "write_points": lambda: subvol.write_points(points, "a.ply"),
        "read_points": lambda: subvol.read_points("a.ply"),
        "render": lambda: subvol.render(ball, size=(16, 16), backend="cpu"),
        "slice": lambda: subvol.slice(ball, "density", point=[0, 0, 0], normal=[0, 0, 1], resolution=8),
        "rasterize": lambda: subvol.rasterize(ball, resolution=8),
        "write_vdb": lambda: subvol.write_vdb(grid, "a.vdb"),
        "read_vdb": lambda: subvol.read_vdb("a.vdb"),
        "page": lambda: subvol.page(ball),
        "check_folds": lambda: subvol.check_folds(ball),
    }


def chosen(count):
    return range(1, count + 1) if count <= MOST else sorted({1 + i * (count - 1) // max(1, MOST - 1) for i in range(MOST)})


def fail_each():
    """What the interpreter with the library does. The last line says that it lives."""
    warnings.simplefilter("ignore")
    subvol.set_threads(1)  # the same allocations in each run
    fail_next = ctypes.CDLL(None).fail_next_call
    fail_next.argtypes, fail_next.restype = [ctypes.c_long], ctypes.c_long
    for name, call in calls().items():
        fail_next(0)
        call()
        count = fail_next(0)
        failed = 0
        for number in chosen(count):
            print(f"{name} {number}", flush=True)
            fail_next(number)
            try:
                call()
            except (MemoryError, subvol.Error):
                failed += 1
            finally:
                fail_next(0)
            left = sorted(set(os.listdir()) - {"a.vtu", "a.ply", "a.vdb"})
            assert not left, f"{name} {number} left {left}"
        call()  # as if nothing had been
        print(f"{name}: {count} allocations, {len(chosen(count))} failed in turn, {failed} exceptions", flush=True)
    print("alive")


def test_each_call_ends_with_an_exception(tmp_path):
    import pytest

    if not LIBRARY or "-fsanitize" in os.environ.get("SUBVOL_FLAGS", ""):
        pytest.skip("SUBVOL_FAIL_CALLS names no library")
    environment = {**os.environ, "LD_PRELOAD": LIBRARY, "SUBVOL_FAIL": "alloc@libstdc++:0"}
    done = subprocess.run([sys.executable, "-B", "-X", "faulthandler", __file__], cwd=tmp_path, env=environment, capture_output=True,
                          text=True)
    assert done.returncode == 0, done.stdout[-200:] + done.stderr[-3000:]
    assert done.stdout.endswith("alive\n")


if __name__ == "__main__":
    fail_each()
