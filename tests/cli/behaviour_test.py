# SPDX-License-Identifier: Apache-2.0
"""What a user sees first: help, exit codes, one sentence for a mistake, no files left behind, repeatable results."""

import json
import os
import pty
import signal
import subprocess
import unittest

from command import COMMAND, CUBE, HANGS_AFTER, SANITIZED, InFolder, Run, start_and_wait_for_progress, subvol

VERBS = ["model", "info", "subdivide", "fit", "points", "vdb", "render", "view", "page", "probe", "check", "slice", "surface", "split", "compare", "demo"]


class Help(unittest.TestCase):
    def test_every_verb_explains_itself_with_examples(self):
        for verb in VERBS:
            done = subvol(verb, "--help")
            self.assertEqual(done.code, 0, done.err)
            self.assertIn("Examples:\n  subvol " + verb, done.out)

    def test_the_program_names_every_verb(self):
        done = subvol("--help")
        self.assertEqual(done.code, 0)
        for verb in VERBS:
            self.assertIn("\n  " + verb, done.out)

    def test_version(self):
        self.assertRegex(subvol("--version").out, r"^\d+\.\d+\.\d+\n$")


class Mistakes(InFolder):
    """Exit code 2, one sentence on standard error, nothing on standard output and no file."""

    def assert_refused(self, *arguments, naming):
        before = self.files()
        done = subvol(*arguments, folder=self.folder)
        self.assertEqual(done.code, 2, done.err)
        self.assertEqual(done.out, "")
        self.assertRegex(done.err, r"^subvol: [^\n]+\n$")
        self.assertIn(naming, done.err)
        self.assertEqual(self.files(), before)

    def test_arguments(self):
        self.assert_refused("frobnicate", naming="frobnicate")
        self.assert_refused(naming="--help")
        self.assert_refused("info", naming="FILE")
        self.assert_refused("info", "a.mesh", "--frobnicate", naming="--frobnicate")
        self.assert_refused("subdivide", "model:ball:2", "-o", "a.mesh", "--levels", "-1", naming="--levels")
        self.assert_refused("subdivide", "model:ball:2", "-o", "a.mesh", "--scheme", "loop", naming="mcq, cc, bsxw, linear")
        self.assert_refused("render", "model:ball:2", "-o", "a.png", "--size", "12y12", naming="--size")
        self.assert_refused("render", "model:ball:2", "-o", "a.png", "--method", "nothing", naming="tets, pt, dense")
        self.assert_refused("render", "model:ball:2", "-o", "a.png", "--view", "up", naming="up")
        self.assert_refused("render", "model:ball:2", "-o", "a.png", "--opacity", "0%:0,50%:2", naming="50%:2")
        self.assert_refused("render", "model:ball:2", "-o", "a.png", "--legend", "a.png", naming=".svg")
        self.assert_refused("compare", "a.png", "b.png", "--fail-under", "psnr", naming="--fail-under")

    def test_what_needs_no_mesh_is_refused_before_one_is_read(self):
        for wrong in ("--size", "3y"), ("--camera", "nix"), ("--tf", "missing.json"):
            self.assert_refused("render", "missing.mesh", "-o", "a.png", *wrong, naming=wrong[1])

    def test_a_full_standard_output(self):
        with open("/dev/full", "w") as full:
            done = subprocess.run([COMMAND, "model", "--list"], stdout=full, stderr=subprocess.PIPE, text=True, timeout=HANGS_AFTER)
        self.assertEqual((done.returncode, done.stderr), (2, "subvol: standard output: could not be written\n"))

    def test_files(self):
        self.assert_refused("info", "missing.mesh", naming="missing.mesh")
        self.assert_refused("subdivide", "model:ball:2", "-o", "a.obj", naming=".vtu")
        self.assert_refused("points", "model:ball:2", "-o", "a.obj", naming=".vtp")
        self.assert_refused("vdb", "model:ball:2", "-o", "nowhere/a.vdb", naming="nowhere")
        self.assert_refused("compare", "missing.png", "missing.png", naming="missing.png")

    def test_fields(self):
        self.assert_refused("render", "model:ball:2", "-o", "a.png", "--field", "heat", naming="density")
        self.assert_refused("render", "model:ball:2", "-o", "a.png", "--density", "x+", naming="x+")
        self.assert_refused("vdb", "model:ball:2", "-o", "a.vdb", "--fields", "density,heat", naming="heat")

    def test_malformed_mesh(self):
        (self.folder / "bad.mesh").write_text(CUBE.format(last=9))
        for verb, output in [("subdivide", "a.vtu"), ("points", "a.ply"), ("vdb", "a.vdb"), ("render", "a.png")]:
            self.assert_refused(verb, "bad.mesh", "-o", output, naming="bad.mesh")

    def test_cancelled_output_is_not_truncated_output(self):
        (self.folder / "a.vtu").write_text("what was there before")
        (self.folder / "bad.mesh").write_text(CUBE.format(last=9))
        self.assert_refused("subdivide", "bad.mesh", "-o", "a.vtu", naming="bad.mesh")
        self.assertEqual((self.folder / "a.vtu").read_text(), "what was there before")


