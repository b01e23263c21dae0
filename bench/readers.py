#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares what we read of mesh files with what VTK and meshio read: numbers of cells, volumes, and the ranges of all fields.

    bench/readers.py FOLDER [--command build/release/bin/subvol] [--peer "python3 bench/peers/mesh_figures.py"] [--root ''] [--json OUT]

All mesh files below the folder, and folders with polyMesh as cases of OpenFOAM. Prints a table: of each format the number of files that
both read, and how many of these have the same number of cells, equal volumes (to 1e-6) and ranges (to 1e-6 of the larger end); then our
refusals by their sentence, with numbers and names taken out, the files that ended the command otherwise, the longest run and the largest
memory; then each other file with the difference. --peer runs bench/peers/mesh_figures.py where VTK and meshio are; --root is taken from the front of the paths that it
gets, for a peer in a root of its own. Curved cells are compared by their corners.
"""
import argparse
import collections
import json
import os
import pathlib
import re
import shlex
import subprocess
import tempfile
import threading
import time

ENDS = (".vtk .vtu .vts .vtr .vti .pvtu .pvts .pvtr .pvti .vtm .vth .vthb .e .exo .ex2 .g .gen .exii .case .vtkhdf .hdf .foam .cgns .msh .mesh "
        ".meshb .inp .xdmf .xmf").split()
TOLERANCE = 1e-6
SECONDS = 300


def files_of(folder):
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.suffix.lower() in ENDS and path.stat().st_size:
            yield path
        elif path.name == "polyMesh" and path.is_dir() and any(path.glob("faces*")):
            case = path.parents[1] / "case.foam"
            case.touch()
            yield case


def cells_of(found):
    """The cells of the file, of all kinds: a warning has their numbers where they were split into hexahedra."""
    for warning in found["warnings"]:
        if re.search(r" split into \d+ hexahedr", warning):
            kinds = re.findall(r"(\d+) (?:hexahedr|tetrahedr|prism|pyramid)", re.split(r" cut into | split into ", warning)[0])
            return sum(map(int, kinds))
    return found["cells"]


def ours_of(command, path):
    words = [*command, "info", "--json", "--curved", "corners", "--cell-values", "mean", str(path)]
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        start = time.monotonic()
        child = subprocess.Popen(words, stdout=out, stderr=err)
        timer = threading.Timer(SECONDS, child.kill)
        timer.start()
        status, usage = os.wait4(child.pid, 0)[1:]
        timer.cancel()
        child.returncode = os.waitstatus_to_exitcode(status)
        run = {"seconds": time.monotonic() - start, "peak_kb": usage.ru_maxrss, "code": child.returncode}
        out.seek(0), err.seek(0)
        printed, said = out.read(), err.read().decode(errors="replace").strip()
    if run["seconds"] > SECONDS:
        return {**run, "error": f"more than {SECONDS} seconds"}
    if child.returncode:
        return {**run, "error": said.splitlines()[-1].replace(str(path), "") if said else str(child.returncode)}
    found = json.loads(printed)
    return {**run, "volume": found.get("volume", 0), "cells": cells_of(found), "warnings": found["warnings"],
            "fields": {field["name"]: [field["min"], field["max"]] for field in found["fields"]}}


def sentence_of(error):
    """A refusal without what differs from file to file."""
    text = re.sub(r"'[^']*'|\"[^\"]*\"|\S*/\S*", "…", error.removeprefix("subvol: "))
    return re.sub(r"-?\d[\d.,e+-]*", "N", text)[:150]


def differs(a, b):
    return abs(a - b) > TOLERANCE * max(abs(a), abs(b), 1e-30)


def differences(ours, peer):
    """What differs, as words; the kinds "cells", "volume", "range" come first in each."""
    found = []
    if ours["cells"] != peer["cells"] and not peer["polyhedra"]:
        found.append(f"cells {ours['cells']}, by {peer['peer']} {peer['cells']}")
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
        row["cells"] += not any(text.startswith("cells") for text in found)
        row["volumes"] += not any(text.startswith("volume") for text in found)
        row["ranges"] += not any(text.startswith("range") for text in found)
        told += [f"{name}: {text}" for text in found]
    columns = ["files", "both", "cells", "volumes", "ranges", "ours alone", "peer alone", "neither"]
    print("| format |", " | ".join(columns), "|\n|" + "---|" * (len(columns) + 1))
    for end, row in sorted(table.items()):
        print(f"| `{end}` |", " | ".join(str(row[column]) for column in columns), "|")
    print("| all |", " | ".join(str(sum(row[column] for row in table.values())) for column in columns), "|\n")
    refused = collections.Counter(sentence_of(r["ours"]["error"]) for r in records if r["ours"]["code"] == 2)
    print("\n".join(f"{count} refused: {sentence}" for sentence, count in refused.most_common()), "\n")
    print("\n".join(f"{r['name']}: exit code {r['ours']['code']}: {r['ours']['error']}" for r in records if r["ours"]["code"] not in (0, 2)))
    if records:
        slowest, largest = (max(records, key=lambda r: r["ours"][key]) for key in ("seconds", "peak_kb"))
        print(f"longest: {slowest['ours']['seconds']:.1f} s, {slowest['name']}\n"
              f"most memory: {largest['ours']['peak_kb'] / 1024:.0f} MiB, {largest['name']}\n")
    print("\n".join(told))
    if arguments.json:
        arguments.json.write_text(json.dumps(records))


if __name__ == "__main__":
    main()
