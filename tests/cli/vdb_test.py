# SPDX-License-Identifier: Apache-2.0
"""Grids: the effects of the options of `vdb`."""

import concurrent.futures
import json
import math
import os
import sys
import unittest

from command import TWO_FIELDS, InFolder, subvol


def write_box(path, offset=0.0, length=1.0):
    """A mesh of one cell: a unit cube that is moved and stretched along x."""
    points = [(offset + length * (k in (1, 2, 5, 6)), k in (2, 3, 6, 7), k > 3) for k in range(8)]
    vertices = "\n".join(f"{x} {int(y)} {int(z)} 0" for x, y, z in points)
    path.write_text(f"MeshVersionFormatted 2\nDimension 3\nVertices\n8\n{vertices}\n"
                    "Hexahedra\n1\n1 2 3 4 5 6 7 8 0\nEnd\n")


class Grids(InFolder):
    def vdb(self, *arguments, source="model:ball:4"):
        return self.run_ok("vdb", source, "-o", "a.vdb", "--quiet", "--json", *arguments).json()

    def test_every_grid_asked_for_is_there(self):
        made = self.vdb("--resolution", 40, "--cell-ids", "--mask", "--coverage", "--half", "--compression", "zip")
        self.assertEqual([grid["name"] for grid in made["grids"]], ["density", "cell", "mask", "coverage"])
        self.assertEqual([grid["kind"] for grid in made["grids"]], ["float", "integer", "mask", "float"])
        active = [grid["active_voxels"] for grid in made["grids"]]
        self.assertEqual(active[:3], [made["active_voxels"]] * 3)
        self.assertGreater(active[3], active[0])  # voxels that are covered, but not at their centre

    def test_the_limit_is_a_level_and_says_how_far_off(self):
        made = self.vdb("--resolution", 30, "--density", "1")
        self.assertGreaterEqual(made["levels"], 1)
        self.assertLessEqual(made["limit_deviation"]["voxels"], 0.1)
        self.assertLessEqual(made["limit_deviation"]["of_range"], 1e-3)
        self.assertEqual(made["warnings"], [])

    def test_the_limit_of_a_rough_field_is_reached_by_finer_pieces(self):
        smooth = self.vdb("--resolution", 30, "--density", "x*y")
        rough = self.vdb("--resolution", 30, "--density", "sin(1e4*x*y)")  # neighbouring control points have unrelated values
        self.assertGreater(rough["cells"], 10 * smooth["cells"])
        self.assertGreater(rough["levels"], smooth["levels"])
        self.assertLessEqual(rough["limit_deviation"]["of_range"], 1e-3)

    def test_parts_hold_the_voxels_of_the_whole(self):
        whole = self.vdb("--resolution", 200, "--levels", 0)
        parts = self.vdb("--resolution", 200, "--levels", 0, "--memory", "8M")
        self.assertGreater(parts["parts"], 1)
        self.assertEqual(parts["active_voxels"], whole["active_voxels"])
        manifest = json.loads((self.folder / "a.json").read_text())
        self.assertEqual(len(manifest["parts"]), parts["parts"])
        for part in manifest["parts"]:
            self.assertTrue((self.folder / part["file"]).exists())
            self.assertLessEqual(sum(grid["bytes"] for grid in part["grids"]), 8 << 20)

    def test_grids_are_computed_renamed_and_mapped(self):
        (self.folder / "two.vtk").write_text(TWO_FIELDS)
        made = self.vdb("--fields", "density=Temp,heat=(Temp-293)/20+max(z,0),V,speed=length(V)", "--remap", "293,303:0,1", "--resolution", 8,
                        "--levels", 0, source="two.vtk")
        grids = {grid["name"]: grid for grid in made["grids"]}
        self.assertEqual([(name, grid["kind"]) for name, grid in grids.items()],
                         [("density", "float"), ("heat", "float"), ("V", "vector"), ("speed", "float")])
        info = self.run_ok("info", "a.vdb", "--at", ".25,.5,.5", "--json").json()
        self.assertEqual([grid["kind"] for grid in info["grids"]], ["float", "float", "vector", "float"])
        values = {entry["field"]: entry["value"] for entry in info["at"]}
        self.assertAlmostEqual(values["density"], .5, delta=1e-3)  # 298 of 293..303
        self.assertAlmostEqual(values["heat"], .75, delta=1e-3)
        self.assertAlmostEqual(values["V.z"], 1, delta=1e-3)
        self.assertEqual(grids["density"]["max"], 1)  # 313 is beyond 303
        for field in ("V", "V.x", "speed"):
            self.run_ok("render", "a.vdb", "-o", "a.png", "--field", field, "--method", "grid", "--size", 16)
        self.run_ok("points", "a.vdb", "-o", "a.ply", "--field", "V.z")
        refused = subvol("render", "a.vdb", "-o", "a.png", "--field", "sped", folder=self.folder)
        self.assertEqual((refused.code, "did you mean speed?" in refused.err), (2, True), refused.err)

    def test_voxels_near_the_background_are_left_out(self):
        # On one cell T - 293 = 20 x: of the layers along x, those up to the tolerance go.
        (self.folder / "two.vtk").write_text(TWO_FIELDS)
        fields = ["--fields", "warm=Temp-293,V", "--resolution", 20]

        def grids(*options, name="a.vdb"):
            return {grid["name"]: grid for grid in self.run_ok("vdb", "two.vtk", "-o", name, *fields, *options, "--json").json()["grids"]}

        whole = grids(name="whole.vdb")["warm"]["active_voxels"]
        layers = round(whole ** (1 / 3))
        self.assertEqual(layers ** 3, whole)
        voxel = self.run_ok("info", "whole.vdb", "--json").json()["grids"][0]["voxel_size"]
        gone = sum(20 * voxel * i <= 6.5 for i in range(layers))
        self.assertGreater(gone, 5)
        left = grids("--prune", 6.5)["warm"]
        self.assertEqual(left["active_voxels"], (layers - gone) * layers ** 2)
        self.assertGreater(left["min"], 6.5)
        # The length of V = (1 - z, 0, 2 z) is never below 2 / √5.
        self.assertEqual(grids("--prune", .89)["V"]["active_voxels"], whole)
        self.assertLess(grids("--prune", .95)["V"]["active_voxels"], whole)
        # In shares, in parts, in frames and of kernels it is the same.
        for part in (1, 2):
            self.run_ok("vdb", "two.vtk", "-o", f"p{part}.vdb", *fields, "--prune", 6.5, "--part", f"{part}/2")
        self.run_ok("join", "p1.vdb", "p2.vdb", "-o", "joined.vdb")
        joined = self.run_ok("info", "joined.vdb", "--json").json()["grids"]
        self.assertEqual([grid["active_voxels"] for grid in joined if grid["name"] == "warm"], [left["active_voxels"]])
        done = self.run_ok("vdb", "two.vtk", "-o", "m.vdb", *fields, "--prune", 6.5, "--memory", "1G", "--json").json()
        self.assertEqual(next(grid for grid in done["grids"] if grid["name"] == "warm")["active_voxels"], left["active_voxels"])
        # Level sets stay as they are.
        sizes = [self.run_ok("vdb", "model:ball:4", "-o", "s.vdb", "--resolution", 16, "--sdf", *words, "--json").json()["grids"][1]["active_voxels"]
                 for words in ([], ["--prune", 0.1])]
        self.assertEqual(sizes[0], sizes[1])
        for wrong, said in (("-1", "out of range"), ("x", "--prune"), ("99", "leaves no voxel")):
            done = subvol("vdb", "two.vtk", "-o", "x.vdb", *fields, f"--prune={wrong}", folder=self.folder)
            self.assertEqual(done.code, 2, wrong)
            self.assertRegex(done.err, rf"^subvol: [^\n]*{said}[^\n]*\n$")

    def test_up_and_scale_turn_and_stretch(self):
        write_box(self.folder / "long.mesh", 0, 4)
        self.run_ok("vdb", "long.mesh", "-o", "b.vdb", "--resolution", 16, "--up", "y", "--scale", 10, "--density", "z")
        low, high = self.run_ok("info", "b.vdb", "--json").json()["grids"][0]["bounds"]
        for axis, (least, most) in enumerate([(0, 40), (0, 10), (-10, 0)]):  # z is now y; y is now -z
            self.assertAlmostEqual(low[axis], least, delta=2.6)
            self.assertAlmostEqual(high[axis], most, delta=2.6)
        at = self.run_ok("info", "b.vdb", "--at", "20,7.5,-5", "--json").json()["at"][0]
        self.assertAlmostEqual(at["value"], .75, delta=.01)

    def test_overshoot_is_said_and_ends(self):
        peak = ["--density", "abs(x)+abs(y)+abs(z)<.1", "--resolution", 40]
        said = self.run_ok("vdb", "model:ball:4", "-o", "a.vdb", *peak)
        self.assertRegex(said.err, r"density 0…1 becomes -0\.\d+…1.*--clamp")
        made = self.vdb(*peak, "--clamp")
        self.assertEqual((made["grids"][0]["min"], made["grids"][0]["max"] <= 1), (0, True))
        said = self.run_ok("subdivide", "model:ball:4", "-o", "a.vtu", *peak[:2])
        self.assertIn("becomes", said.err)
        self.assertNotIn("becomes", self.run_ok("subdivide", "model:ball:4", "-o", "a.vtu", *peak[:2], "--clamp").err)
        fine = ["points", "model:ball:4", "-o", "a.ply", *peak[:2], "--per-edge", 2]
        self.assertIn("becomes", self.run_ok(*fine).err)
        self.assertGreater(self.run_ok(*fine, "--clamp", "--json").json()["clamped"], 0)

    def test_refused_fields_and_ranges(self):
        for arguments, naming in [(["--fields", "a=1+nothing"], "position 2"), (["--fields", "a=densty"], "did you mean density?"),
                                  (["--fields", "a=x,a=y"], "two grids"), (["--fields", "=x"], "empty"), (["--remap", "1"], "LO,HI"),
                                  (["--remap", "2,2"], "no width"), (["--remap", "heat=0,1"], "the grids are: density"),
                                  (["--scale", "0"], "--scale"), (["--up", "x"], "--up")]:
            done = subvol("vdb", "model:ball:2", "-o", "a.vdb", *arguments, folder=self.folder)
            self.assertEqual((done.code, naming in done.err), (2, True), done.err)

    def test_a_budget_is_kept_to_about(self):
        made = self.vdb("--budget", "4M", "--levels", 1)
        size = sum(grid["bytes"] for grid in made["grids"])
        self.assertGreater(size, 2 << 20)
        self.assertLess(size, 8 << 20)

    def test_like_takes_the_voxels_of_another_file(self):
        first = self.vdb("--voxel-size", 0.07, "--levels", 1)
        self.run_ok("vdb", "model:ball:4", "-o", "b.vdb", "--like", "a.vdb", "--levels", 1, "--quiet")
        again = self.run_ok("info", "b.vdb", "--json").json()["grids"][0]
        self.assertEqual(again["active_voxels"], first["active_voxels"])
        self.assertAlmostEqual(again["voxel_size"], 0.07, delta=1e-12)

    def test_kernel_sums_tell_how_far_they_are_from_the_mesh(self):
        made = self.vdb("--from", "points", "--resolution", 40, source="model:twist:10")
        self.assertEqual(made["points"], 11**3)
        (against,) = made["against_mesh"]
        self.assertEqual(against["voxels"], made["active_voxels"])
        finer = self.vdb("--from", "points", "--resolution", 40, "--per-edge", 2, source="model:twist:10")
        self.assertLess(finer["against_mesh"][0]["l2"], against["l2"])
        self.assertLess(against["l2"], 0.05)  # of a range of 2

    def test_a_level_set_stands_beside_the_other_grids(self):
        made = self.vdb("--resolution", 60, "--sdf", "--half-width", 4, source="model:ball:8")
        self.assertEqual([grid["name"] for grid in made["grids"]], ["density", "sdf"])
        h, level_set = made["voxel_size"], made["grids"][1]
        self.assertIn("density", made["grids"][0])
        self.assertNotIn("density", level_set)  # distances have none
        self.assertTrue(level_set["level_set"])
        self.assertLess(abs(level_set["min"] + 4 * h), 0.1 * h)  # the band is whole on both sides
        self.assertLess(abs(level_set["max"] - 4 * h), 0.1 * h)
        shell = 4 * 3.14159 * 8 / h**2  # voxels of a shell of radius 1
        self.assertAlmostEqual(level_set["active_voxels"] / shell, 1, delta=0.05)
        named = self.vdb("--resolution", 20, "--sdf", "surface")
        self.assertEqual(named["grids"][1]["name"], "surface")

    def test_nanovdb_beside_it_or_the_reason(self):
        done = subvol("vdb", "model:ball:2", "-o", "a.vdb", "--resolution", 20, "--nano", folder=self.folder)
        if done.code == 3:
            self.assertIn("libnanovdb-dev", done.err)
            self.assertEqual(self.files(), [])
        else:
            self.assertEqual((done.code, self.files()), (0, ["a.nvdb", "a.vdb"]))
            self.assertEqual((self.folder / "a.nvdb").read_bytes()[:8], b"NanoVDB0")

    def test_points_of_a_file_give_the_sums_of_the_mesh(self):
        write_box(self.folder / "one.mesh")
        self.run_ok("subdivide", "one.mesh", "-o", "box.mesh", "--levels", 2, "--quiet")
        density = ("--density", "sin(4*x)*y+z")
        self.run_ok("vdb", "box.mesh", "-o", "mesh.vdb", "--from", "points", "--voxel-size", 0.03, "--quiet", *density)
        for points in ("p.ply", "p.vtp", "p.vdb"):
            self.run_ok("points", "box.mesh", "-o", points, "--quiet", *density)
            made = self.vdb("--voxel-size", 0.03, "--from", "points", source=points)
            self.assertEqual((made["points"], made["active_voxels"]), (125, 34**3))
            off = self.run_ok("compare", "a.vdb", "mesh.vdb", "--json").json()
            self.assertLess(off["linf"], 1e-6, points)  # float values up to 2, and the rounding of positions in a .vdb

    def test_the_extension_may_be_in_capitals(self):
        self.run_ok("vdb", "model:ball:2", "-o", "a.vdb", "--resolution", 8)
        self.run_ok("points", "model:ball:2", "-o", "p.vdb")
        for name in ("a", "p"):
            os.rename(self.folder / f"{name}.vdb", self.folder / f"{name.upper()}.VDB")
        self.assertGreater(self.run_ok("info", "A.VDB", "--json").json()["grids"][0]["active_voxels"], 0)
        self.assertGreater(self.run_ok("info", "P.VDB", "--json").json()["points"], 0)
        self.run_ok("render", "A.VDB", "-o", "a.png", "--size", 16, "--backend", "cpu")

    def test_refusals(self):
        self.run_ok("points", "model:ball:2", "-o", "p.ply", "--quiet")
        for code, source, *arguments in [
                (2, "model:ball:2", "--voxel-size", 0.1, "--resolution", 20), (2, "model:ball:2", "--from", "air"),
                (2, "model:ball:2", "--from", "points", "--memory", "1G"), (2, "model:ball:2", "--half-width", 3),
                (2, "model:ball:2", "--velocity"), (2, "model:ball:2", "--fps", 24), (2, "p.ply", "--levels", 1),
                (2, "p.ply", "--fields", "heat"), (2, "model:ball:2", "--frames", "1-3"), (2, "model:#", "--frames", "3-1"),
                (2, "in_##.mesh"), (2, "model:ball:2", "--sdf", "density")]:
            done = subvol("vdb", source, "-o", "a.vdb", *arguments, folder=self.folder)
            self.assertEqual(done.code, code, f"{arguments}: {done.err}")
            self.assertEqual(self.files(), ["p.ply"])

    def test_a_link_stays_and_its_file_is_written(self):
        (self.folder / "there").mkdir()
        (self.folder / "a.vdb").symlink_to("there/grid.vdb")
        for resolution in (10, 12):  # where there is no file yet, and where there is one
            made = self.vdb("--resolution", resolution)
            self.assertTrue((self.folder / "a.vdb").is_symlink())
            self.assertEqual(os.listdir(self.folder / "there"), ["grid.vdb"])
            grid = self.run_ok("info", "there/grid.vdb", "--json").json()["grids"][0]
            self.assertEqual(grid["active_voxels"], made["active_voxels"])

    def test_a_pipe_gets_the_whole_file(self):
        os.mkfifo(self.folder / "a.vdb")
        with concurrent.futures.ThreadPoolExecutor() as pool:
            piped = pool.submit((self.folder / "a.vdb").read_bytes)
            made = self.vdb("--resolution", 10)
            (self.folder / "copy.vdb").write_bytes(piped.result())
        grid = self.run_ok("info", "copy.vdb", "--json").json()["grids"][0]
        self.assertEqual(grid["active_voxels"], made["active_voxels"])
        self.assertTrue((self.folder / "a.vdb").is_fifo())


