# SPDX-License-Identifier: Apache-2.0
"""Turntables, cameras and legends of `render`; videos with a replacement for ffmpeg that keeps its input."""

import json
import os
import shutil
import subprocess
import unittest
import zlib
from pathlib import Path
from xml.etree import ElementTree

from command import COMMAND, HANGS_AFTER, TWO_FIELDS, InFolder, Run, subvol

SMALL = ["--backend", "cpu", "--sheets", "20"]  # of splats
CAMERA = ["--camera", "3,-4,2,0,0,0,0,0,1,35"]

# The last argument is file:NAME.
KEEP_FRAMES = """#!/bin/sh
for last; do :; done
printf '%s\\n' "$@" > arguments.txt
exec cat > "${last#file:}"
"""
FAIL = """#!/bin/sh
echo 'first words' >&2
echo 'Unknown encoder, alas' >&2
exit 1
"""

TWO_SETS = """*NODE
1,0,0,0
2,1,0,0
3,1,1,0
4,0,1,0
5,0,0,1
6,1,0,1
7,1,1,1
8,0,1,1
9,2,0,0
10,2,1,0
11,2,0,1
12,2,1,1
*ELEMENT,TYPE=C3D8,ELSET=LEFT
1,1,2,3,4,5,6,7,8
*ELEMENT,TYPE=C3D8,ELSET=RIGHT
2,2,9,10,3,6,11,12,7
"""


