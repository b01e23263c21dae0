# SPDX-License-Identifier: Apache-2.0
"""Patches of the boundary and sets of cells: read from the files that have them, measured, cut out."""

import csv
import math
import os
import struct
import subprocess
import unittest

from command import COMMAND, InFolder, subvol
from quantities_test import write_beam

# A bar of 3 x 1 x 1 unit cubes along x.
POINTS = [(x, y, z) for z in range(2) for y in range(2) for x in range(4)]
NUMBER = {p: i for i, p in enumerate(POINTS)}
AROUND = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
CELLS = [[NUMBER[x + i, j, k] for i, j, k in AROUND] for x in range(3)]
LEFT = [NUMBER[p] for p in ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0))]
RIGHT = [NUMBER[p] for p in ((3, 0, 0), (3, 1, 0), (3, 1, 1), (3, 0, 1))]


def foam(name, kind, text):
    return f"FoamFile\n{{\n version 2.0;\n format ascii;\n class {kind};\n object {name};\n}}\n{text}\n"


def write_foam(folder, boundary=None, flow=(2, 0, 0)):
    """The bar as a case: the flow U is the same in all cells."""
    sides = [(0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7)]
    inner = [([CELLS[c][k] for k in sides[1]], c) for c in range(2)]
    outer = {"left": [], "right": [], "walls": []}
    for c, cell in enumerate(CELLS):
        for s, corners in enumerate(sides):
            if (s == 1 and c < 2) or (s == 0 and c > 0):
                continue
            outer["left" if s == 0 else "right" if s == 1 else "walls"].append(([cell[k] for k in corners], c))
    faces = inner + outer["left"] + outer["right"] + outer["walls"]
    mesh = folder / "constant" / "polyMesh"
    mesh.mkdir(parents=True)
    (mesh / "points").write_text(foam("points", "vectorField", f"{len(POINTS)}\n(" +
                                      " ".join(f"({x} {y} {z})" for x, y, z in POINTS) + ")"))
    (mesh / "faces").write_text(foam("faces", "faceList", f"{len(faces)}\n(" +
                                     " ".join(f"4({' '.join(map(str, f))})" for f, _ in faces) + ")"))
    (mesh / "owner").write_text(foam("owner", "labelList", f"{len(faces)}({' '.join(str(c) for _, c in faces)})"))
    (mesh / "neighbour").write_text(foam("neighbour", "labelList", "2(1 2)"))
    (mesh / "boundary").write_text(boundary or foam("boundary", "polyBoundaryMesh", """3
(
    left { type patch; nFaces 1; startFace 2; }
    right { type patch; inGroups 1(out); nFaces 1; startFace 3; }
    walls { type wall; nFaces 12; startFace 4; }
)"""))
    (mesh / "cellZones").write_text(foam("cellZones", "regIOobject", """1
(
    middle { type cellZone; cellLabels List<label> 1(1); }
)"""))
    (folder / "0").mkdir()
    (folder / "0" / "U").write_text(foam("U", "volVectorField", f"dimensions [0 1 -1 0 0 0 0];\n"
                                         f"internalField uniform ({flow[0]} {flow[1]} {flow[2]});\nboundaryField {{}}"))


