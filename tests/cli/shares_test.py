# SPDX-License-Identifier: Apache-2.0
"""Shares of work: --part, join, and processes of MPI. The result is that of one process, bit by bit."""

import json
import os
import shutil
import signal
import struct
import subprocess
import time
import unittest
from pathlib import Path

from command import COMMAND, InFolder, children, subvol, wait_for_end

COUNTS = (1, 2, 3, 4, 7)
BALL = "model:ball:4"
MPIRUN = shutil.which("mpirun")
AS_ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
PICTURE = ["--size", "160x128", "--backend", "cpu", "--quiet"]


def without_times(report):
    for key in ("seconds", "peak_bytes", "input", "output", "ranks", "bytes_sent", "peak_bytes_of_ranks", "parts"):
        report.pop(key, None)
    return report


def rank_of(pid):
    """Nothing if mpirun has not made it a rank yet."""
    try:
        for setting in Path(f"/proc/{pid}/environ").read_bytes().split(b"\0"):
            if setting.startswith(b"OMPI_COMM_WORLD_RANK="):
                return int(setting.split(b"=")[1])
    except OSError:
        pass
    return None


class Shared(InFolder):
    def parts(self, verb, source, extension, count, *options):
        """The names of the parts of a share each."""
        names = []
        for part in range(1, count + 1):
            name = f"p{part}of{count}{extension}"
            self.run_ok(verb, source, "-o", name, "--part", f"{part}/{count}", *options)
            names.append(name)
        return names

    def bytes_of(self, name):
        return (self.folder / name).read_bytes()

    def grids(self, name):
        return [(g["name"], g["active_voxels"], g["hash"]) for g in self.run_ok("info", name, "--json").json()["grids"]]

    def refused(self, *arguments):
        run = subvol(*arguments, folder=self.folder)
        self.assertEqual(run.code, 2, run.err)
        self.assertEqual(len(run.err.strip().splitlines()), 1, run.err)
        return run.err


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
        options = ["--resolution", "80", "--cell-ids", "--mask", "--coverage", "--sdf", "--half", "--quiet"]
        self.run_ok("vdb", "model:ball:4", "-o", "one.vdb", *options)
        for count in COUNTS:
            names = self.parts("vdb", "model:ball:4", ".vdb", count, *options)
            self.run_ok("join", *names, "-o", "joined.vdb", "--quiet")
            self.assertEqual(self.grids("joined.vdb"), self.grids("one.vdb"), count)

    def test_creases_go_through_shares(self):
        crease = ["--crease-angle", "30"]
        grids, picture = ["--resolution", "64", "--quiet", *crease], [*PICTURE, *crease]
        self.run_ok("points", "model:pawn", "-o", "one.ply", "--per-edge", "2", *crease)
        self.run_ok("vdb", "model:pawn", "-o", "one.vdb", *grids)
        self.run_ok("render", "model:pawn", "-o", "one.exr", *picture)
        for verb, extension, options in (("points", ".ply", ["--per-edge", "2", *crease]), ("vdb", ".vdb", grids),
                                         ("render", ".exr", picture)):
            names = self.parts(verb, "model:pawn", extension, 3, *options)
            self.run_ok("join", *names, "-o", "joined" + extension)
        self.assertEqual(self.bytes_of("joined.ply"), self.bytes_of("one.ply"))
        self.assertEqual(self.grids("joined.vdb"), self.grids("one.vdb"))
        self.assertEqual(self.bytes_of("joined.exr"), self.bytes_of("one.exr"))

    def test_rows_of_shares_are_the_picture_of_one_process(self):
        for options in ([], ["--look", "volume"], ["--samples", "2", "--edges"], ["--legend"]):
            self.run_ok("render", "model:ball:4", "-o", "one.exr", *PICTURE, *options)
            self.run_ok("render", "model:ball:4", "-o", "one.png", *PICTURE, *options)
            for count in COUNTS if not options else (3,):
                names = self.parts("render", "model:ball:4", ".exr", count, *PICTURE, *options)
                for extension in (".exr", ".png"):
                    self.run_ok("join", *names, "-o", "joined" + extension)
                    self.assertEqual(self.bytes_of("joined" + extension), self.bytes_of("one" + extension), (options, count))

    def test_figures_of_shares_are_those_of_one_process(self):
        for source in ("model:ball:4", "model:twist:20"):
            one = without_times(self.run_ok("info", source, "--json").json())
            for count in COUNTS:
                names = []
                for part in range(1, count + 1):
                    names.append(f"p{part}.json")
                    figures = self.run_ok("info", source, "--json", "--part", f"{part}/{count}").out
                    (self.folder / names[-1]).write_text(figures)
                self.run_ok("join", *names, "-o", "joined.json")
                joined = without_times(json.loads((self.folder / "joined.json").read_text()))
                self.assertEqual(joined, one, (source, count))

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
        self.assertIn("tets", self.refused("render", "model:ball:4", "-o", "p.exr", "--method", "tets", "--part", "1/2"))
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

    def test_wrong_figures_are_refused(self):
        sound = self.run_ok("info", "model:ball:4", "--json", "--part", "1/1").json()
        for key, wrong in (("cells", -1), ("edges", 1.5), ("faces", "many"), ("interior_edge_valence", [[4, -7]]),
                           ("interior_edge_valence", [[-4, 7]]), ("interior_edge_valence", [[1 << 40, 7]]),
                           ("inverted", [-1]), ("volumes", ["x"]), ("bounds", [])):
            figures = {**sound["part_figures"], key: wrong}
            (self.folder / "p.json").write_text(json.dumps({**sound, "part_figures": figures}))
            self.assertIn("its figures of a share cannot be read", self.refused("join", "p.json", "-o", "j.json"), key)
            self.assertFalse((self.folder / "j.json").exists())


