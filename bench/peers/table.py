#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""One table of the twisted block by our methods and by VTK's: CPU-seconds per frame and RMSE against the exact picture.

    bench/peers/table.py [build folder = build/release] [N = 40]

Needs the programs `subvol` and `peers_ours` (SUBVOL_BENCH=ON), Debian's python3-vtk9 and xvfb; without those two it prints ours.
Measure on an idle machine. OpenVKL is not run: it takes 1.28 times the CPU time of VTK's projected tetrahedra at N = 40.
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).parent
OPENVKL_BY_VTK = 1.28  # CPU time per frame, relative to VTK's projected tetrahedra on the same machine; RMSE .0017


def rows_of(command):
    result = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, text=True, check=True)
    return [line.split("\t") for line in result.stdout.splitlines() if line.count("\t") == 3]


def main(build="build/release", n="40"):
    build = pathlib.Path(build)
    with tempfile.TemporaryDirectory() as folder:
        mesh, exact = pathlib.Path(folder) / "twist.vtu", pathlib.Path(folder) / "exact.f32"
        rows = rows_of([build / "bench" / "peers_ours", n, exact])
        if shutil.which("xvfb-run"):
            subprocess.run([build / "bin" / "subvol", "model", "twist", "--resolution", n, "-o", mesh, "--quiet"], check=True)
            rows += rows_of(["xvfb-run", "-a", "/usr/bin/python3", HERE / "vtk_volumes.py", mesh, exact])
    print(f"| twist {n}, 512² | first frame, CPU-s | later frame, CPU-s | RMSE |\n|---|---|---|---|")
    for name, first, later, rmse in rows:
        print(f"| {name} | {first} | {later} | {rmse} |")
    for name, _, later, _ in rows:
        if n == "40" and "VTK" in name and "projected" in name:
            print(f"| OpenVKL, by its ratio to VTK's projected tetrahedra | | {OPENVKL_BY_VTK * float(later):.2f} | .0017 |")


main(*sys.argv[1:])
