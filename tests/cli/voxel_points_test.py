# SPDX-License-Identifier: Apache-2.0
"""A .vdb grid as kernels: the splats look like rays through its voxels."""

import unittest

from command import InFolder, subvol

VIEW = ["--camera", "3,-4,2,0,0,0,0,0,1,35", "--opacity-unit", ".05", "--tf-range=-1,1", "--size", "96"]


class VoxelPoints(InFolder):
    def setUp(self):
        super().setUp()
        self.run_ok("vdb", "model:ball:4", "-o", "ball.vdb", "--resolution", "48", "--levels", "1", "--quiet")

    def compare(self, a, b):
        return self.run_ok("compare", a, b, "--json").json()

    def test_a_kernel_a_voxel_or_a_block(self):
        voxels = self.run_ok("info", "ball.vdb", "--json").json()["grids"][0]
        made = self.run_ok("points", "ball.vdb", "-o", "all.ply", "--json").json()
        self.assertEqual((made["points"], made["voxels_a_side"], made["field"]), (voxels["active_voxels"], 1, "density"))
        self.assertAlmostEqual(made["spacing"], voxels["voxel_size"], delta=1e-9)
        info = self.run_ok("info", "all.ply", "--json").json()
        self.assertEqual((info["points"], info["boundary_triangles"]), (made["points"], 0))
        for channel, extreme in [("min", voxels["min"]), ("max", voxels["max"])]:
            self.assertAlmostEqual(info["channels"][0][channel], extreme, delta=1e-6)
        coarse = self.run_ok("points", "ball.vdb", "-o", "few.ply", "--spacing", 2 * voxels["voxel_size"], "--json").json()
        self.assertEqual(coarse["voxels_a_side"], 2)
        # Blocks at the rim count if at least half full: some have fewer than eight voxels, and some voxels are left out.
        self.assertAlmostEqual(8 * coarse["points"], made["points"], delta=0.02 * made["points"])

    def test_splats_of_voxels_look_like_rays_through_them(self):
        self.run_ok("render", "ball.vdb", "-o", "grid.exr", "--method", "grid", *VIEW)
        drawn = self.run_ok("render", "ball.vdb", "-o", "splat.exr", "--backend", "cpu", *VIEW, "--json").json()
        self.assertEqual((drawn["method"], drawn["field"]), ("splat", "density"))
        # The rim of the voxels has steps, that of the kernels is where half the weight is. There is no other visible difference.
        self.assertGreater(self.compare("grid.exr", "splat.exr")["psnr"], 30)
        self.run_ok("points", "ball.vdb", "-o", "ball.ply")
        self.run_ok("render", "ball.ply", "-o", "file.exr", "--backend", "cpu", *VIEW)
        self.assertEqual(self.compare("splat.exr", "file.exr")["max"], 0)

    def test_the_threshold_drops_what_is_not_seen(self):
        ramp = ["--opacity", "-1:0,0:0,1:.5"]
        all_of_it = self.run_ok("render", "ball.vdb", "-o", "all.exr", "--backend", "cpu", *VIEW, *ramp, "--json").json()
        fewer = self.run_ok("render", "ball.vdb", "-o", "seen.exr", "--backend", "cpu", *VIEW, *ramp, "--threshold", "0",
                            "--json").json()
        self.assertLess(fewer["points"], 0.9 * all_of_it["points"])
        self.assertEqual(fewer["points"] + fewer["dropped"], all_of_it["points"])
        self.assertEqual(self.compare("all.exr", "seen.exr")["max"], 0)

    def test_what_needs_a_mesh_is_refused(self):
        for words in (["points", "ball.vdb", "-o", "a.ply", "--per-edge", "2"],
                      ["points", "ball.vdb", "-o", "a.ply", "--levels", "1"],
                      ["points", "ball.vdb", "-o", "a.ply", "--field", "heat"],
                      ["render", "ball.vdb", "-o", "a.png", "--method", "tets"],
                      ["render", "ball.vdb", "-o", "a.png", "--seconds", "1"]):
            with self.subTest(" ".join(words)):
                done = subvol(*words, folder=self.folder)
                self.assertEqual(done.code, 2)
                self.assertRegex(done.err, r"^subvol: [^\n]+\n$", "one sentence")
        self.assertEqual(self.files(), ["ball.vdb"])


if __name__ == "__main__":
    unittest.main()