class Frames(InFolder):
    """Sequences of a box of one cell that moves, is stretched, or changes its cells."""

    def frames(self, *arguments, source="in_###.mesh"):
        return self.run_ok("vdb", source, "-o", "out_##.vdb", "--voxel-size", 0.125, "--density", "x+2*y", "--quiet",
                           "--json", *arguments).json()

    def test_a_frame_is_as_if_it_were_alone(self):
        # Its limit is as fine in each cell as it must be: refining all cells as far as the finest one took ten times as long.
        for k in (1, 2, 3):
            self.run_ok("subdivide", "model:pawn:16", "-o", f"run_{k}.vtu", "--levels", 0, *(["--density", "sin(3*z)"] if k == 2 else []))
        made = self.run_ok("vdb", "run_#.vtu", "-o", "out_#.vdb", "--frames", "1-3", "--resolution", 48, "--json").json()
        self.assertLess(1.5 * made["cells"], 1024 * 8 ** (made["levels"] - 1))  # pieces, of several levels; the pawn has 1024 cells
        self.assertNotIn("tables", made["seconds"])
        for k in (1, 2, 3):
            self.run_ok("vdb", f"run_{k}.vtu", "-o", f"alone_{k}.vdb", "--resolution", 48)
            apart = self.run_ok("compare", f"out_{k}.vdb", f"alone_{k}.vdb", "--json").json()
            self.assertEqual(apart["linf"], 0, apart)

    def test_numbered_files_are_exported_as_each_by_itself(self):
        for frame in (8, 9, 10):
            write_box(self.folder / f"in_{frame:03}.mesh", offset=0.25 * (frame - 8))
        made = self.frames("--frames", "8-10", "--levels", 1)
        self.assertEqual([frame["output"] for frame in made["frames"]], ["out_08.vdb", "out_09.vdb", "out_10.vdb"])
        self.assertEqual(made["active_voxels"], 3 * 512)
        for frame in made["frames"]:
            alone = self.run_ok("vdb", f"in_{frame['frame']:03}.mesh", "-o", "a.vdb", "--voxel-size", 0.125, "--levels", 1,
                                "--density", "x+2*y", "--json", "--quiet").json()
            self.assertEqual(frame["grids"], alone["grids"])
            self.assertEqual(self.run_ok("compare", "a.vdb", frame["output"], "--json").json()["linf"], 0)

    def test_velocity_is_that_of_the_points(self):
        for frame in range(1, 5):  # the place grows with the square of time: 0, 0.22, 0.88, 1.98
            write_box(self.folder / f"in_{frame:03}.mesh", offset=0.22 * (frame - 1) ** 2)
        made = self.frames("--frames", "4", "--velocity", "--fps", "24")
        for frame, speed in zip(made["frames"], (0.22, 0.44, 0.88, 1.1)):  # central differences, one-sided at the ends
            velocity = frame["grids"][-1]
            self.assertEqual((velocity["name"], velocity["kind"]), ("vel", "vector"))
            self.assertAlmostEqual(velocity["min"], 24 * speed, places=5)
            self.assertAlmostEqual(velocity["max"], 24 * speed, places=5)
            self.assertEqual(frame["active_voxels"], 8 ** 3)
            layers = math.ceil(speed / 2 / 0.125) + 1  # half a frame's motion, and one voxel for interpolation
            self.assertEqual(velocity["active_voxels"], (8 + 2 * layers) ** 3)

    def test_velocities_that_reach_too_far_are_told(self):
        for frame in (1, 2):
            write_box(self.folder / f"in_{frame:03}.mesh", offset=20.0 * frame)
        made = self.frames("--frames", "2", "--velocity")
        self.assertEqual([frame["grids"][-1]["active_voxels"] for frame in made["frames"]], [(8 + 2 * 64) ** 3] * 2)
        self.assertEqual(sum("blur" in warning for warning in made["warnings"]), 2)

    def test_one_mesh_becomes_another(self):
        write_box(self.folder / "short.mesh")
        write_box(self.folder / "long.mesh", length=2.0)
        made = self.frames("--to", "long.mesh", "--frames", "1-5", "--velocity", "--sdf", source="short.mesh")
        self.assertEqual([frame["active_voxels"] for frame in made["frames"]], [512, 640, 768, 896, 1024])
        for frame in made["frames"]:  # the far end moves by a quarter per frame, the near end not at all
            self.assertEqual([grid["name"] for grid in frame["grids"]], ["density", "vel", "sdf"])
            self.assertAlmostEqual(frame["grids"][1]["min"], 0, places=6)
            self.assertLess(frame["grids"][1]["max"], 0.25)
            self.assertGreater(frame["grids"][1]["max"], 0.2)

    def test_cells_that_change_are_exported_without_velocity(self):
        write_box(self.folder / "in_001.mesh")
        self.run_ok("subdivide", "in_001.mesh", "-o", "in_002.mesh", "--quiet")
        write_box(self.folder / "in_003.mesh", offset=0.25)  # and back again
        made = self.frames("--frames", "3")
        self.assertEqual([frame["active_voxels"] for frame in made["frames"]], [512, 512, 512])
        before = self.files()
        for arguments in (("in_###.mesh", "--velocity"), ("in_001.mesh", "--to", "in_002.mesh")):
            done = subvol("vdb", *arguments, "-o", "new_#.vdb", "--frames", "2", folder=self.folder)
            self.assertEqual(done.code, 2, done.err)
            self.assertIn("cells", done.err)
            self.assertEqual(self.files(), before)

    def test_a_frame_that_is_missing_is_named(self):
        write_box(self.folder / "in_001.mesh")
        done = subvol("vdb", "in_###.mesh", "-o", "out_#.vdb", "--frames", "1-2", folder=self.folder)
        self.assertEqual(done.code, 2, done.err)
        self.assertIn("in_002.mesh", done.err)


if __name__ == "__main__":
    sys.exit(unittest.main())
