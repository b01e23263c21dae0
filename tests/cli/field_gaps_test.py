# SPDX-License-Identifier: Apache-2.0
"""Fields that a file names and lacks, at all, at some nodes or at some steps: what needs no field works, and what is there is used."""

import csv
import math
import shutil
import unittest

from command import InFolder, subvol
from patches_test import CELLS, POINTS, netcdf, write_foam

# A bar of three unit cubes along z, and the nodes in the middle of their edges.
CORNERS = [(x, y, z) for z in range(4) for y in range(2) for x in range(2)]
AROUND = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 5), (2, 6), (3, 7), (4, 5), (5, 6), (6, 7), (7, 4)]


def bulged(x, y, z):
    """A place of the bar whose sides are curved: no cell is straight, and fields of the place are known."""
    return x + 0.1 * math.sin(math.pi * z / 3) * (2 * x - 1), y, z


def bar(curved):
    """The nodes and the elements of the bar."""
    nodes, cells = list(CORNERS), []
    for c in range(3):
        corners = [(x, y, z + c) for x, y, z in AROUND]
        cell = [nodes.index(p) for p in corners]
        for a, b in EDGES if curved else []:
            middle = tuple((p + q) / 2 for p, q in zip(corners[a], corners[b]))
            if middle not in nodes:
                nodes.append(middle)
            cell.append(nodes.index(middle))
        cells.append(cell)
    return [bulged(*p) for p in nodes] if curved else nodes, cells


def frd(nodes, cells, steps):
    """steps: for each a list of results (name, values by node)"""
    lines = ["    1C", f"    2C{'':18}{len(nodes):12}{'':37}1"]
    lines += [f" -1{n:10}" + "".join(f"{v:12.5E}" for v in p) for n, p in enumerate(nodes, 1)]
    lines += [" -3", f"    3C{'':18}{len(cells):12}{'':37}1"]
    for c, cell in enumerate(cells, 1):
        lines.append(f" -1{c:10}{4 if len(cell) > 8 else 1:5}    0    1")
        lines += [" -2" + "".join(f"{n + 1:10}" for n in cell[k:k + 10]) for k in range(0, len(cell), 10)]
    lines.append(" -3")
    for step, results in enumerate(steps, 1):
        for name, values in results:
            lines += [f"  100CL  101{step:12.5E}{len(values):12}{'':21}{step:4}           1", f" -4  {name:8}    2    1",
                      " -5  C           1    2    0    0", " -5  ALL         1    2    0    0    1ALL"]
            lines += [f" -1{n + 1:10}{v:12.5E}" for n, v in values.items()] + [" -3"]
    return "\n".join(lines + [" 9999", ""])


def heights(nodes, below=99):
    return {n: z for n, (_, _, z) in enumerate(nodes) if z <= below}


class MissingFileTest(InFolder):
    def setUp(self):
        super().setUp()
        points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
        (self.folder / "a.case").write_text("FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: a.geo\nVARIABLE\nscalar per node: T gone.scl\n")
        (self.folder / "a.geo").write_text("a\nb\nnode id off\nelement id off\npart\n         1\nbody\ncoordinates\n         8\n" + "".join(
            f"{p[a]:12.5e}\n" for a in range(3) for p in points) + "hexa8\n         1\n" + "".join(f"{n:10}" for n in range(1, 9)) + "\n")

    def test_what_needs_no_field_works_with_one_warning_that_names_the_variable_and_its_file(self):
        for words in (["info", "a.case"], ["check", "a.case"], ["surface", "a.case", "--boundary", "-o", "b.ply"],
                      ["vdb", "a.case", "--sdf", "--resolution", "8", "-o", "b.vdb"],
                      ["render", "a.case", "-o", "a.png", "--size", "32x32"], ["probe", "a.case", "--stats"],
                      ["subdivide", "a.case", "-o", "a.vtu"]):
            with self.subTest(words[0]):
                done = self.run_ok(*words)
                named = [line for line in done.err.splitlines() if "gone.scl" in line]
                self.assertEqual(len(named), 1, done.err)
                self.assertIn('field "T" left out: a.case, line 6: there is no file "gone.scl"', named[0])

    def test_what_needs_the_field_says_that_it_is_not_there(self):
        for words in (["probe", "a.case", "--stats", "--field", "T"], ["probe", "a.case", "--at", ".5,.5,.5", "--field", "2*T+1"],
                      ["render", "a.case", "-o", "a.png", "--color-field", "T"], ["vdb", "a.case", "-o", "a.vdb", "--fields", "d=abs(T)"],
                      ["subdivide", "a.case", "-o", "a.vtu", "--field", "T"]):
            with self.subTest(" ".join(words)):
                done = subvol(*words, folder=self.folder)
                self.assertEqual(done.code, 2)
                self.assertIn("field 'T': a.case, line 6: there is no file \"gone.scl\"", done.err)
        done = subvol("probe", "a.case", "--stats", "--field", "T2", folder=self.folder)
        self.assertEqual(done.code, 2)
        self.assertIn('there is no field "T2"', done.err)


