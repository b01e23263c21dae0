# SPDX-License-Identifier: Apache-2.0
"""Shares of work: --part, join, and processes of MPI. The result is that of one process, bit by bit."""

import json
import re
import unittest

from shares import COUNTS, HEIGHT, PICTURE, SURFACES, WIDTH, Shared, WithRanks, without_times, picture


class Parts(Shared):
    def test_points_of_shares_are_the_file_of_one_process(self):
        for extension, options in ((".ply", []), (".vtp", []), (".ply", ["--splats", "--up", "y"]), (".ply", ["--ascii"])):
            self.run_ok("points", "model:ball:4", "-o", "one" + extension, *options)
            for count in COUNTS if not options else (3,):
                names = self.parts("points", "model:ball:4", extension, count, *options)
                self.run_ok("join", *reversed(names), "-o", "joined" + extension)
                self.assertEqual(self.bytes_of("joined" + extension), self.bytes_of("one" + extension), (extension, count))
            if extension == ".vtp" or options[:1] == ["--splats"]:
                self.assertEqual(self.bytes_of("joined.boundary.vtp"), self.bytes_of("one.boundary.vtp"))

    def test_grids_of_shares_have_the_leaves_of_one_process(self):
        options = ["--resolution", "50", "--cell-ids", "--mask", "--coverage", "--sdf", "--half", "--quiet"]
        self.run_ok("vdb", "model:ball:4", "-o", "one.vdb", *options)
        for count in COUNTS:
            names = self.parts("vdb", "model:ball:4", ".vdb", count, *options)
            self.run_ok("join", *names, "-o", "joined.vdb", "--quiet")
            self.assertEqual(self.grids("joined.vdb"), self.grids("one.vdb"), count)

    def test_creases_go_through_shares(self):
        crease = ["--crease-angle", "30"]
        grids, picture = ["--resolution", "64", "--quiet", *crease], [*PICTURE, *crease]
        self.run_ok("points", "model:twist:6", "-o", "one.ply", "--per-edge", "2", *crease)
        self.run_ok("vdb", "model:twist:6", "-o", "one.vdb", *grids)
        self.run_ok("render", "model:twist:6", "-o", "one.exr", *picture)
        for verb, extension, options in (("points", ".ply", ["--per-edge", "2", *crease]), ("vdb", ".vdb", grids),
                                         ("render", ".exr", picture)):
            names = self.parts(verb, "model:twist:6", extension, 3, *options)
            self.run_ok("join", *names, "-o", "joined" + extension)
        self.assertEqual(self.bytes_of("joined.ply"), self.bytes_of("one.ply"))
        self.assertEqual(self.grids("joined.vdb"), self.grids("one.vdb"))
        self.assertEqual(self.bytes_of("joined.exr"), self.bytes_of("one.exr"))

    def test_rows_of_shares_are_the_picture_of_one_process(self):
        for options in ([], ["--look", "volume"], ["--samples", "2", "--edges"], ["--legend"], ["--title", "A b", "--legend", "--legend-side", "bottom", "--size", "160x128"], ["--method", "tets"],
                        ["--method", "tets", "--levels", "0", "--samples", "2", "--clip", "0,0,0,1,1,0"]):
            self.run_ok("render", "model:ball:4", "-o", "one.exr", *picture(options))
            self.run_ok("render", "model:ball:4", "-o", "one.png", *picture(options))
            for count in COUNTS if not options else (3,):
                names = self.parts("render", "model:ball:4", ".exr", count, *picture(options))
                for extension in (".exr", ".png"):
                    self.run_ok("join", *names, "-o", "joined" + extension)
                    self.assertEqual(self.bytes_of("joined" + extension), self.bytes_of("one" + extension), (options, count))
        said = [self.run_ok("render", "model:ball:4", "-o", "a.exr", "--size", "48", "--json", *share).json()["points"]
                for share in ([], ["--part", "1/2"])]
        self.assertEqual(*said)  # of the whole picture

    def test_figures_of_shares_are_those_of_one_process(self):
        for source in ("model:ball:4", "model:twist:20"):
            one = without_times(self.run_ok("info", source, "--json").json())
            for count in COUNTS:
                self.assertEqual(self.figures(count, source), one, (source, count))

    def test_surfaces_of_shares_are_those_of_one_process(self):
        for options in SURFACES:
            one = self.run_ok("surface", "model:ball:4", "-o", "one.ply", *options, "--json").json()
            for count in COUNTS if options == SURFACES[0] else (3,):
                names = self.parts("surface", "model:ball:4", ".svshare", count, *options)
                joined = self.run_ok("join", *reversed(names), "-o", "joined.ply", "--json").json()
                self.assertEqual(self.bytes_of("joined.ply"), self.bytes_of("one.ply"), (options, count))
                for key in ("points", "triangles", "area", "volume", "euler", "components", "deviation", "level", "cells"):
                    self.assertEqual(joined[key], one[key], (options, count, key))
        for extension in (".vtp", ".obj", ".glb"):
            self.run_ok("surface", "model:ball:4", "-o", "one" + extension, *options)
            self.run_ok("join", *names, "-o", "joined" + extension)
            self.assertEqual(self.bytes_of("joined" + extension), self.bytes_of("one" + extension))
        self.assertIn("no colours", self.refused("join", *self.parts("surface", "model:ball:4", ".svshare", 2, *SURFACES[1]), "-o", "j.stl"))

    def test_wrong_surfaces_are_refused(self):
        one, two = self.parts("surface", "model:ball:4", ".svshare", 2, *SURFACES[0])
        self.run_ok("surface", "model:ball:5", "-o", "foreign.svshare", "--part", "2/2", *SURFACES[0])
        self.run_ok("points", "model:ball:4", "-o", "points.ply", "--part", "2/2")
        self.assertIn(".svshare", self.refused("surface", "model:ball:4", "-o", "p.ply", "--part", "1/2"))
        self.assertIn(".ply", self.refused("surface", "model:ball:4", "-o", "p.svshare"))
        self.assertIn(".ply", self.refused("join", one, two, "-o", "j.vdb"))
        self.assertIn("part 2/2 of this work is missing", self.refused("join", one, "-o", "j.ply"))
        self.assertIn("and so is", self.refused("join", one, two, two, "-o", "j.ply"))
        self.assertIn("belongs to other work", self.refused("join", one, "foreign.svshare", "-o", "j.ply"))
        self.assertIn("is not a share of a surface", self.refused("join", one, "points.ply", "-o", "j.ply"))
        self.assertIn("the limit does not take this value", self.refused(
            "join", *self.parts("surface", "model:ball:4", ".svshare", 3, "--iso", "99"), "-o", "j.ply"))
        sound = self.bytes_of(two)
        for changed, said in ((sound[:10], "is not a share"), (sound[:2000], "is cut off"), (sound[:-1], "is cut off"),
                              (sound + b"x", "is damaged"), (sound.replace(b'"of":2', b'"of":3', 1), "is damaged")):
            (self.folder / "wrong.svshare").write_bytes(changed)
            self.assertIn(said, self.refused("join", one, "wrong.svshare", "-o", "j.ply"))
        self.assertFalse((self.folder / "j.ply").exists())

    def test_frames_are_divided(self):
        self.run_ok("render", "model:ball:2", "-o", "all_##.png", "--turntable", "5", *PICTURE)
        for part in (1, 2, 3):
            self.run_ok("render", "model:ball:2", "-o", "some_##.png", "--turntable", "5", "--part", f"{part}/3", *PICTURE)
        for frame in range(5):
            self.assertEqual(self.bytes_of(f"some_{frame:02}.png"), self.bytes_of(f"all_{frame:02}.png"))

    def test_a_share_is_a_file_of_its_own(self):
        names = self.parts("points", "model:ball:4", ".ply", 2)
        counts = [self.run_ok("info", name, "--json").json()["points"] for name in names]
        self.assertEqual(sum(counts), self.run_ok("points", "model:ball:4", "-o", "one.ply", "--json").json()["points"])

    def test_wrong_shares_are_refused(self):
        for share in ("0/2", "3/2", "2", "1/0", "a/b", "1/-1", "/2", "1/2/3", "1/99999999"):
            self.refused("points", "model:ball:4", "-o", "p.ply", "--part", share)
        self.assertIn(".exr", self.refused("render", "model:ball:4", "-o", "p.png", "--part", "1/2"))
        self.assertIn("join", self.refused("points", "model:ball:4", "-o", "p.vdb", "--part", "1/2"))
        self.assertIn("dense", self.refused("render", "model:ball:4", "-o", "p.exr", "--method", "dense", "--part", "1/2"))
        self.assertIn("--json", self.refused("info", "model:ball:4", "--part", "1/2"))

    def test_wrong_parts_are_refused(self):
        one, two, three = self.parts("points", "model:ball:4", ".ply", 3)
        self.run_ok("points", "model:ball:4", "-o", "whole.ply")
        self.run_ok("points", "model:ball:5", "-o", "foreign.ply", "--part", "3/3")
        self.run_ok("points", "model:ball:4", "-o", "other.ply", "--part", "3/3", "--per-edge", "2")
        self.run_ok("points", "model:ball:4", "-o", "four.ply", "--part", "3/4")
        self.assertIn("part 2/3 of this work is missing", self.refused("join", one, three, "-o", "j.ply"))
        self.assertIn("and so is", self.refused("join", one, two, two, three, "-o", "j.ply"))
        self.assertIn("belongs to other work", self.refused("join", one, two, "foreign.ply", "-o", "j.ply"))
        self.assertIn("belongs to other work", self.refused("join", one, two, "other.ply", "-o", "j.ply"))
        self.assertIn("one of 4 parts", self.refused("join", one, two, "four.ply", "-o", "j.ply"))
        self.assertIn("not a part", self.refused("join", "whole.ply", "-o", "j.ply"))
        self.assertIn("no such file", self.refused("join", "nothing.ply", "-o", "j.ply"))
        (self.folder / "broken.ply").write_bytes(self.bytes_of(two)[:2000])
        self.refused("join", one, "broken.ply", three, "-o", "j.ply")
        for said, wrong, message in ((b'"of":3', b'"of":2000000000', "parts 2/2000000000, 3/2000000000"),
                                     (b'"of":3', b'"of":99999999999999999999999', "its note of the part"),
                                     (b'"of":3', b'"of":9999999999999999999', "cannot be"),
                                     (b'"part":1', b'"part":-1', "cannot be"),
                                     (b'"part":1', b'"part":"1"', "its note of the part"),
                                     (b'"how":{', b'"how":{"up":7,"was":{', "its note of the part"),
                                     (b'"how":{', b'"how":{"up":"w","was":{', "its note of the part")):
            bytes_of_one = self.bytes_of(one)
            self.assertIn(said, bytes_of_one)
            changed = bytes_of_one.replace(said, wrong, 1)
            (self.folder / "changed.ply").write_bytes(changed.replace(b"}}", b"}}}", 1) if b"was" in wrong else changed)
            others = (two, three) if b"was" in wrong else ()
            self.assertIn(message, self.refused("join", "changed.ply", *others, "-o", "j.ply"))
        self.assertFalse((self.folder / "j.ply").exists())

    def test_parts_of_builds_that_divide_the_work_differently_are_refused(self):
        one, two, three = self.parts("points", "model:ball:4", ".ply", 3)
        note = re.search(rb'"range":\[(\d+),(\d+),(\d+)\]', self.bytes_of(two))
        begin, end, count = (int(number) for number in note.groups())
        kernels = self.run_ok("info", two, "--json").json()["points"]
        self.assertEqual(end - begin, kernels)
        for numbers in ((begin + 1, end, count), (begin, end + 1, count), (begin, end, count + 1)):
            other = f'"range":[{",".join(map(str, numbers))}]'.encode()
            (self.folder / "other.ply").write_bytes(self.bytes_of(two).replace(note.group(), other))
            self.assertIn("another build has divided the work differently", self.refused("join", one, "other.ply", three, "-o", "j.ply"))
        (self.folder / "other.ply").write_bytes(self.bytes_of(two).replace(note.group() + b",", b""))
        self.assertIn("another build", self.refused("join", one, "other.ply", three, "-o", "j.ply"))
        self.assertFalse((self.folder / "j.ply").exists())

    def test_missing_parts_are_noticed_before_the_others_are_read(self):
        one, two, three = self.parts("points", "model:ball:4", ".ply", 3)
        (self.folder / "cut.ply").write_bytes(self.bytes_of(two)[:-9])
        self.assertIn("part 3/3 of this work is missing", self.refused("join", one, "cut.ply", "-o", "j.ply"))
        self.assertNotIn("missing", self.refused("join", one, "cut.ply", three, "-o", "j.ply"))

    def test_wrong_figures_are_refused(self):
        sound = self.run_ok("info", "model:ball:4", "--json", "--part", "1/1").json()
        for key, wrong in (("cells", -1), ("edges", 1.5), ("faces", "many"), ("interior_edge_valence", [[4, -7]]),
                           ("interior_edge_valence", [[-4, 7]]), ("interior_edge_valence", [[1 << 40, 7]]),
                           ("inverted", [-1]), ("volumes", ["x"]), ("bounds", [])):
            figures = {**sound["part_figures"], key: wrong}
            (self.folder / "p.json").write_text(json.dumps({**sound, "part_figures": figures}))
            self.assertIn("its figures of a share cannot be read", self.refused("join", "p.json", "-o", "j.json"), key)
            self.assertFalse((self.folder / "j.json").exists())