class Pictures(InFolder):
    def render(self, *arguments, path=None, size="48x32"):
        environment = dict(os.environ, **({"PATH": path} if path else {}))
        small = [] if "--method" in arguments else SMALL
        done = subprocess.run([COMMAND, "render", "model:ball:2", *map(str, arguments), "--size", size, *small], cwd=self.folder,
                              capture_output=True, text=True, timeout=HANGS_AFTER, env=environment)
        return Run(done.returncode, done.stdout, done.stderr)

    def bytes_of(self, name):
        return (self.folder / name).read_bytes()

    def pixels(self, name):
        """The channels, the width and the rows of a .png, whose filters are undone."""
        data, at, packed, head = self.bytes_of(name), 8, b"", b""
        while at < len(data):
            length = int.from_bytes(data[at:at + 4], "big")
            kind, chunk = data[at + 4:at + 8], data[at + 8:at + 8 + length]
            head, packed = (chunk if kind == b"IHDR" else head), packed + (chunk if kind == b"IDAT" else b"")
            at += 12 + length
        width, height, channels = int.from_bytes(head[:4], "big"), int.from_bytes(head[4:8], "big"), {2: 3, 6: 4}[head[9]]
        raw, step, rows = zlib.decompress(packed), channels * width, []
        above = bytes(step)
        for y in range(height):
            kind, row = raw[y * (step + 1)], bytearray(raw[y * (step + 1) + 1:(y + 1) * (step + 1)])
            for i in range(step):
                a, b, c = (row[i - channels] if i >= channels else 0), above[i], (above[i - channels] if i >= channels else 0)
                p = a + b - c
                nearest = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
                row[i] = row[i] + (0, a, b, (a + b) // 2, nearest)[kind] & 255
            above = bytes(row)
            rows.append(above)
        return channels, width, rows

    def put_ffmpeg(self, script):
        tools = self.folder / "tools"
        tools.mkdir()
        (tools / "ffmpeg").write_text(script)
        (tools / "ffmpeg").chmod(0o755)
        return f"{tools}:/usr/bin:/bin"


class LevelSets(Pictures):
    """Grids of distances are drawn as the body within their surface."""

    def test_the_picture_is_that_of_the_body(self):
        self.run_ok("vdb", "model:ball:4", "--density", "1", "-o", "ball.vdb", "--sdf", "--resolution", 64, "--quiet")
        size = ["--size", "96x96", "--ortho", "--view", "-y", "--camera", "0,-5,0,0,0,0,0,0,1,30", "--background", "none"]
        size.remove("--view"), size.remove("-y")
        self.run_ok("render", "model:ball:4", "--density", "1", "-o", "mesh.png", *size)
        self.run_ok("render", "ball.vdb", "--field", "sdf", "-o", "set.png", *size)
        channels, _, mesh = self.pixels("mesh.png")
        _, _, body = self.pixels("set.png")
        self.assertEqual(channels, 4)
        alpha = [[row[k + 3] for row in rows for k in range(0, len(row), 4)] for rows in (mesh, body)]
        covered = sum(alpha[0])
        # The surface is within a tenth of a voxel, of which the ball has 64 across: a fiftieth of a pixel on its rim.
        self.assertLess(sum(abs(a - b) for a, b in zip(*alpha)), .01 * covered)
        inside = [k for k in range(len(alpha[0])) if alpha[0][k] == alpha[1][k] == 255]
        of = lambda rows: [row[k + c] for row in rows for k in range(0, len(row), 4) for c in range(3)]
        shades = list(zip(of(mesh), of(body)))
        # Light of both surfaces: normals of voxels are those of facets of one voxel.
        self.assertLess(sum(abs(a - b) for k in inside for a, b in shades[3 * k:3 * k + 3]) / (3 * len(inside)), 3)
        self.assertGreater(len(inside), .3 * 96 * 96)

    def test_what_it_is_not(self):
        self.run_ok("vdb", "model:ball:4", "-o", "ball.vdb", "--sdf", "--resolution", 24, "--quiet")
        for words, part in ((["render", "--method", "grid"], "draws no surface"), (["render", "--iso", "0"], "--iso: a level set is drawn as the surface"),
                            (["view", "--screenshot", "b.png", "--look", "isosurface"], "--look isosurface: a level set")):
            if words[0] == "render":
                words += ["-o", "b.png"]
            done = subvol(words[0], "ball.vdb", "--field", "sdf", *words[1:], folder=self.folder)
            self.assertEqual(done.code, 2, done.err)
            self.assertIn(part, done.err)
            self.assertNotIn("b.png", self.files())
        self.run_ok("render", "ball.vdb", "--field", "sdf", "-o", "b.png", "--method", "grid", "--look", "volume", "--size", "32x32")

    def test_the_window_and_the_page_have_it(self):
        self.run_ok("vdb", "model:ball:4", "-o", "ball.vdb", "--sdf", "--resolution", 24, "--quiet")
        same = ["--field", "sdf", "--size", "64x64", "--view", "iso"]
        self.run_ok("render", "ball.vdb", "-o", "a.png", *same)
        self.run_ok("view", "ball.vdb", "--screenshot", "b.png", *same)
        self.assertEqual(self.pixels("a.png"), self.pixels("b.png"))
        page = self.run_ok("page", "ball.vdb", "--field", "sdf", "-o", "ball.html", "--json").json()
        self.assertGreater(page["triangles"], 1000)
        self.assertEqual([(field["name"], field["range"]) for field in page["fields"]], [("density", [1, 1])])


class Turntables(Pictures):
    def test_frames_are_numbered_and_the_first_is_the_camera_itself(self):
        self.assertEqual(self.render("-o", "one.png", *CAMERA).code, 0)
        done = self.render("-o", "a.png", "--turntable", 3, "--json", *CAMERA)
        self.assertEqual(done.code, 0, done.err)
        names = [f"a_000{i}.png" for i in range(3)]
        self.assertEqual(self.files(), names + ["one.png"])
        self.assertEqual(done.json()["outputs"], names)
        self.assertEqual((done.json()["output"], done.json()["frames"]), (names[0], 3))
        frames = [self.bytes_of(name) for name in names]
        self.assertEqual(frames[0], self.bytes_of("one.png"))
        self.assertEqual(len(set(frames)), 3)

    def test_one_frame_is_numbered_too(self):
        self.assertEqual(self.render("-o", "a.exr", "--turntable", 1).code, 0)
        self.assertEqual(self.files(), ["a_0000.exr"])

    def test_the_other_renderer_turns_too(self):
        self.assertEqual(self.render("-o", "a.png", "--turntable", 2, "--method", "tets").code, 0)
        self.assertNotEqual(self.bytes_of("a_0000.png"), self.bytes_of("a_0001.png"))


class Videos(Pictures):
    def assert_refused(self, done, code, naming):
        self.assertEqual(done.code, code, done.err)
        self.assertRegex(done.err, r"^subvol: [^\n]+\n$")
        self.assertIn(naming, done.err)
        self.assertEqual([name for name in self.files() if name != "tools"], [])

    def test_frames_go_to_ffmpeg_as_bytes(self):
        path = self.put_ffmpeg(KEEP_FRAMES)
        done = self.render("-o", "turn.mp4", "--turntable", 3, "--fps", 12, path=path)
        self.assertEqual(done.code, 0, done.err)
        self.assertEqual(self.files(), ["arguments.txt", "tools", "turn.mp4"])
        frames, size = self.bytes_of("turn.mp4"), 48 * 32 * 3
        self.assertEqual(len(frames), 3 * size)
        self.assertEqual(len({frames[i * size:(i + 1) * size] for i in range(3)}), 3)
        arguments = (self.folder / "arguments.txt").read_text().split("\n")
        for option, value in [("-s", "48x32"), ("-r", "12"), ("-pix_fmt", "rgb24"), ("-i", "pipe:0")]:
            self.assertEqual(arguments[arguments.index(option) + 1], value)

    def test_the_length_of_a_video(self):
        path = self.put_ffmpeg(KEEP_FRAMES)
        self.assertEqual(self.render("-o", "turn.mp4", "--turntable", 3, "--duration", 2, path=path).code, 0)
        arguments = (self.folder / "arguments.txt").read_text().split("\n")
        self.assertEqual(float(arguments[arguments.index("-r") + 1]), 1.5)
        for wrong, words in (["--turntable", 3, "--duration", 2, "--fps", 3], "--duration"), (["--duration", 2], "video"):
            done = self.render("-o", "a.png", *wrong, path=path)
            self.assertEqual((done.code, words in done.err), (2, True), done.err)

    def test_without_ffmpeg(self):
        self.assert_refused(self.render("-o", "a.webm", "--turntable", 2, path="/nowhere"), 3, "ffmpeg")

    def test_failure_is_told_in_ffmpegs_last_words(self):
        done = self.render("-o", "a.gif", "--turntable", 2, path=self.put_ffmpeg(FAIL))
        self.assert_refused(done, 2, "Unknown encoder, alas")

    def test_a_video_needs_a_turntable(self):
        self.assert_refused(self.render("-o", "a.mp4"), 2, "--turntable")

    @unittest.skipIf(shutil.which("ffmpeg") is None, "there is no ffmpeg")
    def test_real_videos_of_odd_size(self):
        for name in ["a.mp4", "a.webm", "a.gif"]:
            done = self.render("-o", name, "--turntable", 3, size="33x31")
            self.assertEqual(done.code, 0, done.err)
            self.assertGreater((self.folder / name).stat().st_size, 200)


class Cameras(Pictures):
    def pixels_that_are_not_black(self, *arguments):
        """The pixels of a picture, through a video of one frame."""
        path = f"{self.folder / 'tools'}:/usr/bin:/bin" if (self.folder / "tools").exists() else self.put_ffmpeg(KEEP_FRAMES)
        done = self.render("-o", "a.gif", "--turntable", 1, *arguments, path=path)
        self.assertEqual(done.code, 0, done.err)
        frame = self.bytes_of("a.gif")
        lit = [i // 3 for i in range(0, len(frame), 3) if any(frame[i:i + 3])]
        columns, rows = {i % 48 for i in lit}, {i // 48 for i in lit}
        return len(lit), min(columns, default=0), max(columns, default=0), min(rows, default=0), max(rows, default=0)

    def test_a_folder_is_no_camera_and_no_map(self):
        for option in ("--camera", "--tf"):
            done = self.render("-o", "a.png", option, self.folder)
            self.assertEqual(done.code, 2)
            self.assertRegex(done.err, r"^subvol: [^\n]+ cannot be read[^\n]*\n$", "one sentence")

    def test_colours_of_the_field_itself_are_those_without_a_second_field(self):
        self.assertEqual(self.render("-o", "one.png", *CAMERA).code, 0)
        done = self.render("-o", "both.png", "--color-field", "density", *CAMERA)
        self.assertEqual(done.code, 0, done.err)
        self.assertEqual(self.bytes_of("both.png"), self.bytes_of("one.png"))

    def test_fit_brings_the_whole_box_in(self):
        far = ["--camera", "300,-400,200,0,0,0,0,0,1,35", "--look", "volume", "--tf", "constant"]
        near = ["--camera", "0.3,-0.4,0.2,0,0,0,0,0,1,35", "--look", "volume", "--tf", "constant"]
        self.assertLess(self.pixels_that_are_not_black(*far)[0], 4)
        fitted = self.pixels_that_are_not_black(*far, "--fit")
        self.assertGreater(fitted[0], 200)
        self.assertEqual(fitted, self.pixels_that_are_not_black(*near, "--fit"))
        _, left, right, top, bottom = fitted
        self.assertTrue(0 < left and right < 47 and 0 < top and bottom < 31, fitted)

    def test_an_orthographic_ball_has_its_height(self):
        # 32 / 1.05 = 30.5 rows; one pixel more or less, depending on where the centres are.
        _, left, right, top, bottom = self.pixels_that_are_not_black("--view", "-y", "--ortho", "--look", "volume", "--tf", "constant")
        self.assertIn(bottom - top + 1, (30, 31, 32))
        self.assertEqual(right - left, bottom - top)
        (self.folder / "camera.json").write_text('{"eye": [0, -9, 0], "target": [0, 0, 0], "ortho_height": 50}')
        given = self.pixels_that_are_not_black("--camera", "camera.json", "--ortho", "--look", "volume", "--tf", "constant")
        self.assertLess(given[0], 30)


class Looks(Pictures):
    def corner(self, name):
        """The first pixel of a PNG, whose rows are filtered by nothing or by differences: the same as its first bytes."""
        data = self.bytes_of(name)
        at, packed = 8, b""
        while at < len(data):
            size, kind = int.from_bytes(data[at:at + 4], "big"), data[at + 4:at + 8]
            packed += data[at + 8:at + 8 + size] if kind == b"IDAT" else b""
            at += size + 12
        return tuple(zlib.decompress(packed)[1:4])

    def test_a_mesh_is_a_solid_on_grey_unless_opacities_are_given(self):
        self.assertEqual(self.render("-o", "solid.png").code, 0)
        self.assertEqual(self.render("-o", "same.png", "--look", "solid").code, 0)
        self.assertEqual(self.bytes_of("solid.png"), self.bytes_of("same.png"))
        self.assertGreater(min(self.corner("solid.png")), 200)
        for option in ["--opacity", "0%:0,100%:.9"], ["--opacity-unit", ".1"], ["--look", "volume"]:
            self.assertEqual(self.render("-o", "volume.png", *option).code, 0)
            self.assertEqual(self.corner("volume.png"), (0, 0, 0), option)
        for option in ["--tf", "turbo"], ["--range", "0,2"]:  # these only colour it
            self.assertEqual(self.render("-o", "colored.png", *option).code, 0)
            self.assertEqual(self.corner("colored.png"), self.corner("solid.png"), option)
            self.assertNotEqual(self.bytes_of("colored.png"), self.bytes_of("solid.png"))
        self.assertEqual(self.render("-o", "xray.png", "--look", "xray").code, 0)
        self.assertEqual(self.corner("xray.png"), (255, 255, 255))

    def test_all_methods_light_a_solid_alike(self):
        for method in ["splat", "dense", "tets"]:
            done = self.render("-o", method + ".exr", "--method", method, size="96")
            self.assertEqual(done.code, 0, done.err)
        for method in ["dense", "tets"]:
            psnr = self.run_ok("compare", "splat.exr", method + ".exr", "--json").json()["psnr"]
            # Outlines of a coarse ball differ between the limit and its mesh of level 1.
            self.assertGreater(psnr, 28, method)

    def test_the_error_of_a_picture_is_said_as_it_is_found_with_very_many_sheets(self):
        picture = ["model:twist:12", "--look", "volume", "--size", "96", "--backend", "cpu"]
        self.run_ok("render", *picture, "--sheets", "8192", "-o", "many.exr")
        before = 1
        for tolerance in (1e-2, 1e-3, 1e-4):
            said = self.run_ok("render", *picture, "--tolerance-image", tolerance, "-o", "some.exr", "--json").json()
            found = self.run_ok("compare", "some.exr", "many.exr", "--json").json()
            self.assertLess(said["image_error"], before / 2)
            # A sixteenth is left of the error of sheets by four times as many.
            self.assertAlmostEqual(said["image_error"], found["rmse"], delta=.15 * found["rmse"])
            self.assertAlmostEqual(said["image_error_max"], found["max"], delta=.25 * found["max"])
            before = said["image_error"]
        turntable = [*picture, "--tolerance-image", "1e-2", "--turntable", "2", "-o", "t%d.exr", "--json"]
        first = self.run_ok("render", *picture, "--tolerance-image", "1e-2", "-o", "t.exr", "--json").json()
        self.assertGreater(self.run_ok("render", *turntable).json()["image_error"], first["image_error"] / 2)
        for words in ([], ["--sheets", "50"], ["--method", "tets"]):  # which have no tolerance of sheets
            self.assertNotIn("image_error", self.run_ok("render", *picture[:5], *words, "-o", "t.exr", "--json").json())

    def test_all_methods_cut_a_solid_open_alike(self):
        for cut in (["--clip", "0,0,0,1,-.5,.3"], ["--clip-box=-.5,-9,-.6,.5,.2,9"], ["--slice", "0,0,0,1,-.5,.3"]):
            for method in ["splat", "dense", "tets"]:
                done = self.render("-o", method + ".exr", "--method", method, "--levels", 1, "--samples", 1, *cut)
                self.assertEqual(done.code, 0, done.err)
            for method in ["dense", "tets"]:
                psnr = self.run_ok("compare", "splat.exr", method + ".exr", "--json").json()["psnr"]
                self.assertGreater(psnr, 28, (cut, method))

    def test_all_methods_show_the_material_at_an_eye_inside_a_solid(self):
        (self.folder / "two.vtk").write_text(TWO_FIELDS)
        for name, inside in (("apart", ["--camera", ".5,.5,.5,1,.6,.5,0,0,1,60"]),
                             ("parallel", ["--camera", ".4,.5,.5,1,.6,.7,0,0,1,60,.8"]),
                             ("cut behind", ["--camera", ".5,.5,.5,1,.6,.5,0,0,1,60", "--clip", ".8,0,0,1,0,0"])):
            for method in ["splat", "dense", "tets"]:
                self.run_ok("render", "two.vtk", "-o", method + ".exr", "--field", "Temp", "--size", "32x24", "--method", method, *inside)
            for method in ["dense", "tets"]:
                psnr = self.run_ok("compare", "splat.exr", method + ".exr", "--json").json()["psnr"]
                self.assertGreater(psnr, 45, (name, method))

    def test_opacities_of_a_solid_are_those_of_its_surface(self):
        parts = ["--part-opacity", "half:0,0,0,1,0,0=.3"]
        for words in ["--look", "solid", "--opacity", "0%:.2,100%:.6"], parts, [*parts, "--part-opacity", "half:0,0,0,-1,0,0=.6"]:
            self.assertEqual(self.render("-o", "solid.exr", size="96x64").code, 0)
            for method in ["splat", "dense", "tets"]:
                done = self.render("-o", method + ".exr", "--method", method, *words, size="96x64")
                self.assertEqual(done.code, 0, done.err)
            for method in ["dense", "tets"]:
                psnr = self.run_ok("compare", "splat.exr", method + ".exr", "--json").json()["psnr"]
                self.assertGreater(psnr or 999, 28, (method, words))  # None: the same
            self.assertLess(self.run_ok("compare", "splat.exr", "solid.exr", "--json").json()["psnr"], 32, words)
        for words in ["--part-opacity", "half:0,0,0,1,0,0=1"], ["--look", "solid", "--opacity", "0%:1,100%:1"]:
            self.assertEqual(self.render("-o", "opaque.exr", *words, size="96x64").code, 0)
            psnr = self.run_ok("compare", "opaque.exr", "solid.exr", "--json").json()["psnr"]
            self.assertGreater(psnr or 999, 35, words)  # but for the outline, whose samples are taken elsewhere
        for wrong, words in ((["--part-opacity", "half:0,0,0,1,0,0=.3", "--look", "volume"], "--look solid"), (["--part-opacity", "casing=.3"], "casing"),
                             (["--part-opacity", "half:0,0,0,1,0,0=2"], "--part-opacity"),
                             (["--look", "solid", "--opacity", "0%:.1,100%:1", "--slice", "0,0,0,1,0,0"], "--slice")):
            done = self.render("-o", "x.png", *wrong)
            self.assertEqual((done.code, words in done.err, done.err.count("\n")), (2, True, 1), done.err)

    def test_parts_are_sets_of_cells_by_name(self):
        (self.folder / "two.inp").write_text(TWO_SETS)
        self.run_ok("render", "two.inp", "-o", "all.png", "--size", "64x48")
        self.run_ok("render", "two.inp", "-o", "one.png", "--size", "64x48", "--part-opacity", "LEFT=.25")
        self.run_ok("render", "two.inp", "-o", "none.png", "--size", "64x48", "--part-opacity", "LEFT=0", "--quiet")
        self.assertEqual(len({self.bytes_of(name) for name in ("all.png", "one.png", "none.png")}), 3)

    def test_extremes_are_marked_with_their_values(self):
        said = self.run_ok("render", "model:ball:3", "-o", "a.png", "--size", "96x64", "--density", "z", "--extremes", "--json").json()
        self.assertLess(said["extremes"]["min"], -.9)
        self.assertGreater(said["extremes"]["max"], .9)
        self.assertAlmostEqual(said["extremes"]["max_at"][2], said["extremes"]["max"], delta=.05)
        half = self.run_ok("render", "model:ball:3", "-o", "b.png", "--size", "96x64", "--density", "z", "--extremes", "--clip", "0,0,0,0,0,1", "--json").json()
        self.assertLess(half["extremes"]["max"], .1)
        self.run_ok("render", "model:ball:3", "-o", "c.png", "--size", "96x64", "--density", "z")
        self.assertNotEqual(self.bytes_of("a.png"), self.bytes_of("c.png"))
        done = self.render("-o", "x.png", "--extremes", "--slice", "0,0,0,0,0,1")
        self.assertEqual((done.code, "slice" in done.err), (2, True), done.err)

    def test_edges_stay_with_what_is_left(self):
        words = ["--edges", "--clip", "0,0,0,1,0,0", "--view", "front", "--background", "white"]
        self.assertEqual(self.render("-o", "a.png", *words, size="96x64").code, 0)
        self.assertEqual(self.render("-o", "b.png", *[word for word in words if word != "--edges"], size="96x64").code, 0)
        a, b = (self.pixels(name)[2] for name in ("a.png", "b.png"))
        changed = [x for row, other in zip(a, b) for x in range(96) if row[3 * x:3 * x + 3] != other[3 * x:3 * x + 3]]
        self.assertGreater(len(changed), 30)
        self.assertLess(max(changed), 52)  # the right half is cut away

    def test_wrong_cuts_are_refused(self):
        for wrong, naming in [(["--clip", "0,0,0,0,0"], "--clip"), (["--clip", "0,0,0,0,0,0"], "no length"),
                              (["--clip", "0,0,0,0,0,nan"], "6 numbers"), (["--clip-box", "0,0,0,1,1"], "--clip-box"),
                              (["--clip-box", "1,0,0,0,1,1"], "along x"), (["--slice", "a,b"], "--slice"), (["--around"], "--slice")]:
            done = self.render("-o", "x.png", *wrong)
            self.assertEqual((done.code, naming in done.err), (2, True), (wrong, done.err))
            self.assertEqual(self.files(), [])

    def test_four_views_in_one_picture(self):
        self.assertEqual(self.render("-o", "sheet.exr", "--views", 4, size="64x48").code, 0)
        for view, name in [("-y", "front"), ("iso", "iso")]:
            self.assertEqual(self.render("-o", name + ".exr", "--view", view, size="32x24").code, 0)
        done = self.render("-o", "odd.png", "--views", 4, size="33x24")
        self.assertEqual((done.code, "multiple of 2" in done.err), (2, True), done.err)
        self.assertEqual(self.render("-o", "b.png", "--views", 4, "--turntable", 2).code, 2)

    def test_named_views_in_one_picture(self):
        for views, words in ("3", "--views"), ("front,up", "up"), ("front,", "--views"), ("front", "--views"):
            done = self.render("-o", "b.png", "--views", views)
            self.assertEqual((done.code, words in done.err), (2, True), done.err)
        self.assertEqual(self.render("-o", "b.png", "--views", "front,left", size="96x64").code, 0)
        self.assertEqual(self.render("-o", "c.png", "--views", "front,bottom", size="96x64").code, 0)
        b, c = (self.pixels(name)[2] for name in ("b.png", "c.png"))
        half = [[row[:3 * 48] for row in rows] for rows in (b, c)]
        self.assertEqual(half[0], half[1])  # the front, with its name
        self.assertNotEqual(b, c)
        self.assertEqual(self.render("-o", "three.png", "--views", "front,left,iso", size="96x64").code, 0)
        self.assertEqual(self.render("-o", "front.png", "--view", "front").code, 0)
        self.assertEqual(self.render("-o", "same.png", "--view", "-y").code, 0)
        self.assertEqual(self.bytes_of("front.png"), self.bytes_of("same.png"))

    def test_no_background(self):
        self.assertEqual(self.render("-o", "a.png", "--background", "none", "--look", "volume").code, 0)
        self.assertEqual(self.render("-o", "b.png", "--background", "black", "--look", "volume").code, 0)
        channels, width, rows = self.pixels("a.png")
        self.assertEqual((channels, width, rows[0][:4]), (4, 48, bytes(4)))
        over_black = self.pixels("b.png")[2]

        def linear(byte):
            s = byte / 255
            return s / 12.92 if s <= .04045 else ((s + .055) / 1.055) ** 2.4
        partly = 0
        for straight, black in zip(rows, over_black):
            for x in range(width):
                alpha = straight[4 * x + 3] / 255
                partly += .05 < alpha < .95
                for c in range(3):  # linear light times alpha is what stands on black
                    self.assertAlmostEqual(linear(straight[4 * x + c]) * alpha, linear(black[3 * x + c]), delta=.02)
        self.assertGreater(partly, 20)
        for name in "a.jpg", "a.webp":
            done = self.render("-o", name, "--background", "none")
            self.assertEqual((done.code, "alpha" in done.err), (2, True), done.err)

    def test_letters_without_a_background_are_legible_on_any_page(self):
        for look in "solid", "volume":
            self.assertEqual(self.render("-o", "a.png", "--background", "none", "--look", look, "--legend", size="240x160").code, 0)
            _, width, rows = self.pixels("a.png")
            title = [row[4 * (width - 50):] for row in rows[:22]]  # above the bar there are letters only
            for page in 0, 255:
                seen = [row[4 * x] * row[4 * x + 3] / 255 + page * (1 - row[4 * x + 3] / 255) for row in title for x in range(50)]
                self.assertGreater(max(seen) - min(seen), 100, (look, page))  # white on white is 18

    def test_other_formats(self):
        for name, head in ("a.jpg", b"\xff\xd8\xff"), ("a.webp", b"RIFF"):
            done = self.render("-o", name)
            self.assertEqual(done.code, 0, done.err)
            self.assertEqual(self.bytes_of(name)[:len(head)], head)
            done = subprocess.run([COMMAND, "render", "model:ball:2", "-o", "a.png", "--size", "48x32", *SMALL], cwd=self.folder)
            done = subprocess.run([COMMAND, "compare", name, "a.png", "--json"], cwd=self.folder, capture_output=True, text=True)
            self.assertGreater(json.loads(done.stdout)["psnr"], 25)

    def test_a_scale_bar_is_as_long_as_it_says(self):
        camera = self.folder / "camera.json"
        camera.write_text('{"eye": [0, -9, 0], "target": [0, 0, 0], "up": [0, 0, 1], "ortho_height": 3.2}')
        self.assertEqual(self.render("-o", "a.png", "--camera", "camera.json", size="480x320").code, 0)
        self.assertEqual(self.render("-o", "b.png", "--camera", "camera.json", "--scale-bar", size="480x320").code, 0)
        a, b = (self.pixels(name)[2] for name in ("a.png", "b.png"))
        longest = max(sum(row[3 * x:3 * x + 3] != other[3 * x:3 * x + 3] for x in range(480)) for row, other in zip(a, b))
        self.assertAlmostEqual(longest, 100, delta=3)  # 1 of 3.2 in 320 pixels: a quarter of the width is 1.2

    def test_where_and_how_a_legend_stands(self):
        for words in [], ["--legend-side", "bottom"], ["--legend-side", "bottom", "--legend-size", "2", "--views", "4"], ["--legend-format", "%.3f"]:
            self.assertEqual(self.render("-o", "a.png", "--legend", *words, size="200x160").code, 0)
            self.assertEqual(self.pixels("a.png")[1], 200)
            self.assertEqual(len(self.pixels("a.png")[2]), 160)
        self.assertEqual(self.render("-o", "a.png", "--legend", "a.svg", "--legend-format", "%.3f").code, 0)
        self.assertRegex((self.folder / "a.svg").read_text(), r">0\.\d{3}<")
        for wrong, words in (["--legend-side", "top", "--legend"], "--legend-side"), (["--legend-side", "bottom"], "--legend"), (["--legend-format", "%d", "--legend"], "%d"):
            done = self.render("-o", "x.png", *wrong)
            self.assertEqual((done.code, words in done.err), (2, True), done.err)

    def test_isosurfaces_of_values(self):
        self.assertEqual(self.render("-o", "five.png", "--look", "isosurface").code, 0)
        self.assertEqual(self.render("-o", "same.png", "--iso", "10%,30%,50%,70%,90%").code, 0)
        five, same = (self.pixels(name)[2] for name in ("five.png", "same.png"))
        self.assertLess(max(abs(p - q) for row, other in zip(five, same) for p, q in zip(row, other)), 3)
        self.assertEqual(self.render("-o", "one.png", "--iso", "50%").code, 0)
        self.assertNotEqual(self.bytes_of("one.png"), self.bytes_of("five.png"))
        for wrong, words in (["--iso", "a"], "--iso"), (["--iso", "1", "--look", "solid"], "--iso"), (["--iso", "1", "--opacity", "0:1"], "--iso"):
            done = self.render("-o", "x.png", *wrong)
            self.assertEqual((done.code, words in done.err), (2, True), done.err)

    def test_scales_and_bands(self):
        def colors(*words):
            self.assertEqual(self.render("-o", "a.png", "--slice", "0,0,0,0,1,0", "--view", "-y", "--tf", "grey", "--range", ".01,1", *words).code, 0)
            channels, width, rows = self.pixels("a.png")
            return {row[channels * x] for row in rows for x in range(width)}
        self.assertGreater(len(colors()), 60)
        self.assertLess(len(colors("--bands", "3", "--samples", "1")), 6)
        plain, logarithmic = self.render("-o", "p.png", "--legend", "p.svg"), self.render("-o", "l.png", "--log", "--range", ".01,1", "--legend", "l.svg")
        self.assertEqual((plain.code, logarithmic.code), (0, 0), logarithmic.err)
        self.assertIn(">0.1<", (self.folder / "l.svg").read_text())
        self.assertNotEqual(self.bytes_of("p.png"), self.bytes_of("l.png"))
        for wrong, words in (["--log", "--range=-1,1"], "--log: a logarithmic scale needs values above 0"), (["--log", "--symlog", "1"], "symlog"), (["--bands", "0"], "--bands"), (["--below", "rose"], "--below"):
            done = self.render("-o", "x.png", *wrong)
            self.assertEqual((done.code, words in done.err), (2, True), done.err)

    def test_what_is_drawn_over_an_empty_picture_does_not_hide_that(self):
        nothing = ["--clip=0,0,-9,0,0,1", "--json"]
        for over in [[], ["--axes"], ["--edges"], ["--axes", "--legend"], ["--axes", "--turntable", 2]]:
            for views in [[], ["--views", 4]] if "--turntable" not in over else [[]]:
                for name in "a.png", "a.exr":
                    done = self.render("-o", name, *nothing, *over, *views, size="160x120")
                    self.assertEqual(done.code, 0, done.err)
                    self.assertRegex(" ".join(done.json()["warnings"]), "the picture is empty", (over, views, name))
        white = ["--look", "volume", "--opacity", "0:1,1:1", "--background", "white", "--tf-range=-3,-2", "--tf", "grey", "--json"]
        for over in [], ["--views", 4, "--axes"]:
            self.assertRegex(" ".join(self.render("-o", "a.png", *white, *over).json()["warnings"]), "the picture is blank", over)
        done = self.render("-o", "a.png", "--views", 4, "--axes", "--json")
        self.assertEqual(done.json()["warnings"], [])

    def test_backgrounds(self):
        for background, color in [("#ff8000", (255, 128, 0)), ("white", (255, 255, 255)), ("1,0,0", (255, 0, 0))]:
            self.assertEqual(self.render("-o", "a.png", "--background", background).code, 0)
            self.assertEqual(self.corner("a.png"), color)
        for background, naming in [("2,0,0", "0..1"), ("#12", "#rrggbb"), ("wite", "did you mean white?"), ("1,2", "three numbers")]:
            done = self.render("-o", "b.png", "--background", background)
            self.assertEqual((done.code, naming in done.err), (2, True), done.err)

    def test_unknown_names_are_answered_with_the_nearest(self):
        self.assertIn("did you mean plasma?", self.render("-o", "a.png", "--tf", "plasme").err)
        self.assertIn("did you mean density?", self.render("-o", "a.png", "--field", "Densty").err)
        self.assertEqual(self.render("-o", "a.png", "--look", "nothing").code, 2)


TWO_FAR_APART = """# vtk DataFile Version 3.0
two
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 16 float
0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1
9999 0 0 10000 0 0 10000 1 0 9999 1 0 9999 0 1 10000 0 1 10000 1 1 9999 1 1
CELLS 2 18
8 0 1 2 3 4 5 6 7
8 8 9 10 11 12 13 14 15
CELL_TYPES 2
12 12
"""


class Captions(Pictures):
    TITLE_ROWS = 18  # of letters of 9 pixels, the smallest: twice as many

    def colored(self, name):
        """The rows with colours, which letters do not have, and the columns of what is dark above the body."""
        channels, width, rows = self.pixels(name)
        pixels = [[row[channels * x:channels * x + 3] for x in range(width)] for row in rows]
        colors = {y for y, row in enumerate(pixels) for p in row if max(p) - min(p) > 40}
        ink = {x for row in pixels[:self.TITLE_ROWS] for x, p in enumerate(row) if max(p) < 120}
        return colors, ink

    def test_a_title_stands_above_the_body(self):
        for words in [], ["--edges", "--legend"], ["--streamlines", "grad(density)", "--seeds", "line:-.5,0,0,.5,0,0"], ["--camera", "0,-1.2,0,0,0,0,0,0,1,60"]:
            done = self.render("-o", "a.png", "--title", "A title", "--look", "solid", *words, size="240x160")
            self.assertEqual(done.code, 0, done.err)
            colors, ink = self.colored("a.png")
            self.assertGreaterEqual(min(colors), 0 if "--legend" in words else self.TITLE_ROWS, words)
            self.assertGreater(len(ink), 4)  # strokes that fill a pixel
        self.assertEqual((min(colors), max(colors)), (self.TITLE_ROWS, 159), "the last camera's body fills what is left")

    def test_a_long_title_is_cut_with_dots(self):
        for name, letters in ("a.png", 60), ("b.png", 90):
            self.assertEqual(self.render("-o", name, "--title", "W" * letters, size="240x160").code, 0)
        self.assertEqual(self.bytes_of("a.png"), self.bytes_of("b.png"))
        ink = self.colored("a.png")[1]
        self.assertTrue(200 < max(ink) < 240 - 5, max(ink))
        self.assertEqual(self.render("-o", "c.png", "--title", "W", "--size", "60x20").code, 2, "no room for the body")

    def test_letters_that_cannot_be_drawn_are_named(self):
        done = self.render("-o", "a.png", "--title", "T = 20 ℃, ∂p/∂x, Темп", "--legend", "--unit", "kg m⁻³ s⁻²", "--json", size="240x160")
        self.assertEqual((done.code, done.json()["warnings"]), (0, []), done.err)
        done = self.render("-o", "a.png", "--title", "温度 T", "--legend", "--unit", "度秒", "--json", size="240x160")
        self.assertRegex(" ".join(done.json()["warnings"]), "boxes stand for letters .*: 温 度 秒 ")

    def test_axes_and_scale_bar_of_a_narrow_picture_lie_apart(self):
        def changed(a, b):
            (channels, width, one), (_, _, two) = self.pixels(a), self.pixels(b)
            places = [(x, y) for y in range(len(one)) for x in range(width) if one[y][channels * x:channels * x + 3] != two[y][channels * x:channels * x + 3]]
            return [min(p[k] for p in places) for k in (0, 1)], [max(p[k] for p in places) for k in (0, 1)]
        for size in "100x400", "200x800", "480x320":
            for name, words in ("plain", []), ("axes", ["--axes"]), ("both", ["--axes", "--scale-bar"]):
                self.assertEqual(self.render("-o", f"{name}.png", *words, size=size).code, 0)
            (axes_low, axes_high), (bar_low, bar_high) = changed("plain.png", "axes.png"), changed("axes.png", "both.png")
            self.assertTrue(axes_high[0] < bar_low[0] or bar_high[1] < axes_low[1], (size, axes_high, bar_low))

    def test_bodies_below_a_pixel_are_said(self):
        (self.folder / "far.vtk").write_text(TWO_FAR_APART)
        for method in "splat", "tets":
            done = subprocess.run([COMMAND, "render", "far.vtk", "-o", "a.png", "--size", "160x120", "--method", method, "--json"], cwd=self.folder,
                                  capture_output=True, text=True, check=True)
            self.assertRegex(" ".join(json.loads(done.stdout)["warnings"]), "2 of 2 bodies in the picture are smaller than a pixel")

    def test_an_xray_of_a_body_without_a_field_shows_how_thick_it_is(self):
        (self.folder / "cube.vtk").write_text(TWO_FIELDS)
        subprocess.run([COMMAND, "render", "cube.vtk", "-o", "a.png", "--density", "1", "--look", "xray", "--size", "60x60", "--camera", "3.5,-2.5,.5,.5,.5,.5,0,0,1,20",
                        "--json"], cwd=self.folder, capture_output=True, text=True, check=True)
        channels, width, rows = self.pixels("a.png")
        line = [row for row in zip(*[iter(rows[30])] * channels)]
        dark = [255 - p[0] for p in line]
        inside = [d for d in dark if d > 0]
        # Along the diagonal of a square the thickness grows and falls linearly; nothing is saturated.
        self.assertGreater(len(set(inside)), 10)
        self.assertLess(max(inside), 250)
        self.assertEqual(max(range(60), key=dark.__getitem__) in range(27, 33), True)


class Legends(Pictures):
    def test_integers_as_categories_are_named(self):
        done = self.render("-o", "a.png", "--density", "1+2*(x>0)", "--tf", "categories", "--legend", "a.svg")
        self.assertEqual(done.code, 0, done.err)
        texts = [node.text for node in ElementTree.parse(Path(self.folder) / "a.svg").iter() if node.tag.endswith("text")]
        self.assertEqual(texts, ["density", "1", "3"])
        fills = [node.get("fill") for node in ElementTree.parse(Path(self.folder) / "a.svg").iter() if node.tag.endswith("rect")]
        self.assertEqual(fills, ["#fff", "#1f77b4", "#2ca02c"])  # Tableau's first and third
        self.render("-o", "a.png", "--density", "1+.5*(x>0)", "--tf", "categories", "--legend", "b.svg")
        self.assertGreater(len((self.folder / "b.svg").read_text()), 2000, "a bar: these are no integers")

    def test_a_legend_hides_nothing_of_a_slice(self):
        for name, words in ("a.png", []), ("b.png", ["--no-legend"]):
            subprocess.run([COMMAND, "slice", "model:ball:3", "-o", name, "--extremes", "--resolution", "240", *words], cwd=self.folder, check=True,
                           capture_output=True)
        (channels, _, one), (_, width, two) = self.pixels("a.png"), self.pixels("b.png")
        self.assertEqual([row[:channels * width] for row in one], two)

    def test_legend_names_the_field(self):
        done = self.render("-o", "a.png", "--legend", "a.svg", "--opacity", "0%:0,100%:1", "--json")
        self.assertEqual(done.code, 0, done.err)
        self.assertEqual(done.json()["legend"], "a.svg")
        texts = [node.text for node in ElementTree.parse(Path(self.folder) / "a.svg").iter() if node.tag.endswith("text")]
        self.assertIn("density", texts)

    def test_two_fields_have_a_plot_each(self):
        fields = ["--density", "x", "--look", "volume"]
        self.render("-o", "one.png", "--legend", "one.svg", *fields)
        (self.folder / "two.vtk").write_text(TWO_FIELDS)
        done = subprocess.run([COMMAND, "render", "two.vtk", "-o", "two.png", "--legend", "two.svg", "--field", "Temp", "--color-field",
                               "Pres", "--size", "32", "--unit", "Pa", *SMALL], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        texts = [node.text for node in ElementTree.parse(self.folder / "two.svg").iter() if node.tag.endswith("text")]
        for text in ("Pres [Pa]", "Temp", "300", "1000"):  # titles, and ticks of 293..313 and of 0..2000
            self.assertIn(text, texts)

    def test_a_legend_in_the_picture_is_beside_the_body(self):
        plain = self.render("-o", "a.exr", "--look", "solid", size="128x96")
        self.assertEqual(plain.code, 0, plain.err)
        for name, options in [("legend", ["--legend"]), ("axes", ["--axes"]), ("edges", ["--edges"]),
                              ("sheet", ["--legend", "--views", 4, "--axes", "--edges"])]:
            done = self.render("-o", f"{name}.png", "--look", "solid", *options, size="128x96")
            self.assertEqual(done.code, 0, done.err)
            header = self.bytes_of(f"{name}.png")[16:24]
            self.assertEqual((int.from_bytes(header[:4], "big"), int.from_bytes(header[4:], "big")), (128, 96))
        pictures = [self.bytes_of(f"{name}.png") for name in ("legend", "axes", "edges", "sheet")]
        self.assertEqual(len(set(pictures)), 4)

    def test_what_cannot_be_drawn_over_is_refused(self):
        for options, naming in [(["--unit", "K"], "--legend"),
                                (["--legend", "--size", "30x400"], "--size")]:
            done = self.render("-o", "a.png", *options)
            self.assertEqual((done.code, naming in done.err), (2, True), done.err)

    def test_clamped_values_look_like_the_ends_of_the_range(self):
        # One hot point: the scheme goes below zero beside it, where this map is opaque.
        field = ["--density", "abs(x)+abs(y)+abs(z)<.1", "--opacity", "-1:1,-.001:1,0:0,1:0", "--look", "volume"]
        opaque = self.render("-o", "open.png", *field, "--method", "tets", "--levels", 1, "--json")
        clamped = self.render("-o", "kept.png", *field, "--method", "tets", "--levels", 1, "--clamp", "--json")
        self.assertEqual((opaque.code, clamped.code), (0, 0), clamped.err)
        self.assertEqual(opaque.json()["warnings"], [])
        self.assertIn("the picture is empty", clamped.json()["warnings"][0])

    def test_a_map_is_stretched_to_a_range(self):
        (self.folder / "map.json").write_text('[{"Name": "n m", "RGBPoints": [0, 0, 0, 0, 1, 1, 1, 1]}]')
        for name, options in [("file", ["--tf", "map.json:n m", "--tf-range", "-3,5"]),
                              ("preset", ["--tf", "grey", "--tf-range", "-3,5"])]:
            done = self.render("-o", f"{name}.png", "--legend", f"{name}.svg", *options)
            self.assertEqual(done.code, 0, done.err)
        self.assertEqual(self.bytes_of("file.png"), self.bytes_of("preset.png"))
        self.assertEqual(self.bytes_of("file.svg"), self.bytes_of("preset.svg"))
        self.assertEqual(self.render("-o", "a.png", "--tf-range", "5,-3").code, 2)
        self.assertEqual(self.render("-o", "a.png", "--tf-range", "5").code, 2)


if __name__ == "__main__":
    unittest.main()