class MissingNodesTest(InFolder):
    def test_a_result_of_a_set_of_nodes_is_that_of_the_elements_that_have_it_all(self):
        for curved in False, True:
            with self.subTest(curved=curved):
                nodes, cells = bar(curved)
                (self.folder / "a.frd").write_text(frd(nodes, cells, [[("S", heights(nodes, 2)), ("T", heights(nodes))]]))
                info = self.run_ok("info", "a.frd", "--json").json()
                fields = {field["name"]: field for field in info["fields"]}
                self.assertEqual((fields["S"]["min"], fields["S"]["max"], fields["T"]["max"]), (0, 2, 3))
                self.assertGreaterEqual(fields["S"]["missing"], 4)
                self.assertNotIn("missing", fields["T"])
                self.assertIn("lack it", self.run_ok("info", "a.frd").out)
                two, all_ = (self.run_ok("probe", "a.frd", "--stats", "--scheme", "linear", "--field", name, "--json").json()
                             for name in ("S", "T"))
                self.assertLess(two["cells_with_field"], info["cells"])
                self.assertIn("asked for by its name, it is that of the", " ".join(two["warnings"]))
                # The section is 1, or 1 + 0.2 sin(πz/3), which the elements have as quadratic functions.
                bulge, delta = (0.2, 2e-3) if curved else (0, 1e-9)
                for stats, top in (two["stats"], 2), (all_["stats"], 3):
                    a = math.pi / 3
                    volume = top + bulge / a * (1 - math.cos(a * top))
                    moment = top * top / 2 + bulge * (math.sin(a * top) / a - top * math.cos(a * top)) / a
                    self.assertAlmostEqual(stats["whole"]["volume"], volume, delta=delta)
                    self.assertAlmostEqual(stats["whole"]["fields"][0]["mean"], moment / volume, delta=delta)
                at = self.run_ok("probe", "a.frd", "--at", ".5,.5,1.75", "--at", ".5,.5,2.5", "--field", "10*S", "--json").json()
                self.assertAlmostEqual(at["values"][0]["value"], 17.5, delta=1e-5)
                self.run_ok("render", "a.frd", "-o", "a.png", "--size", "32x32", "--field", "S")

    def test_a_result_that_no_element_has_whole_is_named_and_refused_where_it_is_needed(self):
        nodes, cells = bar(False)
        (self.folder / "a.frd").write_text(frd(nodes, cells, [[("S", {n: 7 + n for n in range(4)})]]))
        done = self.run_ok("info", "a.frd")
        self.assertIn('field "S" has no value at 12 of 16 nodes, and no cell has it at all of its points', done.err)
        self.assertRegex(done.out, r"S +at points +7 … 10; 12 lack it")
        self.run_ok("render", "a.frd", "-o", "a.png", "--size", "32x32")
        done = subvol("render", "a.frd", "-o", "a.png", "--field", "S", folder=self.folder)
        self.assertEqual(done.code, 2)
        self.assertIn("no cell has 'S' at all of its points", done.err)


