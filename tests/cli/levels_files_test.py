# SPDX-License-Identifier: Apache-2.0
"""Files of points with levels of detail: the pictures of the same points in memory, from the bytes that a view needs."""

import unittest

from command import InFolder, subvol

PICTURE = ["--size", "64x64", "--backend", "cpu", "--quiet"]
NEAR, FAR = ["--camera", "0,-6,0,0,0,0,0,0,1,30"], ["--camera", "0,-300,0,0,0,0,0,0,1,30"]
BETWEEN = ["--camera", "0,-60,0,0,0,0,0,0,1,30"]  # some kernels are merged, and some are not


class LevelsFiles(InFolder):
    def write(self, *names, mesh="model:ball:8", options=("--per-edge", "2")):
        for name in names:
            report = self.run_ok("points", mesh, "-o", name, *options, "--json").json()
        return report

    def picture(self, source, *options):
        report = self.run_ok("render", source, "-o", "a.exr", *PICTURE, *options, "--json").json()
        return report, (self.folder / "a.exr").read_bytes()

    def refused(self, *arguments):
        result = subvol(*arguments, folder=self.folder)
        self.assertEqual(result.code, 2, result.err)
        self.assertEqual(len(result.err.strip().splitlines()), 1, result.err)
        return result.err

    def test_pictures_have_the_bits_of_those_in_memory(self):
        self.write("a.ply", "a.svk")
        self.assertEqual(self.picture("a.ply", *NEAR)[1], self.picture("a.svk", *NEAR)[1])
        for camera in NEAR, BETWEEN, FAR:
            for lod in "0", "2":
                memory, expected = self.picture("a.ply", *camera, "--lod", lod)
                report, actual = self.picture("a.svk", *camera, "--lod", lod)
                self.assertEqual(expected, actual)
                for key in "points", "kernels_drawn", "kernels_merged", "merge_error":
                    self.assertEqual(memory.get(key), report.get(key), key)
        for options in ["--shade"], ["--clip", "0,0,0,1,0,0"]:
            self.assertEqual(self.picture("a.ply", *BETWEEN, "--lod", "2", *options)[1],
                             self.picture("a.svk", *BETWEEN, "--lod", "2", *options)[1])

    def test_distant_views_read_little(self):
        written = self.write("a.svk", options=("--per-edge", "4"))
        far = self.picture("a.svk", *FAR, "--lod", "2")[0]
        near = self.picture("a.svk", *NEAR, "--lod", "2")[0]
        self.assertEqual(written["bytes"], (self.folder / "a.svk").stat().st_size)
        self.assertEqual(far["bytes"], written["bytes"])
        self.assertLess(far["bytes_read"], written["bytes"] / 4)
        self.assertLess(far["kernels_drawn"], written["points"] / 100)
        self.assertEqual((near["bytes_read"], near["kernels_drawn"]), (written["bytes"], written["points"]))

    def test_turntables_keep_what_they_have_read(self):
        self.write("a.ply", "a.svk")
        for name in "a", "b":
            (self.folder / name).mkdir()
        turn = [*PICTURE, *BETWEEN, "--lod", "2", "--turntable", "4", "--json"]
        self.run_ok("render", "a.ply", "-o", "a/####.exr", *turn)
        kept = self.run_ok("render", "a.svk", "-o", "b/####.exr", *turn).json()
        for a in sorted((self.folder / "a").iterdir()):
            self.assertEqual(a.read_bytes(), (self.folder / "b" / a.name).read_bytes())
        self.assertEqual(len(list((self.folder / "b").iterdir())), 4)
        again = self.run_ok("render", "a.svk", "-o", "b/####.exr", *turn, "--memory", "0").json()
        self.assertGreater(again["bytes_read"], kept["bytes_read"])

    def test_every_verb_reads_all_points(self):
        self.write("a.ply", "a.svk", options=())
        info = self.run_ok("info", "a.svk", "--json").json()
        of_ply = self.run_ok("info", "a.ply", "--json").json()
        for key in "points", "kernel", "bounds", "boundary_triangles", "channels":
            self.assertEqual(info[key], of_ply[key], key)
        self.assertEqual(info["bytes"], (self.folder / "a.svk").stat().st_size)
        self.assertGreater(info["levels"], 1)
        self.assertEqual(self.run_ok("info", "a.svk", "--list-fields").out, self.run_ok("info", "a.ply", "--list-fields").out)
        for name in "a.ply", "a.svk":
            self.run_ok("vdb", name, "-o", name + ".vdb", "--resolution", "24", "--quiet")
        hashes = [self.run_ok("info", name + ".vdb", "--json").json()["grids"][0]["hash"] for name in ("a.ply", "a.svk")]
        self.assertEqual(hashes[0], hashes[1])
        self.assertEqual(self.run_ok("compare", "a.ply", "a.svk", "--samples", "5000", "--json").json()["linf"], 0)

    def test_shares_of_points_are_joined_to_one_file(self):
        self.write("whole.svk", options=())
        for part in "1/2", "2/2":
            self.run_ok("points", "model:ball:8", "-o", f"part{part[0]}.ply", "--part", part, "--quiet")
        self.run_ok("join", "part1.ply", "part2.ply", "-o", "joined.svk", "--quiet")
        self.assertEqual((self.folder / "whole.svk").read_bytes(), (self.folder / "joined.svk").read_bytes())
        self.assertIn("join", self.refused("points", "model:ball:8", "-o", "a.svk", "--part", "1/2"))
        self.assertFalse((self.folder / "a.svk").exists())

    def test_mistakes_and_damage(self):
        for options in ["--ascii"], ["--splats"]:
            self.assertIn(".ply", self.refused("points", "model:ball:4", "-o", "a.svk", *options))
        self.write("a.svk", options=())
        self.assertIn("no effect on points", self.refused("render", "a.svk", "-o", "a.png", "--lod", "2", "--per-edge", "2"))
        self.assertIn("no field 'x'", self.refused("render", "a.svk", "-o", "a.png", "--lod", "2", "--field", "x"))
        self.assertIn("cannot draw points", self.refused("render", "a.svk", "-o", "a.png", "--method", "dense"))
        good = (self.folder / "a.svk").read_bytes()
        cases = {"cut": good[:-5], "empty": b"", "other": b"solid" + good, "version": good[:20] + b"\7" + good[21:],
                 "head": good[:60] + b"xx" + good[62:], "kernels": good[:-9] + b"xx" + good[-7:]}
        for name, content in cases.items():
            (self.folder / "bad.svk").write_bytes(content)
            self.assertIn("bad.svk", self.refused("render", "bad.svk", "-o", "a.png", *NEAR, "--lod", "2"), name)
            self.assertIn("bad.svk", self.refused("render", "bad.svk", "-o", "a.png", *NEAR), name)
            if name != "kernels":
                self.assertIn("bad.svk", self.refused("info", "bad.svk"), name)
        self.assertFalse((self.folder / "a.png").exists())


if __name__ == "__main__":
    unittest.main()
