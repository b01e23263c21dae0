# SPDX-License-Identifier: Apache-2.0
"""Sessions of `view`: scripts without a window, and the window under Xvfb, by a script and by a real mouse."""

import ctypes.util
import functools
import json
import os
import pathlib
import re
import shlex
import shutil
import struct
import subprocess
import sys
import unittest
import zlib

from command import COMMAND, HANGS_AFTER, InFolder, Run, on_cpu, subvol

BALL = "model:ball:3"
SIZE = ["--size", "64x48"]
SMALL = [*SIZE, "--backend", "cpu"]


class InSession(InFolder):
    def script(self, *actions, name="actions.json"):
        (self.folder / name).write_text(json.dumps(actions))
        return name

    def view(self, *actions, options=(), model=BALL, shot="view.png"):
        return self.run_ok("view", model, *SIZE, *on_cpu(options), *options, "--script", self.script(*actions), "--screenshot", shot, "--json").json()

    def bytes_of(self, name):
        return (self.folder / name).read_bytes()


class WithoutWindow(InSession):
    def test_begins_with_the_picture_of_render(self):
        for options in ([], ["--look", "volume", "--tf", "coolwarm"], ["--view", "-y", "--ortho"], ["--method", "tets", "--axes"]):
            self.view(options=options)
            self.run_ok("render", BALL, *SIZE, *on_cpu(options), *options, "-o", "render.png", "--quiet")
            self.assertEqual(self.bytes_of("view.png"), self.bytes_of("render.png"), options)

    def test_shows_points_and_voxels(self):
        self.run_ok("points", BALL, "-o", "ball.ply", "--quiet")
        self.run_ok("vdb", BALL, "-o", "ball.vdb", "--resolution", "20", "--quiet")
        for model, options in (("ball.ply", []), ("ball.vdb", ["--method", "grid"]), ("ball.vdb", ["--look", "solid"])):
            said = self.view(options=options, model=model)
            self.run_ok("render", model, *SIZE, *on_cpu(options), *options, "-o", "render.png", "--quiet")
            self.assertEqual(self.bytes_of("view.png"), self.bytes_of("render.png"), (model, options))
            self.run_ok(*shlex.split(said["render"])[1:], "--quiet")
            self.assertEqual(self.bytes_of("view.png"), self.bytes_of("picture.png"), said["render"])
        for words in (["ball.ply", "--method", "tets"], [BALL, "--method", "grid"], ["ball.ply", "--per-edge", "2"],
                      ["ball.ply", "--field", "T"], ["ball.ply", "--edges"]):
            done = subvol("view", *words, *SIZE, "--screenshot", "x.png", folder=self.folder)
            self.assertEqual(done.code, 2, done.err)

    def test_shadows_are_those_of_render(self):
        options = ["--shadows", "--ambient-occlusion", ".1"]
        for action in ({"zoom": 1.2}, {"orbit": [30, 0]}, {"clip": [[0, 0, .3, 0, 0, 1]]}):  # only the first keeps the light
            said = self.view({"wait": True}, action, options=options)
            self.run_ok(*shlex.split(said["render"])[1:], "--quiet")
            self.assertEqual(self.bytes_of("view.png"), self.bytes_of("picture.png"), said["render"])

    def test_its_command_draws_the_same(self):
        for actions in (
                [{"orbit": [40, -15]}, {"zoom": 1.3}, {"pan": [0.1, 0]}],
                [{"look": "volume"}, {"tf": "plasma"}, {"range": [-0.5, 1]}, {"opacity": [[-0.3, 0], [0.123456789, 0.3], [1, 0.9]]},
                 {"legend": True}, {"size": [160, 90]}],
                [{"ortho": True}, {"view": "+x"}, {"axes": True}, {"edges": True}, {"look": "isosurface"}],
                [{"edges": True}, {"method": "tets"}],
                [{"edges": True}, {"look": "volume"}, {"orbit": [20, 10]}],
                [{"flow": {"streamlines": "grad(density)", "seeds": "line:-.4,0,0,.4,.1,0", "seed-count": 4}}, {"opacity": [[-1, .1], [1, .1]]}],
                [{"flow": {"glyphs": "grad(density)", "glyph-count": 5}}, {"look": "volume"}, {"edges": True}],
                [{"range": [0.2, 0.9]}, {"log": True}, {"bands": 5}, {"below": [1, 0, 0]}, {"above": [0, 0, 1]}, {"size": [160, 90]}, {"legend": True}],
                [{"range": [0.1, 1]}, {"log": True}, {"symlog": 0.1}, {"range": "field"}, {"bands": 9}, {"bands": None}],
                [{"method": "dense"}, {"look": "xray"}, {"opacity_unit": 0.4}, {"size": [48, 27]}],
        ):
            command = self.view(*actions)["render"]
            words = shlex.split(command)
            self.assertEqual(words[0], "subvol")
            self.run_ok(*words[1:], "--quiet")
            self.assertEqual(self.bytes_of("view.png"), self.bytes_of("picture.png"), command)

    def test_streamlines_are_those_of_render(self):
        options = ["--streamlines", "grad(density)", "--seeds", "disk:0,0,0,0,0,1,.5", "--seed-count", 5, "--tube-radius", ".02"]
        said = self.view({"orbit": [30, 10]}, {"save_state": "state.json"}, options=options)
        for word in map(str, options[:-1]):
            self.assertIn(word, shlex.split(said["render"]))
        self.run_ok(*shlex.split(said["render"])[1:], "--quiet")
        self.assertEqual(self.bytes_of("view.png"), self.bytes_of("picture.png"), said["render"])
        self.run_ok("view", BALL, *SMALL, "--state", "state.json", "--screenshot", "again.png", "--quiet")
        self.assertEqual(self.bytes_of("view.png"), self.bytes_of("again.png"))
        self.view({"orbit": [30, 10]}, {"flow": {}}, options=options)
        self.assertNotEqual(self.bytes_of("view.png"), self.bytes_of("again.png"), "they are seen")
        for words, action in (("has no effect without streamlines", {"seeds": "at:0,0,0"}), ("did you mean", {"streamline": "x"}),
                              ("no field", {"streamlines": "U"}), ("out of range", {"streamlines": "grad(density)", "seed-count": 0})):
            done = subvol("view", BALL, *SMALL, "--script", self.script({"flow": action}), "--screenshot", "a.png", folder=self.folder)
            self.assertEqual(done.code, 2, action)
            self.assertIn(words, done.err)

    def test_a_saved_state_is_where_another_session_begins(self):
        self.view({"orbit": [70, 20]}, {"look": "volume"}, {"save_state": "state.json"})
        self.run_ok("view", BALL, *SMALL, "--state", "state.json", "--screenshot", "again.png", "--quiet")
        self.assertEqual(self.bytes_of("view.png"), self.bytes_of("again.png"))

    def test_inverted_cells_are_said(self):
        push = [{"select": {"ball": [0, 0, 0.5, 0.5]}}, {"move": [0, 0, -1]}]
        said = self.view(*push, {"save_mesh": "pushed.vtu"}, options=["--look", "solid"])
        count = self.run_ok("info", "pushed.vtu", "--json").json()["inverted_cells"]
        self.assertGreater(count, 2)
        self.assertEqual(said["state"]["inverted_cells"], count)
        self.assertIn(f"pushed.vtu: {count} of its ", said["warnings"][-1])
        self.assertIn("# without the marks of inverted cells", said["render"])
        self.run_ok(*shlex.split(said["render"], comments=True)[1:], "--quiet")
        self.assertNotEqual(self.bytes_of("view.png"), self.bytes_of("picture.png"))
        said = self.view(*push, {"save_mesh": "pushed.vtu"}, {"inverted": False}, options=["--look", "solid"])
        self.run_ok(*shlex.split(said["render"])[1:], "--quiet")
        self.assertEqual(self.bytes_of("view.png"), self.bytes_of("picture.png"))

    def test_edits_are_in_the_state_and_the_command(self):
        edit = [{"select": "all"}, {"twist": {"angle": 40}}]
        said = self.view(*edit, {"save_state": "state.json"})
        self.run_ok("view", BALL, *SMALL, "--state", "state.json", "--screenshot", "again.png", "--quiet")
        self.assertEqual(self.bytes_of("view.png"), self.bytes_of("again.png"))
        self.run_ok(*shlex.split(said["render"])[1:], "--quiet")  # of the mesh that was saved with the state
        self.assertEqual(self.bytes_of("view.png"), self.bytes_of("picture.png"), said["render"])
        self.assertIn("# without the edits", self.view(*edit)["render"])
        (self.folder / "state.edits.vtu").unlink()
        self.run_ok("model", "ball", "--resolution", 4, "-o", "state.edits.vtu")
        done = subvol("view", BALL, *SMALL, "--state", "state.json", "--screenshot", "no.png", folder=self.folder)
        self.assertEqual(done.code, 2, done.err)
        self.assertIn("state.edits.vtu", done.err)

    def test_a_state_does_not_replace_the_mesh(self):
        for mesh, state in (("part.vtu", "part.json"), ("part.edits.vtu", "part.json")):
            self.run_ok("model", "ball", "--resolution", 3, "-o", mesh)
            before = self.bytes_of(mesh)
            done = subvol("view", mesh, *SMALL, "--script", self.script({"select": "all"}, {"twist": {"angle": 40}}, {"save_state": state}),
                          "--screenshot", "a.png", folder=self.folder)
            self.assertEqual(done.code, 0 if mesh == "part.vtu" else 2, done.err)
            self.assertEqual(self.bytes_of(mesh), before)
        self.assertIn("part.edits.vtu", done.err)

    def test_regions_and_expressions_are_in_the_command(self):
        said = self.view({"field": "2*density"}, options=["--only", "half:0,0,0,1,0,0", "--look", "volume"])
        self.run_ok(*shlex.split(said["render"])[1:], "--quiet")
        self.assertEqual(self.bytes_of("view.png"), self.bytes_of("picture.png"), said["render"])

    def test_a_comparison_has_the_figures_of_compare(self):
        said = self.view({"compare": "tets"}, options=["--look", "volume"])
        for method in ("splat", "tets"):
            self.run_ok("render", BALL, *SIZE, *(["--backend", "cpu"] if method == "splat" else []), "--look", "volume", "--method", method, "-o", f"{method}.exr", "--quiet")
        figures = self.run_ok("compare", "splat.exr", "tets.exr", "--json").json()
        self.assertAlmostEqual(said["comparison"]["psnr"], figures["psnr"], delta=.01)  # files of pictures have half floats
        self.assertAlmostEqual(said["comparison"]["flip"], figures["flip"], delta=1e-3)
        self.assertNotIn("comparison", self.view())

    def test_only_the_window_opens_without_a_file(self):
        for words in (["--screenshot", "x.png"], ["--script", self.script({"wait": True})]):
            done = subvol("view", *words, folder=self.folder)
            self.assertEqual(done.code, 2, done.err)
            self.assertIn("FILE", done.err)

    def test_writes_pictures_on_the_way_and_says_what_is_there(self):
        said = self.view({"screenshot": "first.png"}, {"orbit": [50, 0]}, {"wait": True}, {"pick": [32, 24]})
        self.assertNotEqual(self.bytes_of("first.png"), self.bytes_of("view.png"))
        self.assertEqual([wait["action"] for wait in said["waits"]], [1, 3])
        for wait in said["waits"]:
            self.assertLessEqual(wait["first"], wait["full"])
        self.assertLess(abs(sum(x * x for x in said["picked"]["at"]) ** .5 - 1), .02)  # on the unit ball

    def test_steps_of_a_series(self):
        for step in (0, 1):
            self.run_ok("model", "ball", "--resolution", 2 + step, "-o", f"ball_{step}.vtu")
        (self.folder / "run.pvd").write_text(
            '<VTKFile type="Collection"><Collection><DataSet timestep="0" file="ball_0.vtu"/>'
            '<DataSet timestep="1" file="ball_1.vtu"/></Collection></VTKFile>')
        said = self.view({"step": 0}, model="run.pvd")
        self.run_ok("render", "run.pvd", *SMALL, "--step", 0, "--camera", ",".join(map(str, self.numbers(said))), "-o", "r.png", "--quiet")
        self.assertEqual(self.bytes_of("view.png"), self.bytes_of("r.png"))

    @staticmethod
    def numbers(said):
        camera = said["state"]["camera"]
        return [*camera["eye"], *camera["target"], *camera["up"], camera["fovy_deg"]]

    def test_refuses_in_one_sentence(self):
        for text, naming in [("", "empty"), ("{", "is not JSON: line 1, column 2"), ("{}", "array"), ("[7]", "object"), ('[{"orbit": [1]}]', "action 1: orbit"),
                             ('[{"wait": true}, {"spin": 1}]', "action 2"), ('[{"field": "T"}]', "density"),
                             ('[{"load_state": "no.json"}]', "no.json"), ("[" * 100000, "wrong.json")]:
            (self.folder / "wrong.json").write_text(text)
            done = subvol("view", BALL, *SMALL, "--script", "wrong.json", "--screenshot", "x.png", folder=self.folder)
            self.assertEqual(done.code, 2, (text[:40], done.err))
            self.assertIn(naming, done.err)
            self.assertEqual(len(done.err.strip().splitlines()), 1, done.err)
        self.assertNotIn("x.png", self.files())

    def test_without_a_display_it_says_so(self):
        environment = {key: value for key, value in os.environ.items() if key not in ("DISPLAY", "WAYLAND_DISPLAY")}
        done = subprocess.run([COMMAND, "view", BALL], cwd=self.folder, capture_output=True, text=True, timeout=HANGS_AFTER,
                              env=environment)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        self.assertIn("--script", done.stderr)


