# SPDX-License-Identifier: Apache-2.0
"""Options of splatting: light, colours of a second field, sheets, devices, a time budget; depth in .exr files."""

import unittest

from command import CUBE, X_AND_Z, InFolder, subvol

SMALL = ["--size", "64x48", "--quiet"]
SHEETS = ["--sheets", "40"]  # of splats


class Splats(InFolder):
    def render(self, name, *options, source="model:ball:4"):
        sheets = [] if "--method" in options else SHEETS
        return self.run_ok("render", source, "-o", name, *SMALL, *sheets, *options)

    def difference(self, a, b):
        return self.run_ok("compare", a, b, "--json").json()["max"]

    def has_gl(self):
        return bool(self.run_ok("info", "--gl", "--json").json()["gl"])

    def test_light_changes_colours_but_no_opacity(self):
        self.render("plain.exr", "--backend", "cpu", "--look", "volume")
        self.render("lit.exr", "--backend", "cpu", "--shade")
        self.assertGreater(self.difference("plain.exr", "lit.exr"), 0.05)
        self.render("alpha.exr", "--backend", "cpu", "--shade", "--opacity", "0%:0,100%:0")
        self.render("nothing.exr", "--backend", "cpu", "--opacity", "0%:0,100%:0")
        self.assertEqual(self.difference("alpha.exr", "nothing.exr"), 0)

    def test_shadows_take_light_but_no_opacity(self):
        small = ["model:ball:3", "--size", 32, "--look", "volume"]
        self.run_ok("render", *small, "-o", "plain.exr")
        done = self.run_ok("render", *small, "-o", "dark.exr", "--shadows", "--ambient-occlusion", ".1", "--json").json()
        self.assertGreater(done["seconds"]["light"], 0)
        self.assertLess(self.run_ok("compare", "plain.exr", "dark.exr", "--json").json()["psnr"], 60)
        for wrong in (["--method", "tets"], ["--method", "sheets"], ["--ambient-occlusion", "2"]):
            done = subvol("render", *small, "-o", "x.png", "--shadows", *wrong, folder=self.folder)
            self.assertEqual(done.code, 2, (wrong, done.err))

    def test_footprints_are_another_picture(self):
        small = ["model:ball:3", "--size", 32, "--look", "volume"]
        self.run_ok("render", *small, "-o", "splat.exr")
        done = self.run_ok("render", *small, "-o", "footprints.exr", "--method", "footprints", "--json").json()
        self.assertEqual((done["method"], done["backend"]), ("footprints", "cpu"))
        psnr = self.run_ok("compare", "splat.exr", "footprints.exr", "--json").json()["psnr"]
        self.assertTrue(20 < psnr < 50, psnr)  # the same thing, but blurred
        for wrong in (["--backend", "gl"], ["--sheets", "9"], ["--shadows"], ["--clip", "0,0,0,1,0,0"], ["--seconds", "1"],
                      ["--part", "1/2"]):
            done = subvol("render", *small, "-o", "x.exr", "--method", "footprints", *wrong, folder=self.folder)
            self.assertEqual(done.code, 2, (wrong, done.err))
            self.assertEqual(len(done.err.strip().splitlines()), 1, done.err)
            self.assertFalse((self.folder / "x.exr").exists())

    def test_colours_of_a_second_field(self):
        self.run_ok("points", "model:twist:6", "-o", "a.vtp")
        self.render("same.exr", "--backend", "cpu", "--color-field", "density", source="a.vtp")
        self.render("one.exr", "--backend", "cpu", source="a.vtp")
        self.assertEqual(self.difference("same.exr", "one.exr"), 0)
        (self.folder / "two.vtk").write_text(X_AND_Z)
        for name, options in [("xx", ["--field", "x"]), ("xz", ["--field", "x", "--color-field", "z"]), ("zz", ["--field", "z"])]:
            self.render(name + ".exr", "--backend", "cpu", "--view", "-y", "--look", "volume", *options, source="two.vtk")
        self.assertGreater(self.difference("xx.exr", "xz.exr"), 0.05)
        self.assertGreater(self.difference("xz.exr", "zz.exr"), 0.05)
        done = subvol("render", "model:ball:4", "-o", "x.png", "--color-field", "nowhere", folder=self.folder)
        self.assertEqual((done.code, "nowhere" in done.err), (2, True), done.err)
        self.assertNotIn("x.png", self.files())

    def test_sheets_and_kernels_make_the_same_picture(self):
        if not self.has_gl():
            self.skipTest("no OpenGL 4.5 through EGL")
        self.render("cpu.exr", "--backend", "cpu")
        self.render("gl.exr", "--backend", "gl")
        done = self.run_ok("render", "model:ball:4", "-o", "sheets.exr", *SMALL, *SHEETS, "--method", "sheets", "--json")
        self.assertEqual((done.json()["method"], done.json()["backend"]), ("sheets", "gl"))
        self.assertLess(self.difference("cpu.exr", "gl.exr"), 1e-4)
        self.assertLess(self.difference("cpu.exr", "sheets.exr"), 1e-4)

    def test_projected_tetrahedra_are_like_rays(self):
        if not self.has_gl():
            self.skipTest("no OpenGL 4.5 through EGL")
        self.render("tets.exr", "--method", "tets")
        for order in ("topological", "centroid", "lists", "havs"):
            done = self.run_ok("render", "model:ball:4", "-o", "pt.exr", *SMALL, "--method", "pt", "--order", order, "--json")
            report = done.json()
            self.assertEqual((report["method"], report["backend"], report["order"]), ("pt", "gl", order))
            if order != "centroid":
                self.assertLess(self.difference("tets.exr", "pt.exr"), 1e-4)
        samples = ["--samples", "2"]
        self.render("tets.exr", "--method", "tets", *samples)
        for order in ("topological", "havs"):
            self.render("pt.exr", "--method", "pt", "--order", order, *samples)
            self.assertLess(self.difference("tets.exr", "pt.exr"), 1e-4)
        for refused in (["--backend", "cpu"], ["--shade"], ["--order", "random"], ["--lod", "0.5"],
                        ["--order", "havs", "--kbuffer", "0"], ["--order", "havs", "--lod", "2"]):
            done = subvol("render", "model:ball:4", "-o", "x.png", "--method", "pt", *refused, folder=self.folder)
            self.assertEqual(done.code, 2, done.err)

    def test_faces_are_left_out_and_counted(self):
        if not self.has_gl():
            self.skipTest("no OpenGL 4.5 through EGL")
        self.render("tets.exr", "--method", "tets", "--look", "volume")
        last = 1
        for lod in 0, 0.1, 0.5, 1:
            report = self.run_ok("render", "model:ball:4", "-o", "pt.exr", *SMALL, "--method", "pt", "--order", "havs",
                                 "--kbuffer", "8", "--look", "volume", "--lod", lod, "--json").json()
            rmse = self.run_ok("compare", "tets.exr", "pt.exr", "--json").json()["rmse"]
            self.assertLess(rmse, last)
            self.assertEqual(report["faces_drawn"] == report["faces"], lod == 1)
            self.assertEqual(report["late_faces"], 0)
            last = rmse

    def test_distant_views_draw_merged_kernels(self):
        near, far = ["--camera", "0,-6,0,0,0,0,0,0,1,30"], ["--camera", "0,-90,0,0,0,0,0,0,1,30"]
        self.run_ok("points", "model:ball:4", "-o", "ball.ply", "--per-edge", 2)
        every = {}
        for place, camera in ("near", near), ("far", far):
            every[place] = self.render_json("all.exr", *camera)["points"]
            self.render("none.exr", *camera, "--lod", 0, source="ball.ply")
            self.assertEqual(self.difference("all.exr", "none.exr"), 0)
            report = self.render_json("merged.exr", *camera, "--lod", 4)
            self.assertEqual(report["points"], every[place])
            if place == "near":
                self.assertEqual((report["kernels_drawn"], report["kernels_merged"]), (every[place], 0))
                self.assertEqual(self.difference("all.exr", "merged.exr"), 0)
            else:
                self.assertLess(report["kernels_drawn"], every[place] / 4)
                self.assertGreater(report["kernels_merged"], every[place] / 2)
                self.assertGreater(report["merge_error"], 0)
                self.assertGreater(self.run_ok("compare", "all.exr", "merged.exr", "--json").json()["psnr"], 40)

    def render_json(self, name, *options):
        return self.run_ok("render", "ball.ply", "-o", name, *SMALL, *SHEETS, *options, "--json").json()

    def test_levels_of_detail_are_refused_where_there_are_none(self):
        for options, says in (
            (["--lod", "-1"], "--lod"),
            (["--lod", "nan"], "--lod"),
            (["--lod", "2", "--method", "tets"], "it draws everything"),
            (["--lod", "2", "--seconds", "1"], "--seconds"),
            (["--lod", "2", "--method", "pt", "--order", "havs"], "0 to 1"),
        ):
            done = subvol("render", "model:ball:4", "-o", "x.png", *options, folder=self.folder)
            self.assertEqual((done.code, done.err.count("\n")), (2, 1), done.err)
            self.assertIn(says, done.err)

    def test_a_turntable_of_merged_kernels_has_the_bits_of_its_frames(self):
        camera = ["--view", "-y", "--lod", "6", "--look", "volume"]
        self.run_ok("render", "model:ball:4", "-o", "turn_##.exr", *SMALL, *camera, "--per-edge", 2, "--turntable", 3)
        for part in "1/2", "2/2":
            self.run_ok("render", "model:ball:4", "-o", "part_##.exr", *SMALL, *camera, "--per-edge", 2, "--turntable", 3,
                        "--part", part)
        for frame in "00", "01", "02":
            self.assertEqual(self.difference(f"turn_{frame}.exr", f"part_{frame}.exr"), 0)

    def test_tetrahedra_keep_a_time_too(self):
        if not self.has_gl():
            self.skipTest("no OpenGL 4.5 through EGL")
        self.render("tets.exr", "--method", "tets", "--samples", "2")
        done = self.run_ok("render", "model:ball:4", "-o", "pt.exr", *SMALL, "--method", "pt", "--samples", "2",
                           "--seconds", "6000", "--json").json()
        self.assertTrue(done["finished"])
        self.assertLess(self.difference("tets.exr", "pt.exr"), 1e-4)
        done = self.run_ok("render", "model:ball:4", "-o", "pt.exr", *SMALL, "--method", "pt", "--seconds", "1e-6",
                           "--json").json()
        self.assertEqual((done["finished"], done["steps"]), (False, 1))

    def test_samples_smooth_the_rim(self):
        self.render("rays.exr", "--method", "tets", "--samples", "4")
        errors = []
        for samples in 1, 4:
            self.render("splats.exr", "--backend", "cpu", "--samples", samples)
            errors.append(self.run_ok("compare", "rays.exr", "splats.exr", "--json").json()["rmse"])
        self.assertLess(errors[1], errors[0])

    def test_devices_that_are_not_there_are_refused(self):
        done = subvol("render", "model:ball:4", "-o", "x.png", "--backend", "gl", "--device", "99", folder=self.folder)
        self.assertEqual(done.code, 3, done.err)
        done = subvol("render", "model:ball:4", "-o", "x.png", "--backend", "cpu", "--device", "0", folder=self.folder)
        self.assertEqual((done.code, "--device" in done.err), (2, True), done.err)
        done = subvol("render", "model:ball:4", "-o", "x.png", "--backend", "cpu", "--method", "sheets", folder=self.folder)
        self.assertEqual(done.code, 2, done.err)
        self.assertEqual(self.files(), [])

    def test_a_time_is_kept_with_the_best_picture(self):
        done = self.run_ok("render", "model:twist:6", "-o", "a.png", "--size", "64", "--backend", "cpu", "--seconds", "6000",
                           "--json").json()
        self.assertEqual((done["picture_scale"], done["footprint_px"]), (1, 1))
        self.assertGreater(done["points"], 343)
        done = self.run_ok("render", "model:twist:6", "-o", "b.png", "--size", "64", "--backend", "cpu", "--seconds", "1e-6",
                           "--json").json()
        self.assertEqual((done["picture_scale"], done["steps"]), (4, 1))

    def test_rays_through_dense_grids_and_voxels_see_the_same_ball(self):
        view = ["--camera", "3,-4,2,0,0,0,0,0,1,35", "--opacity-unit", ".05", "--tf-range=-1,1"]
        self.render("splat.exr", "--backend", "cpu", *view)
        dense = self.run_ok("render", "model:ball:4", "-o", "dense.exr", "--method", "dense", "--levels", "2", *SMALL, *view,
                            "--json").json()
        self.assertEqual((dense["method"], dense["lost_rays"]), ("dense", 0))
        self.run_ok("vdb", "model:ball:4", "-o", "ball.vdb", "--resolution", "80", "--quiet")
        self.render("grid.exr", "--method", "grid", *view, source="ball.vdb")
        # The splats' boundary is refined once; voxels have steps at the boundary.
        for name, least in [("dense.exr", 35), ("grid.exr", 22)]:
            self.assertGreater(self.run_ok("compare", "splat.exr", name, "--json").json()["psnr"], least, name)

    def test_a_cell_alone_is_drawn(self):
        (self.folder / "cell.mesh").write_text(CUBE.format(last=8))
        self.render("cell.exr", "--backend", "cpu", "--density", "x", "--shade", source="cell.mesh")
        self.render("none.exr", "--backend", "cpu", "--density", "x", "--opacity", "0%:0,100%:0", source="cell.mesh")
        self.assertGreater(self.difference("cell.exr", "none.exr"), 0.1)


if __name__ == "__main__":
    unittest.main()