class MissingBlocksTest(InFolder):
    def test_a_variable_of_one_block_is_that_of_its_cells(self):
        """As MOOSE restricts variables to blocks: of three cubes the last two have it."""
        blocks = CELLS[:1], CELLS[1:]
        (self.folder / "a.exo").write_bytes(netcdf(
            {"num_dim": 3, "num_nodes": len(POINTS), "num_elem": 3, "num_el_blk": 2, "num_el_in_blk1": 1, "num_el_in_blk2": 2,
             "num_nod_per_el1": 8, "num_nod_per_el2": 8, "time_step": 1, "num_elem_var": 3, "len": 8},
            [("coord" + "xyz"[a], ["num_nodes"], "d", [p[a] for p in POINTS]) for a in range(3)] +
            [(f"connect{b + 1}", [f"num_el_in_blk{b + 1}", f"num_nod_per_el{b + 1}"], "i", [n + 1 for cell in cells for n in cell])
             for b, cells in enumerate(blocks)] +
            [("time_whole", ["time_step"], "d", [1.5]),
             ("name_elem_var", ["num_elem_var", "len"], "c", b"".join(n.ljust(8, b"\0") for n in (b"flux", b"all", b"none"))),
             ("vals_elem_var1eb2", ["time_step", "num_el_in_blk2"], "d", [3, 5]),
             ("vals_elem_var2eb1", ["time_step", "num_el_in_blk1"], "d", [1]),
             ("vals_elem_var2eb2", ["time_step", "num_el_in_blk2"], "d", [3, 5])]))
        done = self.run_ok("info", "a.exo", "--json").json()
        self.assertEqual({f["name"]: (f["min"], f["max"], f.get("missing")) for f in done["fields"]},
                         {"flux": (3, 5, 1), "all": (1, 5, None)})
        self.assertIn('array "none" ignored: it is not in the blocks that are read', " ".join(done["warnings"]))
        for more, mean in ([], 4), (["--cell-values", "constant"], 4):
            done = self.run_ok("probe", "a.exo", "--stats", "--field", "flux", "--scheme", "linear", "--json", *more).json()
            self.assertEqual(done["cells_with_field"], 2)
            self.assertAlmostEqual(done["stats"]["whole"]["volume"], 2, delta=1e-9)
            self.assertAlmostEqual(done["stats"]["whole"]["fields"][0]["mean"], mean, delta=1e-9)


def cube_file(first_x, fields, cell_field=""):
    """A cube from x = first_x on as a .vtu file; fields: functions of places, by name"""
    points = [(x + first_x, y, z) for x, y, z in AROUND]
    arrays = ""
    for name, f in fields.items():
        values = [f(*p) if isinstance(f(*p), tuple) else (f(*p),) for p in points]
        arrays += (f'<DataArray type="Float64" Name="{name}" NumberOfComponents="{len(values[0])}" format="ascii">'
                   f'{" ".join(str(c) for v in values for c in v)}</DataArray>')
    cells = f'<DataArray type="Float64" Name="{cell_field}" format="ascii">5</DataArray>' if cell_field else ""
    return ('<VTKFile type="UnstructuredGrid" version="1.0"><UnstructuredGrid><Piece NumberOfPoints="8" NumberOfCells="1"><Points>'
            f'<DataArray type="Float64" NumberOfComponents="3" format="ascii">{" ".join(str(c) for p in points for c in p)}</DataArray></Points><Cells>'
            '<DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3 4 5 6 7</DataArray>'
            '<DataArray type="Int64" Name="offsets" format="ascii">8</DataArray><DataArray type="UInt8" Name="types" format="ascii">12</DataArray></Cells>'
            f"<PointData>{arrays}</PointData><CellData>{cells}</CellData></Piece></UnstructuredGrid></VTKFile>")


