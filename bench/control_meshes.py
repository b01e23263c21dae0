#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Control meshes of closed surfaces: cells, distances in cells, folds, CPU seconds and memory of `subvol mesh`.

usage: control_meshes.py SURFACE... [--subvol build/release/bin/subvol] [--cells 16 24 32] [--refine N --tolerance T] [--longest]

With --longest distances are in thousandths of the longest side of the surface's box, which compare with other --cells. Prints tables
for docs/approximate.md."""

import argparse
import json
import os
import subprocess
import tempfile
from pathlib import Path


def sharp_text(sharp, side):
    if sharp["length_world"] == 0:
        return "none | "
    missed = sharp["missed_length_world"] / sharp["length_world"]
    return f"{sharp['rms'] / side:.3f}, {sharp['max'] / side:.2f} | {100 * missed:.0f} %"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("surfaces", nargs="+")
    parser.add_argument("--subvol", default="build/release/bin/subvol")
    parser.add_argument("--cells", type=int, nargs="+", default=[16, 24, 32])
    parser.add_argument("--refine", default="0")
    parser.add_argument("--tolerance", default=".25")
    parser.add_argument("--longest", action="store_true")
    given = parser.parse_args()
    more = ["--refine", given.refine, "--tolerance", given.tolerance] if given.refine != "0" else []
    print("| surface | triangles | cells | boundary from surface: RMS, largest | surface from boundary | creases from sharp edges "
          "| of them missed | folded | undecided | mended | CPU s | MB |\n|---|---|---|---|---|---|---|---|---|---|---|---|")
    for surface in given.surfaces:
        for cells in given.cells:
            with tempfile.TemporaryDirectory() as folder:
                command = [given.subvol, "mesh", surface, "-o", f"{folder}/made.vtu", "--cells", str(cells), *more, "--json"]
                process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
                text = process.stdout.read()
                _, status, use = os.wait4(process.pid, 0)
                if os.waitstatus_to_exitcode(status) not in (0, 1):
                    print(f"| {Path(surface).stem} | | {cells} | no mesh |")
                    continue
                found = json.loads(text)
                after, folds = found["after"], found["folds"]["cells"]
                side = found["side_world"] * (cells / 1000 if given.longest else 1)
                print(f"| {Path(surface).stem} | {found['triangles']:,} | {found['cells']:,} | {after['rms'] / side:.3f}, {after['max'] / side:.2f} "
                      f"| {after['missed_rms'] / side:.3f}, {after['missed_max'] / side:.2f} | {sharp_text(found['sharp'], side)} | {folds['folded']} "
                      f"| {folds['undecided'] - folds['irregular']} | {found['mended']} | {use.ru_utime + use.ru_stime:.0f} "
                      f"| {use.ru_maxrss / 1024:.0f} |", flush=True)


if __name__ == "__main__":
    main()
