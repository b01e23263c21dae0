# SPDX-License-Identifier: Apache-2.0
"""What the command says: proposals for slips, help in 80 columns, units, verdicts, and errors that programs can read."""

import re
import shlex
import unittest

from command import CUBE, InFolder, subvol

VERBS = ["model", "info", "subdivide", "fit", "points", "vdb", "render", "view", "page", "probe", "slice", "surface", "split", "join", "compare", "study",
         "demo"]

# What was typed, and what the one line must contain.
SLIPS = [
    (["rendr", "model:ball", "-o", "a.png"], "'rendr' is not a verb: did you mean render?"),
    (["render", "model:ball", "-o", "a.png", "--leves", "2"], "--leves: render has no such option: did you mean --levels? (see subvol render --help)"),
    (["render", "model:ball", "--outptu", "a.png"], "did you mean --output?"),  # says more than that -o is missing
    (["render", "model:ball", "-o", "a.png", "--turn", "8"], "did you mean --turntable?"),
    (["render", "model:ball", "-o", "a.png", "--heatmap", "b.png"], "render has no such option; it is one of compare"),
    (["render", "model:ball", "-size", "8", "-o", "a.png"], "did you mean --size?"),
    (["fit", "--weld"], "--weld: fit has no such option; it is one of info"),
    (["model", "ball", "--density", "x"], "--density: model has no such option; it is one of info"),
    (["render", "model:ball", "-o", "a.png", "--method", "tetz"], "'tetz' is unknown: did you mean tets?"),
    (["render", "model:ball", "-o", "a.png", "--tf", "virids"], "did you mean viridis?"),
    (["render", "model:ball", "-o", "a.png", "--look", "sold"], "did you mean solid?"),
    (["render", "model:bal", "-o", "a.png"], "there is no model 'bal': did you mean ball?"),
    (["render", "model:ball:4", "-o", "a.png", "--field", "densty"], "did you mean density?"),
    (["subdivide", "model:ball", "-o", "a.vtu", "--scheme", "mqc"], "did you mean mcq?"),
    (["info", "model:ball", "--progress", "autp"], "--progress: 'autp' is unknown: did you mean auto? (supported: auto, on, off)"),
    (["study", "tabel2", "-o", "out"], "there is no study 'tabel2': did you mean table2?"),
    (["fit", "--kernel", "gausian"], "did you mean gaussian?"),
    (["compare", "model:ball:4", "model:ball:4", "--fail-under", "l3=1"], "did you mean l1?"),
    (["render", "model:ball"], "render: -o IMAGE is needed (see subvol render --help)"),
    (["render", "-o", "a.png"], "render: FILE is needed (see subvol render --help)"),
    (["info", "a.vtk", "b.vtk"], "info: 'b.vtk' is one argument too many (see subvol info --help)"),
    (["render", "model:ball", "-o", "a.png", "--levels", "two"], "--levels: 'two' is not a number (0 to 10)"),
    (["render", "model:ball", "-o", "a.png", "--levels", "12"], "--levels: '12' is out of range (0 to 10)"),
    (["surface", "model:ball", "-o", "a.stl", "--tolerance", "0"], "--tolerance: '0' is out of range (more than 0, at most 1)"),
    (["surface", "model:ball", "-o", "a.stl", "--iso", "x"], "--iso: 'x' is not a number"),
    (["probe", "model:ball", "--points", "gone.csv"], "gone.csv: cannot be read: No such file or directory"),
    (["render", "model:ball", "-o", "a.png", "--spacing", "-1"], "--spacing: '-1' is out of range (more than 0)"),
    (["vdb", "in_##.vtu", "-o", "out_##.vdb", "--frames", "1-5"], "5 of 5 frames are missing: in_01.vtu, in_02.vtu, in_03.vtu and 2 more"),
    (["slice", "model:ball:4", "-o", "a.png", "--legend"], "--legend: slice has no such option; it is on, and --no-legend turns it off"),
    (["render", "model:ball", "-o", "a.png", "--no-legend"], "--no-legend: render has no such option; it is off unless --legend is given"),
    (["render", "model:ball", "-o", "a.png", "--levels", "1", "--levels", "2"], "--levels: is given twice, but has one value"),
    (["vdb", "model:ball", "-o", "a.vdb", *3 * ["--resolution", "8"]], "--resolution: is given 3 times, but has one value"),
    (["render", "model:ball", "-o"], "--output: needs a value: -o IMAGE"),
    ([], "a verb is needed: model, info"),
    (["--verson"], "did you mean --version?"),
]