class BlocksWithFieldsOfTheirOwnTest(InFolder):
    """A solid and a fluid beside it have other fields, and one in common."""

    def write(self, *cubes):
        for k, (fields, at_cells) in enumerate(cubes):
            (self.folder / f"{k}.vtu").write_text(cube_file(k, {"h": lambda x, y, z: z, **fields}, at_cells))
        blocks = "".join(f'<DataSet index="{k}" name="block{k}" file="{k}.vtu"/>' for k in range(len(cubes)))
        (self.folder / "a.vtm").write_text(f'<VTKFile type="vtkMultiBlockDataSet" version="1.0"><vtkMultiBlockDataSet>{blocks}</vtkMultiBlockDataSet></VTKFile>')

    def stats(self, field):
        return self.run_ok("probe", "a.vtm", "--stats", "--field", field, "--scheme", "linear", "--json").json()

    def test_each_field_is_that_of_its_block(self):
        self.write(({"T": lambda x, y, z: x}, ""), ({"U": lambda x, y, z: 2 * x + z, "D": lambda x, y, z: (x / 2, 0, 0), "T_x": lambda x, y, z: 8}, "W"))
        found = {f["name"]: (f["min"], f["max"], f.get("missing")) for f in self.run_ok("info", "a.vtm", "--json").json()["fields"]}
        self.assertEqual(found, {"h": (0, 1, None), "T": (0, 1, 4), "U": (2, 5, 4), "D": (.5, 1, 4), "T_x": (8, 8, 4), "W": (5, 5, 1)})
        for field, mean in ("T", .5), ("U", 3.5), ("W", 5), ("U+h", 4):
            with self.subTest(field):
                done = self.stats(field)
                self.assertEqual(done["cells_with_field"], 1)
                self.assertAlmostEqual(done["stats"]["whole"]["volume"], 1, delta=1e-9)
                self.assertAlmostEqual(done["stats"]["whole"]["fields"][0]["mean"], mean, delta=1e-9)
        self.assertAlmostEqual(self.stats("h")["stats"]["whole"]["volume"], 2, delta=1e-9)
        moved = self.run_ok("probe", "a.vtm", "--stats", "--field", "h", "--warp", "D", "--scheme", "linear", "--json").json()
        self.assertEqual(moved["cells_with_field"], 1)
        self.assertAlmostEqual(moved["stats"]["whole"]["volume"], 1.5, delta=1e-9)
        for name in "D_x", "D.x":
            self.assertAlmostEqual(self.stats(name)["stats"]["whole"]["fields"][0]["mean"], .75, delta=1e-9)
        self.assertAlmostEqual(self.stats("T_x")["stats"]["whole"]["volume"], 1, delta=1e-9)
        self.assertAlmostEqual(self.stats("T_x")["stats"]["whole"]["fields"][0]["mean"], 8, delta=1e-9)
        done = subvol("probe", "a.vtm", "--stats", "--field", "T+U", folder=self.folder)
        self.assertEqual(done.code, 2)
        self.assertIn("no cell has 'T', 'U' at all of its points", done.err)

    def test_a_block_between_two_that_have_it_does_not_seem_to_have_it(self):
        with_t = {"T": lambda x, y, z: x}
        self.write((with_t, ""), ({}, ""), (with_t, ""))
        done = subvol("probe", "a.vtm", "--stats", "--field", "T", folder=self.folder)
        self.assertEqual(done.code, 2)
        self.assertIn('array "T" ignored: it is not in every block, and cells without it lie between', self.run_ok("info", "a.vtm").err)
        self.assertAlmostEqual(self.run_ok("probe", "a.vtm", "--blocks", "block2", "--stats", "--field", "T", "--scheme", "linear", "--json")
                               .json()["stats"]["whole"]["fields"][0]["mean"], 2.5, delta=1e-9)


