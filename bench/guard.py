#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A guard of speed: time and memory of the commands, in parts of those of version 0.2.0, which is built beside.

    bench/guard.py [--program build/release/bin/subvol] [--old COMMIT] [--folder build/guard] [--only NAME,NAME] [--csv docs/benchmarks/guard.csv]

Each figure runs with both programs by turns, three times; the least CPU time (user and system) and the least of the peaks count. A figure that takes
more than 1.15 times as much as the old one, and more than .1 s or 16 MB more, fails, and the exit status is 1. --csv adds a row for each figure to a table
of what was measured when. Nothing else should run on the machine, though both programs would suffer alike.
"""
import argparse
import csv
import datetime
import os
import subprocess
import sys
from pathlib import Path

OLD = "0f481603"  # the last commit before what came after 0.2.0
MOST, ROOM_SECONDS, ROOM_BYTES, RUNS = 1.15, 0.1, 16e6, 3
FIELDS = ("date", "commit", "figure", "old_seconds", "seconds", "old_bytes", "bytes")

# Meshes that both programs read: made by the old one.
MESHES = {
    "twist.vtu": ["model", "twist", "--resolution", "24", "-o", "twist.vtu"],
    "pawn.vtu": ["model", "pawn", "-o", "pawn.vtu"],
    "cube.stl": ["surface", "model:twist:6", "--boundary", "-o", "cube.stl"],
}
CPU = ["--backend", "cpu", "--size", "512x512"]
FIGURES = {
    "info": ["info", "pawn.vtu"],
    "check": ["check", "pawn.vtu"],
    "refine": ["subdivide", "twist.vtu", "--levels", "2", "-o", "a.vtu"],
    "points": ["points", "pawn.vtu", "-o", "a.ply"],
    "points, 2 an edge": ["points", "twist.vtu", "--per-edge", "2", "-o", "b.ply"],
    "levels of detail": ["points", "pawn.vtu", "-o", "a.svk"],
    "vdb, 128": ["vdb", "pawn.vtu", "--resolution", "128", "-o", "a.vdb"],
    "vdb, 256": ["vdb", "twist.vtu", "--resolution", "256", "-o", "b.vdb"],
    "solid": ["render", "pawn.vtu", *CPU, "-o", "a.png"],
    "solid, 2048": ["render", "twist.vtu", "--backend", "cpu", "--size", "2048x2048", "-o", "b.png"],
    "volume": ["render", "pawn.vtu", *CPU, "--look", "volume", "-o", "c.png"],
    "turntable": ["render", "twist.vtu", *CPU, "--look", "volume", "--turntable", "12", "-o", "t.png"],
    "tetrahedra": ["render", "pawn.vtu", "--method", "tets", "--size", "512x512", "-o", "d.png"],
    "dense": ["render", "twist.vtu", "--method", "dense", "--size", "512x512", "-o", "e.png"],
    "boundary": ["surface", "pawn.vtu", "--boundary", "-o", "a.stl"],
    "isosurface": ["surface", "twist.vtu", "--iso", "0", "-o", "b.stl"],
    "slice": ["slice", "pawn.vtu", "--plane", "0,0,1,0,0,1", "-o", "s.png"],
    "statistics": ["probe", "twist.vtu", "--stats"],
    "page": ["page", "pawn.vtu", "-o", "a.html"],
    "mesh": ["mesh", "cube.stl", "--cells", "12", "-o", "m.vtu"],
}


def run(command, **options):
    done = subprocess.run([str(word) for word in command], **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: ended with {done.returncode}")


def old_program(commit, folder):
    """Builds the command of a commit, once."""
    source, build = folder / "source", folder / "build"
    if not source.exists():
        run(["git", "worktree", "add", "--detach", source, commit])
    run(["cmake", "-G", "Ninja", "-S", source, "-B", build, "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_UNITY_BUILD=ON", "-DCMAKE_UNITY_BUILD_BATCH_SIZE=16",
         "-DSUBVOL_TESTS=OFF"], stdout=subprocess.DEVNULL)
    run(["cmake", "--build", build, "--target", "bin/subvol"], stdout=subprocess.DEVNULL)
    return build / "bin" / "subvol"


def measured(program, words, folder):
    """CPU seconds and the largest memory."""
    running = subprocess.Popen([program, *words, "--quiet"], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, used = os.wait4(running.pid, 0)
    if status != 0:
        sys.exit(f"{program} {' '.join(words)}: ended with {os.waitstatus_to_exitcode(status)}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss * 1024


def least(program, others, words, folder):
    """The least time and memory of both programs, which run by turns."""
    runs = [(measured(program, words, folder), measured(others, words, folder)) for _ in range(RUNS)]
    return [tuple(min(one[who][what] for one in runs) for what in (0, 1)) for who in (0, 1)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=Path("build/release/bin/subvol"))
    parser.add_argument("--old", default=OLD)
    parser.add_argument("--folder", type=Path, default=Path("build/guard"))
    parser.add_argument("--only", default="")
    parser.add_argument("--csv", type=Path)
    args = parser.parse_args()
    unknown = set(filter(None, args.only.split(","))) - set(FIGURES)
    if unknown:
        parser.error(f"no figures: {', '.join(sorted(unknown))}; there are {', '.join(FIGURES)}")
    folder = args.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    old, new = old_program(args.old, folder), args.program.resolve()
    for name, words in MESHES.items():
        if not (folder / name).exists():
            run([old, *words, "--quiet"], cwd=folder)
    rows, slower = [], []
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=True).stdout.strip()
    print(f"{'figure':20} {'s, old':>8} {'s':>8} {'ratio':>6} {'MB, old':>8} {'MB':>8} {'ratio':>6}")
    for name, words in FIGURES.items():
        if args.only and name not in args.only.split(","):
            continue
        (seconds, peak), (old_seconds, old_peak) = least(new, old, words, folder)
        over = (seconds > MOST * old_seconds and seconds - old_seconds > ROOM_SECONDS) or (peak > MOST * old_peak and peak - old_peak > ROOM_BYTES)
        print(f"{name:20} {old_seconds:8.2f} {seconds:8.2f} {seconds / old_seconds:6.2f} {old_peak / 1e6:8.0f} {peak / 1e6:8.0f} {peak / old_peak:6.2f}"
              f"{'  MORE' if over else ''}", flush=True)
        rows.append(dict(zip(FIELDS, (datetime.date.today().isoformat(), commit, name, round(old_seconds, 3), round(seconds, 3), old_peak, peak))))
        if over:
            slower.append(name)
    if args.csv:
        fresh = not args.csv.exists()
        with args.csv.open("a", newline="") as out:
            writer = csv.DictWriter(out, FIELDS)
            if fresh:
                writer.writeheader()
            writer.writerows(rows)
    if slower:
        sys.exit(f"more than {MOST} times version 0.2.0: {', '.join(slower)}")


if __name__ == "__main__":
    main()
