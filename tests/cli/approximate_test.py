# SPDX-License-Identifier: Apache-2.0
"""`subvol approximate`: meshes, tables and grids become fields of a control mesh."""

import unittest

from command import InFolder, subvol

FIELD = "sin(2*x)+y*z"


class Approximate(InFolder):
    def fit(self, *words):
        return self.run_ok("approximate", *words, "--json").json()

    def test_a_mesh_that_is_a_limit_is_found_again(self):
        self.run_ok("subdivide", "model:twist:4", "--density", FIELD, "-o", "fine.vtu", "--levels", "2")
        found = self.fit("fine.vtu", "--onto", "model:twist:4", "-o", "fitted.vtu")
        self.assertEqual((found["points"], found["cells"], found["outside"], found["unseen"]), (125, 64, 0, 0))
        self.assertLess(found["fields"]["density"]["max"], 1e-10)
        self.assertGreater(found["fields"]["density"]["range"], 1)
        self.run_ok("subdivide", "model:twist:4", "--density", FIELD, "-o", "same.vtu", "--levels", "0")
        same = self.run_ok("compare", "fitted.vtu", "same.vtu", "--field", "density", "--json").json()
        self.assertLess(same["linf"], 1e-6)

    def test_a_table_of_measurements(self):
        rows = [f"{x / 7},{y / 7},{z / 7},{1 + 2 * x / 7 - y / 7},{z / 7}" for x in range(8) for y in range(8) for z in range(8)]
        (self.folder / "box.vtk").write_text(box_of_cells(3))
        (self.folder / "measured.csv").write_text("\n".join(["x,y,z,T,p", *rows, "5,5,5,0,0", ""]))
        found = self.fit("measured.csv", "--onto", "box.vtk", "-o", "fitted.vtu")
        self.assertEqual((found["samples"], found["outside"]), (512, 1))
        self.assertEqual(set(found["fields"]), {"T", "p"})
        self.assertLess(found["fields"]["T"]["max"], 1e-5)  # MCQ reproduces what is linear
        at = self.run_ok("probe", "fitted.vtu", "--at", ".5,.25,.75", "--field", "T", "--json").json()
        self.assertAlmostEqual(at["values"][0]["value"], 1.75, 4)

    def test_a_grid(self):
        self.run_ok("vdb", "model:twist:8", "--density", FIELD, "-o", "grid.vdb", "--resolution", "48", "--quiet")
        coarse = self.fit("grid.vdb", "--onto", "model:twist:2", "-o", "coarse.vtu")
        finer = self.fit("grid.vdb", "--onto", "model:twist:2", "-o", "finer.vtu", "--refine", "1", "--tolerance", "1e-4")
        self.assertEqual((coarse["refined"], coarse["cells"], finer["refined"]), (0, 8, 1))
        self.assertIn(finer["cells"], (16, 32, 64))  # sheets across one, two or three directions
        self.assertLess(finer["fields"]["density"]["rms"], .5 * coarse["fields"]["density"]["rms"])

    def test_fog_gets_a_box_of_its_own_and_stays_fog(self):
        # A ball of fog with a hard edge, which a smooth limit rings at.
        self.run_ok("vdb", "model:ball:6", "--density", "2-x*x-y*y-z*z", "-o", "fog.vdb", "--resolution", "40", "--quiet")
        grid = self.run_ok("info", "fog.vdb", "--json").json()["grids"][0]
        found = self.fit("fog.vdb", "--cells", "10", "-o", "fitted.vtu")
        self.assertEqual((found["points"], found["cells"]), (1331, 1000))
        self.assertNotIn("onto", found)
        about = self.run_ok("info", "fitted.vtu", "--json").json()
        for end, sign in ((0, -1), (1, 1)):
            for box, voxels in zip(about["bounds"][end], grid["bounds"][end]):
                self.assertAlmostEqual(box, voxels + sign * grid["voxel_size"] / 2, places=5)
        self.assertEqual(about["fields"][0]["min"], 0)
        self.run_ok("vdb", "fitted.vtu", "--clamp", "-o", "back.vdb", "--resolution", "40", "--quiet")
        self.assertEqual(self.run_ok("info", "back.vdb", "--json").json()["grids"][0]["min"], 0)
        # Of a sequence the box is about all frames.
        self.run_ok("vdb", "model:ball:6", "-o", "s_2.vdb", "--resolution", "20", "--scale", "2", "--quiet")
        (self.folder / "fog.vdb").rename(self.folder / "s_1.vdb")
        self.fit("s_#.vdb", "--frames", "1-2", "--cells", "6", "-o", "f_#.vtu")
        for frame in (1, 2):
            low, high = self.run_ok("info", f"f_{frame}.vtu", "--json").json()["bounds"]
            self.assertGreater(min(high) - max(low), 3.9)
        for words, said in ((["s_1.vdb"], "--cells N"), (["model:ball:4"], "--onto"), (["model:ball:4", "--cells", "3"], "--cells"),
                            (["s_1.vdb", "--cells", "3", "--onto", "model:ball:4"], "--onto"), (["s_1.vdb", "--cells", "0"], "--cells")):
            done = subvol("approximate", *words, "-o", "x.vtu", folder=self.folder)
            self.assertEqual(done.code, 2, words)
            self.assertRegex(done.err, r"^subvol: [^\n]*\n$")
            self.assertIn(said, done.err)

    def test_a_level_set_is_the_background_below_zero_inside(self):
        self.run_ok("vdb", "model:ball:4", "-o", "ball.vdb", "--sdf", "--resolution", "40", "--quiet")
        grids = self.run_ok("info", "ball.vdb", "--json").json()["grids"]
        background = 3 * next(grid["voxel_size"] for grid in grids if grid["name"] == "sdf")
        self.fit("ball.vdb", "--field", "sdf", "--onto", "model:ball:4", "-o", "fitted.vtu")
        self.fit("ball.vdb", "--field", "density", "--onto", "model:ball:4", "-o", "fog.vtu")
        fog = self.run_ok("probe", "model:ball:4", "--at", "0,0,0", "--json").json()["values"][0]["value"]
        for file, value in (("fitted.vtu", -background), ("fog.vtu", fog)):
            at = self.run_ok("probe", file, "--at", "0,0,0", "--json").json()["values"][0]["value"]
            # The ball is deeper than three voxels there; its cells are as wide as several voxels, and smooth the ends of the band.
            self.assertLess(abs(at / value - 1), .1)

    def test_coarse_data_on_a_fine_mesh(self):
        (self.folder / "coarse.vtk").write_text(box_of_cells(2))
        self.run_ok("subdivide", "coarse.vtk", "--density", "x*y-2*z", "--scheme", "linear", "-o", "data.vtu", "--levels", "0")
        self.run_ok("subdivide", "coarse.vtk", "--scheme", "linear", "-o", "fine.vtu", "--levels", "2")
        found = self.fit("data.vtu", "--onto", "fine.vtu", "-o", "fitted.vtu", "--scheme", "linear")
        self.assertEqual((found["undecided"], found["continuous"]), (0, True))
        self.assertGreater(found["between"], 0)
        self.assertLess(found["fields"]["density"]["max_between"], 1e-6)
        at = self.run_ok("probe", "fitted.vtu", "--at", ".4,.7,.3", "--scheme", "linear", "--json").json()
        self.assertAlmostEqual(at["values"][0]["value"], .4 * .7 - .6, 5)  # trilinear in each coarse cell

    def test_warns_where_samples_decide_nothing(self):
        rows = [f"{x / 9},{y / 9},{z / 9},{x}" for x in range(4) for y in range(10) for z in range(10)]
        (self.folder / "box.vtk").write_text(box_of_cells(4))
        (self.folder / "side.csv").write_text("\n".join(["x,y,z,T", *rows, ""]))
        done = self.run_ok("approximate", "side.csv", "--onto", "box.vtk", "-o", "fitted.vtu")
        self.assertRegex(done.err, r"samples hardly decide the values of \d+ control points, 50 of which have none near them")
        at = self.run_ok("probe", "fitted.vtu", "--at", ".95,.5,.5", "--field", "T", "--json").json()
        self.assertAlmostEqual(at["values"][0]["value"], 9 * .95, 5)  # a linear function is continued

    def test_an_error_at_the_boundary_is_one_of_samples_there(self):
        (self.folder / "box.vtk").write_text(box_of_cells(4))
        inside = [f"{x},{y},{z},{x * x}" for x in (.3, .5, .7) for y in (.3, .5, .7) for z in (.3, .5, .7)]
        for more, known in ([], False), (["0.1,0.5,0.5,7"], True):
            (self.folder / "few.csv").write_text("\n".join(["x,y,z,T", *inside, *more, ""]))
            done = self.run_ok("approximate", "few.csv", "--onto", "box.vtk", "-o", "fitted.vtu")
            self.assertEqual("at the boundary" in done.out, known)
            found = self.run_ok("approximate", "few.csv", "--onto", "box.vtk", "-o", "fitted.vtu", "--json").json()["fields"]["T"]
            self.assertEqual(found["rms_boundary"] is not None, known)

    def test_clamp(self):
        rows = [f"{x / 9},{y / 9},{z / 9},{int(x + y > 9)}" for x in range(10) for y in range(10) for z in range(10)]
        (self.folder / "box.vtk").write_text(box_of_cells(4))
        (self.folder / "front.csv").write_text("\n".join(["x,y,z,T", *rows, ""]))
        for words, least in (([], -1), (["--clamp"], 0)):
            self.fit("front.csv", "--onto", "box.vtk", "-o", "fitted.vtu", *words)
            found = self.run_ok("info", "fitted.vtu", "--json").json()["fields"]
            low = next(field for field in found if field["name"] == "T")["min"]
            self.assertEqual(low >= 0, least == 0)
            self.assertGreater(low, least - 1e-12)

    def test_the_steps_of_a_series(self):
        for number in range(3):
            self.run_ok("subdivide", "model:twist:3", "--density", f"sin(4*x+{number})*cos(3*z)", "-o", f"step_{number}.vtu", "--levels", "2")
        files = "".join(f'<DataSet timestep="{number / 4}" file="step_{number}.vtu"/>' for number in range(3))
        (self.folder / "run.pvd").write_text(f'<VTKFile type="Collection"><Collection>{files}</Collection></VTKFile>')
        found = self.fit("run.pvd", "--onto", "model:twist:2", "-o", "fitted_##.vtu", "--step", "all")
        self.assertEqual(found["placements"], 1)  # the points stay
        self.assertEqual([(step["frame"], step["time"], step["output"]) for step in found["frames"]],
                         [(0, 0, "fitted_00.vtu"), (1, .25, "fitted_01.vtu"), (2, .5, "fitted_02.vtu")])
        frames = self.fit("step_#.vtu", "--onto", "model:twist:2", "-o", "frame_#.vtu", "--frames", "0-2")
        self.assertEqual(frames["placements"], 1)
        for number, step in enumerate(found["frames"]):
            one = self.fit("run.pvd", "--onto", "model:twist:2", "-o", "one.vtu", "--step", str(number))
            self.assertEqual((step["fields"], step["samples"], step["iterations"]), (one["fields"], one["samples"], one["iterations"]))
            self.assertEqual(frames["frames"][number]["fields"], one["fields"])
            alone = (self.folder / "one.vtu").read_bytes()
            self.assertEqual((self.folder / f"fitted_0{number}.vtu").read_bytes(), alone)
            self.assertEqual((self.folder / f"frame_{number}.vtu").read_bytes(), alone)
        self.fit("run.pvd", "--onto", "model:twist:2", "-o", "later_##.vtu", "--step", "1-2")
        self.assertEqual((self.folder / "later_02.vtu").read_bytes(), (self.folder / "fitted_02.vtu").read_bytes())
        self.assertNotIn("later_00.vtu", self.files())

    def test_samples_that_are_measured_again(self):
        (self.folder / "box.vtk").write_text(box_of_cells(2))
        places = [(x / 5, y / 5, z / 5) for x in range(6) for y in range(6) for z in range(6)]
        for number, shift in ((1, 0), (2, 0), (3, .01)):
            rows = [f"{x + shift},{y},{z},{x * number - z}" for x, y, z in places]
            (self.folder / f"m_{number}.csv").write_text("\n".join(["x,y,z,T", *rows, ""]))
        found = self.fit("m_#.csv", "--onto", "box.vtk", "-o", "fitted_#.vtu", "--frames", "3")
        self.assertEqual(found["placements"], 2)  # the sensors of the third were moved
        at = self.run_ok("probe", "fitted_2.vtu", "--at", ".5,.25,.75", "--field", "T", "--json").json()
        self.assertAlmostEqual(at["values"][0]["value"], .25, 4)

    def test_says_what_is_wrong_with_a_series(self):
        self.run_ok("subdivide", "model:twist:2", "--density", FIELD, "-o", "a_0.vtu", "--levels", "1")
        self.run_ok("model", "twist", "-o", "a_1.vtu", "--resolution", "3")
        (self.folder / "run.pvd").write_text('<VTKFile type="Collection"><Collection><DataSet timestep="0" file="a_0.vtu"/>'
                                             '<DataSet timestep="1" file="a_1.vtu"/></Collection></VTKFile>')
        (self.folder / "m_1.csv").write_text("x,y,z,T\n0,0,0,1\n")
        (self.folder / "m_2.csv").write_text("x,y,z,T\n90,0,0,1\n")
        to = ("-o", "fitted_#.vtu")
        for words, part in ((["run.pvd", "--step", "all", "-o", "fitted.vtu"], "fitted.vtu: has no # for the number of the step"),
                            (["run.pvd", "--step", "all", "--refine", "1", *to], "--refine: all steps have the same control mesh"),
                            (["run.pvd", "--step", "all", "--shape", *to], "--shape: moves control points, and all steps have the same"),
                            (["run.pvd", "--step", "1-7", *to], "there is no step 7"),
                            (["run.pvd", "--step", "all", "--frames", "2", *to], "run.pvd: has no # for the number of the frame"),
                            (["m_#.csv", *to], "--frames: is needed for a sequence"),
                            (["m_#.csv", "--frames", "3", *to], "1 of 3 frames are missing: m_3.csv"),
                            (["m_#.csv", "--frames", "2", "-o", "f.vtu"], "f.vtu: has no # for the number of the frame"),
                            (["m_#.csv", "--frames", "2", "--step", "all", *to], "--step"),
                            (["m_#.csv", "--frames", "2", *to], "m_2.csv: none of the samples lies in the limit")):
            done = subvol("approximate", *words, "--onto", "model:ball:2", folder=self.folder)
            self.assertEqual(done.code, 2, done.err)
            self.assertIn(part, done.err)

    def test_values_at_points_are_those_of_the_cells(self):
        (self.folder / "coarse.vtk").write_text(box_of_cells(2))
        (self.folder / "fine.vtk").write_text(box_of_cells(5))
        self.run_ok("subdivide", "coarse.vtk", "--density", "4+x*y-2*z", "-o", "data.vtu", "--levels", "0")
        found = self.fit("data.vtu", "--onto", "fine.vtk", "-o", "mapped.vtu", "--at-points")
        self.assertEqual((found["outside"], found["farthest_world"], found["points"]), (0, 0, 216))
        self.assertEqual(found["warnings"], [])
        # x y is trilinear in each of the coarse cells, so that it is met at all points.
        self.run_ok("subdivide", "fine.vtk", "--density", "4+x*y-2*z", "-o", "exact.vtu", "--levels", "0")
        compared = self.run_ok("compare", "mapped.vtu", "exact.vtu", "--field", "density", "--scheme", "linear", "--json").json()
        self.assertLess(compared["linf"], 1e-6)
        # Of a ball the points outside of the box have the values at the nearest place, and are counted.
        self.run_ok("subdivide", "model:ball:3", "-o", "ball.vtu", "--levels", "0")
        found = self.fit("data.vtu", "--onto", "ball.vtu", "-o", "ball_of.vtu", "--at-points")
        self.assertRegex(found["warnings"][-1], rf"{found['outside']} points of {found['points']} lie outside of data.vtu, at most .* nearest place")
        self.assertGreater(found["outside"], found["points"] / 2)
        at = self.run_ok("info", "ball_of.vtu", "--json").json()["fields"][0]
        self.assertGreaterEqual(at["min"], 2)
        self.assertLessEqual(at["max"], 5)
        for words, part in ((["--levels", "1"], "--levels: is about a fit"), (["--scheme", "linear"], "--scheme: is about a fit"),
                            (["--refine", "1"], "--refine: is about a fit")):
            done = subvol("approximate", "data.vtu", "--onto", "fine.vtk", "-o", "no.vtu", "--at-points", *words, folder=self.folder)
            self.assertEqual((done.code, part in done.err), (2, True), done.err)
        (self.folder / "T.csv").write_text("x,y,z,T\n0,0,0,1\n")
        done = subvol("approximate", "T.csv", "--onto", "fine.vtk", "-o", "no.vtu", "--at-points", folder=self.folder)
        self.assertEqual((done.code, "T.csv: has no cells" in done.err), (2, True), done.err)
        self.assertNotIn("no.vtu", self.files())

    def test_says_what_is_wrong(self):
        (self.folder / "holes.csv").write_text("x,y,z,T\n0,0,0,1\n0,0,1,\n")
        (self.folder / "T.csv").write_text("x,y,z,T\n0,0,0,1\n")
        self.run_ok("points", "model:ball:2", "-o", "a.ply")
        (self.folder / "places.csv").write_text("x,y,z\n0,0,0\n")
        for words, part in ((["holes.csv"], "holes.csv:3: column 4 has no number here"), (["places.csv"], "places.csv: has no column of values"),
                            (["none.csv"], "none.csv"), (["T.csv", "--only", "box:0,0,0,1,1,1"], "--only: needs a mesh; this is a table"),
                            (["T.csv", "--field", "T"], "--field: needs a mesh or a grid"), (["a.ply"], "a.ply: has kernels"),
                            (["model:ball", "--warp", "density"], "model:ball: --warp"),
                            (["model:ball", "--tolerance", ".1"], "--tolerance: has no effect without --refine")):
            done = subvol("approximate", *words, "--onto", "model:ball:2", "-o", "fitted.vtu", folder=self.folder)
            self.assertEqual(done.code, 2, done.err)
            self.assertIn(part, done.err)
            self.assertNotIn("fitted.vtu", self.files())
        done = subvol("approximate", "model:ball", "--onto", "model:ball:2", "-o", "fitted.stl", folder=self.folder)
        self.assertEqual(done.code, 2, done.err)


def box_of_cells(n):
    """The unit cube as n×n×n cells, legacy VTK."""
    side = n + 1
    points = [f"{x / n} {y / n} {z / n}" for z in range(side) for y in range(side) for x in range(side)]
    corners = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    cells = [" ".join(["8", *(str((x + i) + side * ((y + j) + side * (z + k))) for i, j, k in corners)])
             for z in range(n) for y in range(n) for x in range(n)]
    return "\n".join(["# vtk DataFile Version 3.0", "box", "ASCII", "DATASET UNSTRUCTURED_GRID", f"POINTS {len(points)} double", *points,
                      f"CELLS {len(cells)} {9 * len(cells)}", *cells, f"CELL_TYPES {len(cells)}", *["12"] * len(cells), ""])


if __name__ == "__main__":
    unittest.main()