class OtherInputs(InFolder):
    """Surfaces and grids that are given to verbs of meshes."""

    VERBS = (["info"], ["render", "-o", "a.png"], ["vdb", "-o", "a.vdb"], ["points", "-o", "a.ply"], ["page", "-o", "a.html"], ["check"],
             ["probe", "--stats"], ["slice", "-o", "a.png"], ["surface", "-o", "a.stl", "--boundary"], ["subdivide", "-o", "a.vtu"],
             ["split", "-o", "a.bricks"], ["view", "--screenshot", "a.png"], ["compare", "model:ball:2"], ["usd", "-o", "a.usda"])
    # The surface is not the first argument.
    SECOND = (["compare", "model:ball:2", "FILE"], ["approximate", "model:ball:2", "--onto", "FILE", "-o", "a.vtu"],
              ["vdb", "model:ball:2", "--to", "FILE", "--frames", "1-2", "-o", "a_##.vdb"])

    def refused(self, arguments, file, *words):
        with self.subTest(arguments=arguments, file=file):
            done = subvol(*arguments, folder=self.folder)
            self.assertEqual(done.code, 2, done.err)
            for part in words:
                self.assertIn(part, done.err)
            self.assertEqual(done.err.count("\n"), 1, done.err)
            self.assertEqual([name for name in self.files() if name.startswith("a.") or name.startswith("a_")], [])

    def test_the_way_to_a_mesh_is_said(self):
        for name in ("torus.stl", "torus.ply"):
            self.run_ok("surface", "model:ball:2", "-o", name, "--boundary")
        (self.folder / "torus.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.run_ok("surface", "model:ball:2", "-o", "torus.glb", "--boundary")
        (self.folder / "torus.gltf").write_text("{}")
        (self.folder / "torus.step").write_text("ISO-10303-21;\n")
        self.run_ok("surface", "model:ball:2", "-o", "torus.vtp", "--boundary")
        (self.folder / "torus.vtk").write_text("# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\n")
        self.run_ok("vdb", "model:ball:2", "-o", "smoke.vdb", "--resolution", 8)
        read = {name: f"{name}: is a surface, not a mesh of cells (`subvol mesh {name} -o torus.vtu` makes a control mesh of it)"
                for name in ("torus.stl", "torus.obj", "torus.ply", "torus.glb")}
        exported = {name: f"{name}: is a surface, not a mesh of cells (exported as torus.stl, `subvol mesh torus.stl -o torus.vtu` makes a control mesh of it)"
                    for name in ("torus.gltf", "torus.step")}
        for file, sentence in {**read, **exported}.items():
            for arguments in self.VERBS:
                self.refused([arguments[0], file, *arguments[1:]], file, sentence)
            for arguments in self.SECOND:
                self.refused([file if word == "FILE" else word for word in arguments], file, sentence)
        # Formats that may have other things than surfaces.
        hint = "(exported as torus.stl, `subvol mesh torus.stl -o torus.vtu` makes a control mesh of it)"
        for verb, more in (("info", []), ("render", ["-o", "a.png"]), ("probe", ["--stats"]), ("vdb", ["-o", "a.vdb"])):
            self.refused([verb, "torus.vtk", *more], "torus.vtk", "POLYDATA is not a volume mesh, but a surface " + hint)
            if verb != "probe":  # which never reads kernels
                self.refused([verb, "torus.vtp", *more], "torus.vtp", hint)
        # Verbs of surfaces: what they cannot read, and what else they need.
        for file, sentence in exported.items():
            self.refused(["mesh", file, "-o", "a.vtu"], file, sentence)
            self.refused(["approximate", file, "--shape", "--onto", "model:ball:2", "-o", "a.vtu"], file, sentence)
        for file in ("torus.stl", "torus.obj", "torus.glb"):
            self.refused(["approximate", file, "--onto", "model:ball:2", "-o", "a.vtu"], file, "--shape with it; `subvol mesh " + file)
        self.refused(["approximate", "torus.ply", "--onto", "model:ball:2", "-o", "a.vtu"], "torus.ply", read["torus.ply"])
        for verb, more in (("check", []), ("subdivide", ["-o", "a.vtu"])):
            self.refused([verb, "smoke.vdb", *more], "smoke.vdb", "smoke.vdb: is a grid, not a mesh of cells (`subvol mesh smoke.vdb --iso VALUE -o smoke.vtu` makes")
        self.refused(["page", "smoke.vdb", "-o", "a.html", "--look", "solid"], "smoke.vdb", "is fog, which has no surface", "--look volume or xray")
        self.refused(["info", "gone.obj"], "gone.obj", "gone.obj: cannot be read: No such file")
        self.refused(["info", "gone.glb"], "gone.glb", "gone.glb: cannot be read: No such file")

    def test_the_command_can_be_typed_as_it_stands(self):
        (self.folder / "my parts").mkdir()
        (self.folder / "my parts" / "Bob's ball.STL").write_text("")
        self.run_ok("surface", "model:ball:2", "-o", "ball.stl", "--boundary")
        (self.folder / "ball.stl").rename(self.folder / "my parts" / "Bob's ball.STL")
        error = subvol("info", "my parts/Bob's ball.STL", folder=self.folder).err
        words = shlex.split(error.split("`")[1])
        self.assertEqual(words, ["subvol", "mesh", "my parts/Bob's ball.STL", "-o", "Bob's ball.vtu"])
        self.run_ok(*words[1:], "--cells", "4")
        self.assertIn("Bob's ball.vtu", self.files())


class Slips(InFolder):
    def test_every_slip_has_a_proposal_in_one_line(self):
        for arguments, words in SLIPS:
            with self.subTest(arguments=arguments):
                done = subvol(*arguments, folder=self.folder)
                self.assertEqual(done.code, 2)
                self.assertEqual(done.out, "")
                self.assertRegex(done.err, r"^subvol: [^\n]+\n$")
                self.assertIn(words, done.err)
                self.assertEqual(self.files(), [])

    def test_errors_are_objects_for_programs(self):
        for arguments, code, parts in (
            (["render", "model:ball", "-o", "a.png", "--leves", "2"], 2, {"where": "--leves", "allowed": "see subvol render --help"}),
            (["render", "model:ball", "-o", "a.png", "--method", "tetz"], 2,
             {"what": "'tetz' is unknown: did you mean tets?", "where": "--method", "allowed": "supported: splat, sheets, footprints, tets, pt, dense, grid"}),
            (["info", "gone.mesh"], 2, {"where": "gone.mesh"}),
            (["subdivide", "model:twist", "-o", "a.vtu", "--levels", "8"], 3, {"where": "--levels"}),
        ):
            done = subvol(*arguments, "--json", folder=self.folder)
            self.assertEqual(done.code, code)
            error = done.json()["error"]
            self.assertEqual(set(error), {"code", "what", "where", "allowed"})
            self.assertEqual(error["code"], code)
            for key, value in parts.items():
                self.assertEqual(error[key], value)
            self.assertIn(error["what"], done.err)  # people read the same

    def test_missing_frames_are_found_before_anything_is_written(self):
        for frame in (1, 3):
            (self.folder / f"in_{frame}.mesh").write_text(CUBE.format(last=8))
        (self.folder / "out_1.vdb").write_text("precious")
        done = subvol("vdb", "in_#.mesh", "-o", "out_#.vdb", "--frames", "1-3", folder=self.folder)
        self.assertEqual(done.code, 2)
        self.assertIn("--frames: 1 of 3 frames are missing: in_2.mesh (nothing was written)", done.err)
        self.assertEqual((self.folder / "out_1.vdb").read_text(), "precious")


class Helps(unittest.TestCase):
    def test_every_help_fits_80_columns(self):
        for arguments in [[], *([verb] for verb in VERBS)]:
            for flag in ("--help", "--help-all"):
                done = subvol(*arguments, flag)
                self.assertEqual(done.code, 0)
                for line in done.out.splitlines():
                    self.assertLessEqual(len(line), 80, f"{arguments} {flag}: {line}")

    def test_there_are_two_tiers(self):
        short, full = subvol("render", "--help").out, subvol("render", "--help-all").out
        self.assertLess(len(short.splitlines()), 70)
        for option in ("--kbuffer", "--weld", "--quiet"):
            self.assertNotIn(option + " ", short.split("--help-all")[0])
            self.assertIn(option, full)
        self.assertIn("--help-all", short)
        # Each option is there once.
        names = re.findall(r"^  (--?\S+?)[, \n]", full, re.M)
        self.assertEqual(len(names), len(set(names)))

    def test_help_of_a_verb(self):
        self.assertEqual(subvol("help", "render").out, subvol("render", "--help").out)
        self.assertEqual(subvol("help").out, subvol("--help").out)
        self.assertIn("did you mean render?", subvol("help", "rendr").err)

    def test_no_verb_has_options_of_others(self):
        for verb in ("model", "fit", "study", "demo"):
            for option in ("--weld", "--sharp", "--other-cells", "--field ", "--density"):
                if (verb, option) != ("study", "--field "):  # its own: of the meshes of --mesh
                    self.assertNotIn(option, subvol(verb, "--help-all").out)


class Lines(InFolder):
    def test_info_ends_in_a_verdict(self):
        lines = self.run_ok("info", "model:ball").out.splitlines()
        self.assertRegex(lines[-1], r"^verdict +sound$")
        self.assertRegex(lines[-2], r"^memory +\d[\d.]* [kMG]B$")
        self.assertRegex(lines[-3], r"^time +read (under 1|\d[\d.]*) m?s, inspect (under 1|\d[\d.]*) m?s$")
        columns = {len(re.match(r"^(.{0,20}?\S*)  +", line).group(0)) for line in lines if line.strip() and line[0] != " "}
        self.assertEqual(len(columns), 1, lines)  # aligned
        for line in lines:
            self.assertLessEqual(len(line), 80)

    def test_info_says_which_cells_are_inverted(self):
        mesh = CUBE.format(last=8).replace("0 0 1 0\n", "0 0 -1 0\n", 1)
        (self.folder / "bad.mesh").write_text(mesh)
        done = self.run_ok("info", "bad.mesh")
        self.assertRegex(done.out.splitlines()[-1], r"^verdict +1 cell inverted: 0$")
        self.assertEqual(self.run_ok("info", "bad.mesh", "--json").json()["verdict"], "1 cell inverted: 0")

    def test_info_lists_fields_alone(self):
        self.assertEqual(self.run_ok("info", "model:ball", "--list-fields").out, "density\n")

    def test_compare_says_the_figure_that_is_asked_for_first(self):
        self.run_ok("render", "model:ball:4", "-o", "a.png", "--size", 32)
        self.run_ok("render", "model:ball:4", "-o", "b.png", "--size", 32, "--view", "+x")
        done = subvol("compare", "a.png", "b.png", "--fail-under", "psnr=90", folder=self.folder)
        self.assertEqual(done.code, 1)
        lines = done.out.splitlines()
        self.assertRegex(lines[0], r"^psnr +[\d.]+ dB$")
        self.assertRegex(lines[-1], r"^verdict +failed: psnr=90 is not met by [\d.]+$")
        lines = self.run_ok("compare", "model:ball:4", "model:ball:4", "--samples", 100).out.splitlines()
        self.assertRegex(lines[0], r"^l2 +")

    def test_a_blank_picture_is_not_left_without_a_word(self):
        done = self.run_ok("render", "model:ball:4", "-o", "a.png", "--size", 32, "--look", "volume", "--tf", "constant", "--background", "white")
        self.assertIn("the picture is blank", done.err)
        done = self.run_ok("render", "model:ball:4", "-o", "a.png", "--size", 32, "--look", "volume", "--tf", "constant", "--background", "black")
        self.assertNotIn("blank", done.err)

    def test_the_field_that_is_drawn_is_a_sensible_one_and_is_said(self):
        arrays = "".join(f"SCALARS {name} double 1\nLOOKUP_TABLE default\n{values}\n" for name, values in (
            ("GlobalNodeId", "1 2 3 4 5 6 7 8"), ("flat", "3 3 3 3 3 3 3 3"), ("Temp", "20 20 20 20 90 90 90 90")))
        corners = "0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1"
        (self.folder / "a.vtk").write_text(
            "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\n"
            f"POINTS 8 double\n{corners}\nCELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\nPOINT_DATA 8\n{arrays}")
        done = self.run_ok("render", "a.vtk", "-o", "a.png", "--size", 16)
        self.assertIn("drawing Temp (of 3 fields; --field chooses)", done.err)
        self.assertNotIn("drawing", self.run_ok("render", "a.vtk", "-o", "a.png", "--size", 16, "--field", "flat").err)

    def test_lists_are_columns(self):
        self.run_ok("points", "model:ball:4", "-o", "a.vtp")
        lines = self.run_ok("info", "a.vtp").out.splitlines()
        first = next(k for k, line in enumerate(lines) if line.startswith("channels"))
        names, values = lines[first].split(), lines[first + 1].split()
        self.assertEqual(names, ["channels", "name", "min", "max"])
        self.assertEqual(values[0], "density")
        self.assertEqual(lines[first].index("min"), lines[first + 1].index(values[1]))

    def test_many_arrays_make_one_line(self):
        arrays = "".join(f"SCALARS a{k} double 1\nLOOKUP_TABLE default\n{k}\n" for k in range(9))
        corners = "0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1"
        (self.folder / "a.vtk").write_text(
            "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\n"
            f"POINTS 8 double\n{corners}\nCELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\nCELL_DATA 1\n{arrays}")
        done = self.run_ok("info", "a.vtk")
        self.assertEqual(done.err.count("\n"), 1, done.err)
        self.assertIn('9 cell arrays became point arrays ("a0", "a1", "a2", "a3", "a4", "a5" and 3 more)', done.err)


if __name__ == "__main__":
    unittest.main()
