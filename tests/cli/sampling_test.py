# SPDX-License-Identifier: Apache-2.0
"""The ways to turn a mesh into points, as the options of `points` and `render` name them."""

import unittest

from command import InFolder, subvol


class Sampling(InFolder):
    def points(self, *options, model="model:pawn:16"):
        return self.run_ok("points", model, "-o", "p.ply", "--json", *options).json()

    def test_intervals_and_spacings_count(self):
        self.assertEqual(self.points(model="model:twist:4")["points"], 5**3)
        self.assertEqual(self.points("--per-edge", 2, model="model:twist:4")["points"], 9**3)
        self.assertEqual(self.points("--per-edge", 3, model="model:twist:4")["points"], 13**3)
        self.assertGreater(self.points("--spacing-voxels", 4)["points"], self.points("--spacing-voxels", 8)["points"])

    def test_a_tolerance_is_kept_and_reported(self):
        coarse, fine = self.points("--tolerance", 0.05), self.points("--tolerance", 0.02)
        self.assertLessEqual(coarse["largest_error"], 0.05)
        self.assertLessEqual(fine["largest_error"], 0.02)
        self.assertLess(coarse["points"], fine["points"])

    def test_a_footprint_follows_the_size_of_the_picture(self):
        small = self.points("--footprint", "iso", "--footprint-size", 32)["points"]
        large = self.points("--footprint", "iso", "--footprint-size", 64)["points"]
        self.assertLess(small, large)

    def test_rules_and_kernels_are_named(self):
        for rule in ("scheme", "cubic", "paper"):
            self.points("--values", rule, "--per-edge", 2)
        self.points("--values", "paper", "--value-kernel", "two_gaussians", "--per-edge", 2, "--correction", "none")
        self.points("--kernel", '{"type": "gaussian", "sigma": 0.5, "radius": 2}')
        info = self.run_ok("info", "p.ply", "--json").json()
        self.assertEqual((info["kernel"]["type"], info["kernel"]["sigma"]), ("gaussian", 0.5))

    def test_what_cannot_be_seen_is_dropped_and_not_missed(self):
        everything = self.points(model="model:pawn:32")["points"]
        kept = self.points("--threshold", 0, model="model:pawn:32")
        self.assertEqual(kept["points"] + kept["dropped"], everything)
        self.assertGreater(kept["dropped"], everything / 4)
        by_map = self.points("--threshold", "--tf", "surface", model="model:pawn:32")
        self.assertEqual(by_map["points"], kept["points"])
        for name, options in ("all.exr", []), ("kept.exr", ["--threshold"]):
            self.run_ok("render", "model:pawn:32", "-o", name, "--tf", "surface", "--size", 96, "--sheets", 128, "--quiet", *options)
        self.assertEqual(self.run_ok("compare", "all.exr", "kept.exr", "--json").json()["max"], 0)

    def test_kernels_are_merged_up_to_an_error(self):
        last = self.points(model="model:pawn:32")["points"] + 1
        for error in 0.01, 0.1, 1:
            merged = self.points("--merge", error, "--error", model="model:pawn:32")
            self.assertLessEqual(merged["merge_error"], error)
            self.assertLess(merged["points"], last)
            last = merged["points"]
            self.assertEqual(self.run_ok("info", "p.ply", "--json").json()["points"], last)
            self.assertGreater(merged["error_max"], 0)
        self.assertEqual(self.points("--merge", 0.1, model="model:pawn:32")["points_before"],
                         self.points(model="model:pawn:32")["points"])

    def test_mistakes_have_a_sentence(self):
        for options, says in (
            (["--values", "linear"], "scheme, cubic, paper"),
            (["--kernel", "box"], "box"),
            (["--kernel", "cubic"], "radial"),
            (["--kernel", "{"], "kernel"),
            (["--threshold"], "--threshold"),
            (["--threshold", "much"], "much"),
            (["--threshold", "1e3"], "nothing of the field"),
            (["--footprint", "up"], "up"),
            (["--footprint", "iso", "--footprint-size", "0"], "--footprint-size"),
            (["--tolerance", "-1"], "--tolerance"),
            (["--merge", "0"], "--merge"),
            (["--merge", "inf"], "--merge"),
        ):
            done = subvol("points", "model:pawn:8", "-o", "p.ply", *options, folder=self.folder)
            self.assertEqual(done.code, 2, options)
            self.assertIn(says, done.err)
            self.assertEqual(done.err.count("\n"), 1, done.err)
            self.assertFalse((self.folder / "p.ply").exists())


if __name__ == "__main__":
    unittest.main()
