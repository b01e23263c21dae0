#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A table of hashes: points, grids, pictures and surfaces of one mesh, cut and divided in every way, against those of one process.

    bench/equality.py [build/release/bin/subvol] [--counts 1,2,3,4,7] [--resolution 4] [--columns points,vdb,render,tets,surface]

The mesh is `ball` in pieces (.pvtu) by slabs, by blocks or at random, a cell at a time: with a layer of ghost cells, with the
points between pieces in each of them, with a piece that is empty; points and cells have their global numbers. It is read as it
is, and as bricks that are cut in the same way. Each row is computed by one process, by as many shares as --counts says (`--part`,
`join`), and by as many ranks (`mpirun`, where it is installed). Prints the table of docs/shares.md; ends with 1 if a hash differs, also between two cuts.
"""
import argparse
import hashlib
import json
import math
import os
import random
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

SHAPES = ("slabs", "blocks", "random")
PICTURE = ["--size", "160x128", "--backend", "cpu"]
COLUMNS = {"points": ("points", ".ply", []), "vdb": ("vdb", ".vdb", ["--resolution", "48"]),
           "render": ("render", ".exr", PICTURE), "tets": ("render", ".exr", ["--method", "tets", *PICTURE]),
           "surface": ("surface", ".obj", ["--iso", "0.3", "--cap", "--boundary", "--color-field", "density", "--tolerance", "3e-3"])}
OF_SHARES = {"surface": ".svshare"}  # where a share is another file
RANKS = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


class Runner:
    def __init__(self, program, folder):
        self.program, self.folder = str(Path(program).resolve()), Path(folder)
        self.runs = 0

    def run(self, *words, ranks=1):
        command = [self.program, *map(str, words)]
        if ranks > 1:
            command = ["mpirun", "--oversubscribe", "-n", str(ranks), *command]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, env={**os.environ, **RANKS})
        self.runs += 1
        if done.returncode != 0:
            sys.exit(f"{' '.join(command)}: {done.stderr}")
        return done.stdout

    def hash_of(self, name):
        """Of a grid its leaves: each file has an identity of its own."""
        path = self.folder / name
        if path.suffix == ".vdb":
            return json.loads(self.run("info", name, "--json"))["grids"][0]["hash"][:12]
        return hashlib.sha256(path.read_bytes()).hexdigest()[:12]


def read_medit(path):
    """Points and cells of a .mesh file, and a field at the points."""
    words = path.read_text().split()
    at = words.index("Vertices")
    count = int(words[at + 1])
    points = [words[at + 2 + 4 * i:at + 5 + 4 * i] for i in range(count)]
    at = words.index("Hexahedra")
    cells = [[int(p) - 1 for p in words[at + 2 + 9 * i:at + 10 + 9 * i]] for i in range(int(words[at + 1]))]
    x = [[float(word) for word in point] for point in points]
    return points, cells, [repr(math.sin(3 * p[0]) * p[1] + p[2]) for p in x]


def pieces_of(points, cells, shape, count):
    """The piece of each cell."""
    if shape == "random":
        dice = random.Random(27)
        return [dice.randrange(count) for _ in cells]
    middle = [[sum(float(points[p][d]) for p in cell) for d in range(3)] for cell in cells]
    if shape == "slabs":
        order = sorted(range(len(cells)), key=lambda c: (middle[c], c))
        piece = [0] * len(cells)
        for place, c in enumerate(order):
            piece[c] = place * count // len(cells)
        return piece
    return [sum(1 << d for d in range(3) if m[d] > 0) for m in middle]  # octants


def write_pieces(folder, points, cells, values, shape):
    """A .pvtu of the pieces, with ghost cells; the last piece is empty. Returns its name."""
    piece_of = pieces_of(points, cells, shape, 5)
    names = []
    for number in range(max(piece_of) + 2):
        own = [c for c, piece in enumerate(piece_of) if piece == number]
        touched = {p for c in own for p in cells[c]}
        ghosts = [c for c, piece in enumerate(piece_of) if piece != number and touched & set(cells[c])]
        used = sorted({p for c in own + ghosts for p in cells[c]})
        place = {p: i for i, p in enumerate(used)}

        def array(name, kind, items, components=1):
            text = " ".join(map(str, items))
            return f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="ascii">{text}</DataArray>'

        kept = own + ghosts
        text = (f'<VTKFile type="UnstructuredGrid"><UnstructuredGrid><Piece NumberOfPoints="{len(used)}" '
                f'NumberOfCells="{len(kept)}"><PointData>{array("density", "Float64", (values[p] for p in used))}'
                f'{array("GlobalNodeId", "Int64", used)}</PointData><CellData>'
                f'{array("vtkGhostType", "UInt8", [0] * len(own) + [1] * len(ghosts))}'
                f'{array("GlobalElementId", "Int64", kept)}</CellData><Points>'
                f'{array("Points", "Float64", (x for p in used for x in points[p]), 3)}</Points><Cells>'
                f'{array("connectivity", "Int64", (place[p] for c in kept for p in cells[c]))}'
                f'{array("offsets", "Int64", (8 * (i + 1) for i in range(len(kept))))}'
                f'{array("types", "UInt8", [12] * len(kept))}</Cells></Piece></UnstructuredGrid></VTKFile>')
        names.append(f"{shape}_{number}.vtu")
        (folder / names[-1]).write_text(text)
    listed = "".join(f'<Piece Source="{name}"/>' for name in names)
    (folder / f"{shape}.pvtu").write_text(
        '<VTKFile type="PUnstructuredGrid"><PUnstructuredGrid GhostLevel="1"><PPointData>'
        '<PDataArray type="Float64" Name="density"/><PDataArray type="Int64" Name="GlobalNodeId"/></PPointData>'
        '<PPoints><PDataArray type="Float64" NumberOfComponents="3"/></PPoints>'
        f'{listed}</PUnstructuredGrid></VTKFile>')
    return f"{shape}.pvtu"


def hashes(runner, source, column, counts, with_ranks):
    """One process, then shares, then ranks."""
    verb, extension, options = COLUMNS[column]
    runner.run(verb, source, "-o", "one" + extension, *options, "--quiet")
    found = {"one process": runner.hash_of("one" + extension)}
    for count in counts:
        parts = [f"p{part}{OF_SHARES.get(verb, extension)}" for part in range(1, count + 1)]
        for part, name in enumerate(parts, 1):
            runner.run(verb, source, "-o", name, "--part", f"{part}/{count}", *options, "--quiet")
        runner.run("join", *parts, "-o", "joined" + extension, "--quiet")
        found[f"{count} shares"] = runner.hash_of("joined" + extension)
        if with_ranks and count > 1:
            runner.run(verb, source, "-o", "ranks" + extension, *options, "--quiet", ranks=count)
            found[f"{count} ranks"] = runner.hash_of("ranks" + extension)
    return found


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("program", nargs="?", default="build/release/bin/subvol")
    options.add_argument("--counts", default="1,2,3,4,7")
    options.add_argument("--resolution", type=int, default=4)
    options.add_argument("--columns", default=",".join(COLUMNS))
    asked = options.parse_args()
    counts = [int(count) for count in asked.counts.split(",")]
    columns = asked.columns.split(",")
    if unknown := set(columns) - set(COLUMNS):
        sys.exit(f"--columns: there is no {', '.join(sorted(unknown))} ({','.join(COLUMNS)})")
    with_ranks = shutil.which("mpirun") is not None
    different = 0
    with tempfile.TemporaryDirectory() as folder:
        runner = Runner(asked.program, folder)
        runner.run("model", "ball", "--resolution", asked.resolution, "-o", "ball.mesh", "--quiet")
        points, cells, values = read_medit(runner.folder / "ball.mesh")
        print("| cut | read as | " + " | ".join(f"`{column}`" for column in columns) + " |")
        print("|---|---|" + "---|" * len(columns))
        first = {}
        for shape in SHAPES:
            pieces = write_pieces(runner.folder, points, cells, values, shape)
            bricks = f"{shape}.bricks"
            runner.run("split", pieces, "-o", bricks, "--bricks", 5, "--by", shape, "--quiet")
            for source, form in ((pieces, "pieces"), (bricks, "bricks")):
                row = []
                for column in columns:
                    found = hashes(runner, source, column, counts, with_ranks)
                    expected = first.setdefault(column, found.get("one process"))
                    wrong = [way for way, value in found.items() if value != expected]
                    different += len(wrong)
                    row.append(f"{expected}" + (f" **but not {', '.join(wrong)}**" if wrong else ""))
                print(f"| {shape} | {form} | " + " | ".join(row) + " |", flush=True)
        print(f"\n{runner.runs} runs; ways: 1 process, {asked.counts} shares" +
              (f", {','.join(str(c) for c in counts if c > 1)} ranks" if with_ranks else "") +
              f"; {different} hashes differ")
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main())
