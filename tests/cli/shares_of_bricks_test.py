# SPDX-License-Identifier: Apache-2.0
"""Shares of a folder of bricks: --part, join, and processes of MPI. The result is that of the mesh in one piece."""

import json
import os
import signal
import struct
import subprocess
import time
import unittest

from command import COMMAND, children
from shares import AS_ROOT, BALL, COUNTS, PICTURE, SURFACES, Shared, WithRanks, end_of, in_ranks, rank_of, run_in_ranks, without_times, picture


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
        for options in (["--resolution", "50", "--mask", "--half"], ["--resolution", "50", "--levels", "1"]):
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
        for options in ([], ["--look", "volume", "--samples", "2"], ["--method", "tets"]):
            self.run_ok("render", BALL, "-o", "one.exr", *picture(options))
            for count in COUNTS if not options else (3,):
                names = self.parts("render", "b.bricks", ".exr", count, *picture(options))
                self.run_ok("join", *names, "-o", "joined.exr")
                self.assertEqual(self.bytes_of("joined.exr"), self.bytes_of("one.exr"), (count, options))

    def test_surfaces(self):
        for options in SURFACES:
            self.run_ok("surface", BALL, "-o", "one.ply", *options)
            for count in COUNTS if options == SURFACES[1] else (3,):
                names = self.parts("surface", "b.bricks", ".svshare", count, *options)
                self.run_ok("join", *names, "-o", "joined.ply")
                self.assertEqual(self.bytes_of("joined.ply"), self.bytes_of("one.ply"), (count, options))

    def test_figures(self):
        one = without_times(self.run_ok("info", "b.bricks", "--json").json())
        whole = without_times(self.run_ok("info", BALL, "--json").json())
        for count in COUNTS:
            self.assertEqual(self.figures(count, "b.bricks"), one, count)
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


class RanksOfBricks(WithRanks):
    def setUp(self):
        super().setUp()
        self.run_ok("split", BALL, "-o", "b.bricks", "--bricks", "5", "--by", "random", "--quiet")

    def test_points_and_grids(self):
        grids = ["--resolution", "50", "--mask", "--half", "--quiet"]
        self.run_ok("points", BALL, "-o", "one.ply")
        self.run_ok("vdb", BALL, "-o", "one.vdb", *grids)
        for count in COUNTS[1:]:
            self.ranks(count, "points", "b.bricks", "-o", "ranks.ply")
            self.assertEqual(self.bytes_of("ranks.ply"), self.bytes_of("one.ply"), count)
            self.ranks(count, "vdb", "b.bricks", "-o", "ranks.vdb", *grids, "--memory", "4M")
            self.assertEqual(self.grids("ranks.vdb"), self.grids("one.vdb"), count)

    def test_surfaces(self):
        self.run_ok("surface", BALL, "-o", "one.ply", *SURFACES[1])
        for count in COUNTS[1:]:
            self.ranks(count, "surface", "b.bricks", "-o", "ranks.ply", *SURFACES[1])
            self.assertEqual(self.bytes_of("ranks.ply"), self.bytes_of("one.ply"), count)

    def test_pictures(self):
        for options in ([], ["--look", "volume", "--samples", "2"], ["--method", "tets"]):
            self.run_ok("render", BALL, "-o", "one.exr", *picture(options))
            for count in COUNTS[1:] if not options else (3,):
                memory = "10M" if "tets" in options else "100K"  # several parts for each rank
                self.ranks(count, "render", "b.bricks", "-o", "ranks.exr", *picture(options), "--memory", memory)
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
        report = json.loads(self.ranks(4, "render", "t.bricks", "-o", "r.exr", "--look", "volume", *PICTURE[:-1], "--json").stdout)
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
            run = subprocess.Popen(in_ranks(3, COMMAND, verb, "t.bricks", "-o", name, *options), cwd=self.folder,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=AS_ROOT)
            ranks = []
            while run.poll() is None and len(ranks) < 3:
                ranks = [pid for pid in children(run.pid) if rank_of(pid) is not None]
            self.assertIsNone(run.poll(), "ended before it could be killed")
            time.sleep(0.1)  # anywhere in its work
            os.kill(next(pid for pid in ranks if rank_of(pid) == 1), signal.SIGKILL)
            end_of(run, ranks)
            self.assertNotEqual(run.returncode, 0, verb)
            self.assertEqual(self.files(), ["b.bricks", "t.bricks"], verb)
            # The same command again is not disturbed by what was killed.
            self.ranks(3, verb, "t.bricks", "-o", name, *options)
            (self.folder / name).unlink()

    def test_a_cancelled_run_is_one_sentence(self):
        """mpirun passes the signal on to all ranks; one of them speaks."""
        self.run_ok("split", "model:twist:40", "-o", "t.bricks", "--bricks", 30, "--quiet")
        run = subprocess.Popen(in_ranks(4, COMMAND, "vdb", "t.bricks", "-o", "a.vdb", "--resolution", "300", "--quiet"), cwd=self.folder,
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=AS_ROOT)
        ranks = []
        while run.poll() is None and len(ranks) < 4:
            ranks = [pid for pid in children(run.pid) if rank_of(pid) is not None]
        time.sleep(0.5)  # anywhere in its work
        run.send_signal(signal.SIGTERM)
        said = [line for line in end_of(run, ranks)[1].splitlines() if line.startswith("subvol:")]
        self.assertLessEqual(len(said), 1, said)

    def test_what_cannot_be_written_is_one_sentence(self):
        """By rank 0, which writes; and by any rank, whose kernels wait in files until they are drawn."""
        for verb, name, *options in (["points", "a.ply"], ["vdb", "a.vdb", "--resolution", 40], ["render", "a.exr", *PICTURE]):
            (self.folder / name).symlink_to("/dev/full")
            done = self.mpirun(3, verb, "b.bricks", "-o", name, *options, folder=self.folder)
            self.assert_said("a." if verb != "vdb" else "vdb", done)
        line = 'if [ $OMPI_COMM_WORLD_RANK = 1 ]; then export TMPDIR=/nowhere; fi; exec "$@"'
        done = run_in_ranks(self.folder, 3, "sh", "-c", line, "sh", COMMAND, "render", "b.bricks", "-o", "b.exr", "--look", "volume", *PICTURE)
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
