# SPDX-License-Identifier: Apache-2.0
"""Quantities, regions, displacement and steps mean the same in every command."""

import csv
import math
import unittest

from command import InFolder, subvol


def write_beam(path, bend, stress=lambda x, y, z: 10 * (x - 1), shear=3):
    """A bar of 2 x 2 x 6 unit cells along z with a temperature, a displacement and a stress at its points.

    stress: zz of the place; shear: yz
    """
    points = [(x, y, z) for z in range(7) for y in range(3) for x in range(3)]
    number = {p: i for i, p in enumerate(points)}
    around = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = [[number[x + i, y + j, z + k] for i, j, k in around] for z in range(6) for y in range(2) for x in range(2)]

    def rows(values):
        return "\n".join(" ".join(map(repr, map(float, value))) for value in values)

    path.write_text(f"""# vtk DataFile Version 3.0
a bar
ASCII
DATASET UNSTRUCTURED_GRID
POINTS {len(points)} double
{rows(points)}
CELLS {len(cells)} {9 * len(cells)}
""" + "\n".join(" ".join(map(str, [8, *cell])) for cell in cells) + f"""
CELL_TYPES {len(cells)}
""" + "12 " * len(cells) + f"""
POINT_DATA {len(points)}
FIELD fields 4
T 1 {len(points)} double
{rows([(3 + 2 * x - y + .5 * z,) for x, y, z in points])}
D 3 {len(points)} double
{rows([(bend * z, 0, 0) for x, y, z in points])}
STRESS 6 {len(points)} double
{rows([(0, 0, stress(x, y, z), 0, shear, 0) for x, y, z in points])}
p%200 1 {len(points)} double
{rows([(x,) for x, y, z in points])}
""")


def write_flow(path):
    """A box of two unit cells along y with a density 1 + x + y, a speed y along x, and its side x = 1 as a group of faces; Gmsh 2.2."""
    points = [(x, y, z) for z in (0, 1) for y in (0, 1, 2) for x in (0, 1)]
    number = {p: i + 1 for i, p in enumerate(points)}
    around = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    elements = []
    for y in (0, 1):
        elements.append([5, 2, 2, 2] + [number[i, y + j, k] for i, j, k in around])
        elements.append([3, 2, 1, 1] + [number[1, y + j, k] for j, k in ((0, 0), (1, 0), (1, 1), (0, 1))])

    def data(name, value):
        rows = "\n".join(f"{number[p]} {value(*p)}" for p in points)
        return f'$NodeData\n1\n"{name}"\n1\n0.0\n3\n0\n1\n{len(points)}\n{rows}\n$EndNodeData\n'

    path.write_text('$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 "side"\n3 2 "body"\n$EndPhysicalNames\n'
                    f"$Nodes\n{len(points)}\n" + "\n".join(" ".join(map(str, (i + 1, *p))) for i, p in enumerate(points)) + "\n$EndNodes\n"
                    f"$Elements\n{len(elements)}\n" + "\n".join(" ".join(map(str, (i + 1, *e))) for i, e in enumerate(elements)) + "\n$EndElements\n"
                    + data("rho", lambda x, y, z: 1 + x + y) + data("u", lambda x, y, z: y))


