# SPDX-License-Identifier: Apache-2.0
"""What a command may do to files that are there already: replace the one that was asked for, as it is, and no other."""

import os
import stat
import subprocess
import threading
import unittest

from command import COMMAND, TWO_FIELDS, InFolder, subvol

POINTS = ["points", "model:ball:2"]
SMALL = ["--size", "16x16", "--backend", "cpu", "--quiet"]
WRITERS = {  # one for each way to write a file: our own writers, OpenVDB, libpng, OpenEXR, text
    "a.vtu": ["subdivide", "model:ball:2", "--levels", 0],
    "a.mesh": ["subdivide", "model:ball:2", "--levels", 0],
    "a.ply": POINTS,
    "a.svk": POINTS,
    "a.vdb": ["vdb", "model:ball:2", "--resolution", 12],
    "b.vdb": POINTS,
    "a.png": ["render", "model:ball:2", *SMALL],
    "a.exr": ["render", "model:ball:2", *SMALL],
    "a.csv": ["slice", "model:ball:2", "--plane", "0,0,0,0,0,1", "--resolution", 4],
    "a.stl": ["surface", "model:ball:2", "--boundary"],
    "a.html": ["page", "model:ball:2"],
}


class Replaced(InFolder):
    def mode_of(self, name):
        return stat.S_IMODE((self.folder / name).stat().st_mode)

    def test_permissions_stay(self):
        for name, command in WRITERS.items():
            file = self.folder / name
            file.write_text("private")
            file.chmod(0o600)
            self.run_ok(*command, "-o", name)
            self.assertNotEqual(file.read_bytes(), b"private", name)
            self.assertEqual(self.mode_of(name), 0o600, name)
            file.chmod(0o664)
            self.run_ok(*command, "-o", name)
            self.assertEqual(self.mode_of(name), 0o664, name)
        self.assertEqual([name for name in self.files() if name.startswith(".")], [])

    def test_owners_stay_where_that_is_allowed(self):
        if os.geteuid() != 0:
            self.skipTest("only root can give files to others")
        file = self.folder / "a.vtu"
        file.write_text("of somebody else")
        os.chown(file, 12345, 23456)
        file.chmod(0o640)
        self.run_ok("subdivide", "model:ball:2", "--levels", 0, "-o", "a.vtu")
        about = file.stat()
        self.assertEqual((about.st_uid, about.st_gid, stat.S_IMODE(about.st_mode)), (12345, 23456, 0o640))

    def test_new_files_have_the_permissions_of_new_files(self):
        for mask, mode in ((0o022, 0o644), (0o077, 0o600)):
            done = subprocess.run([COMMAND, *map(str, WRITERS["a.vdb"]), "-o", f"{mode:o}.vdb"], cwd=self.folder,
                                  capture_output=True, text=True, preexec_fn=lambda mask=mask: os.umask(mask))
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(self.mode_of(f"{mode:o}.vdb"), mode)

    def test_long_names(self):
        for name, command in WRITERS.items():
            extension = name[1:]
            long = "n" * (255 - len(extension)) + extension
            if name in ("a.ply", "b.vdb", "a.svk"):  # a boundary of a longer name may lie beside it
                long = long[16:]
            self.run_ok(*command, "-o", long)
            self.assertGreater((self.folder / long).stat().st_size, 0)
            done = subvol(*command, "-o", "n" * 256 + extension, folder=self.folder)
            self.assertEqual(done.code, 2)
            self.assertRegex(done.err, r"^subvol: [^\n]+too long\n$")

    def test_several_processes_may_write_one_file(self):
        codes = []
        runs = [threading.Thread(target=lambda: codes.append(subvol(*WRITERS["a.vtu"], "-o", "a.vtu", folder=self.folder).code))
                for _ in range(6)]
        for run in runs:
            run.start()
        for run in runs:
            run.join()
        self.assertEqual(codes, [0] * 6)
        self.assertEqual(self.files(), ["a.vtu"])
        self.assertEqual(self.run_ok("info", "a.vtu", "--json").json()["cells"], self.run_ok("info", "model:ball:2", "--json").json()["cells"])


