# SPDX-License-Identifier: Apache-2.0
"""Quantities, regions, displacement and steps mean the same in every command."""

import csv
import math
import unittest

from command import InFolder, subvol


def write_beam(path, bend):
    """A bar of 2 x 2 x 6 unit cells along z with a temperature, a displacement and a stress at its points."""
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
{rows([(0, 0, 10 * (x - 1), 0, 3, 0) for x, y, z in points])}
p%200 1 {len(points)} double
{rows([(x,) for x, y, z in points])}
""")


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
                self.assertAlmostEqual(one["mean"], many["mean"], delta=1e-9)
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