def has_window():
    if not shutil.which("xvfb-run"):
        return "xvfb-run is not installed"
    said = subprocess.run(["xvfb-run", "-a", COMMAND, "view", "model:ball:2", "--window", "--script", "/dev/stdin", "--screenshot",
                           "/dev/null.png"], input="[]", capture_output=True, text=True, timeout=HANGS_AFTER).stderr
    return "the command was built without a window" if "built without" in said else None


def patiently(test):
    """A test by hand again, with pauses four and sixteen times as long, if it fails: a window on a busy machine may need them."""
    def run(self):
        for pace in (1, 4, 16):
            self.pace = pace
            try:
                return test(self)
            except AssertionError:
                if pace == 16:
                    raise
                print(f"{test.__name__} failed with pauses {pace} times as long; again", file=sys.stderr)
                self.setUp()  # a new folder
    return functools.wraps(test)(run)


class InWindow(InSession):
    @classmethod
    def setUpClass(cls):
        missing = has_window()
        if missing:
            print(f"skipped: {missing}")
            raise unittest.SkipTest(missing)

    def in_xvfb(self, *words):
        return subprocess.run(["xvfb-run", "-a", "-s", "-screen 0 1280x800x24", *map(str, words)], cwd=self.folder,
                              capture_output=True, text=True, timeout=HANGS_AFTER)

    @patiently
    def test_the_middle_is_the_picture_of_render(self):
        script = self.script({"orbit": [20, 10]}, {"wait": True}, {"screenshot": "middle.png"})
        done = self.in_xvfb(COMMAND, "view", BALL, "--backend", "cpu", "--window", "--script", script, "--screenshot", "window.exr",
                            "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        state = json.loads(done.stdout)["state"]
        width, height = state["size"]
        camera = ",".join(map(str, WithoutWindow.numbers({"state": state})))
        self.run_ok("render", BALL, "--backend", "cpu", "--size", f"{width}x{height}", "--camera", camera, "-o", "r.png", "--quiet")
        self.assertEqual(self.bytes_of("middle.png"), self.bytes_of("r.png"))

    def by_hand(self, steps, arguments, size=(1280, 800)):
        """Steps of xdotool at a window. `save FILE` waits for a saved state, `shot NAME` keeps the pixels of the screen, `idle` waits."""
        if not shutil.which("xdotool"):
            print("skipped: xdotool is not installed")
            self.skipTest("xdotool is not installed")
        script = f"""
            save() {{ rm -f state.json; xdotool key ctrl+s; for i in $(seq 100); do [ -s state.json ] && break; sleep .1; done; sleep .2; mv state.json $1; }}
            enter() {{ xdotool keydown Return sleep .3 keyup Return sleep .3; }}  # held, as by a hand: fields of text see keys once a frame
            shot() {{ cp screen/Xvfb_screen0 $1.xwd; }}
            drag() {{ xdotool mousemove $1 $2 sleep .3 mousedown ${{5:-1}} sleep .3 mousemove $((($1 + $3) / 2)) $((($2 + $4) / 2)) sleep .3 mousemove $3 $4 sleep .3 mouseup ${{5:-1}} sleep .5; }}
            for i in $(seq 100); do window=$(xdotool search --onlyvisible --name subvol | head -1); [ -n "$window" ] && break; sleep .1; done
            xdotool windowsize $window {size[0]} {size[1]} mousemove 300 300
            sleep 3
            {steps}
            xdotool mousemove 300 300 key Escape key Escape key q
        """
        (self.folder / "steps.sh").write_text(f"""{shlex.join([COMMAND, "view", *map(str, arguments)])} >out.txt 2>err.txt & subvol=$!
            ({re.sub(r"sleep ([0-9.]+)", lambda wait: f"sleep {self.pace * float(wait[1]):g}", script)})
            for i in $(seq 100); do kill -0 $subvol 2>/dev/null || break; sleep .1; done
            kill -0 $subvol 2>/dev/null && {{ kill $subvol; echo "the window did not close" >&2; }}
            wait $subvol; code=$?; cat err.txt >&2; exit $code""")
        (self.folder / "screen").mkdir(exist_ok=True)
        done = subprocess.run(["xvfb-run", "-a", "-s", f"-screen 0 {size[0]}x{size[1]}x24 -fbdir screen", "bash", "steps.sh"], cwd=self.folder,
                              capture_output=True, text=True, timeout=HANGS_AFTER, env=os.environ | {"XDG_STATE_HOME": str(self.folder / "home")})
        self.assertEqual(done.returncode, 0, done.stderr)
        kept = os.environ.get("SUBVOL_SHOTS")  # a folder for people who want to look
        for shot in self.folder.glob("*.xwd"):
            if kept:
                write_png(pixels_of(shot), pathlib.Path(kept) / f"{self._testMethodName}_{shot.stem}.png")

    def state(self, name):
        return json.loads((self.folder / name).read_text())

    @patiently
    def test_mouse_and_keys(self):
        self.by_hand("""
            save before.json
            drag 300 300 400 300
            xdotool key k key a
            save after.json
            xdotool key ctrl+z key ctrl+z key ctrl+z sleep .5
            save undone.json
        """, [BALL, "--backend", "cpu"])
        before, after = self.state("before.json"), self.state("after.json")
        self.assertEqual((before["look"], after["look"]), ("solid", "volume"))
        self.assertEqual((before["axes"], after["axes"]), (False, True))
        self.assertNotEqual(before["camera"]["eye"], after["camera"]["eye"])
        self.assertAlmostEqual(before["camera"]["eye"][2], after["camera"]["eye"][2])  # the drag was level
        self.assertEqual(self.state("undone.json"), before)  # a drag is one step

    @patiently
    def test_wheel_and_double_click(self):
        self.by_hand("""
            xdotool mousemove 570 290 sleep .3 click --repeat 4 --delay 100 4 sleep .5
            save near.json
            for i in $(seq 20); do  # until the picture is there that has the place
                xdotool click 1 sleep .1 click 1 sleep 1
                save middle.json
                cmp -s near.json middle.json || break
            done
            xdotool key Return sleep .5
            save fit.json
            shot middle
        """, [BALL, "--backend", "cpu"])
        near, middle = self.state("near.json"), self.state("middle.json")
        distance = lambda state: sum((a - b) ** 2 for a, b in zip(state["camera"]["eye"], state["camera"]["target"])) ** .5
        self.assertAlmostEqual(distance(near), distance(middle))  # only the wheel goes nearer
        self.assertNotEqual(near["camera"]["target"], [0, 0, 0])  # about the pointer, which is beside the middle
        self.assertAlmostEqual(sum(x * x for x in middle["camera"]["target"]) ** .5, 1, delta=.02)  # on the ball
        self.assertGreater(distance(self.state("fit.json")), distance(near))

    @patiently
    def test_menu_tools_and_escape(self):
        self.by_hand("""
            xdotool mousemove 400 300 click 3 sleep .5
            shot menu
            xdotool mousemove 450 505 sleep .3 click 1 sleep .5
            save axes.json
            xdotool mousemove 400 300 click 3 sleep .5 key Escape sleep .5 key e sleep .5
            shot tool
            drag 470 390 520 390
            save edited.json
            xdotool key Escape sleep .5
            drag 470 390 520 390
            save turned.json
        """, [BALL, "--backend", "cpu"])
        axes, edited, turned = (self.state(name) for name in ("axes.json", "edited.json", "turned.json"))
        self.assertTrue(axes["axes"])  # an item of the menu
        self.assertEqual(axes["camera"], edited["camera"])  # the brush worked, and the camera stayed
        self.assertIn("mesh", edited)
        self.assertNotEqual(edited["camera"], turned["camera"])  # Escape has left the tool

    @patiently
    def test_edits_are_not_dropped_unasked(self):
        self.by_hand("""
            xdotool mousemove 400 300 key e sleep .5
            drag 470 390 520 390
            xdotool key q sleep 1
            shot asked
            save kept.json
        """, [BALL, "--backend", "cpu"])
        self.assertIn("mesh", self.state("kept.json"))

    @patiently
    def test_border_and_typed_planes(self):
        self.by_hand("""
            xdotool key r sleep 2
            drag 470 384 235 384
            save moved.json
            shot border
            xdotool key r sleep .3 mousemove 1000 174 click 1 sleep .5 mousemove 983 204 click 1 sleep 1
            shot plane
            xdotool mousemove 985 294 click --repeat 2 --delay 60 1 sleep .3 type .25
            enter
            save plane.json
            shot typed
        """, [BALL, "--backend", "cpu"])
        self.assertAlmostEqual(self.state("moved.json")["slider"], .25, delta=.01)
        self.assertEqual(self.state("moved.json")["camera"], self.state("plane.json")["camera"])
        [plane] = self.state("plane.json")["clip"]
        self.assertEqual((plane[0], plane[3:]), (.25, [1, 0, 0]))

    @patiently
    def test_a_window_without_a_file_opens_one(self):
        self.run_ok("model", "ball", "--resolution", 3, "-o", "ball.vtu")
        (self.folder / "home" / "subvol").mkdir(parents=True)
        (self.folder / "home" / "subvol" / "recent").write_text(f"{self.folder}/gone.vtu\n")
        self.by_hand("""
            shot start
            xdotool key ctrl+o sleep .7 mousemove 640 587 click 1 sleep .3 type ball.vtu
            shot dialog
            enter
            sleep 3
            shot opened
            xdotool mousemove 300 300
            save opened.json
        """, ["--backend", "cpu"])
        self.assertEqual(self.state("opened.json")["field"], "density")
        self.assertEqual((self.folder / "home" / "subvol" / "recent").read_text(), f"{self.folder}/ball.vtu\n")
        self.assertNotEqual(pixels_of(self.folder / "start.xwd"), pixels_of(self.folder / "opened.xwd"))

    @patiently
    def test_a_file_is_dropped(self):
        if not ctypes.util.find_library("X11"):
            self.skipTest("libX11 is not installed")
        self.run_ok("model", "ball", "--resolution", 3, "-o", "a ball.vtu")
        drop = shlex.join([sys.executable, str(pathlib.Path(__file__).with_name("drop_file.py"))])
        self.by_hand(f"""
            {drop} $window 'a ball.vtu' || echo failed >fault
            sleep 3
            shot dropped
            save dropped.json
        """, ["--backend", "cpu"])
        self.assertNotIn("fault", self.files())
        self.assertEqual(self.state("dropped.json")["field"], "density")

    @patiently
    def test_nothing_overlaps_in_a_small_window(self):
        self.by_hand("""
            shot start
            xdotool key question sleep .5
            shot keys
            xdotool key Escape key b sleep .5
            shot light
            xdotool key Tab sleep 1
            shot wide
            save wide.json
        """, [BALL, "--backend", "cpu"], size=(520, 400))
        width, height = self.state("wide.json")["size"]
        self.assertEqual(width, 520)  # without the panel
        self.assertLess(height, 400)  # the line below it stays


def pixels_of(path):
    """The pixels of a screen as Xvfb keeps it: width, height, and rows of RGB."""
    data = path.read_bytes()
    header, _, _, _, width, height, _, order, _, _, _, bits, line, *_, colors = struct.unpack(">20I", data[:80])
    if (order, bits) != (0, 32):
        raise ValueError(f"{path}: not the pixels that are expected")
    rows = []
    for y in range(height):
        start = header + 12 * colors + y * line
        row, rgb = data[start:start + 4 * width], bytearray(3 * width)
        rgb[0::3], rgb[1::3], rgb[2::3] = row[2::4], row[1::4], row[0::4]
        rows.append(bytes(rgb))
    return width, height, rows


def write_png(pixels, path):
    width, height, rows = pixels

    def part(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    path.write_bytes(b"\x89PNG\r\n\x1a\n" + part(b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)) +
                     part(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows))) + part(b"IEND", b""))


if __name__ == "__main__":
    unittest.main()