class WhatInfoShows(InFolder):
    def fields(self, *arguments):
        return self.run_ok("info", *arguments, "--json").json()["fields"]

    def assert_refused(self, said, *arguments):
        done = subvol(*arguments, folder=self.folder)
        self.assertEqual(done.code, 2, f"{arguments}: {done.err}")
        self.assertRegex(done.err, r"^(subvol: warning: [^\n]+\n)*subvol: [^\n]+\n$")
        self.assertIn(said, done.err)

    def test_an_expression(self):
        box = self.run_ok("info", "model:ball:4", "--json").json()["bounds"]
        shown = self.fields("model:ball:4", "--density", "2*x")[0]
        self.assertEqual((shown["name"], shown["location"], shown["components"]), ("density", "point", 1))
        self.assertAlmostEqual(shown["min"], 2 * box[0][0])
        self.assertAlmostEqual(shown["max"], 2 * box[1][0])
        self.assertEqual(len(self.fields("model:ball:4", "--density", "2*x")), 1)  # in place of the model's own
        self.run_ok("subdivide", "model:ball:4", "-o", "a.vtu", "--levels", 0)
        self.assertEqual(self.fields("a.vtu", "--density", "2*x")[0], shown)
        self.assertIn("density", self.run_ok("info", "model:ball:4", "--density", "2*x", "--list-fields").out)
        for wrong in ("1/0", "log(-1)", "nonsense(x)", "x+"):
            for name in ("model:ball:4", "a.vtu"):
                self.assert_refused("expression", "info", name, "--density", wrong)
                self.assert_refused("expression", "info", name, "--density", wrong, "--list-fields")

    def test_one_field(self):
        self.assertEqual([field["name"] for field in self.fields("model:ball:4", "--field", "density")], ["density"])
        self.assert_refused("no field", "info", "model:ball:4", "--field", "nothing")
        self.run_ok("split", "model:ball:4", "-o", "b.bricks", "--bricks", 2)
        self.assertEqual([field["name"] for field in self.fields("b.bricks", "--field", "density")], ["density"])
        self.assert_refused("nothing", "info", "b.bricks", "--field", "nothing")
        self.run_ok(*WRITERS["a.vdb"], "-o", "a.vdb", "--coverage")
        grids = self.run_ok("info", "a.vdb", "--field", "coverage", "--json").json()["grids"]
        self.assertEqual([grid["name"] for grid in grids], ["coverage"])
        self.assert_refused("nothing", "info", "a.vdb", "--field", "nothing")
        for name in ("a.ply", "a.svk"):
            self.run_ok(*POINTS, "-o", name)
            self.assertEqual(len(self.run_ok("info", name, "--field", "density", "--json").json()["channels"]), 1)
            self.assert_refused("nothing", "info", name, "--field", "nothing")

    def test_the_field_that_is_written(self):
        (self.folder / "two.vtk").write_text(TWO_FIELDS)
        for command, name in ((["subdivide", "--levels", 1], "a.vtu"), (["split", "--bricks", 1], "a.bricks")):
            for field, components in (("Temp", 1), ("V", 3)):
                self.run_ok(*command, "two.vtk", "-o", name, "--field", field)
                self.assertEqual([(one["name"], one["components"]) for one in self.fields(name)], [(field, components)])
            self.assert_refused("nothing", *command, "two.vtk", "-o", name, "--field", "nothing")
            self.assertEqual(self.run_ok("info", name, "--list-fields", "--field", "V").out, "V\n")
            self.assert_refused("nothing", "info", name, "--list-fields", "--field", "nothing")
        self.assert_refused("nothing", "split", "model:twist:4", "-o", "b.bricks", "--field", "nothing")

    def test_options_without_effect_are_refused(self):
        self.run_ok(*WRITERS["a.vdb"], "-o", "a.vdb")
        self.run_ok(*POINTS, "-o", "a.ply")
        self.run_ok(*POINTS, "-o", "a.svk")
        self.run_ok(*WRITERS["a.png"], "-o", "a.png")
        of_files = (["--weld"], ["--weld-distance", 1], ["--sharp", "a"], ["--step", 0], ["--time", 1], ["--blocks", "a"],
                    ["--other-cells", "ignore"], ["--curved", "corners"], ["--cell-values", "mean"])
        for option in of_files:
            for command in (["info", "model:ball:2"], ["subdivide", "model:ball:2", "-o", "a.vtu"],
                            ["render", "model:ball:2", "-o", "b.png"], ["probe", "model:ball:2", "--at", "0,0,0"],
                            ["split", "model:ball:2", "-o", "b.bricks"], ["compare", "model:ball:2", "model:ball:2"]):
                self.assert_refused(option[0], *command, *option)
        for option in (*of_files, ["--density", "x"]):
            for command in (["info", "a.vdb"], ["info", "a.ply"], ["info", "a.svk"], ["info", "a.vdb", "--list-fields"],
                            ["compare", "a.png", "a.png"], ["compare", "a.vdb", "a.ply"],
                            ["render", "a.vdb", "--method", "grid", "-o", "b.png"], ["render", "a.vdb", "-o", "b.png"],
                            ["render", "a.ply", "-o", "b.png"], ["points", "a.vdb", "-o", "b.ply"]):
                self.assert_refused("needs a mesh", *command, *option)


if __name__ == "__main__":
    unittest.main()