class BlocksInTimeAndWeldedTest(InFolder):
    """Fields of one block between two steps, and where the points of blocks are welded."""

    def write(self, name, cubes):
        """cubes: (first x, fields, field at the cell) of each block"""
        blocks = ""
        for k, (x, fields, at_cell) in enumerate(cubes):
            (self.folder / f"{name}{k}.vtu").write_text(cube_file(x, fields, at_cell))
            blocks += f'<DataSet index="{k}" name="block{k}" file="{name}{k}.vtu"/>'
        (self.folder / f"{name}.vtm").write_text('<VTKFile type="vtkMultiBlockDataSet" version="1.0"><vtkMultiBlockDataSet>'
                                                 f"{blocks}</vtkMultiBlockDataSet></VTKFile>")

    def mean(self, file, field, *more):
        done = self.run_ok("probe", file, "--stats", "--field", field, "--scheme", "linear", "--json", *more).json()
        return round(done["stats"]["whole"]["volume"], 5), round(done["stats"]["whole"]["fields"][0]["mean"], 5)

    def test_between_steps(self):
        h = {"h": lambda x, y, z: z}
        self.write("a", [(0, {"T": lambda x, y, z: x, **h}, "W"), (1, h, "")])
        self.write("b", [(0, {"T": lambda x, y, z: x + 100, **h}, "W"), (1, h, "")])
        self.write("c", [(0, h, ""), (1, {"T": lambda x, y, z: x, **h}, "W")])
        for name, last in ("ab", "b"), ("ac", "c"):
            (self.folder / f"{name}.pvd").write_text('<VTKFile type="Collection"><Collection><DataSet timestep="1" file="a.vtm"/>'
                                                     f'<DataSet timestep="2" file="{last}.vtm"/></Collection></VTKFile>')
        time = ["--time", 1.25, "--interpolate-time"]
        self.assertEqual(self.mean("ab.pvd", "T", *time), (1, 25.5))
        self.assertEqual(self.mean("ab.pvd", "W", *time), (1, 5))
        self.assertEqual(self.mean("ab.pvd", "h", *time), (2, .5))
        found = {f["name"]: (f["min"], f["max"], f.get("missing")) for f in self.run_ok("info", "ab.pvd", *time, "--json").json()["fields"]}
        self.assertEqual(found, {"h": (0, 1, None), "T": (25, 26, 4), "W": (5, 5, 1)})
        done = subvol("probe", "ac.pvd", "--stats", "--field", "T", *map(str, time), folder=self.folder)
        self.assertEqual(done.code, 2)  # no cell has it in both steps
        self.assertIn("no cell has 'T'", done.err)
        found = {f["name"]: (f["min"], f["max"], f.get("missing")) for f in self.run_ok("info", "ac.pvd", *time, "--json").json()["fields"]}
        self.assertEqual(found, {"T": (1, 1, 8), "h": (0, 1, None)})  # T where the blocks touch, W nowhere

    def test_a_list_of_one_step_has_its_time(self):
        self.write("a", [(0, {"T": lambda x, y, z: x}, "")])
        (self.folder / "one.pvd").write_text('<VTKFile type="Collection"><Collection><DataSet timestep="10" file="a.vtm"/></Collection></VTKFile>')
        self.assertEqual(self.mean("one.pvd", "2*time"), (1, 20))
        self.assertEqual(self.run_ok("info", "one.pvd", "--json").json()["times"], [10])

    def test_welded_points_have_the_value_that_is_there(self):
        with_t, without = {"T": lambda x, y, z: x}, {"h": lambda x, y, z: z}
        for name, cubes in ("first", [(0, with_t, ""), (1.0000001, without, "")]), ("last", [(1.0000001, without, ""), (0, with_t, "")]):
            self.write(name, cubes)
            self.assertEqual(self.mean(f"{name}.vtm", "T", "--weld-distance", "1e-5"), (1, .5))
        self.write("between", [(0, with_t, "W"), (2.0000002, with_t, "W"), (1.0000001, without, "")])
        done = subvol("probe", "between.vtm", "--stats", "--field", "T", "--weld-distance", "1e-5", folder=self.folder)
        self.assertEqual(done.code, 2)
        self.assertIn('array "T" ignored: cells without it lie between those that have it, and their points are welded',
                      self.run_ok("info", "between.vtm", "--weld-distance", "1e-5").err)
        self.assertEqual(self.mean("between.vtm", "W", "--weld-distance", "1e-5"), (2, 5))

    def test_labels_fractions_and_fits(self):
        halves = {"MaterialId": lambda x, y, z: 1 + (x > 0), "alpha.water": lambda x, y, z: 1 if x > 0 and z > 0 else 0}
        self.write("a", [(0, halves, "q"), (1, {}, "")])
        at = self.run_ok("probe", "a.vtm", "--field", "MaterialId", "--at", ".3,.5,.5", "--json").json()
        self.assertEqual(at["values"][0]["value"], 1)
        done = self.run_ok("probe", "a.vtm", "--stats", "--field", "alpha.water", "--json").json()["stats"]["whole"]["fields"][0]
        self.assertEqual((done["min"], done["max"]), (0, 1))
        done = self.run_ok("probe", "a.vtm", "--stats", "--field", "q", "--cell-values", "fit")
        self.assertIn('"q" has gaps, so it is not fitted to the means over the cells', done.err)
        self.assertNotIn("fitted", self.run_ok("probe", "a.vtm", "--stats", "--field", "q").err)

    def test_other_numbers_of_components_are_named(self):
        self.write("a", [(0, {"T": lambda x, y, z: x}, ""), (1, {"T": lambda x, y, z: (1, 2, 3)}, "")])
        parts = self.run_ok("info", "a.vtm", "--json").json()["ignored"]
        self.assertEqual([(part["kind"], part["name"], part["count"]) for part in parts], [("array", "T", 1)])
        self.assertIn("other numbers of components", parts[0]["reason"])
        self.assertEqual(self.mean("a.vtm", "T"), (1, .5))

    def test_regions_of_such_fields(self):
        self.write("a", [(0, {"T": lambda x, y, z: 1, "h": lambda x, y, z: z}, ""), (1, {"h": lambda x, y, z: z}, "")])
        self.assertEqual(self.mean("a.vtm", "h", "--only", "where:T>.5"), (1, .5))
        # A block and a field of one name: the block is not asked for the field.
        self.write("b", [(0, {"block1": lambda x, y, z: 1, "h": lambda x, y, z: z}, ""), (1, {"h": lambda x, y, z: z}, "")])
        self.assertEqual(self.mean("b.vtm", "h", "--only", "block:block1"), (1, .5))