class Quantities(InFolder):
    def setUp(self):
        super().setUp()
        write_beam(self.folder / "a.vtk", .1)

    def run_fails(self, *arguments):
        done = subvol(*arguments, folder=self.folder)
        self.assertEqual(done.code, 2, f"subvol {' '.join(map(str, arguments))}: {done.err}")
        self.assertEqual(len(done.err.strip().splitlines()[-1:]), 1)
        return done

    def stats(self, field, *more, mesh="a.vtk"):
        found = self.run_ok("probe", mesh, "--stats", "--field", field, *more, "--json").json()
        whole = found["stats"]["whole"]
        return whole, whole["fields"][0], found

    def value(self, field, at, *more, mesh="a.vtk"):
        found = self.run_ok("probe", mesh, "--at", at, "--field", field, *more, "--json").json()
        return found["values"][0]["value"]

    def test_the_same_value_in_each_command(self):
        """21 kinds of words, each by `probe`, and as a grid, points, a slice and a page."""
        wanted = {"T": 7, "D.x": .2, "STRESS.zz": 10, "STRESS.yz": 3, "length(D)": .2, "mises(STRESS)": math.sqrt(100 + 27),
                  "trace(STRESS)": 10, "hydrostatic(STRESS)*3": 10, "grad(T).x": 2, "grad(T).y": -1, "length(grad(T))": math.sqrt(5.25),
                  "grad(D).xz": .1, "div(D)": 0, "curl(D).y": .1, "qcriterion(D)": 0, "`p 0`*2": 4, "(T-3)*2+x": 10, "x>0": 1,
                  "principal1(STRESS)+principal2(STRESS)+principal3(STRESS)": 10, "det(STRESS)": 0, "tresca(STRESS)": math.sqrt(100 + 36)}
        for field, value in wanted.items():
            with self.subTest(field):
                self.assertAlmostEqual(self.value(field, "2,1,2"), value, delta=2e-6)
        for field in "T", "D.x", "grad(T).y", "mises(STRESS)", "(T-3)*2+x":
            with self.subTest(field):
                probed = self.value(field, "1,1,2")
                self.run_ok("vdb", "a.vtk", "-o", "a.vdb", "--field", field, "--voxel-size", .25)
                grid = self.run_ok("info", "a.vdb", "--at", "1,1,2", "--json").json()["at"][0]["value"]
                self.assertAlmostEqual(grid, probed, delta=1e-3 * max(1, abs(probed)))
                self.run_ok("slice", "a.vtk", "-o", "a.csv", "--field", field, "--plane", "1,1,2,0,0,1", "--resolution", 9)
                self.run_ok("points", "a.vtk", "-o", "a.ply", "--field", field)
                if field != "grad(T).y":  # which is one value
                    self.run_ok("surface", "a.vtk", "-o", "a.stl", "--field", field, "--iso", "50%")
                self.run_ok("render", "a.vtk", "-o", "a.png", "--field", field, "--size", 32)
                self.run_ok("page", "a.vtk", "-o", "a.html", "--field", field, "--no-reference")
                same = self.run_ok("compare", "a.vtk", "a.vtk", "--field", field, "--samples", 100, "--json").json()
                self.assertLess(same["linf"], 1e-9)

    def test_info_says_what_fields_are(self):
        self.assertRegex(self.run_ok("info", "a.vtk").out, r"STRESS +at points symmetric tensors +\S")

    def test_one_largest_stress_in_all_commands(self):
        """A stress 100 - 10 |x - c|^2 along z, which the limit of mcq has exactly: the largest is 100 at c, on a side between the points."""
        c = 0, .7, 2.4
        write_beam(self.folder / "peak.vtk", 0, lambda *x: 100 - 10 * sum((a - b) ** 2 for a, b in zip(x, c)), 0)
        field = "--field", "mises(STRESS)"
        found = self.stats(field[1], mesh="peak.vtk")[1]
        slices = [self.run_ok("slice", "peak.vtk", "-o", "a.png", *field, "--plane", "1,.7,2,0,1,0", "--extremes", "--resolution", n, "--json").json()
                  for n in (5, 40)]
        drawn = self.run_ok("render", "peak.vtk", "-o", "b.png", *field, "--extremes", "--size", "48x36", "--json").json()["extremes"]
        for largest, at in [(found["max"], found["max_at"]), (drawn["max"], drawn["max_at"])] + [(s["max"], s["extremes"]["max_at"]) for s in slices]:
            self.assertAlmostEqual(largest, 100, delta=.02)  # searches end within 1e-4 of the range, about 170
            for a, b in zip(at, c):
                self.assertAlmostEqual(a, b, delta=.05)  # where it is lower by 10 * .05^2 = .025
        self.assertAlmostEqual(slices[0]["max"], slices[1]["max"], delta=1e-4)
        grid = self.run_ok("vdb", "peak.vtk", "-o", "a.vdb", *field, "--voxel-size", .05, "--json").json()["grids"][0]
        self.assertAlmostEqual(grid["max"], 100, delta=.03)  # 10 times the square of half a voxel's diagonal is .019
        # The surface of 99 is half a sphere with a radius of the root of .1.
        surface = self.run_ok("surface", "peak.vtk", "-o", "a.vtp", *field, "--iso", 99, "--tolerance", 1e-4, "--json").json()
        self.assertAlmostEqual(surface["area"], 2 * math.pi * .1, delta=.002)

    def test_lengths_are_those_of_the_place(self):
        self.assertAlmostEqual(self.value("mag(vector(x,y,z))", ".1,.1,.1", mesh="model:twist:2"), math.sqrt(.03), delta=1e-9)
        self.assertAlmostEqual(self.value("x^2+y^2", ".3,.2,.1", mesh="model:twist:2"), .13, delta=1e-9)
        # |x - .9| of a bar with points at 0, 1 and 2: 0 between them in all commands.
        field = "--field", "abs(x-.9)"
        for scheme in "mcq", "cc", "linear":
            found = self.stats(field[1], "--scheme", scheme)[1]
            self.assertGreaterEqual(found["min"], 0)
            self.assertLess(found["min"], 2e-3)
            self.assertAlmostEqual(found["max"], 1.1, delta=1e-6)
            self.assertAlmostEqual(found["mean"], (.81 + 1.21) / 4, delta=2e-3)  # a kink in the middle of cells
        grid = self.run_ok("vdb", "a.vtk", "-o", "a.vdb", *field, "--voxel-size", .1, "--json").json()["grids"][0]
        self.assertGreaterEqual(grid["min"], 0)
        self.assertLess(grid["min"], .05)
        cut = self.run_ok("slice", "a.vtk", "-o", "a.png", *field, "--resolution", 7, "--json").json()
        self.assertGreaterEqual(cut["min"], 0)
        self.assertLess(cut["min"], 1e-3)

    def test_a_mass_flow_is_that_of_the_product(self):
        """Through x = 1 of a box flows a density 1 + x + y with a speed y, each linear: the integral of (2 + y) y from 0 to 2 is 20/3."""
        write_flow(self.folder / "flow.msh")
        found = self.run_ok("probe", "flow.msh", "--patch", "side", "--flux", "vector(rho*u,0,0)", "--json").json()["patches"][0]
        self.assertAlmostEqual(found["flux"], 20 / 3, delta=1e-6)

    def test_fields_stay_in_the_range_of_the_file(self):
        """A stress that jumps: the limit overshoots, but not with --clamp file."""
        write_beam(self.folder / "jump.vtk", 0, lambda x, y, z: 50 if z < 3.5 else 90, 0)
        field, clamp = ("--field", "STRESS.zz"), ("--clamp", "file")
        for words, beyond in ((), True), (clamp, False):
            with self.subTest(words):
                whole = self.stats(field[1], *words, mesh="jump.vtk")[1]
                cut = self.run_ok("slice", "jump.vtk", "-o", "a.png", *field, *words, "--plane", "1,1,3,1,0,0", "--json").json()
                grid = self.run_ok("vdb", "jump.vtk", "-o", "a.vdb", *field, *words, "--resolution", 40, "--json").json()["grids"][0]
                drawn = self.run_ok("render", "jump.vtk", "-o", "b.png", *field, *words, "--extremes", "--size", "32x24", "--json").json()["extremes"]
                for found in whole, cut, grid, drawn:
                    self.assertEqual((found["min"] < 49.9, found["max"] > 90.1), (beyond, beyond), found)
                    self.assertAlmostEqual(max(found["min"], 50), 50, delta=1e-5)
        self.assertEqual(self.stats("mises(STRESS)", *clamp, mesh="jump.vtk")[1]["max"], 90)
        self.assertIn("--clamp file", self.run_ok("probe", "--help-all").out)

    def test_a_stress_is_shown_by_its_von_mises_stress(self):
        by_name = self.stats("STRESS")[1]
        self.assertEqual(by_name["name"], "mises(STRESS)")
        self.assertEqual(by_name["max"], self.stats("mises(STRESS)")[1]["max"])

    def test_says_what_is_wrong(self):
        for field, words in {"mises(D)": "takes a tensor", "grad(STRESS)": "takes a scalar or a vector", "T+Q": "no field",
                             "2*D.w": "", "mises(STRESS": "closing parenthesis", "time*2": "no time", "T=3": "==", "1/(T-T)": "not finite"}.items():
            with self.subTest(field):
                self.assertIn(words, self.run_fails("probe", "a.vtk", "--stats", "--field", field).err)

    def test_warp_moves_the_points(self):
        about = self.run_ok("info", "a.vtk", "--warp", "D*5", "--json").json()
        self.assertEqual(about["warp"], {"field": "D", "factor": 5})
        self.assertAlmostEqual(about["bounds"][1][0], 2 + 5 * .6)
        self.assertAlmostEqual(about["volume"], 24)
        self.assertAlmostEqual(self.value("grad(T).x", "3,1,4", "--warp", "D*5"), 2, delta=1e-6)  # of the mesh at rest
        automatic = self.run_ok("info", "a.vtk", "--warp", "D*auto", "--json").json()["warp"]["factor"]
        self.assertAlmostEqual(automatic, .1 * math.sqrt(4 + 4 + 36) / .6)
        for wrong in "T", "D*x", "E":
            self.run_fails("render", "a.vtk", "-o", "b.png", "--warp", wrong)
        self.assertFalse((self.folder / "b.png").exists())

    def test_only_takes_cells_and_cuts_statistics(self):
        about = self.run_ok("info", "a.vtk", "--only", "box:0,0,0,2,2,3", "--json").json()
        self.assertEqual((about["cells"], about["only_cells"]), (12, 12))
        whole, field, _ = self.stats("T", "--only", "box:.3,.2,.1,1.9,1.5,4.7")
        self.assertAlmostEqual(whole["volume"], 1.6 * 1.3 * 4.6, delta=1e-4 * 9.6)
        self.assertAlmostEqual(field["mean"], 3 + 2 * 1.1 - .85 + .5 * 2.4, delta=1e-3)
        two = self.stats("T", "--only", "half:0,0,1,0,0,1", "--only", "half:0,0,2,0,0,-1")[0]
        self.assertAlmostEqual(two["volume"], 4, delta=1e-4)
        self.assertEqual(self.run_ok("info", "a.vtk", "--only", "where:z<=1", "--json").json()["cells"], 8)
        self.assertEqual(self.value("T", "1,1,1", "--only", "sphere:0,0,5,2"), None)
        for wrong in "box:0,0,0,1,1", "cube:0", "sphere:50,50,50,1", "where:T>900", "block:none":
            self.run_fails("vdb", "a.vtk", "-o", "b.vdb", "--only", wrong)

    def test_steps_make_a_table(self):
        for k in range(3):
            write_beam(self.folder / f"s{k}.vtk", .1 * k)
            self.run_ok("subdivide", f"s{k}.vtk", "-o", f"s{k}.vtu", "--levels", 0)
        (self.folder / "run.pvd").write_text('<VTKFile type="Collection"><Collection>' + "".join(
            f'<DataSet timestep="{k * .5}" file="s{k}.vtu"/>' for k in range(3)) + "</Collection></VTKFile>")
        self.run_ok("probe", "run.pvd", "--at", "1,1,2", "--step", "all", "--field", "D.x", "-o", "a.csv", "--quiet")
        with open(self.folder / "a.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([float(row["time"]) for row in rows], [0, .5, 1])
        for k, row in enumerate(rows):
            self.assertAlmostEqual(float(row["D.x"]), .2 * k)
        self.run_ok("probe", "run.pvd", "--stats", "--step", "1-2", "--field", "D.x", "-o", "a.svg")
        self.assertIn("<svg", (self.folder / "a.svg").read_text())
        found = self.run_ok("probe", "run.pvd", "--stats", "--step", "1-2", "--field", "D.x", "--json").json()
        self.assertEqual([step["step"] for step in found["steps"]], [1, 2])
        self.assertAlmostEqual(found["steps"][1]["stats"]["whole"]["fields"][0]["mean"], .6, delta=1e-3)
        late = self.run_ok("info", "run.pvd", "--time", 99, "--json").json()
        self.assertEqual((late["step"], late["time"]), (2, 1))
        self.assertIn("beyond the steps", "".join(late["warnings"]))
        self.assertAlmostEqual(self.value("time*2+0*T", "1,1,1", "--step", 1, mesh="run.pvd"), 1)
        self.assertIn("--time .5", self.run_fails("info", "run.pvd", "--step", ".5").err)
        self.assertIn("steps", self.run_ok("info", "run.pvd").out)
        self.run_fails("probe", "run.pvd", "--stats", "--at", "1,1,1", "--step", "all")
        for output, first in ("a_.png", "a_0000.png"), ("b.png", "b_0000.png"):
            self.run_ok("render", "run.pvd", "-o", output, "--step", "all", "--size", 24, "--warp", "D*3")
            self.assertTrue((self.folder / first).exists())

    def test_blocks_are_measured_in_regions_moved_and_over_steps(self):
        for k in range(2):
            write_beam(self.folder / f"b{k}.vtk", .1)
            self.run_ok("subdivide", f"b{k}.vtk", "-o", f"b{k}.vtu", "--levels", 0, "--only", f"half:0,0,{3},0,0,{2 * k - 1}")
        (self.folder / "b.vtm").write_text('<VTKFile type="vtkMultiBlockDataSet"><vtkMultiBlockDataSet><DataSet index="0" name="low" '
                                           'file="b0.vtu"/><DataSet index="1" name="high" file="b1.vtu"/></vtkMultiBlockDataSet></VTKFile>')
        for more in [], ["--only", "block:low,high"], ["--warp", "D*auto"], ["--only", "box:-9,-9,-9,9,9,9"], ["--only", "where:x>=0"]:
            with self.subTest(more):
                stats = self.run_ok("probe", "b.vtm", "--stats", "--field", "T", *more, "--json").json()["stats"]
                self.assertEqual([part["name"] for part in stats["parts"]], ["low", "high"])
                for part in stats["parts"]:
                    self.assertAlmostEqual(part["volume"], 12, delta=2e-3)
        (self.folder / "blocks.pvd").write_text('<VTKFile type="Collection"><Collection>' + "".join(
            f'<DataSet timestep="{k}" file="b.vtm"/>' for k in range(2)) + "</Collection></VTKFile>")
        self.run_ok("probe", "blocks.pvd", "--stats", "--step", "all", "--field", "T", "-o", "parts.csv", "--quiet")
        self.assertIn("low", (self.folder / "parts.csv").read_text())

    def test_velocity_is_that_of_the_flow_in_a_mesh_at_rest(self):
        text = (self.folder / "a.vtk").read_text()
        (self.folder / "flow.vtk").write_text(text.replace("\nD 3 ", "\nU 3 "))
        for output, more in ("a.vdb", []), ("b.vdb", ["--fields", "T"]):
            grids = self.run_ok("vdb", "flow.vtk", "-o", output, "--velocity", "--resolution", 12, "--json", *more).json()["grids"]
            velocity = next(grid for grid in grids if grid["name"] == "vel")
            self.assertEqual(velocity["kind"], "vector")
            self.assertAlmostEqual(velocity["max"], .6, delta=.06)
        self.assertIn("a vector field", self.run_fails("vdb", "a.vtk", "-o", "c.vdb", "--velocity").err)

    def test_bricks_have_quantities_without_derivatives(self):
        self.run_ok("split", "a.vtk", "-o", "a.bricks", "--bricks", 3)
        for field in "mises(STRESS)", "T*2+x", "D.x", "length(D)":
            with self.subTest(field):
                one, many = self.stats(field)[1], self.stats(field, mesh="a.bricks")[1]
                # Polynomials are integrated exactly, lengths and stresses to 1e-4 of their range.
                exact = field in ("T*2+x", "D.x")
                self.assertAlmostEqual(one["mean"], many["mean"], delta=1e-9 if exact else 1e-4 * (one["max"] - one["min"]) + 1e-9)
                self.run_ok("render", "a.bricks", "-o", "a.png", "--field", field, "--size", 24)
        self.assertIn("derivatives", self.run_fails("probe", "a.bricks", "--stats", "--field", "grad(T).x").err)
        self.run_fails("probe", "a.bricks", "--stats", "--warp", "D")

    def test_what_was_asked_for_is_said_quietly(self):
        self.assertIn("T 4", self.run_ok("probe", "a.vtk", "--at", "1,1,0", "--field", "T", "--quiet").out)
        self.assertIn("volume", self.run_ok("probe", "a.vtk", "--stats", "--quiet").out)

    def test_ranges_in_per_cent(self):
        for verb, name in ("render", "a.png"), ("slice", "b.png"), ("page", "a.html"):
            self.run_ok(verb, "a.vtk", "-o", name, "--range", "10%,90%")
            self.run_ok(verb, "a.vtk", "-o", name, "--tf-range", "3,4")
            self.run_fails(verb, "a.vtk", "-o", name, "--range", "90%,10%")
        found = self.run_ok("surface", "a.vtk", "-o", "a.ply", "--field", "T", "--iso", "50%", "--json").json()
        value = self.run_ok("surface", "a.vtk", "-o", "b.ply", "--field", "T", "--iso", "5.5", "--json").json()
        self.assertEqual(found["area"], value["area"])


if __name__ == "__main__":
    unittest.main()