class PartsOfBricks(Shared):
    """Shares of a folder of bricks give what one process makes of the mesh in one piece."""

    def setUp(self):
        super().setUp()
        self.run_ok("split", BALL, "-o", "b.bricks", "--bricks", "5", "--by", "random", "--quiet")

    def test_points(self):
        self.run_ok("points", BALL, "-o", "one.ply")
        for count in COUNTS:  # more shares than bricks, too
            names = self.parts("points", "b.bricks", ".ply", count)
            self.run_ok("join", *reversed(names), "-o", "joined.ply")
            self.assertEqual(self.bytes_of("joined.ply"), self.bytes_of("one.ply"), count)

    def test_a_part_of_the_points_opens_alone(self):
        names = self.parts("points", "b.bricks", ".ply", 2)
        counts = [self.run_ok("info", name, "--json").json() for name in names]
        self.assertEqual(sum(one["points"] for one in counts), self.run_ok("info", "b.bricks", "--json").json()["points"])
        self.assertGreater(counts[0]["boundary_triangles"], 0)
        self.assertEqual(counts[1]["boundary_triangles"], 0)

    def test_grids(self):
        for options in (["--resolution", "80", "--mask", "--half"], ["--resolution", "50", "--levels", "1"]):
            self.run_ok("vdb", BALL, "-o", "one.vdb", *options, "--quiet")
            for count in COUNTS:
                names = self.parts("vdb", "b.bricks", ".vdb", count, *options, "--memory", "4M", "--quiet")
                self.run_ok("join", *names, "-o", "joined.vdb", "--quiet")
                self.assertEqual(self.grids("joined.vdb"), self.grids("one.vdb"), (count, options))

    def test_a_slab_without_voxels_is_a_part(self):
        self.run_ok("vdb", BALL, "-o", "one.vdb", "--resolution", "20", "--quiet")
        names = self.parts("vdb", "b.bricks", ".vdb", 7, "--resolution", "20", "--quiet")
        self.assertIn(0, [self.grids(name)[0][1] for name in names])
        self.run_ok("join", *names, "-o", "joined.vdb", "--quiet")
        self.assertEqual(self.grids("joined.vdb"), self.grids("one.vdb"))

    def test_pictures(self):
        for options in ([], ["--look", "volume", "--samples", "2"]):
            self.run_ok("render", BALL, "-o", "one.exr", *PICTURE, *options)
            for count in COUNTS if not options else (3,):
                names = self.parts("render", "b.bricks", ".exr", count, *PICTURE, *options)
                self.run_ok("join", *names, "-o", "joined.exr")
                self.assertEqual(self.bytes_of("joined.exr"), self.bytes_of("one.exr"), (count, options))

    def figures(self, count, source="b.bricks"):
        names = []
        for part in range(1, count + 1):
            names.append(f"p{part}.json")
            figures = self.run_ok("info", source, "--json", "--part", f"{part}/{count}").out
            (self.folder / names[-1]).write_text(figures)
        self.run_ok("join", *names, "-o", "joined.json")
        return without_times(json.loads((self.folder / "joined.json").read_text()))

    def test_figures(self):
        one = without_times(self.run_ok("info", "b.bricks", "--json").json())
        whole = without_times(self.run_ok("info", BALL, "--json").json())
        for count in COUNTS:
            self.assertEqual(self.figures(count), one, count)
        # Volumes of bricks are added up in another order than those of the mesh in one piece.
        self.assertAlmostEqual(one["volume"], whole["volume"], delta=1e-12 * whole["volume"])
        for key in one:
            if key in whole and key != "volume":
                self.assertEqual(one[key], whole[key], key)

    def test_inverted_cells_are_named(self):
        self.run_ok("model", "ball", "--resolution", 4, "-o", "ball.mesh", "--quiet")
        lines = (self.folder / "ball.mesh").read_text().splitlines()
        first = lines.index("Vertices") + 2
        for point in (70, 90):  # far through their neighbours
            x, y, z, tag = lines[first + point].split()
            lines[first + point] = f"{float(x) + 0.9} {float(y) - 0.7} {z} {tag}"
        (self.folder / "ball.mesh").write_text("\n".join(lines) + "\n")
        self.run_ok("split", "ball.mesh", "--density", "x", "-o", "i.bricks", "--bricks", 4, "--by", "random", "--quiet")
        expected = self.run_ok("info", "ball.mesh", "--json").json()["verdict"]
        self.assertRegex(expected, r"cells inverted: \d+, \d+, \d+")
        self.assertEqual(self.run_ok("info", "i.bricks", "--json").json()["verdict"], expected)
        self.assertEqual(self.figures(3, "i.bricks")["verdict"], expected)

    def test_a_share_reads_only_its_bricks(self):
        self.run_ok("split", "model:ball:8", "-o", "t.bricks", "--bricks", 6, "--by", "slabs", "--quiet")
        (self.folder / "t.bricks" / "brick_00000.vtu").write_bytes(
            b"x" * (self.folder / "t.bricks" / "brick_00000.vtu").stat().st_size)
        self.run_ok("points", "t.bricks", "-o", "p.ply", "--part", "2/2")
        self.run_ok("info", "t.bricks", "--json", "--part", "2/2")
        self.assertIn("brick_00000", self.refused("points", "t.bricks", "-o", "p.ply", "--part", "1/2"))
        grids = ["vdb", "t.bricks", "-o", "p.vdb", "--resolution", "200", "--part"]
        self.run_ok(*grids, "7/7")
        self.assertIn("brick_00000", self.refused(*grids, "1/7"))

    def test_wrong_parts_are_refused(self):
        one, two, three = self.parts("points", "b.bricks", ".ply", 3)
        self.assertIn("part 2/3 of this work is missing", self.refused("join", one, three, "-o", "j.ply"))
        self.assertIn(".ply", self.refused("join", one, two, three, "-o", "j.vtp"))
        sound = self.bytes_of(two)
        (self.folder / two).write_bytes(sound[:2000])
        self.refused("join", one, two, three, "-o", "j.ply")
        # The numbers of points end the rows: of the first part's last point, and of this part's first.
        header = sound.index(b"end_header\n") + len(b"end_header\n")
        count = int(sound[sound.index(b"element vertex ") + 15:].split(b"\n")[0])
        row = (len(sound) - header) // count
        for number, said in ((1e6, "point 1000000 does not exist"), (-1.0, "has the number -1"), (0.5, "has the number 0.5"),
                             (struct.unpack("<d", sound[header + 2 * row - 8:header + 2 * row])[0], "is in another part, too")):
            (self.folder / two).write_bytes(sound[:header + row - 8] + struct.pack("<d", number) + sound[header + row:])
            self.assertIn(said, self.refused("join", one, two, three, "-o", "j.ply"))
        for name in (one, two, three):  # the note says how many points the whole has
            text = self.bytes_of(name) if name != two else sound
            at = text.index(b'"points":')
            (self.folder / name).write_bytes(text[:at] + b'"points":9' + text[at + 9:])
        self.assertIn("points", self.refused("join", one, two, three, "-o", "j.ply"))
        self.assertFalse((self.folder / "j.ply").exists())


