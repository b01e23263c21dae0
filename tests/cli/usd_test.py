# SPDX-License-Identifier: Apache-2.0
"""OpenUSD text of the command."""
import unittest
from pathlib import Path

from command import InFolder, subvol

RUN = ("<VTKFile type=\"Collection\"><Collection><DataSet timestep=\"0\" file=\"a.vtu\"/><DataSet timestep=\"1\" file=\"b.vtu\"/>"
       "</Collection></VTKFile>")


class Usd(InFolder):
    def run_command(self, *arguments):
        return subvol("usd", *arguments, folder=self.folder)

    def text(self, name):
        return (Path(self.folder) / name).read_text()

    def test_a_mesh_and_its_grid(self):
        done = self.run_command("model:ball:4", "-o", "ball.usda", "--resolution", "12", "--tf", "plasma", "--json")
        report = done.json()
        self.assertEqual((report["files"], report["codes"], report["grids"]), (["ball.vdb"], [0], ["density"]))
        self.assertIn("asset filePath = @./ball.vdb@", self.text("ball.usda"))
        self.assertEqual(subvol("info", "ball.vdb", "--json", folder=self.folder).json()["grids"][0]["name"], "density")

    def test_steps_are_time_samples(self):
        for name in "ab":
            subvol("subdivide", "model:ball:4", "-o", f"{name}.vtu", "--levels", "0", folder=self.folder)
        (Path(self.folder) / "run.pvd").write_text(RUN)
        done = self.run_command("run.pvd", "-o", "run.usda", "--step", "all", "--resolution", "8")
        self.assertEqual(done.code, 0, done.err)
        text = self.text("run.usda")
        for step in (0, 1):
            self.assertIn(f"{step}: @./run_000{step}.vdb@,", text)
            self.assertTrue((Path(self.folder) / f"run_000{step}.vdb").exists())
        again = self.run_command("run_0000.vdb", "run_0001.vdb", "-o", "again.usda")
        self.assertEqual(again.code, 0, again.err)
        self.assertEqual(self.text("again.usda").replace('"again"', '"run"').replace("</again/", "</run/"), text)

    def test_kernels_are_splats(self):
        subvol("points", "model:ball:4", "-o", "ball.svk", folder=self.folder)
        report = self.run_command("ball.svk", "-o", "splats.usda", "--json").json()
        self.assertEqual(report["channels"], ["density"])
        text = self.text("splats.usda")
        self.assertIn('def ParticleField3DGaussianSplat "splats"', text)
        positions = next(line for line in text.splitlines() if "point3f[] positions" in line)
        self.assertEqual(positions.count("("), report["points"][0])

    def test_a_stage_says_which_axis_is_up(self):
        subvol("points", "model:ball:4", "-o", "ball.svk", folder=self.folder)
        for name, words, axis in (("a", [], "Z"), ("b", ["--up", "z"], "Z"), ("c", ["--up", "y"], "Y")):
            for source in ("model:ball:4", "ball.svk"):
                voxels = ["--resolution", "8"] if source.startswith("model") else []
                self.assertEqual(self.run_command(source, "-o", f"{name}.usda", *voxels, *words).code, 0)
                self.assertIn(f'\n    upAxis = "{axis}"\n', self.text(f"{name}.usda"))
        done = self.run_command("ball.svk", "-o", "x.usda", "--up", "x")
        self.assertEqual(done.code, 2)
        self.assertRegex(done.err, r"^subvol: --up: [^\n]*y or z[^\n]*\n$")

    def test_what_is_no_stage_is_refused(self):
        subvol("points", "model:ball:4", "-o", "ball.svk", folder=self.folder)
        subvol("vdb", "model:ball:4", "-o", "ball.vdb", "--resolution", "8", folder=self.folder)
        for words, said in ((["model:ball:4", "-o", "a.usd"], "did you mean .usda"), (["model:ball:4", "-o", "a.usda", "--tf", "none"], "none"),
                            (["ball.vdb", "ball.svk", "-o", "a.usda"], "not as the first"),
                            (["model:ball:4", "model:ball:4", "-o", "a.usda"], "second mesh"),
                            (["ball.vdb", "-o", "a.usda", "--half"], "--half"),
                            (["ball.svk", "-o", "a.usda", "--opacity-unit", "1"], "--opacity-unit"),
                            (["ball.vdb", "-o", "a.usda", "--field", "density"], "--field")):
            done = self.run_command(*words)
            self.assertEqual(done.code, 2, words)
            self.assertIn(said, done.err)
            self.assertEqual(done.err.count("\n"), 1, done.err)
        self.assertFalse(list(Path(self.folder).glob("a.*")))


if __name__ == "__main__":
    unittest.main()
