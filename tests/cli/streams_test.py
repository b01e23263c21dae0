# SPDX-License-Identifier: Apache-2.0
"""Streamlines and arrows: `surface --streamlines`, `render --streamlines` and `--glyphs`."""

import csv
import os
import unittest
from collections import defaultdict
from pathlib import Path

from command import InFolder, subvol

COLLECTION = Path(os.environ.get("SUBVOL_DATA", "none"))
UP = ["model:ball:3", "--density", "z", "--streamlines", "grad(density)"]  # a uniform flow
SMALL = ["--size", "64x48", "--backend", "cpu"]


class Streams(InFolder):
    def succeed(self, *arguments):
        return self.run_ok(*arguments).json()

    def lines(self, name):
        found = defaultdict(list)
        with open(self.folder / name, newline="") as file:
            for row in csv.DictReader(file):
                found[int(row["line"])].append({key: float(value) for key, value in row.items()})
        return found

    def compared(self, a, b, metric="max"):
        return self.succeed("compare", a, b, "--json")[metric]


class OfAUniformFlow(Streams):
    def test_lines_are_straight_to_both_ends(self):
        told = self.succeed("surface", *UP, "--seeds", "line:-.3,.1,0,.4,.1,.2", "--seed-count", 5, "-o", "lines.csv", "--json")["streamlines"]
        self.assertEqual((told["count"], told["outside"], told["ends"]), (5, 0, {"boundary": 10}))
        lines = self.lines("lines.csv")
        for number, line in lines.items():
            x = -.3 + .7 * number / 4
            for point in line:
                self.assertAlmostEqual(point["x"], x, delta=1e-6)
                self.assertAlmostEqual(point["y"], .1, delta=1e-6)
            for end in (line[0], line[-1]):  # the limit of the ball's mesh is near to a sphere
                self.assertAlmostEqual(end["x"] ** 2 + end["y"] ** 2 + end["z"] ** 2, 1, delta=.02)
        length = sum(line[-1]["z"] - line[0]["z"] for line in lines.values())
        self.assertAlmostEqual(told["length"], length, delta=1e-6)

    def test_they_go_one_way_and_as_long_as_they_may(self):
        told = self.succeed("surface", *UP, "--seeds", "at:0,0,0", "--stream-direction", "backward", "--stream-length", .25, "-o", "back.csv", "--json")
        self.assertEqual(told["streamlines"]["ends"], {"length": 1})
        line = self.lines("back.csv")[0]
        self.assertAlmostEqual(line[0]["z"], -.25, delta=1e-5)
        self.assertEqual(line[-1]["time"], 0)

    def test_seeds_are_places_of_a_table_too_and_those_outside_are_said(self):
        (self.folder / "seeds.csv").write_text("x,y,z\n0,0,0\n5,5,5\n.2,0,0\n")
        done = self.run_ok("surface", *UP, "--seeds", "seeds.csv", "-o", "lines.vtp")
        self.assertIn("1 of 3 seeds lies outside the volume and has no streamline", done.err)
        self.assertIn('NumberOfLines="2"', (self.folder / "lines.vtp").read_text())

    def test_a_body_that_is_opaque_hides_them_and_a_thin_one_does_not(self):
        self.succeed("render", *UP[:3], *SMALL, "--look", "solid", "-o", "body.exr", "--json")
        self.succeed("render", *UP, "--seeds", "at:0,0,0", "--stream-length", .3, "--glyphs", "grad(density)", "--glyph-count", 1, *SMALL, "--look", "solid", "-o",
                     "hidden.exr", "--json")
        self.assertLess(self.compared("body.exr", "hidden.exr"), .02)
        told = self.succeed("render", *UP, "--glyphs", "grad(density)", "--glyph-count", 9, *SMALL, "-o", "seen.exr", "--json")
        self.assertEqual((told["streamlines"]["count"], told["glyphs"]), (30, 9))
        self.assertGreater(self.compared("body.exr", "seen.exr"), .2)

    def test_volumes_end_at_them_by_every_method(self):
        for method in ("splat", "tets", "dense"):
            options = ["--size", "64x48", "--method", method, "--look", "volume", "--opacity", "0%:.01,100%:.01"]
            self.succeed("render", *UP[:3], *options, "-o", f"{method}_alone.exr", "--json")
            self.succeed("render", *UP, "--seeds", "at:.1,-.3,0", "--tube-radius", .1, "--stream-length", .3, *options, "-o", f"{method}.exr", "--json")
            self.assertGreater(self.compared(f"{method}.exr", f"{method}_alone.exr", "rmse"), .015)
        for method in ("tets", "dense"):  # by edges of the body in both
            alone = self.compared("splat_alone.exr", f"{method}_alone.exr", "rmse")
            self.assertLess(self.compared("splat.exr", f"{method}.exr", "rmse"), alone + .003)

    def test_cuts_leave_them_whole(self):
        cut = ["--clip", "0,0,0,0,1,0", *SMALL, "--view", "-y"]
        self.succeed("render", *UP, "--seeds", "at:0,-.5,0", "--tube-radius", .03, *cut, "-o", "tube.exr", "--json")
        self.succeed("render", *UP[:3], *cut, "-o", "cut.exr", "--json")
        self.assertGreater(self.compared("tube.exr", "cut.exr"), .1)

    def test_they_are_the_same_for_any_number_of_threads(self):
        for threads in (1, 3):
            self.succeed("surface", *UP, "--threads", threads, "-o", f"{threads}.csv", "--json")
        self.assertEqual((self.folder / "1.csv").read_bytes(), (self.folder / "3.csv").read_bytes())


