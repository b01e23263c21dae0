# SPDX-License-Identifier: Apache-2.0
"""Every example of every document is run: commands, studies, Python and C++. The examples of a page run in its order, in one folder,
with small files in place of those of a reader, and with smaller pictures, grids and sequences. A comment before a block, which no
reader sees, says what a block needs, or why it cannot be run:

    <!-- needs: mpirun -->             programs, or modules of Python: where they are missing, the block is skipped
    <!-- with: const View& view -->    what the C++ code of the block is given
    <!-- not run: REASON -->

C++ is compiled; the examples in examples/ are programs that run."""

import json
import os
import re
import shutil
import subprocess
import sys
import unittest

import documents_test
from command import COMMAND, HANGS_AFTER, InFolder, subvol
from documents_test import DOCUMENTS, TOP, WALKS
from patches_test import foam, write_foam

BLOCK = re.compile(r"(?:^<!-- (needs|with|not run): (.*?) -->\n)?^```(\w*)\n(.*?)^```$", re.M | re.S)
PYTHON = os.environ.get("SUBVOL_PYTHON", "")
MODULES = os.environ.get("SUBVOL_MODULES", "")  # the folder of the package subvol


class Block:
    def __init__(self, document, match):
        self.kind, self.note, self.language, self.text = match.groups()
        self.place = f"{document.relative_to(TOP)}:{document.read_text()[:match.start(4)].count(chr(10))}"


def blocks_of(document):
    return [Block(document, match) for match in BLOCK.finditer(document.read_text())]


def all_blocks():
    return [block for document in sorted(DOCUMENTS) for block in blocks_of(document)]


# What is smaller here: the same command with less work.
SMALLER = [(r"(--resolution )\d+", r"\g<1>16"), (r"(--size )\d+x\d+", r"\g<1>40x30"), (r"(--frames )1-\d+", r"\g<1>1-3"),
           (r"(--frames )\d+$", r"\g<1>3"), (r"(--frames )\d+(?= )", r"\g<1>3"), (r"(--turntable )\d+", r"\g<1>3"), (r"(--cells )\d+", r"\g<1>4"), (r"(subvol mesh (?!.*--cells)\S+)", r"\1 --cells 4"),
           (r"(subvol vdb (?!.*(--resolution|--voxel-size))\S+)", r"\1 --resolution 16"),
           (r"(subvol usd (?!.*(--resolution|\.vdb|\.svk))\S+)", r"\1 --resolution 16"),
           (r"model:(nozzle|pawn)(?= )", r"model:\1:4"), (r"model:twist:8", "model:twist:3"),
           (r"(--count )\d+", r"\g<1>9"), (r"(-count )\d+", r"\g<1>6"), (r"(subvol render (?!.*(--size|--legend))\S+)", r"\1 --size 40x30"),
           (r"\.mp4", "_##.png")]  # no ffmpeg is needed for single pictures
# Files of other programs, of which the tests of their readers make real ones: here files with the same contents.
INSTEAD = [("beam.frd", "beam.vtk"), ("disk_out.ex2", "disk_out.vtk"), ("run.exo", "run.pvd"), ("big.ply", "big_.ply")]
SMALLER_STUDY = {"size": [40, 30], "resolution": [4, 6], "places": 500, "max_levels": 2, "sheets": [20, 30], "tolerance": None}


def write_grid(path, cells, fields, low=(-1, -1, -1), high=(1, 1, 1)):
    """A box of cubes with the values of functions at its points, as a legacy file of VTK."""
    n = cells + 1
    at = [[low[d] + (high[d] - low[d]) * i / cells for i in range(n)] for d in range(3)]
    points = [(x, y, z) for z in at[2] for y in at[1] for x in at[0]]
    around = [0, 1, 1 + n, n, n * n, 1 + n * n, 1 + n + n * n, n + n * n]
    corners = [[x + n * (y + n * z) + k for k in around] for z in range(cells) for y in range(cells) for x in range(cells)]
    lines = ["# vtk DataFile Version 3.0", "a box", "ASCII", "DATASET UNSTRUCTURED_GRID", f"POINTS {len(points)} double"]
    lines += [" ".join(map(repr, point)) for point in points]
    lines += [f"CELLS {len(corners)} {9 * len(corners)}", *(" ".join(map(str, [8, *cell])) for cell in corners)]
    lines += [f"CELL_TYPES {len(corners)}", "12 " * len(corners), f"POINT_DATA {len(points)}", f"FIELD fields {len(fields)}"]
    for name, value in fields.items():
        rows = [value(*point) if isinstance(value(*point), tuple) else (value(*point),) for point in points]
        lines += [f"{name} {len(rows[0])} {len(rows)} double", *(" ".join(map(repr, map(float, row))) for row in rows)]
    path.write_text("\n".join(lines) + "\n")


