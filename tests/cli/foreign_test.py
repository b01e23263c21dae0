# SPDX-License-Identifier: Apache-2.0
"""Files of other programs, which every command takes by itself: python3 converts them by meshio or VTK in a child process."""

import os
import signal
import stat
import subprocess
import sys
import time
import unittest
from pathlib import Path

from command import COMMAND, InFolder, Run, children, has_ended

sys.path.insert(1, str(Path(__file__).parent.parent / "python"))

import foreign_texts

DEBIANS = "/usr/bin/python3"


def has(module):
    """Whether a python3 that the command asks has a module."""
    for python in ("python3", DEBIANS):
        try:
            if subprocess.run([python, "-c", f"import {module}"], capture_output=True).returncode == 0:
                return True
        except OSError:
            pass
    return False


class Foreign(InFolder):
    def setUp(self):
        super().setUp()
        self.texts = foreign_texts
        (self.folder / "tmp").mkdir()
        self.env = {**os.environ, "TMPDIR": str(self.folder / "tmp")}

    def subvol(self, *arguments, **env):
        done = subprocess.run([COMMAND, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True, env={**self.env, **env})
        self.assertEqual(list((self.folder / "tmp").iterdir()), [])  # nothing remains
        return Run(done.returncode, done.stdout, done.stderr)

    def fine(self, *arguments, **env):
        done = self.subvol(*arguments, **env)
        self.assertEqual(done.code, 0, done.err)
        return done

    def nastran(self):
        if not has("meshio"):
            self.skipTest("meshio is not installed")
        (self.folder / "a.bdf").write_text(self.texts.nastran())

    def fake(self, folder, name, text):
        """An executable file in a folder. Returns the folder."""
        (self.folder / folder).mkdir(exist_ok=True)
        (self.folder / folder / name).write_text(text)
        (self.folder / folder / name).chmod(stat.S_IRWXU)
        return str(self.folder / folder)


class Commands(Foreign):
    def test_every_command_reads_them_and_says_so(self):
        self.nastran()
        info = self.fine("info", "a.bdf", "--json").json()
        self.assertEqual((info["cells"], info["points"], info["inverted_cells"]), (8, 27, 0))
        self.assertAlmostEqual(info["volume"], 8)
        self.assertRegex(info["warnings"][0], r"^read by meshio( \S+)? \(Nastran\); sets and steps are not read$")
        self.assertIn("read by meshio", self.fine("info", "a.bdf").err)
        stats = self.fine("probe", "a.bdf", "--density", "x", "--stats", "--json", "--crease-angle", "40").json()
        self.assertIn("read by meshio", stats["warnings"][0])
        whole = stats["stats"]["whole"]
        self.assertAlmostEqual(whole["file_volume"], 8)
        for words in (["subdivide", "-o", "fine.vtu", "--levels", "1"], ["surface", "-o", "a.ply", "--boundary", "--density", "1"], ["split", "-o", "a.bricks", "--bricks", "2"],
                      ["render", "-o", "a.png", "--size", "40x30", "--backend", "cpu", "--density", "1"], ["vdb", "-o", "a.vdb", "--resolution", "10", "--density", "1"]):
            done = self.fine(words[0], "a.bdf", *words[1:], "--json")
            self.assertIn("read by meshio", done.json()["warnings"][0], words)
        fine = self.fine("info", "fine.vtu", "--json").json()
        self.assertEqual(fine["cells"], 64)
        self.assertFalse(any("meshio" in warning for warning in fine["warnings"]))

    def test_steps_are_those_of_the_file(self):
        self.nastran()
        done = self.subvol("info", "a.bdf", "--step", "1")
        self.assertEqual(done.code, 2)
        self.assertIn("a.bdf: there is no step 1 (it has one step, number 0)", done.err)
        if not has("vtkmodules"):
            self.skipTest("VTK is not installed")
        for name, data in zip(("d3plot", "d3plot01"), self.texts.ls_dyna()):
            (self.folder / name).write_bytes(data)
        info = self.fine("info", "d3plot", "--json").json()
        self.assertEqual((info["steps"], info["times"]), (2, [0, .5]))
        for words, volume in ((["--step", "0"], 8), (["--step", "1"], 64), (["--time", "0.4"], 64), ([], 64)):
            self.assertAlmostEqual(self.fine("info", "d3plot", *words, "--json").json()["volume"], volume, places=4)
        self.assertIn("steps are 0 to 1", self.subvol("info", "d3plot", "--step", "2").err)

    def test_errors_name_the_file(self):
        self.nastran()
        (self.folder / "b.bdf").write_text("BEGIN BULK\nGRID,1,,zero,0,0\nENDDATA\n")
        done = self.subvol("info", "b.bdf", "--json")
        self.assertEqual(done.code, 2)
        self.assertRegex(done.err, r"^subvol: b\.bdf: meshio cannot read it: ")
        self.assertEqual(done.json()["error"]["code"], 2)
        done = self.subvol("info", "none.bdf")
        self.assertEqual(done.code, 2)
        self.assertIn("none.bdf: cannot be read: No such file", done.err)
        (self.folder / "-x.bdf").write_text(self.texts.nastran())  # no option
        self.assertEqual(self.fine("info", "--json", "--", "-x.bdf").json()["cells"], 8)

    def test_contents_decide_first(self):
        self.fine("model", "ball", "-o", "a.vtu")
        (self.folder / "a.vtu").rename(self.folder / "a.dat")
        self.assertNotIn("read by", self.fine("info", "a.dat", PATH="").err)


class Interpreters(Foreign):
    def test_missing_packages_are_named(self):
        (self.folder / "a.bdf").write_text("GRID")
        (self.folder / "packages" / "meshio").mkdir(parents=True)
        (self.folder / "packages" / "meshio" / "__init__.py").write_text("raise ModuleNotFoundError('no meshio', name='meshio')")
        done = self.subvol("info", "a.bdf", PYTHONPATH=str(self.folder / "packages"))
        self.assertEqual(done.code, 3)
        self.assertIn("a.bdf: is a file of Nastran, and meshio is not installed (Debian has it as python3-meshio)", done.err)

    def test_the_current_folder_is_no_place_for_packages(self):
        self.nastran()
        (self.folder / "meshio.py").write_text("open('taken', 'w')")
        for name in ("json.py", "__future__.py", "os.py", "contextlib.py"):
            (self.folder / name).write_text("open('taken', 'w')")
        self.assertAlmostEqual(self.fine("info", "a.bdf", "--json").json()["volume"], 8)
        self.assertNotIn("taken", self.files())

    def test_without_python(self):
        (self.folder / "a.bdf").write_text(self.texts.nastran())
        done = self.subvol("info", "a.bdf", "--json", PATH=str(self.folder))
        if os.access(DEBIANS, os.X_OK):  # it is asked, too
            self.assertIn(done.code, (0, 3), done.err)
        else:
            self.assertEqual(done.code, 3)
            self.assertIn("a.bdf: is a file of Nastran, which meshio reads, and there is no python3 to run it (Debian: python3-meshio)", done.err)

    def test_debians_python_is_asked_where_another_one_fails(self):
        if subprocess.run([DEBIANS, "-c", "import meshio"], capture_output=True).returncode != 0:
            self.skipTest("Debian's meshio is not installed")
        (self.folder / "a.bdf").write_text(self.texts.nastran())
        empty = self.fake("bin", "python3", "#!/bin/sh\necho no such thing >&2\nexit 3\n")
        self.assertAlmostEqual(self.fine("info", "a.bdf", "--json", PATH=empty).json()["volume"], 8)

    def test_what_one_says_of_the_file_stays(self):
        (self.folder / "a.avs").write_text("no mesh")
        answer = '{"message": "meshio cannot read it: no mesh; VTK is not installed", "allowed": "", "missing": ["python3-vtk9"]}'
        first = self.fake("bin", "python3", f"#!/bin/sh\necho '{answer}'\nexit 2\n")
        done = self.subvol("info", "a.avs", PATH=first)
        self.assertEqual(done.code, 2)
        self.assertRegex(done.err, "cannot read it")
        for name in ("meshio", "vtkmodules"):  # Debian's lacks both
            (self.folder / "packages" / name).mkdir(parents=True)
            (self.folder / "packages" / name / "__init__.py").write_text(f"raise ModuleNotFoundError('none', name='{name}')")
        done = self.subvol("info", "a.avs", PATH=first, PYTHONPATH=str(self.folder / "packages"))
        self.assertEqual(done.code, 2)
        self.assertIn("meshio cannot read it: no mesh; VTK is not installed", done.err)

    def test_a_link_to_debians_python_is_another_one(self):
        if subprocess.run([DEBIANS, "-c", "import meshio"], capture_output=True).returncode != 0:
            self.skipTest("Debian's meshio is not installed")
        (self.folder / "a.bdf").write_text(self.texts.nastran())
        (self.folder / "venv" / "bin").mkdir(parents=True)
        (self.folder / "venv" / "pyvenv.cfg").write_text("home = /usr/bin\ninclude-system-site-packages = false\n")
        (self.folder / "venv" / "bin" / "python3").symlink_to(DEBIANS)
        self.assertAlmostEqual(self.fine("info", "a.bdf", "--json", PATH=str(self.folder / "venv" / "bin")).json()["volume"], 8)

    def test_completion_starts_no_python(self):
        (self.folder / "a.bdf").write_text(self.texts.nastran())
        slow = self.fake("bin", "python3", "#!/bin/sh\n: > taken\n")
        self.assertEqual(self.subvol("info", "a.bdf", "--list-fields", PATH=slow, SUBVOL_COMPLETION="1").code, 2)
        self.assertNotIn("taken", self.files())
        for shell in ("bash", "zsh"):
            self.assertIn("SUBVOL_COMPLETION=1", subprocess.run([COMMAND, "--generate", shell], capture_output=True, text=True).stdout)

    def test_files_of_hdf5_reach_meshio(self):
        (self.folder / "a.med").write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(200))
        done = self.subvol("info", "a.med")
        self.assertIn(done.code, (2, 3))
        self.assertRegex(done.err, "a.med: .*(meshio|h5py)")

    def test_a_full_disk_is_no_fault_of_the_file(self):
        (self.folder / "a.bdf").write_text("GRID")
        full = self.fake("bin", "python3", """#!/bin/sh\necho '{"message": "cannot be written", "allowed": "TMPDIR", "missing": []}'\nexit 4\n""")
        done = self.subvol("info", "a.bdf", PATH=full)
        self.assertEqual(done.code, 2)
        self.assertIn("a.bdf: cannot be written (TMPDIR)", done.err)
        self.nastran()
        short = subprocess.run(["sh", "-c", f"ulimit -f 1; exec '{COMMAND}' info a.bdf"], cwd=self.folder, capture_output=True, text=True, env=self.env)
        self.assertEqual(short.returncode, 2)
        self.assertRegex(short.stderr, "a.bdf: .* cannot be written in .*TMPDIR")

    def test_an_interrupt_ends_the_child(self):
        (self.folder / "a.bdf").write_text(self.texts.nastran())
        slow = self.fake("bin", "python3", "#!/bin/sh\n/bin/sleep 1000 &\necho $! > it\n/bin/mv it below\nwait\n")
        process = subprocess.Popen([COMMAND, "info", "a.bdf"], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**self.env, "PATH": slow})
        while not (self.folder / "below").exists():
            self.assertIsNone(process.poll(), "the command ended without a child")
            time.sleep(.01)
        below = [*children(process.pid), int((self.folder / "below").read_text())]  # the child's own child, too
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=300)
        self.assertEqual(process.returncode, 130, err)
        self.assertIn("cancelled", err)
        while not all(map(has_ended, below)):  # they have been killed, and end when they come to it; without that in 1000 s
            time.sleep(.01)
        self.assertEqual(list((self.folder / "tmp").iterdir()), [])


if __name__ == "__main__":
    unittest.main()
