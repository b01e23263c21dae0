# SPDX-License-Identifier: Apache-2.0
"""Large libraries are loaded when they are needed, also from an installation that has been moved."""

import os
import shutil
import subprocess
import unittest
from pathlib import Path

from command import COMMAND, CUBE, HANGS_AFTER, InFolder, Run

HEAVY = ["libOpenImageIO", "libopenvdb", "libcairo", "libhdf5_serial", "libglfw", "libmpi"]


class Program(unittest.TestCase):
    def test_starts_without_large_libraries(self):
        libraries = subprocess.run(["ldd", COMMAND], check=True, capture_output=True, text=True).stdout
        self.assertIn("libtbb", libraries)  # the list is whole
        for name in HEAVY:
            self.assertNotIn(name, libraries)

    def test_loads_only_the_library_that_is_needed(self):
        def mapped(*words):
            done = subprocess.run([COMMAND, *words], check=True, capture_output=True, text=True, timeout=HANGS_AFTER,
                                  env={**os.environ, "LD_DEBUG": "files"})
            return {name for name in HEAVY if f"{name}." in done.stderr}

        self.assertEqual(mapped("--version"), set())
        self.assertEqual(mapped("info", "model:ball:2", "--json"), set())


class Installation(InFolder):
    def setUp(self):
        super().setUp()
        first = self.folder / "first"
        subprocess.run(["cmake", "--install", os.environ["SUBVOL_BUILD"], "--prefix", str(first), "--component", "command"], check=True,
                       capture_output=True)
        self.prefix = self.folder / "moved here"
        first.rename(self.prefix)

    def run_installed(self, *words):
        done = subprocess.run([str(self.prefix / "bin/subvol"), *words], cwd=self.folder, capture_output=True, text=True,
                              timeout=HANGS_AFTER)
        return Run(done.returncode, done.stdout, done.stderr)

    def module(self, name):
        return next(self.prefix.rglob(f"subvol_{name}.so"))

    def test_reads_and_writes_pictures_and_grids(self):
        for words in [("render", "model:ball:2", "-o", "a.exr", "--size", "16", "--backend", "cpu"), ("compare", "a.exr", "a.exr"),
                      ("vdb", "model:ball:2", "-o", "a.vdb", "--resolution", "8"), ("info", "a.vdb")]:
            done = self.run_installed(*words)
            self.assertEqual((done.code, words), (0, words), done.err)

    def test_says_which_module_is_missing(self):
        (self.folder / "cube.mesh").write_text(CUBE.format(last=8))
        for name in ("openexr", "openvdb"):
            self.module(name).unlink()
        for words, sentence in [
                (("render", "cube.mesh", "-o", "a.exr", "--size", "16"),
                 "subvol: reading or writing .exr pictures needs the module subvol_openexr.so, which is not installed"),
                (("vdb", "cube.mesh", "-o", "a.vdb"),
                 "subvol: reading, writing or computing grids needs the module subvol_openvdb.so, which is not installed")]:
            done = self.run_installed(*words)
            self.assertEqual(done.code, 3, done.err)
            self.assertIn(sentence, done.err)
        self.assertEqual([file.name for file in self.folder.iterdir() if file.suffix in (".exr", ".vdb")], [])
        self.assertEqual(self.run_installed("info", "cube.mesh").code, 0)

    def test_refuses_a_module_of_another_version(self):
        module = self.module("openvdb")
        version = self.run_installed("--version").out.strip().encode() + b"\0"
        content = module.read_bytes()
        self.assertIn(version, content)
        module.write_bytes(content.replace(version, b"7" + version[1:]))
        done = self.run_installed("vdb", "model:ball:2", "-o", "a.vdb")
        self.assertEqual(done.code, 3)
        self.assertIn("subvol_openvdb.so, which is of another version", done.err)

    def test_says_that_a_damaged_module_cannot_be_loaded(self):
        self.module("openimageio").write_bytes(b"not a library")
        done = self.run_installed("compare", "model.png", "model.png")
        self.assertEqual(done.code, 2)  # there is no such picture: that comes first
        shutil.copy(Path(__file__).parents[2] / "docs/nozzle.png", self.folder / "a.png")
        done = self.run_installed("compare", "a.png", "a.png")
        self.assertEqual(done.code, 3)
        self.assertRegex(done.err, r"^subvol: .*subvol_openimageio.so, which cannot be loaded: [^\n]+\n$")


if __name__ == "__main__":
    unittest.main()