FIELDS = {"Temp": lambda x, y, z: 350 + 80 * x + 20 * z, "Pres": lambda x, y, z: 10 + x * y, "V": lambda x, y, z: (1, y, 0)}
SOLID = {"T": lambda x, y, z: 600 + 250 * x, "STRESS": lambda x, y, z: (0, 0, 400 * x, 0, 30, 0), "DISP": lambda x, y, z: (.01 * z, 0, 0)}


class Files:
    """What readers have, made where a page names it."""

    def __init__(self, folder):
        self.folder = folder

    def command(self, *words):
        done = subvol(*words, folder=self.folder)
        assert done.code == 0, f"{words}: {done.err}"

    def mesh(self, name, cells=2, fields=FIELDS, **box):
        """A file of any format that `subdivide` writes, or .vtk."""
        write_grid(self.folder / "made.vtk", cells, fields, **box)
        if name.endswith(".vtk"):
            (self.folder / "made.vtk").rename(self.folder / name)
        else:
            self.command("subdivide", "made.vtk", "-o", name, "--levels", 0)

    def surface(self, name, *words):
        self.command("surface", "model:ball:2", "-o", name, "--boundary", *words)

    def series(self, pattern, count=3):
        for k in range(1, count + 1):
            self.mesh(pattern.replace("#" * pattern.count("#"), str(k).zfill(pattern.count("#"))), low=(-1 + .1 * k, -1, -1))

    def pvd(self, name, count=10):
        entries = ""
        for k in range(count):
            self.mesh(f"{name}{k}.vtu", low=(-1 + .1 * k, -1, -1))
            entries += f'<DataSet timestep="{k}" file="{name}{k}.vtu"/>'
        (self.folder / name).write_text(f'<VTKFile type="Collection" version="0.1"><Collection>{entries}</Collection></VTKFile>')

    def fog(self, name):
        self.command("vdb", "model:ball:4", "-o", name, "--resolution", 16, "--density", "1 - .5*(x*x + y*y + z*z)")

    def case(self, folder, inlet="inlet", outlet="outlet"):
        boundary = foam("boundary", "polyBoundaryMesh", f"""3
(
    {inlet} {{ type patch; nFaces 1; startFace 2; }}
    {outlet} {{ type patch; nFaces 1; startFace 3; }}
    walls {{ type wall; nFaces 12; startFace 4; }}
)""")
        write_foam(folder, boundary)
        (folder / "0" / "p").write_text(foam("p", "volScalarField", "dimensions [0 2 -2 0 0 0 0];\n"
                                             "internalField nonuniform List<scalar> 3(1 2 4);\nboundaryField {}"))

    def bolts(self):
        (self.folder / "bolts.csv").write_text("x,y,z\n0,0,0\n0.2,0.1,-0.3\n")


def approximate(files):
    files.mesh("coarse.vtu")
    files.mesh("block.vtu")
    files.surface("scan.stl")
    files.surface("statue.stl")
    files.surface("statue.obj")
    files.surface("skin.stl")
    files.surface("bone.stl", "--warp", "vector(-.4*x,-.4*y,-.4*z)")
    labels = [1 if x < 8 else 2 for z in range(12) for y in range(12) for x in range(16)]
    (files.folder / "scan.nrrd").write_text("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 16 12 12\nencoding: ascii\n\n" + " ".join(map(str, labels)))
    files.fog("smoke.vdb")
    files.case(files.folder)
    (files.folder / "case.foam").touch()
    for k in range(1, 4):
        files.fog(f"smoke_{k:04}.vdb")
        (files.folder / f"measured_{k:04}.csv").write_text(
            "x,y,z,T\n" + "".join(f"{x},{y},{z},{x + k}\n" for x in (-.9, 0, .9) for y in (-.9, 0, .9) for z in (-.9, 0, .9)))


def cookbook(files):
    files.surface("nut.stl")
    files.surface("bolt.stl", "--warp", "vector(-.4*x,-.4*y,-.4*z)")
    files.mesh("fire.vtu", fields={"soot": lambda x, y, z: .01 + .01 * x, "Temp": FIELDS["Temp"], "V": FIELDS["V"]}, high=(60, 60, 60))
    files.series("run_####.vtu")
    files.pvd("run.pvd")
    files.mesh("part.vtu")
    for name in ("first.vdb", "second.vdb"):
        files.fog(name)


def folds(files):
    files.command("model", "ball", "--resolution", 4, "-o", "ball.vtu")  # with a point pushed through its cell
    (files.folder / "fold.json").write_text('[{"select": {"ball": [0, 0, 0.5, 0.3]}}, {"move": [0, 0, -0.8]}, {"save_mesh": "part.vtu"}]')
    files.command("view", "ball.vtu", "--script", "fold.json")
    files.pvd("run.pvd")


