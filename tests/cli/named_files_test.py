# SPDX-License-Identifier: Apache-2.0
"""Files that name files: in a circle, again and again, pipes and devices; and numbers in a locale with a decimal comma."""

import os
import shutil
import subprocess
import unittest

from command import COMMAND, SANITIZED, InFolder, subvol_measured

COLLECTION = '<VTKFile type="Collection"><Collection>\n{}</Collection></VTKFile>'
BLOCKS = '<VTKFile type="vtkMultiBlockDataSet"><vtkMultiBlockDataSet>\n{}</vtkMultiBlockDataSet></VTKFile>'


class NamedFiles(InFolder):
    def write(self, name, text):
        (self.folder / name).write_text(text)

    def assert_refused(self, *arguments, naming):
        before = self.files()
        done = subvol_measured(*arguments, folder=self.folder, max_seconds=60)
        self.assertEqual(done.code, 2, done.err)
        self.assertRegex(done.err, r"\Asubvol: [^\x00-\x1f\x7f]+\n\Z", "one sentence")
        self.assertIn(naming, done.err)
        self.assertEqual(self.files(), before)
        if not SANITIZED:
            self.assertLess(done.peak_mib, 300)

    def test_circles(self):
        self.write("a.pvd", COLLECTION.format('<DataSet timestep="0" file="b.vtk.series"/>'))
        self.write("b.vtk.series", '{"files": [{"name": "a.pvd", "time": 1}]}')
        circle = 'b.vtk.series, entry 0 of "files": names itself, by a.pvd > b.vtk.series > a.pvd'
        for words in (["info", "a.pvd"], ["points", "a.pvd", "-o", "a.ply"], ["split", "a.pvd", "-o", "a.bricks", "--bricks", "2"]):
            with self.subTest(words):
                self.assert_refused(*words, naming=circle)

    def test_few_bytes_that_ask_for_many(self):
        for depth in range(12):
            self.write(f"i{depth}.inp", f"*INCLUDE, INPUT=i{depth + 1}.inp\n" * 8 if depth < 11 else "**\n")
        self.assert_refused("info", "i0.inp", naming="more than 10000 files are named")
        for depth in range(7):
            self.write(f"l{depth}.vtm", BLOCKS.format(f'<DataSet file="{"s.vtp" if depth == 6 else f"l{depth + 1}.vtm"}"/>\n' * 30))
        self.write("s.vtp", "")
        self.assert_refused("info", "l0.vtm", naming="more than 100000 files are named")
        part = ("*PART, NAME=P\n*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n"
                "*ELEMENT, TYPE=C3D8\n1,1,2,3,4,5,6,7,8\n*ELGEN\n1,{},0,1\n*END PART\n")
        instance = "*INSTANCE, NAME=i, PART=P\n*END INSTANCE\n"
        self.write("a.inp", part.format(900000) + instance * 100)
        self.assert_refused("info", "a.inp", naming="its instances have too many nodes, elements and members of sets")
        self.write("a.inp", part.format(10000) + instance * 200)
        self.assert_refused("info", "a.inp", naming="a.inp, line ")

    def test_pipes_devices_and_folders_behind_names(self):
        os.mkfifo(self.folder / "pipe.json")
        os.mkfifo(self.folder / "pipe.vtu")
        (self.folder / "zero.vtu").symlink_to("/dev/zero")
        (self.folder / "zero.json").symlink_to("/dev/zero")
        for kind in ("pipe", "zero"):
            with self.subTest(kind):
                self.write("a.pvd", COLLECTION.format(f'<DataSet timestep="0" file="{kind}.vtu"/>'))
                self.assert_refused("info", "a.pvd", naming=f'"{kind}.vtu" is not a regular file')
                study = '{{"name": "s", "inputs": [{}], "methods": [{{"method": "splat"}}], "size": 16, "cameras": [{}]{}}}'
                self.write("s.json", study.format(f'{{"file": "{kind}.vtu"}}', '"iso"', ""))
                self.assert_refused("study", "s.json", "-o", "out", naming="is not a regular file")
                self.write("s.json", study.format('{"model": "ball", "resolution": 2}', f'"{kind}.json"', ""))
                self.assert_refused("study", "s.json", "-o", "out", naming="is not a regular file")
                for action in ("load_state", "tf"):
                    self.write("view.json", f'[{{"{action}": "{kind}.json"}}]')
                    self.assert_refused("view", "model:ball:2", "--script", "view.json", naming="is not a regular file")

    def test_the_command_reads_its_numbers_in_any_locale(self):
        compiler, localedef = shutil.which("cc"), shutil.which("localedef")
        if SANITIZED or not compiler or not localedef:
            self.skipTest("cc and localedef are needed, and a program that is not sanitized")
        made = subprocess.run([localedef, "-i", "de_DE", "-f", "UTF-8", self.folder / "de_DE.UTF-8"], capture_output=True, text=True)
        if made.returncode != 0:
            self.skipTest("localedef has no definitions (Debian's package locales): " + made.stderr)
        (self.folder / "host.c").write_text("#include <locale.h>\n"
                                            "__attribute__((constructor)) static void host(void) { setlocale(LC_ALL, \"\"); }\n")
        subprocess.run([compiler, "-shared", "-fPIC", "-o", "host.so", "host.c"], cwd=self.folder, check=True)
        comma = {**os.environ, "LOCPATH": str(self.folder), "LC_ALL": "de_DE.UTF-8", "LD_PRELOAD": str(self.folder / "host.so")}
        said = [subprocess.run([COMMAND, "vdb", "model:ball:2", "-o", name, "--voxel-size", "0.25", "--density", "0.5*x", "--json"],
                               cwd=self.folder, env=environment, capture_output=True, text=True)
                for name, environment in (("comma.vdb", comma), ("point.vdb", os.environ))]
        self.assertEqual([done.returncode for done in said], [0, 0], said[0].stderr)
        self.run_ok("compare", "comma.vdb", "point.vdb")
        figures = [self.run_ok("info", name, "--json").json()["grids"] for name in ("comma.vdb", "point.vdb")]
        self.assertEqual(figures[0], figures[1])


if __name__ == "__main__":
    unittest.main()
