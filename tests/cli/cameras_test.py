# SPDX-License-Identifier: Apache-2.0
"""A named view is one camera for a mesh, its bricks, its points and its grid; the camera that was used is in reports and pictures."""

import json
import os
import unittest
from pathlib import Path

from command import InFolder, subvol

MODELS = ["model:twist:4", "model:ball:6"]
FILES = ["vtkdata_can.vtu", "sibl_bunny_conforming.mesh", "geos_crackInPlane_benchmark.vtu", "sofa_cylinder_hexa.msh"]


class Cameras(InFolder):
    def render(self, body, picture="a.exr", *options, size="60x40"):
        done = subvol("render", body, "-o", picture, "--size", size, "--json", *options, folder=self.folder)
        self.assertEqual(done.code, 0, done.err)
        return done.json()

    def bytes_of(self, name):
        return (self.folder / name).read_bytes()

    def make(self, *command):
        done = subvol(*command, folder=self.folder)
        self.assertEqual(done.code, 0, done.err)

    def meshes(self):
        folder = os.environ.get("SUBVOL_DATA")
        yield from MODELS
        for name in FILES if folder else []:
            if (Path(folder) / name).is_file():
                yield str(Path(folder) / name)

    def test_a_mesh_its_bricks_and_its_grid_have_one_camera(self):
        for mesh in self.meshes():
            with self.subTest(mesh=mesh):
                # Bricks have values at points alone.
                of_points = [] if mesh in MODELS else ["--cell-values", "mean"]
                self.make("split", mesh, "-o", "bricks", "--bricks", "3")
                self.make("vdb", mesh, "-o", "grid.vdb", "--resolution", "24")
                self.make("vdb", "bricks", "-o", "of_bricks.vdb", "--voxel-size", self.voxel_size("grid.vdb"))
                for look in [["--look", "volume"], ["--look", "solid"], ["--look", "volume", "--opacity", "0%:0,70%:0,80%:1"]]:
                    whole = self.render(mesh, "whole.exr", *look, *of_points)["camera"]
                    self.assertEqual(self.render("bricks", "bricks.exr", *look)["camera"], whole)
                    self.assertEqual(self.bytes_of("bricks.exr"), self.bytes_of("whole.exr"))  # ∞ dB
                whole = self.render(mesh, "whole.exr", "--look", "volume", "--view", "-y")["camera"]
                for grid in ("grid.vdb", "of_bricks.vdb"):
                    self.assertEqual(self.render(grid, "grid.exr", "--method", "grid", "--view", "-y")["camera"], whole)
                    self.assertEqual(self.render(grid, "grid.exr", "--view", "-y", "--spacing", self.voxel_size(grid))["camera"], whole)

    def voxel_size(self, grid):
        done = subvol("info", grid, "--json", folder=self.folder)
        return str(done.json()["grids"][0]["voxel_size"])

    def test_a_foreign_grid_is_framed_by_its_voxels(self):
        folder = os.environ.get("SUBVOL_DATA")
        smoke = Path(folder or "") / "arnold_smoke.vdb"
        if not smoke.is_file():
            self.skipTest("SUBVOL_DATA does not name the folder of arnold_smoke.vdb")
        camera = self.render(str(smoke), "a.exr", "--method", "grid", "--view", "-y")["camera"]
        grid = subvol("info", str(smoke), "--json").json()["grids"][0]
        low, high = grid["bounds"]
        for k in (0, 2):  # in the middle of the picture; bounds are of centres, the same distance inside on both sides
            self.assertAlmostEqual(camera["target"][k], (low[k] + high[k]) / 2, places=6)

    def test_data_whose_y_is_up_stand_upright(self):
        # The same body twice: as it is, and with its z along y.
        self.make("model", "twist", "--resolution", "4", "-o", "z.vtu")
        self.make("vdb", "z.vtu", "-o", "z.vdb", "--resolution", "24")
        self.make("vdb", "z.vtu", "-o", "y.vdb", "--resolution", "24", "--up", "y")
        for side in ("iso", "front", "top"):
            z = self.render("z.vdb", "z.exr", "--method", "grid", "--view", side)["camera"]
            y = self.render("y.vdb", "y.exr", "--method", "grid", "--view", side, "--up", "y")["camera"]
            for key in ("eye", "target", "up"):
                turned = [z[key][0], z[key][2], -z[key][1]]
                for k in range(3):
                    self.assertAlmostEqual(y[key][k], turned[k], places=6, msg=(side, key))
        self.assertEqual(self.render("y.vdb", "y.exr", "--method", "grid", "--view", "+z", "--up", "y")["camera"]["up"], [0, 1, 0])
        # A turntable turns about that axis: the eye stays at its height.
        self.render("y.vdb", "turn.png", "--method", "grid", "--turntable", "2", "--up", "y")
        # Views of a session, too, and what a page says to its buttons.
        (self.folder / "turn.json").write_text(json.dumps([{"view": "-x"}, {"view": "iso"}, {"save_state": "state.json"}]))
        self.make("view", "z.vtu", "--size", "60x40", "--backend", "cpu", "--script", "turn.json", "--screenshot", "a.png", "--up", "y")
        camera = json.loads((self.folder / "state.json").read_text())["camera"]
        self.assertEqual(camera["up"], [0, 1, 0])
        self.assertTrue(all(end > start for end, start in zip(camera["eye"], camera["target"])))  # from +x, +y, +z
        self.make("page", "z.vtu", "-o", "a.html", "--up", "y", "--no-reference")
        self.assertIn('"up":"y"', (self.folder / "a.html").read_text())
        for wrong in (["--up", "w"], ["--up", "y", "--camera", "3,-4,2,0,0,0,0,0,1,35"]):
            done = subvol("render", "z.vtu", "-o", "a.png", *wrong, folder=self.folder)
            self.assertEqual(done.code, 2, wrong)
            self.assertRegex(done.err, r"^subvol: [^\n]*--up[^\n]*\n$")

    def test_a_report_is_a_camera_file(self):
        for options in [[], ["--ortho"], ["--view", "-x"], ["--camera", "3,-4,2,0,0,0,0,0,1,35"]]:
            report = self.render("model:ball:6", "a.png", *options)
            (self.folder / "report.json").write_text(json.dumps(report))
            again = self.render("model:ball:6", "b.png", "--camera", "report.json")
            self.assertEqual(again["camera"], report["camera"])
            self.assertEqual(self.bytes_of("a.png"), self.bytes_of("b.png"))

    def test_frames_and_sheets_have_a_camera_each(self):
        frames = self.render("model:ball:6", "a.png", "--turntable", "3")
        self.assertNotIn("camera", frames)
        self.assertEqual(len({json.dumps(camera) for camera in frames["cameras"]}), 3)
        for frame, camera in enumerate(frames["cameras"]):
            (self.folder / "one.json").write_text(json.dumps(camera))
            self.render("model:ball:6", "one.png", "--camera", "one.json")
            self.assertEqual(self.bytes_of("one.png"), self.bytes_of(f"a_{frame:04d}.png"))
        self.assertEqual(len(self.render("model:ball:6", "sheet.png", "--views", "4")["cameras"]), 4)

    def test_a_picture_has_its_camera_in_the_header(self):
        numbers = b"3,-4,2,0,0,0,0,0,1,35"
        camera = numbers.decode()
        self.render("model:ball:6", "a.exr", "--camera", camera)
        header = self.bytes_of("a.exr")
        name = header.index(b"subvolCamera\0string\0")
        self.assertEqual(header[name + 24:name + 24 + len(numbers)], numbers)
        for part in (1, 2):  # and so has what is joined
            self.render("model:ball:6", f"part{part}.exr", "--camera", camera, "--part", f"{part}/2")
        self.make("join", "part1.exr", "part2.exr", "-o", "joined.exr")
        self.assertEqual(self.bytes_of("joined.exr"), header)
        # With a legend at its side, the picture is not what the camera alone would show.
        self.render("model:ball:6", "legend.exr", "--camera", camera, "--legend", size="240x120")
        self.assertNotIn(b"subvolCamera", self.bytes_of("legend.exr"))


if __name__ == "__main__":
    unittest.main()
