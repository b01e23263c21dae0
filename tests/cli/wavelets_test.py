# SPDX-License-Identifier: Apache-2.0
"""Files of wavelets: written within their tolerance, read by every verb, and refused with a sentence."""

import unittest

from command import CUBE, InFolder, subvol


class Wavelets(InFolder):
    def write(self, name="pawn.svw", tolerance="1e-3", *options):
        return self.run_ok("compress", "model:pawn:32", "-o", name, "--wavelet-tolerance", tolerance, "--json", *options).json()

    def test_bytes_and_errors_follow_the_tolerance(self):
        bytes_before, kept_before = 0, 0
        for tolerance in ("1e-2", "1e-3", "1e-4"):
            report = self.write("a.svw", tolerance)
            self.assertLessEqual(report["rms"], float(tolerance))
            self.assertLessEqual(report["point_rms"], float(tolerance) / 10)
            self.assertGreaterEqual(report["max"], report["rms"])
            self.assertEqual(report["bytes"], (self.folder / "a.svw").stat().st_size)
            self.assertGreater(report["bytes"], bytes_before)
            self.assertGreater(report["coefficients_kept"], kept_before)
            self.assertEqual(report["coefficients"], 4 * report["points"])
            self.assertEqual(report["inverted_cells"], 0)
            bytes_before, kept_before = report["bytes"], report["coefficients_kept"]

    def test_other_verbs_read_it(self):
        written = self.write()
        info = self.run_ok("info", "pawn.svw", "--json").json()
        self.assertEqual(info["cells"], written["cells"])
        self.assertEqual(info["points"], written["points"])
        self.assertEqual([field["name"] for field in info["fields"]], ["density"])
        points = self.run_ok("points", "pawn.svw", "-o", "pawn.ply", "--json").json()
        self.assertEqual(points["points"], written["points"])
        self.run_ok("vdb", "pawn.svw", "-o", "pawn.vdb", "--resolution", "32", "--quiet")
        self.run_ok("render", "pawn.svw", "-o", "pawn.png", "--size", "32x32", "--backend", "cpu", "--quiet")

    def test_the_field_is_near_that_of_the_mesh(self):
        self.write("a.svw", "1e-3")
        compared = self.run_ok("compare", "a.svw", "model:pawn:32", "--levels", "1", "--samples", "5000", "--json").json()
        # The density is from -1 to 1; where points move by a tenth of the tolerance the field moves with them.
        self.assertLess(compared["l2"], 4e-3)

    def test_the_same_bits_for_any_number_of_threads(self):
        self.write("one.svw", "1e-3", "--threads", "1")
        self.write("four.svw", "1e-3", "--threads", "4")
        self.assertEqual((self.folder / "one.svw").read_bytes(), (self.folder / "four.svw").read_bytes())

    def test_a_refined_mesh_costs_what_its_control_mesh_does(self):
        self.run_ok("model", "ball", "--resolution", "4", "-o", "ball.vtu", "--quiet")
        sizes = []
        for levels in ("1", "2"):
            self.run_ok("subdivide", "ball.vtu", "--levels", levels, "-o", "fine.vtu", "--quiet")
            report = self.run_ok("compress", "fine.vtu", "-o", "fine.svw", "--wavelet-tolerance", "1e-4", "--levels", levels,
                                 "--json").json()
            self.assertEqual(report["levels"], int(levels))
            sizes.append(report["bytes"])
        self.assertLess(sizes[1], 1.5 * sizes[0])  # eight times as many points, and no details

    def refused(self, *arguments):
        result = subvol("compress", *arguments, "--quiet", folder=self.folder)
        self.assertEqual(result.code, 2, result.err)
        self.assertEqual(len(result.err.strip().splitlines()), 1, result.err)
        return result.err

    def test_mistakes(self):
        mesh = ("model:pawn:8", "-o", "a.svw")
        for wrong in ("0", "-1", "2", "nan", "inf"):
            self.assertIn("--wavelet-tolerance", self.refused(*mesh, f"--wavelet-tolerance={wrong}"))
            self.assertIn("--wavelet-point-tolerance",
                          self.refused(*mesh, "--wavelet-tolerance", "1e-3", f"--wavelet-point-tolerance={wrong}"))
        self.assertIn("--wavelet-tolerance", self.refused(*mesh, "--wavelet-tolerance", "small"))
        self.assertIn("--wavelet-tolerance", self.refused(*mesh))
        self.assertIn("--wavelet-tolerance", self.refused(*mesh, "--wavelet-point-tolerance", "1e-3"))
        self.assertIn(".svw", self.refused("model:pawn:8", "-o", "a.ply", "--wavelet-tolerance", "1e-3"))
        self.assertIn("--per-edge", self.refused(*mesh, "--wavelet-tolerance", "1e-3", "--per-edge", "2"))
        self.assertIn("--levels", self.refused(*mesh, "--wavelet-tolerance", "1e-3", "--levels", "0"))
        (self.folder / "one.mesh").write_text(CUBE.format(last=8))
        self.assertIn("refinement", self.refused("one.mesh", "-o", "a.svw", "--wavelet-tolerance", "1e-3"))
        self.assertIn("three cells", self.refused("model:ball:4", "-o", "a.svw", "--wavelet-tolerance", "1e-3", "--scheme", "cc"))
        self.assertFalse((self.folder / "a.svw").exists())

    def test_damaged_files(self):
        self.write("good.svw", "1e-2")
        good = (self.folder / "good.svw").read_bytes()
        for name, bytes_ in (("cut", good[:-5]), ("empty", b""), ("other", b"solid" + good), ("flipped", good[:300] + b"xx" + good[302:])):
            (self.folder / "bad.svw").write_bytes(bytes_)
            result = subvol("info", "bad.svw", folder=self.folder)
            self.assertEqual(result.code, 2, name)
            self.assertIn("bad.svw", result.err)


if __name__ == "__main__":
    unittest.main()