class Ranks(WithRanks):
    def test_points_and_grids(self):
        grids = ["--resolution", "50", "--cell-ids", "--mask", "--sdf", "--half", "--quiet"]
        self.run_ok("points", "model:ball:4", "-o", "one.ply")
        self.run_ok("vdb", "model:ball:4", "-o", "one.vdb", *grids)
        for count in COUNTS[1:]:
            self.ranks(count, "points", "model:ball:4", "-o", "ranks.ply")
            self.assertEqual(self.bytes_of("ranks.ply"), self.bytes_of("one.ply"), count)
            self.ranks(count, "vdb", "model:ball:4", "-o", "ranks.vdb", *grids)
            self.assertEqual(self.grids("ranks.vdb"), self.grids("one.vdb"), count)

    def test_pictures(self):
        for options in ([], ["--look", "volume", "--samples", "2"], ["--method", "tets"]):
            self.run_ok("render", "model:ball:4", "-o", "one.exr", *picture(options))
            for count in COUNTS[1:] if not options else (3,):
                self.ranks(count, "render", "model:ball:4", "-o", "ranks.exr", *picture(options))
                self.assertEqual(self.bytes_of("ranks.exr"), self.bytes_of("one.exr"), (options, count))

    def test_sums_of_sheets_are_floats(self):
        said = self.refused("render", "model:ball:4", "-o", "x.png", "--sheet-sums", "fixed")
        self.assertIn("--sheet-sums: sheets are always summed in floats", said)
        self.assertIn("leave it out", said)

    def test_figures(self):
        one = without_times(self.run_ok("info", "model:ball:4", "--json").json())
        for count in COUNTS[1:]:
            report = json.loads(self.ranks(count, "info", "model:ball:4", "--json").stdout)
            self.assertEqual(report["ranks"], count)
            self.assertEqual(without_times(report), one, count)

    def test_surfaces(self):
        for options in SURFACES:
            self.run_ok("surface", "model:ball:4", "-o", "one.ply", *options)
            for count in COUNTS[1:] if options == SURFACES[0] else (3,):
                self.ranks(count, "surface", "model:ball:4", "-o", "ranks.ply", *options)
                self.assertEqual(self.bytes_of("ranks.ply"), self.bytes_of("one.ply"), (options, count))

    def test_bytes_sent_are_those_of_the_model(self):
        """Points: 68 bytes a kernel of a rank other than 0; pictures: 72 bytes a kernel and band, 20 a pixel."""
        report = json.loads(self.ranks(4, "points", "model:twist:20", "-o", "r.ply", "--json").stdout)
        sent = 68 * report["points"] * 3 / 4
        self.assertLess(abs(report["bytes_sent"] / sent - 1), 0.1)
        report = json.loads(self.ranks(4, "render", "model:twist:20", "-o", "r.exr", "--look", "volume", *PICTURE[:-1], "--json").stdout)
        self.assertLess(abs(report["kernel_bytes_sent"] / (72 * report["kernels_shipped"]) - 1), 0.1)
        pixels = 20 * WIDTH * HEIGHT * 3 / 4
        self.assertLess(abs(report["bytes_sent"] / (72 * report["kernels_shipped"] + pixels) - 1), 0.15)

    def test_one_sentence_for_all(self):
        for arguments in (["points", "nothing.vtk", "-o", "a.ply"], ["points", "model:ball:4", "-o", "nowhere/a.ply"],
                          ["vdb", "model:ball:4", "-o", "a.vdb", "--error"], ["subdivide", "model:ball:4", "-o", "a.vtk"],
                          ["points", "model:ball:4", "-o", "a.ply", "--part", "1/2"],
                          ["surface", "model:ball:4", "-o", "a.ply", "--iso", "99"]):
            done = self.mpirun(3, *arguments, folder=self.folder)
            self.assertEqual(done.returncode, 2, (arguments, done.stderr))
            said = [line for line in done.stderr.splitlines() if line.startswith("subvol:")]
            self.assertEqual(len(said), 1, done.stderr)
            self.assertEqual([p.name for p in self.folder.iterdir() if p.name.startswith("a.")], [])

    def test_only_one_speaks(self):
        done = self.ranks(3, "points", "model:ball:4", "-o", "r.ply")
        self.assertEqual(done.stdout.count("points"), self.run_ok("points", "model:ball:4", "-o", "one.ply").out.count("points"))
        self.assertEqual(self.mpirun(3, "--version").stdout.count("\n"), 1)


if __name__ == "__main__":
    unittest.main()