class TooMuch(InFolder):
    """Exit code 3 and one sentence, before the system kills the program."""

    def assert_beyond_the_machine(self, done):
        self.assertEqual(done.code, 3, done.err)
        self.assertRegex(done.err, r"^subvol: [^\n]*memory[^\n]*\n$")
        self.assertEqual(self.files(), [])

    def test_more_levels_than_memory(self):
        self.assert_beyond_the_machine(subvol("subdivide", "model:twist", "-o", "a.vtu", "--levels", "8", folder=self.folder))

    @unittest.skipIf(SANITIZED, "the sanitizer needs all addresses")
    def test_memory_that_runs_out_on_the_way(self):
        limited = f"ulimit -v 900000; exec '{COMMAND}' subdivide model:twist -o a.vtu --levels 3"  # needs some 5 GB
        done = subprocess.run(["bash", "-c", limited], cwd=self.folder, capture_output=True, text=True, timeout=HANGS_AFTER)
        self.assert_beyond_the_machine(Run(done.returncode, done.stdout, done.stderr))


class Interrupt(InFolder):
    def test_ctrl_c_stops_and_leaves_nothing(self):
        # Uninterrupted it takes minutes.
        process, terminal = start_and_wait_for_progress("render", "model:twist", "-o", "a.png", "--method", "tets",
                                                        "--samples", "16", "--size", "4096", folder=self.folder)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(HANGS_AFTER), 130)
        os.close(terminal)
        self.assertEqual(self.files(), [])


    def test_programs_read_that_it_was_interrupted(self):
        terminal, end = pty.openpty()
        process = subprocess.Popen([COMMAND, "vdb", "model:twist", "-o", "a.vdb", "--resolution", "1500", "--json", "--progress", "on"],
                                   cwd=self.folder, stdout=subprocess.PIPE, stderr=end, text=True)
        os.close(end)
        os.read(terminal, 1)
        process.send_signal(signal.SIGTERM)
        out, _ = process.communicate(timeout=HANGS_AFTER)
        os.close(terminal)
        self.assertIn(process.returncode, (130, 143))
        self.assertIn(json.loads(out)["error"]["code"], (130, 143))
        self.assertEqual(self.files(), [])

    def test_progress_says_the_frame(self):
        made = subvol("vdb", "model:ball:2", "--to", "model:ball:2", "-o", "a_#.vdb", "--frames", "3", "--resolution", "8", "--progress", "on",
                      folder=self.folder)
        self.assertEqual(made.code, 0, made.err)
        for frame in (1, 2, 3):
            self.assertIn(f"frame {frame} of 3", made.err)
        self.assertTrue(made.err.endswith("\033[K"))  # nothing is left of the bar


class SameForAnyNumberOfThreads(InFolder):
    def assert_same(self, verb, ending, *options):
        outputs = []
        for threads in (1, 3):
            name = f"{threads}{ending}"
            self.run_ok(verb, "model:ball:4", "-o", name, "--threads", threads, *options)
            outputs.append((self.folder / name).read_bytes())
        self.assertEqual(*outputs)

    def test_meshes_points_and_pictures(self):
        self.assert_same("subdivide", ".vtu")
        self.assert_same("points", ".ply")
        self.assert_same("points", ".ply", "--splats")
        self.assert_same("points", ".vtp")
        self.assert_same("render", ".png", "--size", "64", "--backend", "cpu")
        self.assert_same("render", ".png", "--size", "64", "--method", "tets")


if __name__ == "__main__":
    unittest.main()