@unittest.skipUnless(MPIRUN, "mpirun is not installed")
class WithRanks(Shared):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        probe = cls.mpirun(2, "info", "model:ball:2", "--json")
        if probe.returncode == 3:
            raise unittest.SkipTest("this build is without MPI: " + probe.stderr.strip())

    @staticmethod
    def mpirun(count, *arguments, folder=None):
        return subprocess.run([MPIRUN, "--oversubscribe", "-n", str(count), COMMAND, *map(str, arguments)], cwd=folder,
                              capture_output=True, text=True, timeout=600, env={**os.environ, **AS_ROOT})

    def ranks(self, count, *arguments):
        done = self.mpirun(count, *arguments, folder=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done


class Ranks(WithRanks):
    def test_points_and_grids(self):
        grids = ["--resolution", "80", "--cell-ids", "--mask", "--sdf", "--half", "--quiet"]
        self.run_ok("points", "model:ball:4", "-o", "one.ply")
        self.run_ok("vdb", "model:ball:4", "-o", "one.vdb", *grids)
        for count in COUNTS[1:]:
            self.ranks(count, "points", "model:ball:4", "-o", "ranks.ply")
            self.assertEqual(self.bytes_of("ranks.ply"), self.bytes_of("one.ply"), count)
            self.ranks(count, "vdb", "model:ball:4", "-o", "ranks.vdb", *grids)
            self.assertEqual(self.grids("ranks.vdb"), self.grids("one.vdb"), count)

    def test_pictures(self):
        for options in ([], ["--look", "volume", "--samples", "2"]):
            self.run_ok("render", "model:ball:4", "-o", "one.exr", *PICTURE, *options)
            for count in COUNTS[1:] if not options else (3,):
                self.ranks(count, "render", "model:ball:4", "-o", "ranks.exr", *PICTURE, *options)
                self.assertEqual(self.bytes_of("ranks.exr"), self.bytes_of("one.exr"), (options, count))

    def test_figures(self):
        one = without_times(self.run_ok("info", "model:ball:4", "--json").json())
        for count in COUNTS[1:]:
            report = json.loads(self.ranks(count, "info", "model:ball:4", "--json").stdout)
            self.assertEqual(report["ranks"], count)
            self.assertEqual(without_times(report), one, count)

    def test_bytes_sent_are_those_of_the_model(self):
        """Points: 68 bytes a kernel of a rank other than 0; pictures: 72 bytes a kernel and band, 20 a pixel."""
        report = json.loads(self.ranks(4, "points", "model:twist:20", "-o", "r.ply", "--json").stdout)
        sent = 68 * report["points"] * 3 / 4
        self.assertLess(abs(report["bytes_sent"] / sent - 1), 0.1)
        report = json.loads(self.ranks(4, "render", "model:twist:20", "-o", "r.exr", *PICTURE[:-1], "--json").stdout)
        self.assertLess(abs(report["kernel_bytes_sent"] / (72 * report["kernels_shipped"]) - 1), 0.1)
        pixels = 20 * 160 * 128 * 3 / 4
        self.assertLess(abs(report["bytes_sent"] / (72 * report["kernels_shipped"] + pixels) - 1), 0.15)

    def test_one_sentence_for_all(self):
        for arguments in (["points", "nothing.vtk", "-o", "a.ply"], ["points", "model:ball:4", "-o", "nowhere/a.ply"],
                          ["vdb", "model:ball:4", "-o", "a.vdb", "--error"], ["subdivide", "model:ball:4", "-o", "a.vtk"],
                          ["points", "model:ball:4", "-o", "a.ply", "--part", "1/2"]):
            done = self.mpirun(3, *arguments, folder=self.folder)
            self.assertEqual(done.returncode, 2, (arguments, done.stderr))
            said = [line for line in done.stderr.splitlines() if line.startswith("subvol:")]
            self.assertEqual(len(said), 1, done.stderr)
            self.assertEqual([p.name for p in self.folder.iterdir() if p.name.startswith("a.")], [])

    def test_only_one_speaks(self):
        done = self.ranks(3, "points", "model:ball:4", "-o", "r.ply")
        self.assertEqual(done.stdout.count("points"), self.run_ok("points", "model:ball:4", "-o", "one.ply").out.count("points"))
        self.assertEqual(self.mpirun(3, "--version").stdout.count("\n"), 1)


class RanksOfBricks(WithRanks):
    def setUp(self):
        super().setUp()
        self.run_ok("split", BALL, "-o", "b.bricks", "--bricks", "5", "--by", "random", "--quiet")

    def test_points_and_grids(self):
        grids = ["--resolution", "80", "--mask", "--half", "--quiet"]
        self.run_ok("points", BALL, "-o", "one.ply")
        self.run_ok("vdb", BALL, "-o", "one.vdb", *grids)
        for count in COUNTS[1:]:
            self.ranks(count, "points", "b.bricks", "-o", "ranks.ply")
            self.assertEqual(self.bytes_of("ranks.ply"), self.bytes_of("one.ply"), count)
            self.ranks(count, "vdb", "b.bricks", "-o", "ranks.vdb", *grids, "--memory", "4M")
            self.assertEqual(self.grids("ranks.vdb"), self.grids("one.vdb"), count)

    def test_pictures(self):
        for options in ([], ["--look", "volume", "--samples", "2"]):
            self.run_ok("render", BALL, "-o", "one.exr", *PICTURE, *options)
            for count in COUNTS[1:] if not options else (3,):
                self.ranks(count, "render", "b.bricks", "-o", "ranks.exr", *PICTURE, *options, "--memory", "100K")
                self.assertEqual(self.bytes_of("ranks.exr"), self.bytes_of("one.exr"), (options, count))

    def test_frames_are_divided(self):
        turn = ["--turntable", "3", *PICTURE]
        self.run_ok("render", BALL, "-o", "one_#.png", *turn)
        self.ranks(2, "render", "b.bricks", "-o", "all_#.png", *turn)
        for frame in range(3):
            self.assertEqual(self.bytes_of(f"all_{frame}.png"), self.bytes_of(f"one_{frame}.png"))

    def test_figures(self):
        one = without_times(self.run_ok("info", "b.bricks", "--json").json())
        for count in COUNTS[1:]:
            report = json.loads(self.ranks(count, "info", "b.bricks", "--json").stdout)
            self.assertEqual(without_times(report), one, count)

    def test_bytes_sent_are_those_of_the_model(self):
        """76 bytes a kernel: its 68, and its number."""
        self.run_ok("split", "model:twist:20", "-o", "t.bricks", "--bricks", "8", "--quiet")
        report = json.loads(self.ranks(4, "points", "t.bricks", "-o", "r.ply", "--json").stdout)
        self.assertLess(abs(report["bytes_sent"] / (76 * report["points"] * 3 / 4) - 1), 0.1)
        report = json.loads(self.ranks(4, "render", "t.bricks", "-o", "r.exr", *PICTURE[:-1], "--json").stdout)
        self.assertLess(abs(report["kernel_bytes_sent"] / (76 * report["kernels_shipped"]) - 1), 0.1)

    def test_a_damaged_brick_is_one_sentence(self):
        brick = self.folder / "b.bricks" / "brick_00003.vtu"
        brick.write_bytes(b"x" * brick.stat().st_size)
        for verb, name, *options in (["points", "a.ply"], ["vdb", "a.vdb", "--resolution", 40], ["render", "a.png", *PICTURE]):
            done = self.mpirun(3, verb, "b.bricks", "-o", name, *options, folder=self.folder)
            self.assertEqual(done.returncode, 2, (verb, done.stderr))
            said = [line for line in done.stderr.splitlines() if line.startswith("subvol:")]
            self.assertEqual(len(said), 1, done.stderr)
            self.assertIn("brick_00003.vtu", said[0])
            self.assertEqual(self.files(), ["b.bricks"])

    def test_a_killed_rank_leaves_no_file(self):
        self.run_ok("split", "model:twist:40", "-o", "t.bricks", "--bricks", 30, "--quiet")
        for verb, name, *options in (["points", "a.ply"], ["vdb", "a.vdb", "--resolution", "300"],
                                     ["render", "a.exr", "--size", "512x512", "--backend", "cpu"]):
            run = subprocess.Popen([MPIRUN, "--oversubscribe", "-n", "3", COMMAND, verb, "t.bricks", "-o", name, *options],
                                   cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                   env={**os.environ, **AS_ROOT})
            ranks = []
            while run.poll() is None and len(ranks) < 3:
                ranks = [pid for pid in children(run.pid) if rank_of(pid) is not None]
            self.assertIsNone(run.poll(), "ended before it could be killed")
            time.sleep(0.1)  # anywhere in its work
            os.kill(next(pid for pid in ranks if rank_of(pid) == 1), signal.SIGKILL)
            self.assertNotEqual(run.wait(timeout=600), 0, verb)
            wait_for_end(ranks)
            self.assertEqual(self.files(), ["b.bricks", "t.bricks"], verb)
            # The same command again is not disturbed by what was killed.
            self.ranks(3, verb, "t.bricks", "-o", name, *options)
            (self.folder / name).unlink()

    def test_a_cancelled_run_is_one_sentence(self):
        """mpirun passes the signal on to all ranks; one of them speaks."""
        self.run_ok("split", "model:twist:40", "-o", "t.bricks", "--bricks", 30, "--quiet")
        run = subprocess.Popen([MPIRUN, "--oversubscribe", "-n", "4", COMMAND, "vdb", "t.bricks", "-o", "a.vdb", "--resolution", "300"],
                               cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                               env={**os.environ, **AS_ROOT})
        ranks = []
        while run.poll() is None and len(ranks) < 4:
            ranks = [pid for pid in children(run.pid) if rank_of(pid) is not None]
        time.sleep(0.5)  # anywhere in its work
        run.send_signal(signal.SIGTERM)
        said = [line for line in run.communicate(timeout=600)[1].splitlines() if line.startswith("subvol:")]
        self.assertLessEqual(len(said), 1, said)
        wait_for_end(ranks)
        self.assertEqual(self.files(), ["b.bricks", "t.bricks"])

    def test_what_cannot_be_written_is_one_sentence(self):
        """By rank 0, which writes; and by any rank, whose kernels wait in files until they are drawn."""
        for verb, name, *options in (["points", "a.ply"], ["vdb", "a.vdb", "--resolution", 40], ["render", "a.exr", *PICTURE]):
            (self.folder / name).symlink_to("/dev/full")
            done = self.mpirun(3, verb, "b.bricks", "-o", name, *options, folder=self.folder)
            self.assert_said("a." if verb != "vdb" else "vdb", done)
        line = 'if [ $OMPI_COMM_WORLD_RANK = 1 ]; then export TMPDIR=/nowhere; fi; exec "$@"'
        done = subprocess.run([MPIRUN, "--oversubscribe", "-n", "3", "sh", "-c", line, "sh", COMMAND, "render", "b.bricks", "-o",
                               "b.exr", *PICTURE], cwd=self.folder, capture_output=True, text=True, timeout=600,
                              env={**os.environ, **AS_ROOT})
        self.assert_said("TMPDIR names the folder", done)
        self.assertEqual(self.files(), ["a.exr", "a.ply", "a.vdb", "b.bricks"])

    def assert_said(self, words, done):
        self.assertIn(done.returncode, (2, 3), done.stderr)
        said = [line for line in done.stderr.splitlines() if line.startswith("subvol:")]
        self.assertEqual(len(said), 1, done.stderr)
        self.assertIn("cannot be written", said[0])
        self.assertIn(words, said[0])


if __name__ == "__main__":
    unittest.main()
