#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What sharp edges that are kept by default change: the volume of the limit beside that of the file, and CPU seconds.

usage: sharp_edges.py MESH... [--subvol build/release/bin/subvol] [--times] [--repeat 1]

For each mesh: cells, sharp edges, the volume of the file's cells, how far that of the limit is from it with --crease-angle none and by
default. With --times CPU seconds of `vdb --resolution 128`, `render --size 512x512` and `probe --stats`, none and default, the least of
so many runs each. Meshes that a command refuses are left out, with its message."""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

VERBS = {"vdb": ["--resolution", "128"], "render": ["--size", "512x512"], "probe": ["--stats"]}


def run(given, verb, mesh, *arguments):
    """The JSON object of a command and its CPU seconds."""
    before = os.times()
    done = subprocess.run([given.subvol, verb, mesh, *arguments, "--json", "--quiet"], capture_output=True, text=True)
    after = os.times()
    if done.returncode not in (0, 1):
        raise RuntimeError(str(json.loads(done.stdout)["error"]) if done.stdout else done.stderr)
    seconds = after.children_user - before.children_user + after.children_system - before.children_system
    return json.loads(done.stdout), seconds


def volume(given, mesh, *arguments):
    return run(given, "probe", mesh, "--stats", *arguments)[0]["stats"]["whole"]["volume"]


def least_seconds(given, verb, mesh, *arguments):
    with tempfile.TemporaryDirectory() as folder:
        output = {"vdb": ["-o", f"{folder}/a.vdb"], "render": ["-o", f"{folder}/a.png"], "probe": []}[verb]
        return min(run(given, verb, mesh, *VERBS[verb], *output, *arguments)[1] for _ in range(given.repeat))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", nargs="+")
    parser.add_argument("--subvol", default="build/release/bin/subvol")
    parser.add_argument("--times", action="store_true")
    parser.add_argument("--repeat", type=int, default=1)
    given = parser.parse_args()
    smooth = ["--crease-angle", "none"]
    columns = ["mesh", "cells", "sharp edges", "volume", "limit, none", "limit, default"]
    if given.times:
        columns += [f"{verb}: s, s, ratio" for verb in VERBS]
    print("| " + " | ".join(columns) + " |\n|" + "---|" * len(columns))
    for mesh in given.meshes:
        try:
            about, _ = run(given, "info", mesh)
            exact = about["volume"]
            errors = [volume(given, mesh, *arguments) / exact - 1 for arguments in (smooth, [])]
            row = [Path(mesh).name, f"{about['cells']:,}", f"{about.get('sharp_edges', 0):,}", f"{exact:.6g}", *(f"{100 * e:+.3f} %" for e in errors)]
            for verb in VERBS if given.times else ():
                none, default = (least_seconds(given, verb, mesh, *arguments) for arguments in (smooth, []))
                row.append(f"{none:.2f}, {default:.2f}, {default / none:.2f}")
            print("| " + " | ".join(row) + " |", flush=True)
        except RuntimeError as error:
            print(f"{mesh}: {error}", file=sys.stderr)


if __name__ == "__main__":
    main()
