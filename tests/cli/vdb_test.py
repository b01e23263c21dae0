"""Grids: what the options of `vdb` promise."""

import json
import sys
import unittest

from command import InFolder, subvol


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

    def test_a_limit_that_is_not_reached_is_said(self):
        made = self.vdb("--resolution", 30, source="model:twist:24")  # its field is cut off: no level draws the kink
        self.assertGreater(made["limit_deviation"]["of_range"], 1e-3)
        self.assertRegex(made["warnings"][0], "level . was the finest within limits")

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

    def test_refusals(self):
        for code, *arguments in [(3, "--nano"), (2, "--voxel-size", 0.1, "--resolution", 20), (2, "--from", "air"),
                                 (2, "--from", "points", "--memory", "1G")]:
            done = subvol("vdb", "model:ball:2", "-o", "a.vdb", *arguments, folder=self.folder)
            self.assertEqual(done.code, code, done.err)
            self.assertEqual(self.files(), [])


if __name__ == "__main__":
    sys.exit(unittest.main())