class PiecesOfOneFileTest(InFolder):
    """Cubes beside each other as pieces of one .vtu, which have other fields."""

    def write(self, *cubes):
        pieces = []
        for k, (fields, at_cells) in enumerate(cubes):
            text = cube_file(k, {"h": lambda x, y, z: z, **fields}, at_cells)
            pieces.append(text[text.index("<Piece"):text.index("</UnstructuredGrid>")])
        (self.folder / "a.vtu").write_text('<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian"><UnstructuredGrid>'
                                           + "".join(pieces) + "</UnstructuredGrid></VTKFile>")

    def stats(self, field, *more):
        done = self.run_ok("probe", "a.vtu", "--stats", "--field", field, "--scheme", "linear", "--json", *more).json()
        whole = done["stats"]["whole"]
        return done.get("cells_with_field"), round(whole["volume"], 9), round(whole["fields"][0]["mean"], 9)

    def test_each_field_is_that_of_its_piece(self):
        T, U = {"T": lambda x, y, z: x}, {"U": lambda x, y, z: 2 * x + z}
        self.write((T, "W"), (U, ""), (T, ""))
        found = {f["name"]: (f["min"], f["max"], f.get("missing")) for f in self.run_ok("info", "a.vtu", "--json").json()["fields"]}
        self.assertEqual(found, {"h": (0, 1, None), "T": (0, 3, 8), "W": (5, 5, 2), "U": (2, 5, 16)})
        self.assertEqual(self.stats("T"), (2, 2, 1.5))
        self.assertEqual(self.stats("U"), (1, 1, 3.5))
        self.assertEqual(self.stats("W"), (1, 1, 5))
        self.assertEqual(self.stats("h"), (None, 3, .5))

    def test_welding_joins_what_is_there(self):
        self.write(({"T": lambda x, y, z: x}, ""), ({}, ""), ({}, ""))
        self.assertEqual(self.stats("T", "--weld"), (1, 1, .5))
        self.write(({"T": lambda x, y, z: x}, ""), ({}, ""), ({"T": lambda x, y, z: x}, ""))
        done = subvol("probe", "a.vtu", "--stats", "--field", "T", "--weld", folder=self.folder)
        self.assertEqual(done.code, 2)
        self.assertIn('array "T" ignored: cells without it lie between those that have it', self.run_ok("info", "a.vtu", "--weld").err)

    def test_files_with_gaps_beside_others(self):
        T = {"T": lambda x, y, z: x}
        for order in "01", "10":
            self.write((T, ""), ({}, ""))
            (self.folder / "a.vtu").rename(self.folder / "0.vtu")
            (self.folder / "1.vtu").write_text(cube_file(2, {"h": lambda x, y, z: z, **T}))
            pieces = "".join(f'<Piece Source="{k}.vtu"/>' for k in order)
            (self.folder / "a.vtu").unlink(missing_ok=True)
            (self.folder / "a.pvtu").write_text(f'<VTKFile type="PUnstructuredGrid" version="1.0"><PUnstructuredGrid>{pieces}</PUnstructuredGrid></VTKFile>')
            done = self.run_ok("probe", "a.pvtu", "--stats", "--field", "T", "--scheme", "linear", "--json").json()
            whole = done["stats"]["whole"]
            self.assertEqual((done["cells_with_field"], round(whole["volume"], 9), round(whole["fields"][0]["mean"], 9)), (2, 2, 1.5))
        # Between two others the cell without it would have all its corners' values: nobody may invent it.
        (self.folder / "2.vtu").write_text(cube_file(-1, {"h": lambda x, y, z: z}))
        self.write(({}, ""), (T, ""))
        (self.folder / "a.vtu").rename(self.folder / "0.vtu")
        (self.folder / "1.vtu").write_text(cube_file(-1, {"h": lambda x, y, z: z, **T}))
        (self.folder / "a.pvtu").write_text('<VTKFile type="PUnstructuredGrid" version="1.0"><PUnstructuredGrid><Piece Source="0.vtu"/><Piece Source="1.vtu"/>'
                                            "</PUnstructuredGrid></VTKFile>")
        found = self.run_ok("info", "a.pvtu", "--weld", "--json").json()
        self.assertEqual([f["name"] for f in found["fields"]], ["h"])
        self.assertTrue(any("cells without it lie between" in warning for warning in found["warnings"]))

    def test_names_in_the_warning_are_those_of_the_mesh(self):
        self.write(({"T": lambda x, y, z: x}, "T"), ({"T": lambda x, y, z: x}, ""))
        self.assertIn('field "T_2" has no value at 1 of 2 cells', self.run_ok("info", "a.vtu").err)

    def test_other_components_and_numbers_of_things_are_left_out(self):
        self.write(({"T": lambda x, y, z: x, "GlobalNodeId": lambda x, y, z: x}, ""), ({"T": lambda x, y, z: (x, y, z)}, ""))
        done = self.run_ok("info", "a.vtu")
        self.assertIn('array "T" ignored: it has other numbers of components than in the first piece that has it', done.err)
        self.assertIn('array "GlobalNodeId" ignored: it is not in every piece', done.err)
        self.assertEqual(self.stats("T"), (1, 1, .5))