def formats(files):
    files.series("run_####.vtu")
    files.mesh("rest.vtu")
    files.mesh("bent.vtu", high=(1.2, 1, 1))


def lod(files):
    files.mesh("part.vtu")
    files.mesh("big.vtu", 4)
    files.command("points", "model:ball:4", "-o", "points.ply")


def measure(files):
    for name in ("part.vtu", "run1.vtu", "run2.vtu"):
        files.mesh(name)
    files.pvd("run.pvd")
    files.bolts()


def page(files):
    files.mesh("part.vtu")
    files.mesh("disk.vtu")
    files.pvd("run.pvd")


def pictures(files):
    files.mesh("run.vtu", fields={"U": lambda x, y, z: (0, .1 * x, 1)}, low=(-9, -9, -9), high=(9, 9, 9))
    files.mesh("part.vtu")
    files.command("vdb", "part.vtu", "-o", "part.vdb", "--resolution", 16)
    files.bolts()


def python(files):
    files.mesh("part.vtk", fields=SOLID)
    (files.folder / "build/release").mkdir(parents=True)
    (files.folder / "build/release/python").symlink_to(MODULES)


def quantities(files):
    for name, fields in (("beam.vtk", SOLID), ("disk_out.vtk", FIELDS)):
        files.mesh(name, fields=fields, low=(0, 0, 0))
    files.case(files.folder / "case")


def readme(files):
    files.mesh("part.vtk")


def scale(files):
    files.mesh("big.vtu", 4)
    files.mesh("piece.vtu")
    arrays = "".join(f'<PDataArray type="Float64" Name="{name}" NumberOfComponents="{count}"/>' for name, count in (("Temp", 1), ("Pres", 1), ("V", 3)))
    (files.folder / "run.pvtu").write_text(
        '<VTKFile type="PUnstructuredGrid" version="1.0"><PUnstructuredGrid><PPoints><PDataArray type="Float64" NumberOfComponents="3"/></PPoints>'
        f'<PPointData>{arrays}</PPointData><Piece Source="piece.vtu"/></PUnstructuredGrid></VTKFile>')


def shares(files):
    files.mesh("part.vtu")
    files.mesh("run.vtu")
    files.mesh("big.vtu", 4)


def studies(files):
    files.mesh("part.vtu")
    files.mesh("lox1.vtk", 1, {"StagnationEnergy": lambda x, y, z: 3 + x * y})
    files.command("subdivide", "lox1.vtk", "-o", "lox.vtu", "--levels", 2)


def view(files):
    (files.folder / "turn.json").write_text('[{"size": [40, 30]}, {"orbit": [30, 10]}]')


def wavelets(files):
    files.mesh("coarse.vtk", 1, {"T": lambda x, y, z: x + y * z})
    files.command("subdivide", "coarse.vtk", "-o", "fine.vtu", "--levels", 2)
    files.mesh("disk_out.vtu")
    files.case(files.folder)
    (files.folder / "sloshing.foam").touch()


PAGES = {"README.md": readme, **{f"docs/{make.__name__}.md": make for make in
                                 (approximate, cookbook, folds, formats, lod, measure, page, pictures, python, quantities, scale, shares, studies, view,
                                  wavelets)}}


def smaller(text):
    for given, instead in SMALLER:
        text = re.sub(given, instead, text, flags=re.M)
    for given, instead in INSTEAD:
        text = text.replace(given, instead)
    return text


def smaller_study(part):
    """The same keys with smaller numbers, and of lists of numbers the first two."""
    if isinstance(part, list):
        return [smaller_study(one) for one in (part[:2] if all(isinstance(one, (int, float)) for one in part) else part)]
    if not isinstance(part, dict):
        return part
    made = {key: smaller_study(value) for key, value in part.items()}
    for key, value in SMALLER_STUDY.items():
        if value is not None and key in made:
            made[key] = value[:len(made[key])] if isinstance(made[key], list) else value[0] if isinstance(value, list) else value
    made.pop("demands", None)  # of sizes that are not these
    return made


def missing(needs):
    """Programs and modules of a list that are not here."""
    def is_there(name):
        asked = [PYTHON or sys.executable, "-c", f"import {name}"]
        return shutil.which(name) or subprocess.run(asked, capture_output=True, env=environment()).returncode == 0
    return [name for name in re.split(r"[, ]+", needs) if not is_there(name)]


def environment():
    return os.environ | {"PYTHONPATH": MODULES, "SLURM_ARRAY_TASK_ID": "1", "SLURM_ARRAY_TASK_COUNT": "16", "SLURM_CPUS_PER_TASK": "2",
                         "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1"}