class Mistakes(Streams):
    def test_each_is_one_sentence(self):
        for words, *arguments in (
            ("no field", "render", "model:ball:2", "-o", "x.png", "--streamlines", "U"),
            ("'density' has 1 component", "render", "model:ball:2", "-o", "x.png", "--streamlines", "density"),
            ("'density' has 1 component", "render", "model:ball:2", "-o", "x.png", "--glyphs", "density"),
            ("no seed lies in the volume", "render", *UP, "-o", "x.png", "--seeds", "at:9,9,9"),
            ("are not places", "render", *UP, "-o", "x.png", "--seeds", "somewhere"),
            ("a number is wrong", "surface", *UP, "-o", "x.vtp", "--seeds", "at:1,2,three"),
            ("has no effect without --streamlines", "render", "model:ball:2", "-o", "x.png", "--seed-count", 5),
            ("has no effect without --streamlines", "render", "model:ball:2", "-o", "x.png", "--tube-radius", .01),
            ("has no effect without --glyphs", "render", "model:ball:2", "-o", "x.png", "--glyph-size", .01),
            ("--seeds", "render", "model:ball:2", "-o", "x.png", "--seeds", "at:0,0,0"),
            ("not drawn within footprints", "render", *UP, "-o", "x.png", "--method", "footprints"),
            ("out of range", "render", *UP, "-o", "x.png", "--stream-tolerance", 2),
            ("supported: .vtp, .csv", "surface", *UP, "-o", "x.stl"),
            ("cannot be given together", "surface", *UP, "-o", "x.vtp", "--iso", .5),
        ):
            done = subvol(*arguments, folder=self.folder)
            self.assertEqual(done.code, 2, arguments)
            self.assertIn(words, done.err)
            self.assertEqual(len(done.err.strip().splitlines()), 1, done.err)
            self.assertFalse((self.folder / "x.png").exists() or (self.folder / "x.vtp").exists())


@unittest.skipUnless((COLLECTION / "lox_post_103k.vtu").exists(), "SUBVOL_DATA names no collection")
class OfRealMeshes(Streams):
    def test_points_follow_the_field(self):
        for mesh, vector in ((COLLECTION / "trame_disk_out_ref.vtu", "V"), (COLLECTION / "lox_post_103k.vtu", "Momentum"),
                             (COLLECTION.parent / "series" / "tjunction", "U")):
            told = self.succeed("surface", mesh, "--streamlines", vector, "--seed-count", 8, "--stream-step", .002, "-o", "lines.csv", "--json")["streamlines"]
            self.assertEqual(told["count"], 8)
            self.assertEqual(told["ends"].get("steps", 0), 0)
            for line in self.lines("lines.csv").values():
                fastest = max(sum(point[f"{vector}.{axis}"] ** 2 for axis in "xyz") ** .5 for point in line)
                for a, b in zip(line, line[1:]):
                    step = b["time"] - a["time"]
                    for axis in "xyz":  # a step turns by 15 degrees at most
                        mean = (a[f"{vector}.{axis}"] + b[f"{vector}.{axis}"]) / 2
                        self.assertAlmostEqual(b[axis] - a[axis], mean * step, delta=.06 * fastest * step + 1e-9)


if __name__ == "__main__":
    unittest.main()
