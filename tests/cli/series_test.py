# SPDX-License-Identifier: Apache-2.0
"""Series of meshes: their steps are listed, chosen, and written a file a step."""

import unittest

from command import InFolder, subvol

# A unit cube that moves along x, at x = t², with the field t + z.
TIMES = [0, 1, 3]


def cube(t):
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    points = " ".join(f"{x + t * t} {y} {z}" for x, y, z in corners)
    values = " ".join(str(t + z) for x, y, z in corners)
    return f"""<VTKFile type="UnstructuredGrid" version="0.1"><UnstructuredGrid><Piece NumberOfPoints="8" NumberOfCells="1">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">{points}</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3 4 5 6 7</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">8</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">12</DataArray></Cells>
<PointData><DataArray type="Float64" Name="f" format="ascii">{values}</DataArray></PointData>
</Piece></UnstructuredGrid></VTKFile>"""


class Series(InFolder):
    def setUp(self):
        super().setUp()
        for k, t in enumerate(TIMES):
            (self.folder / f"t{k}.vtu").write_text(cube(t))
        sets = "".join(f'<DataSet timestep="{t}" file="t{k}.vtu"/>' for k, t in enumerate(TIMES))
        (self.folder / "run.pvd").write_text(f'<VTKFile type="Collection"><Collection>{sets}</Collection></VTKFile>')

    def error(self, *arguments):
        done = subvol(*arguments, folder=self.folder)
        self.assertEqual(done.code, 2, done.err)
        return done.err

    def test_info_lists_the_steps(self):
        info = self.run_ok("info", "run.pvd", "--json").json()
        self.assertEqual((info["steps"], info["times"], info["step"], info["blocks"]), (3, TIMES, 2, []))
        self.assertIn("the file has 3 steps; the last one is read", info["warnings"])
        for chosen in (["--step", "1"], ["--time", "1.9"]):
            info = self.run_ok("info", "run.pvd", "--json", *chosen).json()
            self.assertEqual((info["step"], info["bounds"][0][0]), (1, 1))
            self.assertEqual(info["warnings"], [])

    def test_a_grid_a_step_with_velocities(self):
        report = self.run_ok("vdb", "run.pvd", "-o", "g_##.vdb", "--step", "all", "--resolution", "10", "--velocity",
                             "--json").json()
        self.assertEqual(report["times"], TIMES)
        # x = t²: the velocity is the difference over the steps beside, (1 - 0) / 1, (9 - 0) / 3, (9 - 1) / 2.
        for frame, t, velocity in zip(report["frames"], TIMES, [1, 3, 4]):
            f, v = frame["grids"]
            self.assertEqual(f["active_voxels"], 1000)
            self.assertAlmostEqual(f["min"], t, delta=1e-6)
            self.assertEqual((v["name"], v["kind"]), ("vel", "vector"))
            self.assertAlmostEqual(v["max"], velocity, delta=1e-5)
        self.assertIn(b"subvol_time", (self.folder / "g_02.vdb").read_bytes())
        self.run_ok("vdb", "run.pvd", "-o", "h_#.vdb", "--step", "1-2", "--resolution", "10")
        self.assertEqual([name for name in self.files() if name.startswith("h_")], ["h_1.vdb", "h_2.vdb"])

    def test_pictures_have_one_range_of_colours(self):
        view = ["--backend", "cpu", "--size", "32", "--camera", "5,-9,3,5,0,.5,0,0,1,60", "--opacity-unit", ".1"]
        self.run_ok("render", "run.pvd", "-o", "p_#.exr", "--step", "all", *view)
        for k in range(len(TIMES)):
            self.run_ok("render", f"t{k}.vtu", "-o", "one.exr", "--tf-range", "0,4", *view)
            self.run_ok("compare", f"p_{k}.exr", "one.exr", "--fail-under", "psnr=100")

    def test_grids_of_steps_are_mapped_turned_and_scaled_too(self):
        asked = ["--resolution", "10", "--remap", "0,4", "--up", "y", "--scale", "2", "--json"]
        report = self.run_ok("vdb", "run.pvd", "-o", "g_##.vdb", "--step", "all", *asked).json()
        self.assertAlmostEqual(report["voxel_size"], 0.2)
        for frame, t in zip(report["frames"], TIMES):
            self.assertAlmostEqual(frame["grids"][0]["min"], t / 4, delta=1e-6)  # a voxel centre lies at z = 0
            one = self.run_ok("vdb", f"t{TIMES.index(t)}.vtu", "-o", "one.vdb", *asked).json()["grids"][0]
            grid = self.run_ok("info", f"g_{TIMES.index(t):02}.vdb", "--json").json()["grids"][0]
            self.assertEqual([grid["active_voxels"], grid["min"], grid["max"]], [one["active_voxels"], one["min"], one["max"]])
            self.assertAlmostEqual(grid["bounds"][0][1], 0, delta=0.11)  # z is up in the file, y in the grid

    def test_points_of_steps(self):
        report = self.run_ok("points", "run.pvd", "-o", "k_#.ply", "--step", "0-1", "--json").json()
        self.assertEqual([(f["time"], f["output"]) for f in report["frames"]], [(0, "k_0.ply"), (1, "k_1.ply")])
        self.assertEqual(self.run_ok("info", "k_1.ply", "--json").json()["bounds"][0][0], 1)

    def test_mistakes_are_explained(self):
        self.assertIn("run.pvd: there is no step 3 (steps are 0 to 2)", self.error("info", "run.pvd", "--step", "3"))
        self.assertIn("there is no step 5", self.error("vdb", "run.pvd", "-o", "a_#.vdb", "--step", "1-5"))
        self.assertIn("'x' is not a step", self.error("info", "run.pvd", "--step", "x"))
        self.assertIn("only one step can be read here", self.error("info", "run.pvd", "--step", "all"))
        self.assertIn("has no # for the number of the step", self.error("vdb", "run.pvd", "-o", "a.vdb", "--step", "all"))
        self.assertIn("such files have no named blocks", self.error("info", "t0.vtu", "--blocks", "a"))
        self.assertIn("this is a model", self.error("info", "model:ball", "--step", "0"))
        self.assertIn("--curved", self.error("info", "t0.vtu", "--curved", "0"))
        (self.folder / "one.pvd").write_text('<VTKFile type="Collection"><Collection><DataSet timestep="0" file="t0.vtu"/>'
                                             '</Collection></VTKFile>')
        self.assertIn("needs at least two frames", self.error("vdb", "one.pvd", "-o", "a_#.vdb", "--step", "all", "--velocity"))


if __name__ == "__main__":
    unittest.main()