class Examples(InFolder):
    def setUp(self):
        super().setUp()
        # `check` ends with 1 where something folds, as it shall.
        programs = self.folder / ".programs"
        programs.mkdir()
        (programs / "subvol").write_text(f'#!/bin/sh\n"{COMMAND}" "$@"\ncode=$?\n[ "$1" = check ] && [ $code = 1 ] && exit 0\nexit $code\n')
        (programs / "subvol").chmod(0o755)
        self.environment = environment() | {"PATH": f"{programs}:{os.environ['PATH']}"}

    def run_program(self, block, words, text):
        done = subprocess.run(words, input=text, cwd=self.folder, env=self.environment, capture_output=True, text=True, timeout=HANGS_AFTER)
        self.assertEqual(done.returncode, 0, f"{block.place}:\n{text}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")

    def run_block(self, block):
        if block.language in ("sh", ""):
            self.run_program(block, ["bash", "-e"], smaller(block.text))
        elif block.language == "json":
            self.run_study(block)
        elif block.language == "python":
            if not PYTHON:
                return f"{block.place}: this build has no Python"
            self.run_program(block, [PYTHON, "-"], smaller_python(block.text))
        else:
            self.assertEqual(block.language, "cpp", f"{block.place}: a language that is not run needs a comment")
        return None

    def run_study(self, block):
        """As it is, up to the folder that cannot be made; then with smaller numbers."""
        name = json.loads(block.text)["name"]
        (self.folder / "study.json").write_text(block.text)
        refused = subvol("study", "study.json", "-o", "study.json", folder=self.folder)
        self.assertEqual((refused.code, refused.err.count("\n")), (2, 1), f"{block.place}: {refused.err}")
        self.assertNotIn("study.json: ", refused.err.removeprefix("subvol: study.json: "), f"{block.place}: {refused.err}")
        self.assertRegex(refused.err, "folder|directory", f"{block.place}: {refused.err}")
        (self.folder / "study.json").write_text(json.dumps(smaller_study(json.loads(block.text))))
        self.run_ok("study", "study.json", "-o", "out")
        self.assertTrue((self.folder / "out" / name / "results.csv").exists())

    def check(self, name):
        skipped = []
        blocks = blocks_of(TOP / name)
        if any(block.kind != "not run" for block in blocks) and name in PAGES:
            if PAGES[name] is not python or MODULES:
                PAGES[name](Files(self.folder))
        for block in blocks:
            if block.kind == "not run":
                continue
            lacks = missing(block.note) if block.kind == "needs" else []
            reason = f"{block.place}: there is no {', '.join(lacks)}" if lacks else self.run_block(block)
            if reason:
                skipped.append(reason)
        for reason in skipped:
            print(f"skipped: {reason}", file=sys.stderr)


def smaller_python(text):
    text = re.sub(r"resolution=\d+", "resolution=16", text)
    for given, instead in INSTEAD:
        text = text.replace(given, instead)
    return text


def add_tests():
    for document in sorted(DOCUMENTS):
        name = str(document.relative_to(TOP))
        if name in WALKS or not blocks_of(document):  # documents_test.py walks through those, and compares the pictures
            continue
        test = "test_" + re.sub(r"\W", "_", name.removesuffix(".md"))
        setattr(Examples, test, lambda self, name=name: self.check(name))


add_tests()


class Marks(unittest.TestCase):
    def test_every_fence_is_seen(self):
        for document in DOCUMENTS:
            fences = len(re.findall(r"^\s*```", document.read_text(), re.M))
            self.assertEqual(fences, 2 * len(blocks_of(document)), f"{document}: a block that is not at the start of a line, or not closed")

    def test_most_blocks_run(self):
        marked = [block.place for block in all_blocks() if block.kind == "not run"]
        self.assertLess(len(marked), len(all_blocks()) / 4, marked)
        for block in all_blocks():
            self.assertTrue(block.kind != "not run" or len(block.note) > 10, f"{block.place}: why?")


@unittest.skipUnless("SUBVOL_COMPILER" in os.environ, "no compiler is named by SUBVOL_COMPILER")
class Code(documents_test.CodeInDocuments):
    test_the_examples_of_the_table_compile = None  # in documents_test.py

    def test_the_blocks_of_all_pages_compile(self):
        functions = ""
        for number, block in enumerate(block for block in all_blocks() if block.language == "cpp"):
            lines = [line for line in block.text.splitlines() if not line.startswith("#include")]
            given = block.note if block.kind == "with" else ""
            functions += f"// {block.place}\nauto block{number} = []({given}) {{\n" + "\n".join(lines) + "\n};\n"
        self.assertGreater(functions.count("auto block"), 4)
        self.compile(functions)


if __name__ == "__main__":
    unittest.main()