class MissingStepsTest(InFolder):
    def setUp(self):
        super().setUp()
        nodes, cells = bar(False)
        with_s = [("T", heights(nodes)), ("S", {n: 2 * z for n, z in heights(nodes).items()})]
        (self.folder / "a.frd").write_text(frd(nodes, cells, [with_s[:1], with_s, with_s[:1], with_s[:1], with_s]))
        self.left_out = "steps 0, 2 to 3 left out: "

    def test_a_table_has_the_steps_that_have_the_field(self):
        for more in (["--stats"], ["--at", ".5,.5,1"]):
            for quantity, value in ("S", 3), ("S+T", 4.5):
                with self.subTest(more=more, quantity=quantity):
                    done = self.run_ok("probe", "a.frd", *more, "--field", quantity, "--step", "all", "--scheme", "linear", "-o", "a.csv")
                    self.assertIn(self.left_out, done.err)
                    rows = list(csv.reader((self.folder / "a.csv").read_text().splitlines()))[1:]
                    self.assertEqual([row[0] for row in rows], ["1", "4"])
                    at = 4 if "--stats" in more else 3
                    self.assertAlmostEqual(float(rows[0][at]), value if "--stats" in more else 2 * value / 3, delta=1e-9)

    def test_pictures_grids_and_kernels_of_the_steps_that_have_it(self):
        for words, ending in ((["render", "--size", "32x32"], "png"), (["vdb", "--resolution", "6"], "vdb"), (["points"], "ply")):
            with self.subTest(words[0]):
                done = self.run_ok(words[0], "a.frd", *words[1:], "--field", "S", "--step", "all", "-o", f"a_#.{ending}")
                self.assertIn(self.left_out, done.err)
                self.assertEqual(sorted(p.name for p in self.folder.glob(f"a_?.{ending}")), [f"a_1.{ending}", f"a_4.{ending}"])
        done = self.run_ok("render", "a.frd", "--size", "32x32", "--field", "S", "--step", "all", "-o", "a_#.png", "--json").json()
        self.assertEqual((done["outputs"], done["frames"], done["times"]), (["a_1.png", "a_4.png"], 2, [2, 5]))

    def test_a_compressed_series_keeps_the_steps_without_the_field(self):
        words = ["compress", "a.frd", "--field", "S", "--max-error", "1e-4", "-o", "a.svw"]
        done = self.run_ok(*words, "--step", "all")
        self.assertIn("steps 0, 2 to 3 written without the field: ", done.err)
        for step, time in enumerate((1, 2, 3, 4, 5)):
            info = self.run_ok("info", "a.svw", "--step", str(step), "--json").json()
            self.assertEqual((info["time"], [f["name"] for f in info["fields"]]), (time, ["S"] if step in (1, 4) else []))
        mean = self.run_ok("probe", "a.svw", "--stats", "--step", "4", "--scheme", "linear", "--json").json()
        self.assertAlmostEqual(mean["stats"]["whole"]["fields"][0]["mean"], 3, delta=1e-3)
        (self.folder / "a.svw").unlink()
        none = subvol(*words, "--step", "2-3", folder=self.folder)
        self.assertEqual((none.code, list(self.folder.glob("a.svw*"))), (2, []))
        self.assertIn("a.frd", none.err)

    def test_a_field_of_no_step_is_an_error(self):
        for words in (["probe", "a.frd", "--stats"], ["render", "a.frd", "-o", "a_#.png"], ["vdb", "a.frd", "-o", "a_#.vdb"],
                      ["points", "a.frd", "-o", "a_#.ply"]):
            with self.subTest(words[0]):
                done = subvol(*words, "--step", "all", "--field", "nope", folder=self.folder)
                self.assertEqual(done.code, 2)
                self.assertIn('there is no field "nope"', done.err)


