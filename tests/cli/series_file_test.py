# SPDX-License-Identifier: Apache-2.0
"""Series in few bytes: written within their largest error, read by every command step by step, and refused with a sentence."""

import unittest

from command import InFolder, subvol


class SeriesFiles(InFolder):
    def series(self, steps=4):
        names = []
        for step in range(steps):
            name = f"step{step}.vtu"
            self.run_ok("subdivide", "model:ball:4", "--levels", "1", "--density", f"sin(x+{step}/4)*y", "-o", name, "--quiet")
            names.append(f'{{"name": "{name}", "time": {step / 2}}}')
        (self.folder / "run.vtu.series").write_text('{"file-series-version": "1.0", "files": [' + ", ".join(names) + "]}")
        return "run.vtu.series"

    def write(self, name, error, *options):
        return self.run_ok("compress", self.series(), "-o", name, "--step", "all", "--max-error", error, "--json", *options).json()

    def test_steps_are_those_of_the_series(self):
        report = self.write("a.svw", "1e-4", "--key-steps", "2")
        self.assertEqual((report["steps"], report["key_steps"], report["meshes"]), (4, 2, 1))
        self.assertEqual(report["bytes"], (self.folder / "a.svw").stat().st_size)
        self.assertTrue(0 < report["max"] <= 1e-4)
        self.assertTrue(0 < report["point_max"] <= 1e-5)
        info = self.run_ok("info", "a.svw", "--step", "1", "--json").json()
        self.assertEqual(info["times"], [0, .5, 1, 1.5])
        self.assertEqual((info["step"], info["time"]), (1, .5))
        self.assertEqual(info["cells"], report["cells"])
        for step in ("0", "3"):
            kept = self.run_ok("probe", "a.svw", "--step", step, "--at", ".1,.2,.3", "--json").json()["values"][0]["value"]
            given = self.run_ok("probe", "run.vtu.series", "--step", step, "--at", ".1,.2,.3", "--json").json()["values"][0]["value"]
            self.assertAlmostEqual(kept, given, delta=4e-4)  # the range is 2, and points moved too

    def test_bytes_follow_the_error(self):
        sizes = [self.write("a.svw", error)["bytes"] for error in ("1e-2", "1e-4", "1e-6")]
        self.assertEqual(sizes, sorted(sizes))
        self.assertLess(3 * sizes[0], sizes[2])

    def test_pictures_and_grids_of_all_steps(self):
        self.write("a.svw", "1e-3")
        self.run_ok("vdb", "a.svw", "-o", "a_####.vdb", "--step", "all", "--resolution", "8", "--quiet")
        self.assertEqual(len(list(self.folder.glob("a_*.vdb"))), 4)
        self.run_ok("render", "a.svw", "-o", "a_##.png", "--step", "1-2", "--size", "16x16", "--backend", "cpu", "--quiet")
        self.assertEqual(len(list(self.folder.glob("a_*.png"))), 2)
        again = self.run_ok("compress", "a.svw", "-o", "b.svw", "--step", "1-3", "--max-error", "1e-2", "--json").json()
        self.assertEqual(again["steps"], 3)

    def test_one_mesh_keeps_all_fields_or_one(self):
        self.run_ok("model", "ball", "--resolution", "4", "-o", "ball.vtu", "--quiet")
        report = self.run_ok("compress", "ball.vtu", "-o", "a.svw", "--max-error", "1e-3", "--json").json()
        self.assertEqual((report["steps"], [array["name"] for array in report["arrays"]]), (1, ["", "density"]))
        report = self.run_ok("compress", "ball.vtu", "-o", "a.svw", "--max-error", "1e-3", "--density", "x", "--json").json()
        self.assertEqual([array["name"] for array in report["arrays"]], ["", "density"])
        self.assertEqual(self.run_ok("info", "a.svw", "--json").json()["steps"], 1)

    def test_the_same_bits_for_any_number_of_threads(self):
        self.write("one.svw", "1e-3", "--threads", "1")
        self.write("four.svw", "1e-3", "--threads", "4")
        self.assertEqual((self.folder / "one.svw").read_bytes(), (self.folder / "four.svw").read_bytes())

    def test_points_does_it_as_long_as_it_is_announced(self):
        for options in (("--max-error", "1e-3"), ("--wavelet-tolerance=1e-2",)):
            done = self.run_ok("points", "model:pawn:16", "-o", "old.svw", *options)
            self.assertIn("subvol compress", done.err)
            done = self.run_ok("compress", "model:pawn:16", "-o", "new.svw", *options)
            self.assertNotIn("subvol compress", done.err)
            self.assertEqual((self.folder / "old.svw").read_bytes(), (self.folder / "new.svw").read_bytes())
        self.assertIn("--max-error", subvol("points", "model:pawn:16", "--output=old.svw", folder=self.folder).err)
        self.run_ok("points", "old.svw", "-o", "kernels.ply", "--quiet")  # a compressed mesh as the input is nothing of the kind

    def refused(self, *arguments):
        result = subvol("compress", *arguments, "--quiet", folder=self.folder)
        self.assertEqual(result.code, 2, result.err)
        self.assertEqual(len(result.err.strip().splitlines()), 1, result.err)
        return result.err

    def test_mistakes(self):
        mesh = ("model:ball:4", "-o", "a.svw")
        for wrong in ("0", "-1", "2", "nan"):
            self.assertIn("--max-error", self.refused(*mesh, f"--max-error={wrong}"))
            self.assertIn("--max-point-error", self.refused(*mesh, "--max-error", "1e-3", f"--max-point-error={wrong}"))
        self.assertIn("--key-steps", self.refused(*mesh, "--max-error", "1e-3", "--key-steps", "0"))
        self.assertIn("--max-error", self.refused(*mesh, "--key-steps", "3"))
        self.assertIn("--max-error", self.refused(*mesh))
        self.assertIn("--wavelet-tolerance", self.refused(*mesh, "--max-error", "1e-3", "--wavelet-tolerance", "1e-3"))
        self.assertIn("--per-edge", self.refused(*mesh, "--max-error", "1e-3", "--per-edge", "2"))
        self.assertIn("--scheme", self.refused(*mesh, "--max-error", "1e-3", "--scheme", "cc"))
        self.assertIn(".svw", self.refused("model:ball:4", "-o", "a.ply", "--max-error", "1e-3"))
        self.assertFalse((self.folder / "a.svw").exists())

    def test_damaged_files(self):
        self.write("good.svw", "1e-2")
        good = (self.folder / "good.svw").read_bytes()
        middle = len(good) // 2
        for name, bytes_ in (("cut", good[:-5]), ("head", good[:20]), ("flipped", good[:middle] + b"xxxxxxxx" + good[middle + 8:])):
            (self.folder / "bad.svw").write_bytes(bytes_)
            codes = {subvol("info", "bad.svw", "--step", str(step), folder=self.folder).code for step in range(4)}
            self.assertIn(2, codes, name)
            self.assertLessEqual(codes, {0, 2}, name)


if __name__ == "__main__":
    unittest.main()
