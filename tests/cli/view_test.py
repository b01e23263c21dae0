# SPDX-License-Identifier: Apache-2.0
"""Sessions of `view`: scripts without a window, and the window under Xvfb, by a script and by a real mouse."""

import json
import os
import shlex
import shutil
import subprocess
import time
import unittest

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
                      ["ball.ply", "--field", "T"], [BALL, "--edges", "--method", "tets"]):
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
                [{"edges": True}, {"method": "tets"}],  # which has no depths to hide lines by
                [{"method": "dense"}, {"look": "xray"}, {"opacity_unit": 0.4}, {"size": [48, 27]}],
        ):
            command = self.view(*actions)["render"]
            words = shlex.split(command)
            self.assertEqual(words[0], "subvol")
            self.run_ok(*words[1:], "--quiet")
            self.assertEqual(self.bytes_of("view.png"), self.bytes_of("picture.png"), command)

    def test_a_saved_state_is_where_another_session_begins(self):
        self.view({"orbit": [70, 20]}, {"look": "volume"}, {"save_state": "state.json"})
        self.run_ok("view", BALL, *SMALL, "--state", "state.json", "--screenshot", "again.png", "--quiet")
        self.assertEqual(self.bytes_of("view.png"), self.bytes_of("again.png"))

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
        for text, naming in [("", "empty"), ("{", "parse error"), ("{}", "array"), ("[7]", "object"), ('[{"orbit": [1]}]', "action 1: orbit"),
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

    def test_mouse_and_keys(self):
        if not shutil.which("xdotool"):
            print("skipped: xdotool is not installed")
            self.skipTest("xdotool is not installed")
        steps = f"""
            {shlex.quote(COMMAND)} view {BALL} --backend cpu & subvol=$!
            xdotool search --sync --onlyvisible --name 'subvol - ' >/dev/null
            sleep 3
            xdotool mousemove 300 300 key ctrl+s
            for i in $(seq 100); do [ -s state.json ] && break; sleep .1; done
            mv state.json before.json
            xdotool mousemove 300 300 sleep 1 mousedown 1 sleep 1 mousemove 340 300 sleep 1 mousemove 400 300 sleep 1 mouseup 1 sleep 1
            xdotool key k key a key ctrl+s
            for i in $(seq 100); do [ -s state.json ] && break; sleep .1; done
            mv state.json after.json
            xdotool key q
            wait $subvol
        """
        done = self.in_xvfb("bash", "-c", steps)
        self.assertEqual(done.returncode, 0, done.stderr)
        before, after = (json.loads((self.folder / name).read_text()) for name in ("before.json", "after.json"))
        self.assertEqual((before["look"], after["look"]), ("solid", "volume"))
        self.assertEqual((before["axes"], after["axes"]), (False, True))
        self.assertNotEqual(before["camera"]["eye"], after["camera"]["eye"])
        self.assertAlmostEqual(before["camera"]["eye"][2], after["camera"]["eye"][2])  # the drag was level


if __name__ == "__main__":
    unittest.main()