class SeriesWarningsTest(InFolder):
    def test_what_differs_in_numbers_alone_is_said_once(self):
        write_foam(self.folder / "case")
        for step in range(1, 6):
            shutil.copytree(self.folder / "case" / "0", self.folder / "case" / str(step))
            values = " ".join(str(k * step * step + math.sin(step * k)) for k in range(3))
            (self.folder / "case" / str(step) / "T").write_text(
                "FoamFile\n{\n version 2.0;\n format ascii;\n class volScalarField;\n object T;\n}\ndimensions [0 0 0 0 0 0 0];\n"
                f"internalField nonuniform List<scalar> 3({values});\nboundaryField {{ left {{ type fixedValue; value uniform {step}; }} }}\n")
        words = ["probe", "case", "--stats", "--field", "T", "--step", "1-5"]
        done = self.run_ok(*words, "-o", "a.csv")
        warnings = [line for line in done.err.splitlines() if line.startswith("subvol: warning:")]
        self.assertEqual(len([w for w in warnings if "became values at points" in w]), 1, done.err)
        self.assertRegex(done.err, r"\d+ more warnings differ from these in numbers alone; --json has all")
        self.assertEqual(len([w for w in self.run_ok(*words, "--json").json()["warnings"] if "became values at points" in w]), 5)
        self.assertLessEqual(len(done.err.splitlines()), len(warnings) + 4)


if __name__ == "__main__":
    unittest.main()