INP = """*NODE
""" + "\n".join(f"{i + 1}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(POINTS)) + """
*ELEMENT, TYPE=C3D8, ELSET=all
""" + "\n".join(f"{c + 1}, " + ", ".join(str(p + 1) for p in cell) for c, cell in enumerate(CELLS)) + """
*ELSET, ELSET=ends
1, 3
*SURFACE, NAME=left, TYPE=ELEMENT
1, S6
*SURFACE, NAME=right
3, S4
*SURFACE, NAME=tips
ends, S4
1, S6
*SURFACE, NAME=free
ends
*SURFACE, NAME=inside
1, S4
*SURFACE, NAME=nodes, TYPE=NODE
1,
"""

MSH2 = f"""$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
2 1 "left"
2 2 "right"
3 7 "bar"
$EndPhysicalNames
$Nodes
{len(POINTS)}
""" + "\n".join(f"{i + 1} {x} {y} {z}" for i, (x, y, z) in enumerate(POINTS)) + """
$EndNodes
$Elements
6
1 3 2 1 1 """ + " ".join(str(p + 1) for p in LEFT) + """
2 3 2 2 2 """ + " ".join(str(p + 1) for p in RIGHT) + """
3 3 2 0 3 1 2 6 5
""" + "\n".join(f"{c + 4} 5 2 7 4 " + " ".join(str(p + 1) for p in cell) for c, cell in enumerate(CELLS)) + """
$EndElements
"""

MSH4 = f"""$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
2 1 "left"
3 7 "bar"
$EndPhysicalNames
$Entities
0 0 2 1
1 0 0 0 0 1 1 1 1 0
2 3 0 0 3 1 1 1 5 0
1 0 0 0 3 1 1 1 7 0
$EndEntities
$Nodes
1 {len(POINTS)} 1 {len(POINTS)}
3 1 0 {len(POINTS)}
""" + "\n".join(str(i + 1) for i in range(len(POINTS))) + "\n" + "\n".join(f"{x} {y} {z}" for x, y, z in POINTS) + """
$EndNodes
$Elements
3 5 1 5
2 1 3 1
1 """ + " ".join(str(p + 1) for p in LEFT) + """
2 2 3 1
2 """ + " ".join(str(p + 1) for p in RIGHT) + """
3 1 5 3
""" + "\n".join(f"{c + 3} " + " ".join(str(p + 1) for p in cell) for c, cell in enumerate(CELLS)) + """
$EndElements
"""


def netcdf(dimensions, variables):
    """A classic netCDF file: dimensions {name: length}, variables [(name, dimensions, type, values)] of ints, reals, texts."""
    def name(text):
        return struct.pack(">i", len(text)) + text.encode() + b"\0" * (-len(text) % 4)
    order = list(dimensions)
    kinds = {"c": (2, 1), "i": (4, 4), "d": (6, 8)}
    data = []
    for _, _, kind, values in variables:
        raw = values if kind == "c" else struct.pack(f">{len(values)}{kind}", *values)
        data.append(raw + b"\0" * (-len(raw) % 4))
    def header(first):
        text = b"CDF\1" + struct.pack(">i", 0) + struct.pack(">ii", 10, len(order))
        for dimension in order:
            text += name(dimension) + struct.pack(">i", dimensions[dimension])
        text += struct.pack(">ii", 0, 0) + struct.pack(">ii", 11, len(variables))
        for (variable, over, kind, _), raw in zip(variables, data):
            text += name(variable) + struct.pack(">i", len(over))
            text += b"".join(struct.pack(">i", order.index(d)) for d in over)
            if variable.startswith("connect"):
                text += struct.pack(">ii", 12, 1) + name("elem_type") + struct.pack(">ii", 2, 4) + b"HEX8"
            else:
                text += struct.pack(">ii", 0, 0)
            text += struct.pack(">iii", kinds[kind][0], len(raw), first)
            first += len(raw)
        return text
    return header(len(header(0))) + b"".join(data)


def exodus():
    def names(*texts):
        return b"".join(text.encode().ljust(8, b"\0") for text in texts)
    return netcdf({"num_dim": 3, "num_nodes": len(POINTS), "num_elem": 3, "num_el_blk": 1, "num_el_in_blk1": 3,
                   "num_nod_per_el1": 8, "num_side_sets": 3, "num_side_ss1": 1, "num_side_ss2": 1, "num_side_ss3": 2,
                   "num_elem_sets": 1, "num_ele_els1": 1, "len": 8},
                  [("coordx", ["num_nodes"], "d", [p[0] for p in POINTS]), ("coordy", ["num_nodes"], "d", [p[1] for p in POINTS]),
                   ("coordz", ["num_nodes"], "d", [p[2] for p in POINTS]),
                   ("connect1", ["num_el_in_blk1", "num_nod_per_el1"], "i", [p + 1 for cell in CELLS for p in cell]),
                   ("ss_names", ["num_side_sets", "len"], "c", names("left", "", "between")),
                   ("ss_prop1", ["num_side_sets"], "i", [4, 9, 11]),
                   ("elem_ss1", ["num_side_ss1"], "i", [1]), ("side_ss1", ["num_side_ss1"], "i", [4]),
                   ("elem_ss2", ["num_side_ss2"], "i", [3]), ("side_ss2", ["num_side_ss2"], "i", [2]),
                   ("elem_ss3", ["num_side_ss3"], "i", [1, 2]), ("side_ss3", ["num_side_ss3"], "i", [2, 4]),
                   ("els_names", ["num_elem_sets", "len"], "c", names("one")),
                   ("elem_els1", ["num_ele_els1"], "i", [2])])


class Patches(InFolder):
    def patches(self, file, *more):
        found = self.run_ok("info", file, "--json", *more).json()
        return ({p["name"]: p["faces"] for p in found["patches"]}, {s["name"]: s["cells"] for s in found["sets"]})

    def refused(self, words, *arguments):
        done = subvol(*arguments, folder=self.folder)
        self.assertEqual(done.code, 2, done.err)
        for word in words:
            self.assertIn(word, done.err)

    def centre_x(self, file, patch):
        """The mean of x over a patch tells which side it is."""
        found = self.run_ok("probe", file, "--patch", patch, "--density", "x", "--json").json()
        return found["patches"][0]["fields"][0]["mean"]

    def test_openfoam(self):
        write_foam(self.folder / "case")
        self.assertEqual(self.patches("case"), ({"left": 1, "right": 1, "walls": 12}, {"middle": 1}))
        self.assertIn("patches", self.run_ok("info", "case").err + self.run_ok("info", "case").out)
        self.assertAlmostEqual(self.centre_x("case", "left"), 0, 9)
        self.assertAlmostEqual(self.centre_x("case", "right"), 3, 9)
        found = self.run_ok("probe", "case", "--patch", "all", "--flux", "U", "--json").json()
        flows = {p["name"]: p["flux"] for p in found["patches"]}
        self.assertAlmostEqual(flows["left"], -2 * found["patches"][0]["area"], 9)
        self.assertAlmostEqual(flows["right"], -flows["left"], 9)
        self.assertAlmostEqual(found["flux_sum"], 0, 9)

    def test_mesh_files_keep_them(self):
        write_foam(self.folder / "case")
        (self.folder / "a.inp").write_text(INP)
        for name, kinds in (("case", (3, 1)), ("a.inp", (4, 2))):
            given = self.patches(name)
            self.assertEqual(tuple(map(len, given)), kinds)
            for end in ".vtu", ".vtkhdf":
                for words in (["check", name, "--mend"], ["approximate", "case", "--onto", name],
                              ["subdivide", name, "--levels", "0"], ["subdivide", name], ["subdivide", name, "--levels", "2"]):
                    with self.subTest(words + [end]):
                        done = self.run_ok(*words, "-o", "b" + end, "--json").json()
                        self.assertNotIn("not written", str(done.get("warnings")))
                        levels = 0 if words[0] != "subdivide" else int(words[3]) if len(words) > 3 else 1
                        faces, cells = self.patches("b" + end)
                        self.assertEqual(faces, {patch: 4 ** levels * count for patch, count in given[0].items()})
                        self.assertEqual(cells, {part: 8 ** levels * count for part, count in given[1].items()})
                        self.assertAlmostEqual(self.centre_x("b" + end, "left"), 0, 9)
                        self.assertAlmostEqual(self.centre_x("b" + end, "right"), 3, 9)

    def test_refined_control_meshes_keep_them(self):
        """Sheets of cells are split where a field bends: patches and sets are where they were."""
        (self.folder / "a.inp").write_text(INP)
        rows = [(x / 8, y / 8, z / 8, math.exp(-(x / 8) ** 2)) for x in range(25) for y in range(9) for z in range(9)]
        (self.folder / "bent.csv").write_text("x,y,z,T\n" + "".join(f"{x},{y},{z},{t}\n" for x, y, z, t in rows))
        done = self.run_ok("approximate", "bent.csv", "--onto", "a.inp", "-o", "b.vtu", "--refine", "2", "--tolerance", "1e-3",
                           "--json").json()
        self.assertEqual(done["refined"], 2)
        self.assertNotEqual(done["cells"], 3 * 64)  # split along x more often than across it
        linear = ("--scheme", "linear", "--density", "x", "--json")
        # The sizes of cells change step by step, so the ends of the middle cell, where "free" and "ends" end, move a little.
        for patch, delta in ("left", 1e-9), ("right", 1e-9), ("tips", 1e-9), ("free", .2):
            before, after = (self.run_ok("probe", file, "--patch", patch, *linear).json()["patches"][0] for file in ("a.inp", "b.vtu"))
            self.assertAlmostEqual(before["area"], after["area"], delta=delta)
            self.assertAlmostEqual(before["fields"][0]["mean"], after["fields"][0]["mean"], delta=delta)
        for part, volume, delta in ("ends", 2, .05), ("all", 3, 1e-9):
            found = self.run_ok("probe", "b.vtu", "--stats", "--only", f"set:{part}", *linear).json()["stats"]["whole"]
            self.assertAlmostEqual(found["volume"], volume, delta=delta)

    def test_mesh_files_that_cannot_hold_them(self):
        write_foam(self.folder / "case")
        lost = "3 patches (left, right, walls) and 1 set of cells (middle) not written"
        for words in ["-o", "a.mesh"], ["-o", "a.vtu", "--scheme", "tetoct"]:
            with self.subTest(words):
                warnings = self.run_ok("subdivide", "case", *words, "--json").json()["warnings"]
                self.assertEqual(len([w for w in warnings if lost in w]), 1, warnings)

    def test_files_whose_cells_were_changed(self):
        """Patches name points and are ignored; sets are arrays at the cells, which programs take along."""
        (self.folder / "a.inp").write_text(INP)
        self.run_ok("subdivide", "a.inp", "--levels", "0", "-o", "a.vtu")
        self.run_ok("subdivide", "a.inp", "--only", "box:-1,-1,-1,2,2,2", "--levels", "0", "-o", "less.vtu")
        text, less = ((self.folder / name).read_text() for name in ("a.vtu", "less.vtu"))
        fields = text[text.index("<FieldData>"):text.index("</FieldData>")]
        rest = less[less.index("</FieldData>"):]
        (self.folder / "less.vtu").write_text(less[:less.index("<FieldData>")] + fields + rest)
        self.assertEqual(self.patches("less.vtu"), ({}, {"all": 2, "ends": 1}))
        self.assertIn("4 patches left out (\"left\", \"right\", \"tips\", \"free\"): it is of another mesh",
                      self.run_ok("info", "less.vtu").err)

    def test_openfoam_that_is_wrong(self):
        for number, entry in enumerate(("left { nFaces 99; startFace 2; }", "left { nFaces 1; startFace -2; }", "left { nFaces",
                                        "left { nFaces 9999999999999999999; startFace 1; }", "left { nFaces 1 { ( }")):
            write_foam(self.folder / f"c{number}", foam("boundary", "polyBoundaryMesh", f"1\n(\n{entry}\n)"))
            done = self.run_ok("info", f"c{number}")
            self.assertIn('"boundary" ignored', done.err)

    def test_surfaces_of_abaqus(self):
        (self.folder / "a.inp").write_text(INP)
        patches, sets = self.patches("a.inp")
        self.assertEqual(patches, {"left": 1, "right": 1, "tips": 2, "free": 10})
        self.assertEqual(sets, {"all": 3, "ends": 2})
        self.assertAlmostEqual(self.centre_x("a.inp", "left"), 0, 9)
        self.assertAlmostEqual(self.centre_x("a.inp", "right"), 3, 9)
        self.assertIn("inside", self.run_ok("info", "a.inp").err)

    def test_groups_of_gmsh(self):
        (self.folder / "a.msh").write_text(MSH2)
        self.assertEqual(self.patches("a.msh"), ({"left": 1, "right": 1}, {"bar": 3}))
        self.assertAlmostEqual(self.centre_x("a.msh", "right"), 3, 9)
        (self.folder / "b.msh").write_text(MSH4)
        self.assertEqual(self.patches("b.msh"), ({"left": 1, "group 5": 1}, {"bar": 3}))
        self.assertAlmostEqual(self.centre_x("b.msh", "left"), 0, 9)

    def test_side_sets_of_exodus(self):
        (self.folder / "a.exo").write_bytes(exodus())
        self.assertEqual(self.patches("a.exo"), ({"left": 1, "side set 9": 1}, {"block 1": 3, "one": 1}))
        self.assertAlmostEqual(self.centre_x("a.exo", "left"), 0, 9)
        self.assertAlmostEqual(self.centre_x("a.exo", "side set 9"), 3, 9)
        self.assertIn("between", self.run_ok("info", "a.exo").err)

    def test_prisms_are_split_with_their_patches(self):
        lines = INP.split("*ELEMENT")[0] + """*ELEMENT, TYPE=C3D6
1, 1, 2, 5, 9, 10, 13
2, 2, 6, 5, 10, 14, 13
*SURFACE, NAME=bottom
1, S1
2, S1
*SURFACE, NAME=front
1, S3
"""
        (self.folder / "a.inp").write_text(lines)
        patches, _ = self.patches("a.inp")
        self.assertEqual(patches, {"bottom": 6, "front": 4})
        found = self.run_ok("probe", "a.inp", "--patch", "bottom", "--patch", "front", "--scheme", "linear", "--density", "y+z",
                            "--json").json()["patches"]
        self.assertAlmostEqual(found[0]["area"], 1, 9)
        self.assertAlmostEqual(found[0]["fields"][0]["mean"], .5, 9)
        self.assertAlmostEqual(found[1]["area"], 1, 9)
        self.assertAlmostEqual(found[1]["normal"][1], -1, 9)

    def test_curved_cells_keep_their_patches(self):
        middle = [(a, b) for a, b in ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))]
        corners = [(i, j, k) for i, j, k in AROUND]
        nodes = corners + [tuple((u + v) / 2 for u, v in zip(corners[a], corners[b])) for a, b in middle]
        nodes = [(x, y, z + .3 * x * (1 - x)) for x, y, z in nodes]
        (self.folder / "a.inp").write_text("*NODE\n" + "\n".join(f"{i + 1}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(nodes)) +
                                           "\n*ELEMENT, TYPE=C3D20\n1, " + ", ".join(str(k + 1) for k in range(20)) +
                                           "\n*SURFACE, NAME=top\n1, S2\n*SURFACE, NAME=side\n1, S6\n")
        patches, _ = self.patches("a.inp")
        self.assertGreater(patches["top"], 1)
        found = self.run_ok("probe", "a.inp", "--patch", "top", "--patch", "side", "--density", "x", "--json").json()["patches"]
        slopes = [math.hypot(1, .3 * (1 - 2 * (k + .5) / 1000)) for k in range(1000)]
        self.assertAlmostEqual(found[0]["area"], sum(slopes) / 1000, 3)  # of the parabola
        self.assertAlmostEqual(found[1]["fields"][0]["mean"], 0, 9)

    def test_means_and_flows_agree_with_formulas(self):
        (self.folder / "a.inp").write_text(INP)
        found = self.run_ok("probe", "a.inp", "--patch", "free", "--patch", "left", "--density", "x+2*y", "--flux",
                            "grad(density)", "--scheme", "linear", "--json").json()
        free, left = found["patches"]
        self.assertAlmostEqual(free["area"], 10, 9)
        self.assertAlmostEqual(free["flux"], 0, 9)
        self.assertAlmostEqual(left["flux"], -1, 9)
        self.assertAlmostEqual(left["fields"][0]["mean"], 1, 9)
        self.assertEqual((left["fields"][0]["min"], left["fields"][0]["max"]), (0, 2))
        field = left["fields"][0]
        for name, place in (("min", [0, 0]), ("max", [0, 1]), ("file_min", [0, 0]), ("file_max", [0, 1])):
            self.assertEqual([round(x, 9) for x in field[name + "_at"][:2]], place)  # x + 2y on x = 0: the same along z
        self.assertEqual((field["file_min"], field["file_max"], field["min_cell"]), (0, 2, 0))
        said = self.run_ok("probe", "a.inp", "--patch", "left", "--density", "x+2*y").out
        self.assertRegex(said, r"max 2 at 0,1,[\d.]+ .*· file 2 at point \d+")
        self.assertAlmostEqual(found["flux_sum"], -1, 9)

    def test_sets_choose_cells(self):
        (self.folder / "a.inp").write_text(INP)
        linear = ("--density", "x", "--scheme", "linear", "--json")
        volume = lambda *only: self.run_ok("probe", "a.inp", "--stats", *linear, *only).json()["stats"]["whole"]["volume"]
        self.assertAlmostEqual(volume("--only", "set:ends"), 2, 9)
        self.assertAlmostEqual(volume("--only", "set:ends,all"), 3, 9)
        self.assertAlmostEqual(volume("--only", "set:ends", "--only", "box:0,0,0,.5,1,1"), .5, 6)
        found = self.run_ok("probe", "a.inp", "--patch", "right", "--only", "set:ends", *linear).json()
        self.assertAlmostEqual(found["patches"][0]["area"], 1, 9)
        self.refused(["no set \"nowhere\"", "all, ends"], "probe", "a.inp", "--stats", "--only", "set:nowhere")

    def test_names_that_are_not_there(self):
        (self.folder / "a.inp").write_text(INP)
        for option in ["--sheets", "20"], ["--per-edge", "2"], ["--slice", "0,0,1,0,0,1"], ["--shadows"], ["--lod", "2"]:
            self.refused([option[0], "no volume is drawn"], "render", "a.inp", "-o", "d.png", "--patch", "left", *option)
        self.assertFalse((self.folder / "d.png").exists())
        self.refused(["no patch \"inlet\"", "left, right, tips, free"], "probe", "a.inp", "--patch", "inlet")
        self.refused(["no patch \"inlet\"", "left, right, tips, free"], "surface", "a.inp", "-o", "a.ply", "--patch", "inlet")
        self.refused(["has no patches"], "probe", "model:ball:2", "--patch", "all")
        self.refused(["--flux", "1 component"], "probe", "a.inp", "--patch", "left", "--density", "x", "--flux", "density")
        self.refused(["--flux", "--patch"], "probe", "a.inp", "--stats", "--flux", "x")
        self.refused(["--patch", "set:"], "probe", "a.inp", "--patch", "left", "--only", "box:0,0,0,1,1,1")

    def test_the_surface_of_a_patch(self):
        (self.folder / "a.inp").write_text(INP)
        whole = self.run_ok("surface", "a.inp", "-o", "a.ply", "--scheme", "linear", "--json").json()
        self.assertAlmostEqual(whole["area"], 14, 6)
        for names, area in ((["left"], 1), (["free"], 10), (["left", "right"], 2), (["all"], 10)):
            words = [word for name in names for word in ("--patch", name)]
            part = self.run_ok("surface", "a.inp", "-o", "b.ply", "--scheme", "linear", "--json", *words).json()
            self.assertAlmostEqual(part["area"], area, 6)

    def test_pictures_of_patches(self):
        (self.folder / "a.inp").write_text(INP)
        def picture(*words):
            return self.run_ok("render", "a.inp", "-o", "a.png", "--size", "48x32", "--density", "x", *words)
        said = self.run_ok("render", "a.inp", "-o", "a.png", "--size", "48x32", "--patch", "left", "--patch", "right", "--json")
        self.assertEqual(said.json()["field"], "patch")
        self.assertIn("1 left, 2 right", self.run_ok("render", "a.inp", "-o", "b.png", "--size", "48x32", "--patch", "left",
                                                     "--patch", "right").err)
        both = (self.folder / "a.png").read_bytes()
        self.run_ok("render", "a.inp", "-o", "c.png", "--size", "48x32", "--patch", "right", "--patch", "left")
        self.assertNotEqual(both, (self.folder / "c.png").read_bytes())  # the colours are the other way round
        self.assertEqual(picture("--patch", "left", "--json").json()["field"], "density")
        self.refused(["no patch \"inlet\"", "left, right, tips, free"], "render", "a.inp", "-o", "a.png", "--patch", "inlet")

    def test_hulls_of_sets(self):
        (self.folder / "a.inp").write_text(INP)
        found = self.run_ok("probe", "a.inp", "--patch", "set:ends", "--patch", "left", "--density", "x", "--flux", "grad(density)",
                            "--scheme", "linear", "--json").json()["patches"]
        self.assertEqual([(p["name"], p["faces"]) for p in found], [("ends", 12), ("left", 1)])  # the sides between cells, too
        self.assertAlmostEqual(found[0]["area"], 12, 6)
        self.assertAlmostEqual(found[0]["flux"], 0, 6)  # a closed surface
        self.run_ok("render", "a.inp", "-o", "a.png", "--size", "48x32", "--patch", "set:ends", "--legend", "a.svg")
        self.assertIn(">ends<", (self.folder / "a.svg").read_text())
        self.refused(["no set", "ends"], "probe", "a.inp", "--patch", "set:middle")

    def test_the_legend_names_patches(self):
        (self.folder / "a.inp").write_text(INP)
        def legend(*words):
            self.run_ok("render", "a.inp", "-o", "a.png", "--size", "96x64", "--legend", "a.svg", *words)
            return (self.folder / "a.svg").read_text()
        named = legend("--patch", "right", "--patch", "left")
        self.assertLess(named.index(">right<"), named.index(">left<"))
        self.assertNotIn("linearGradient", named)
        self.assertIn("linearGradient", legend("--patch", "right", "--density", "y"))
        self.run_ok("render", "a.inp", "-o", "b.png", "--size", "96x64", "--legend", "--patch", "all")

    def test_heat_through_a_pipe(self):
        """T = ln r in a quarter of a pipe: the same heat, pi/2 for a height of 1, flows through each cylinder."""
        def errors(n):
            points = [(r * math.cos(a), r * math.sin(a), z) for z in (0, 1) for a in (math.pi / 4 * j / n for j in range(2 * n + 1))
                      for r in (1 + i / n for i in range(n + 1))]
            at = lambda i, j, k: 1 + i + (n + 1) * (j + (2 * n + 1) * k)
            cells = [[at(i + a, j + b, k) for k in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))] for j in range(2 * n) for i in range(n)]
            lines = ["*NODE", *(f"{p + 1}, {x!r}, {y!r}, {z}" for p, (x, y, z) in enumerate(points)), "*ELEMENT, TYPE=C3D8, ELSET=all",
                     *(f"{c + 1}, " + ", ".join(map(str, cell)) for c, cell in enumerate(cells))]
            for name, column, side in ("inner", 0, "S6"), ("outer", n - 1, "S4"):
                lines += [f"*SURFACE, NAME={name}", *(f"{c + 1}, {side}" for c in range(column, len(cells), n))]
            (self.folder / "pipe.inp").write_text("\n".join(lines) + "\n")
            found = self.run_ok("probe", "pipe.inp", "--patch", "inner", "--patch", "outer", "--density", "ln(sqrt(x^2+y^2))",
                                "--flux", "grad(density)", "--json").json()
            inner, outer = (p["flux"] / (math.pi / 2) for p in found["patches"])
            return abs(inner + 1), abs(outer - 1)
        coarse, fine = errors(4), errors(8)
        for before, after in zip(coarse, fine):
            self.assertLess(after, .01)
            self.assertGreater(math.log2(before / after), 1.5)  # the order of the gradient at the boundary

    def test_a_table_over_steps(self):
        write_foam(self.folder / "case")
        later = self.folder / "case" / "0.5"
        later.mkdir()
        (later / "U").write_text((self.folder / "case" / "0" / "U").read_text().replace("(2 0 0)", "(4 0 0)"))
        self.run_ok("probe", "case", "--patch", "left", "--patch", "right", "--flux", "U", "--step", "all", "-o", "a.csv")
        rows = list(csv.DictReader((self.folder / "a.csv").read_text().splitlines()))
        self.assertEqual([row["of"] for row in rows], ["left", "right", "left", "right"])
        flows = [float(row["flow out"]) for row in rows]
        for flow, expected in zip(flows, (-1, 1, -2, 2)):
            self.assertAlmostEqual(flow / abs(flows[0]), expected, 6)
        self.run_ok("probe", "case", "--patch", "left", "--flux", "U", "--step", "all", "-o", "a.svg")
        self.assertIn("flow out", (self.folder / "a.svg").read_text())


    def test_units_of_openfoam(self):
        write_foam(self.folder / "case")
        zero = self.folder / "case" / "0"
        for name, dimensions in (("a", "[1 -1 -2 0 0 0 0]"), ("b", "[0 2 -2 0 0]"), ("c", "[0 0 0 0 0 0 0]"), ("d", "[0 0 0.5 -1 0 0 0]"),
                                 ("e", "[1 0 -3 -1 0 0 0]"), ("f", "[x 1"), ("g", "wrong")):
            (zero / name).write_text(foam(name, "volScalarField", f"dimensions {dimensions};\ninternalField uniform 1;\n"))
        fields = {f["name"]: f.get("unit") for f in self.run_ok("info", "case", "--json").json()["fields"]}
        self.assertEqual(fields["U"], "m/s")
        self.assertEqual([fields[name] for name in "abcde"], ["Pa", "m²/s²", None, "s^0.5/K", "kg/(s³ K)"])
        self.assertEqual([fields.get(name) for name in "fg"], [None, None])
        for field, unit in (("U.x", "U.x [m/s]"), ("a", "a [Pa]"), ("c", "c"), ("2*a", "2*a")):
            self.run_ok("render", "case", "-o", "a.png", "--field", field, "--legend", "a.svg", "--size", "32x32")
            self.assertIn(f">{unit}<", (self.folder / "a.svg").read_text())


class Values(InFolder):
    """What OpenFOAM has on patches: points there get it."""

    def case(self, name, boundary, flow=(2, 0, 0)):
        write_foam(self.folder / name, flow=flow)
        file = self.folder / name / "0" / "U"
        file.write_text(file.read_text().replace("boundaryField {}", f"boundaryField {{ {boundary} }}"))
        return name

    def flows(self, case, *more, use="meet"):
        found = self.run_ok("probe", case, "--patch", "all", "--flux", "U", "--patch-values", use, "--json", *more).json()
        return {p["name"]: p["flux"] / p["area"] for p in found["patches"]}

    def at_walls(self, case, *more, use="meet"):
        found = self.run_ok("probe", case, "--at", "1,0,.5", "--field", "U.x", "--patch-values", use, "--json", *more).json()
        return found["values"][0]["value"]

    def test_walls_rest_and_inlets_have_their_speed(self):
        for means in ((), ("--cell-values", "mean")):
            name = self.case("case" + str(len(means)), "left { type fixedValue; value uniform (3 0 0); } "
                             "right { type zeroGradient; } walls { type noSlip; }")
            flows = self.flows(name, *means)
            self.assertAlmostEqual(flows["left"], -3, 9)  # its own value also where it meets the walls
            self.assertAlmostEqual(flows["right"], 2, 9)  # says nothing: the cells decide, also where it meets the walls
            self.assertAlmostEqual(flows["walls"], 0, 9)
            self.assertAlmostEqual(self.at_walls(name, *means), 0, 9)
            self.assertAlmostEqual(self.at_walls(name, *means, use="normal"), 2, 9)  # along the wall the cells' means are kept
            self.assertAlmostEqual(self.at_walls(name, *means, use="ignore"), 2, 9)
            default = self.run_ok("probe", name, *means, "--at", "1,0,.5", "--field", "U.x", "--json").json()
            self.assertAlmostEqual(default["values"][0]["value"], 2, 9)
        self.assertAlmostEqual(self.at_walls(name, "--cell-values", "exact"), 2, 9)
        said = self.run_ok("info", name, "--json").json()
        self.assertTrue(any("points on patches" in warning for warning in said["warnings"]))

    def test_walls_let_nothing_through(self):
        """The cells flow towards a wall, and the outlet beside it says nothing."""
        name = self.case("case", "left { type zeroGradient; } right { type zeroGradient; } walls { type noSlip; }", (2, 1, .5))
        self.assertAlmostEqual(self.flows(name)["walls"], 0, 9)
        self.assertAlmostEqual(self.flows(name, use="normal")["walls"], 0, 9)
        slip = self.case("slip", "left { type zeroGradient; } right { type zeroGradient; } walls { type slip; }", (2, 1, .5))
        self.assertAlmostEqual(self.flows(slip)["walls"], 0, 9)
        self.assertAlmostEqual(self.at_walls(slip), 2, 9)

    def test_groups_patterns_and_names_of_values(self):
        """The last pattern that fits, before it a group, before that the name itself."""
        pattern = self.case("a", '"(left|rig.*)" { type fixedValue; value uniform (1 0 0); } ".*l.*" { type noSlip; } '
                                 'left { type fixedValue; value $internalField; }')
        self.assertAlmostEqual(self.flows(pattern)["left"], -2, 9)
        self.assertAlmostEqual(self.flows(pattern)["right"], 1, 9)
        self.assertAlmostEqual(self.at_walls(pattern), 0, 9)
        group = self.case("b", 'out { type fixedValue; value uniform (5 0 0); } "r.*" { type noSlip; }')
        self.assertAlmostEqual(self.flows(group)["right"], 5, 9)
        wild = self.case("c", '"(((((.*)+)+)+)+)+x" { type noSlip; } "(" { type noSlip; }')
        self.assertAlmostEqual(self.at_walls(wild), 2, 9)

    def test_values_that_say_nothing_about_the_field(self):
        for number, kind in enumerate(("zeroGradient", "nutkWallFunction", "cyclic", "empty")):
            name = self.case(f"c{number}", f"walls {{ type {kind}; value uniform (9 9 9); }}")
            self.assertAlmostEqual(self.at_walls(name), 2, 9)
        name = self.case("other", "walls { type anything; table ((0 1) (2 3)); code #{ a; } #}; d { e f; } value uniform (9 0 0); }")
        self.assertAlmostEqual(self.at_walls(name), 9, 9)

    def test_lists_of_values(self):
        values = " ".join(f"({k} 0 0)" for k in range(12))
        name = self.case("a", f"walls {{ type calculated; value nonuniform List<vector> 12({values}); }} "
                              "left { type fixedValue; value nonuniform List<vector> 1((4 0 0)); }")
        self.assertAlmostEqual(self.flows(name)["left"], -4, 9)
        found = self.run_ok("probe", name, "--patch", "walls", "--field", "U.x", "--patch-values", "meet", "--json").json()
        self.assertGreater(found["patches"][0]["fields"][0]["max"], 4)

    def test_what_is_wrong_is_left_out(self):
        for number, entry in enumerate(("left { type fixedValue; }", "left { type fixedValue; value uniform (1 2); }",
                                        "left { type fixedValue; value nonuniform List<vector> 2((1 0 0) (1 0 0)); }",
                                        "left { type fixedValue; value nonuniform List<vector> 999999999999((1 0 0)); }",
                                        "left { type fixedValue; value uniform (nan 0 0); }", "left { type", "left {", "left", "{",
                                        "left { type a; code #{ ", "left { a { b c }", "left { value $nowhere; }")):
            name = self.case(f"c{number}", entry)
            done = self.run_ok("probe", name, "--at", "1.5,.5,.5", "--field", "U.x", "--json")
            self.assertEqual(sum("boundaryField" in warning and "left out" in warning for warning in done.json()["warnings"]), 1, entry)
            self.assertAlmostEqual(done.json()["values"][0]["value"], 2, 9)


class Times(InFolder):
    def setUp(self):
        super().setUp()
        for k, bend in enumerate((0, .1, .2)):
            write_beam(self.folder / f"s{k}.vtk", bend)
        sets = "".join(f'<DataSet timestep="{t}" file="s{k}.vtk"/>' for k, t in enumerate((0, 1, 3)))
        (self.folder / "a.pvd").write_text(f'<VTKFile type="Collection"><Collection>{sets}</Collection></VTKFile>')

    def displacement(self, *more):
        return self.run_ok("probe", "a.pvd", "--at", "1,1,3", "--field", "D.x", "--json", *more).json()

    def test_a_time_between_steps(self):
        found = self.displacement("--time", "1.5", "--interpolate-time")
        self.assertAlmostEqual(found["values"][0]["value"], (.75 * .1 + .25 * .2) * 3, 9)
        self.assertAlmostEqual(found["time"], 1.5)
        self.assertAlmostEqual(self.displacement("--time", "1.5")["values"][0]["value"], .3, 9)
        self.assertAlmostEqual(self.displacement("--time", "1", "--interpolate-time")["values"][0]["value"], .3, 9)
        self.assertAlmostEqual(self.displacement("--time", "7", "--interpolate-time")["values"][0]["value"], .6, 9)
        self.assertNotEqual(subvol("probe", "a.pvd", "--at", "1,1,1", "--interpolate-time", folder=self.folder).code, 0)

    def test_one_factor_for_all_steps(self):
        def heights(*more):
            found = self.run_ok("probe", "a.pvd", "--stats", "--field", "x", "--step", "0-2", "--json", *more).json()
            return [step["stats"]["whole"]["fields"][0]["max"] for step in found["steps"]], found
        _, found = heights("--warp", "D*auto")
        factor = found["warp"]["factor"]
        self.assertAlmostEqual(factor * .2 * 6, .1 * math.sqrt(4 + 4 + 36), 6)  # of the last step, which moves most

    def test_a_film_of_a_bending_beam(self):
        """Three steps in one box and one range, each moved by its own displacement, with its time."""
        tools = self.folder / "tools"
        tools.mkdir()
        (tools / "ffmpeg").write_text('#!/bin/sh\nprintf "%s\\n" "$@" > arguments.txt\nfor last; do :; done\nexec cat > "${last#file:}"\n')
        (tools / "ffmpeg").chmod(0o755)
        words = ["render", "a.pvd", "--step", "all", "--size", "96x64", "--field", "T", "--warp", "D*3"]
        environment = dict(os.environ, PATH=f"{tools}:{os.environ['PATH']}")
        done = subprocess.run([COMMAND, *words, "-o", "a.mp4", "--time-label", "--duration", "6"], cwd=self.folder, env=environment,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        arguments = (self.folder / "arguments.txt").read_text().split("\n")
        self.assertEqual(float(arguments[arguments.index("-r") + 1]), .5)
        film, size = (self.folder / "a.mp4").read_bytes(), 96 * 64 * 3
        self.assertEqual(len(film), 3 * size)
        frames = [film[k * size:(k + 1) * size] for k in range(3)]
        self.assertEqual(len(set(frames)), 3)
        words[words.index("96x64")] = "96x46"  # the time has 18 rows: twice its letters of 9 pixels
        subprocess.run([COMMAND, *words, "-o", "b.mp4", "--duration", "6"], cwd=self.folder, env=environment, check=True, capture_output=True)
        plain, body = (self.folder / "b.mp4").read_bytes(), 96 * 46 * 3
        for k in range(3):  # the time stands above the body of every frame, and nowhere else
            above = frames[k][:size - body]
            ink = {i // 3 for i in range(len(above)) if above[i] != above[i % 3 - 3]}
            self.assertGreater(len(ink), 20)
            self.assertLess(max(i % 96 for i in ink), 60)
            self.assertEqual(frames[k][size - body:], plain[k * body:(k + 1) * body])

    def test_what_is_written_into_pictures(self):
        def picture(*more):
            self.run_ok("render", "a.pvd", "-o", "a.png", "--size", "96x64", "--field", "T", *more)
            return (self.folder / "a.png").read_bytes()
        plain, titled = picture("--time", "1"), picture("--time", "1", "--title", "A bar")
        timed, later = picture("--time", "1", "--time-label"), picture("--time", "3", "--time-label")
        self.assertEqual(len({plain, titled, timed, later}), 4)
        done = subvol("render", "s0.vtk", "-o", "a.png", "--time-label", folder=self.folder)
        self.assertEqual(done.code, 2)
        self.assertIn("--time-label", done.err)
        self.run_ok("render", "a.pvd", "-o", "a.png", "--size", "96x64", "--field", "T", "--warp", "D*3", "--legend", "a.svg")
        self.assertIn("moved by 3 × D", (self.folder / "a.svg").read_text())

    def test_a_grid_that_is_not_called_density_is_reported(self):
        said = self.run_ok("vdb", "s2.vtk", "-o", "a.vdb", "--field", "T", "--resolution", "8").err
        self.assertIn('"density=T"', said)
        self.assertNotIn("no grid is called", self.run_ok("vdb", "s2.vtk", "-o", "a.vdb", "--fields", "density=T", "--resolution",
                                                          "8").err)

    def test_quantities_at_rest(self):
        self.run_ok("surface", "s2.vtk", "-o", "a.vtp", "--color-field", "grad(T).z", "--warp", "D*3", "--json")
        rest = self.run_ok("vdb", "s2.vtk", "-o", "a.vdb", "--fields", "g=grad(T).z", "--resolution", "12", "--warp", "D*3",
                           "--json").json()
        grid = {g["name"]: g for g in rest["grids"]}["g"]
        self.assertAlmostEqual(grid["min"], .5, 4)
        self.assertAlmostEqual(grid["max"], .5, 4)


if __name__ == "__main__":
    unittest.main()
