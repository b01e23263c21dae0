#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares what we read of mesh files with what VTK and meshio read: volumes, and the ranges of all fields.

    bench/readers.py FOLDER [--command build/release/bin/subvol] [--peer "python3 bench/peers/mesh_figures.py"] [--root ''] [--json OUT]

All mesh files below the folder, and folders with polyMesh as cases of OpenFOAM. Prints a table: of each format the number of files that
both read, and how many of these have equal volumes (to 1e-6) and ranges (to 1e-6 of the larger end); then each other file with the
difference. --peer runs bench/peers/mesh_figures.py where VTK and meshio are; --root is taken from the front of the paths that it
gets, for a peer in a root of its own. Curved cells are compared by their corners.
"""
import argparse
import collections
import json
import pathlib
import shlex
import subprocess
import tempfile

ENDS = (".vtk .vtu .vts .vtr .vti .pvtu .pvts .pvtr .pvti .vtm .e .exo .ex2 .g .gen .exii .case .vtkhdf .hdf .foam .cgns .msh .mesh "
        ".meshb .inp .xdmf .xmf").split()
TOLERANCE = 1e-6


def files_of(folder):
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.suffix.lower() in ENDS and path.stat().st_size:
            yield path
        elif path.name == "polyMesh" and path.is_dir() and any(path.glob("faces*")):
            case = path.parents[1] / "case.foam"
            case.touch()
            yield case


def ours_of(command, path):
    words = [*command, "info", "--json", "--curved", "corners", "--cell-values", "mean", str(path)]
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=300)
    except subprocess.TimeoutExpired:
        return {"error": "more than 300 seconds"}
    if done.returncode:
        return {"error": done.stderr.strip().splitlines()[-1].replace(str(path), "") if done.stderr else str(done.returncode), "code": done.returncode}
    found = json.loads(done.stdout)
    return {"volume": found.get("volume", 0), "cells": found["cells"], "warnings": found["warnings"],
            "fields": {field["name"]: [field["min"], field["max"]] for field in found["fields"]}}


def differs(a, b):
    return abs(a - b) > TOLERANCE * max(abs(a), abs(b), 1e-30)


def differences(ours, peer):
    """What differs, as words; the kinds "volume", "range", "field" come first in each."""
    found = []
    if differs(ours["volume"], peer["volume"]):
        found.append(f"volume {ours['volume']:.9g}, by {peer['peer']} {peer['volume']:.9g}")
    for name, there in peer["fields"].items():
        here = ours["fields"].get(name)
        if here and any(abs(a - b) > TOLERANCE * max(map(abs, there)) for a, b in zip(here, there)):
            found.append(f"range of {name} {here[0]:.9g} to {here[1]:.9g}, by {peer['peer']} {there[0]:.9g} to {there[1]:.9g}")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--command", default="build/release/bin/subvol")
    parser.add_argument("--peer", default="python3 bench/peers/mesh_figures.py")
    parser.add_argument("--root", default="")
    parser.add_argument("--json", type=pathlib.Path)
    arguments = parser.parse_args()
    paths = list(files_of(arguments.folder.resolve()))
    listed = "".join(str(path).removeprefix(arguments.root) + "\n" for path in paths)
    with tempfile.TemporaryFile("w+") as names:  # a pipe would wait for the reader of the answers
        names.write(listed)
        names.seek(0)
        peers = subprocess.Popen(shlex.split(arguments.peer), stdin=names, stdout=subprocess.PIPE, text=True)
    table, told, records = collections.defaultdict(collections.Counter), [], []
    for path, line in zip(paths, peers.stdout):
        peer, ours = json.loads(line), ours_of(shlex.split(arguments.command), path)
        row = table[path.suffix.lower()]
        name = str(path.relative_to(arguments.folder.resolve()))
        records.append({"name": name, "ours": ours, "peer": peer})
        row["files"] += 1
        theirs = "error" not in peer and peer["cells"] > 0
        if "error" in ours or not theirs:
            row["neither" if not theirs and "error" in ours else "ours alone" if not theirs else "peer alone"] += 1
            if theirs:
                told.append(f"{name}: {peer['cells']} cells by {peer['peer']}; ours: {ours['error']}")
            continue
        row["both"] += 1
        found = [text for text in differences(ours, peer) if not (peer["curved"] and text.startswith("range"))]  # nodes that are left out
        row["volumes"] += not any(text.startswith("volume") for text in found)
        row["ranges"] += not any(text.startswith("range") for text in found)
        told += [f"{name}: {text}" for text in found]
    columns = ["files", "both", "volumes", "ranges", "ours alone", "peer alone", "neither"]
    print("| format |", " | ".join(columns), "|\n|" + "---|" * (len(columns) + 1))
    for end, row in sorted(table.items()):
        print(f"| `{end}` |", " | ".join(str(row[column]) for column in columns), "|")
    print("| all |", " | ".join(str(sum(row[column] for row in table.values())) for column in columns), "|\n")
    print("\n".join(told))
    if arguments.json:
        arguments.json.write_text(json.dumps(records))


if __name__ == "__main__":
    main()
