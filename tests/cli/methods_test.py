# SPDX-License-Identifier: Apache-2.0
"""Methods of pictures: each option either changes what a method makes, or is refused by a sentence that names both."""

import unittest
from pathlib import Path

from command import X_AND_Z, InFolder, subvol

METHODS = ["splat", "sheets", "footprints", "tets", "pt", "dense", "grid"]
PLANE = "0,0,0,1,0,0"
FAR = "0,-60,0,0,0,0,0,0,1,30"  # a camera that sees the ball on a few pixels

# For each option a value that matters (None: a flag), and what else it needs. Without it the value is the default one.
GIVEN = {
    "per-edge": ("2", []), "centers": (None, []), "spacing": (".3", []), "spacing-voxels": ("30", []), "tolerance": ("1e-3", []),
    "footprint": (FAR, []), "footprint-size": ("900x900", ["--footprint", FAR]), "values": ("cubic", ["--per-edge", "2"]),
    "value-kernel": ("compact", ["--values", "paper", "--per-edge", "2"]), "kernel": ("gaussian", []), "threshold": (".2", []),
    "correction": ("none", []), "reduce": (".2", []), "refine": (None, ["--reduce", ".2"]), "scheme": ("cc", []),
    "tension": (".02", ["--per-edge", "2"]), "crease-angle": ("10", []), "levels": ("2", []), "samples": ("3", []),
    "tolerance-image": (".1", []), "order": ("lists", []), "kbuffer": ("1", ["--order", "havs"]),
    "lod": ("30", []), "seconds": ("2", []), "backend": ("gl", []), "device": ("0", []), "sheets": ("40", []),
    "plain-sums": (None, []), "shade": (None, []), "shadows": (None, []), "ambient-occlusion": (".3", []),
    "color-field": ("z", ["--field", "x"]), "edges": (None, []), "clip": (PLANE, []), "clip-box": ("0,0,0,1,1,1", []),
    "slice": (PLANE, []), "around": (None, ["--slice", PLANE]), "memory": ("100M", []),
}
OF_SOLIDS = {"correction"}  # by the light on kernels; all others are seen in a transparent volume, too
NEED_ANOTHER = {"refine": "reduce", "around": "slice", "footprint-size": "footprint",
                "value-kernel": "per-edge", "kbuffer": "order"}  # of which one is then refused first
SAME_OUTPUT = {"device", "memory"}  # they choose where the work is done


class Methods(InFolder):
    @classmethod
    def setUpClass(cls):
        cls.table = subvol("--generate", "methods").out
        cls.rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in cls.table.splitlines()[2:]]
        cls.has_gl = bool(subvol("info", "--gl", "--json").json()["gl"])

    def setUp(self):
        super().setUp()
        (self.folder / "two.vtk").write_text(X_AND_Z)
        self.run_ok("vdb", "model:ball:3", "-o", "ball.vdb", "--resolution", 12)
        self.run_ok("split", "model:ball:3", "-o", "ball.bricks", "--bricks", 2)

    def test_the_eye_in_the_body_sees_the_cells_around_it(self):
        values = " ".join(str(x) for _ in range(49) for x in range(7))
        (self.folder / "x.vtk").write_text("# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 7 7 7\nORIGIN 0 0 0\n"
                                           f"SPACING 1 1 1\nPOINT_DATA 343\nSCALARS T double 1\nLOOKUP_TABLE default\n{values}\n")
        for where, options in (("in what is cut away", ["--clip", "3,3.3,3,0,-1,0", "--camera", "3,1,3,3,6,3,0,0,1,60"]),
                               ("in the body", ["--camera", "3,3.5,3,3,6,3,0,0,1,60"])):
            with self.subTest(where):
                for method in "dense", "tets":
                    self.run_ok("render", "x.vtk", "-o", f"{method}.exr", "--size", 64, "--method", method, *options)
                self.assertLess(self.run_ok("compare", "dense.exr", "tets.exr", "--json").json()["rmse"], .01)

    def refused(self, *arguments):
        done = subvol(*arguments, folder=self.folder)
        self.assertEqual((done.code, done.err.count("\n")), (2, 1), done.err)
        return done.err

    def drawn(self, source, method, *words):
        """The picture and the facts of it, without times."""
        report = self.run_ok("render", source, "-o", "a.exr", "--size", "24x20", "--method", method, "--json", *words).json()
        facts = {name: value for name, value in report.items() if name not in ("seconds", "version", "peak_bytes", "output")}
        return (self.folder / "a.exr").read_bytes(), facts

    def source(self, option, method, bodies):
        if method == "grid" and "voxels" in bodies:
            return "ball.vdb"
        if option == "memory" and method in ("splat", "sheets", "footprints", "tets"):
            return "ball.bricks"
        return "ball.vdb" if method == "grid" else "two.vtk" if option == "color-field" else "model:ball:3"

    def words(self, option, method):
        value, more = GIVEN[option]
        if option == "lod" and method == "pt":
            value, more = ".2", ["--order", "havs"]
        given = ["--" + option] + ([value] if value is not None else [])
        look = [] if option in OF_SOLIDS else ["--look", "volume"]
        if method in ("tets", "pt", "dense") and option == "tension":
            more = []
        return given, [*more, *look]

    def test_the_document_has_the_table(self):
        document = Path(__file__).parents[2] / "docs/pictures.md"
        self.assertIn(self.table, document.read_text(), "put the output of `subvol --generate methods` into docs/pictures.md")

    def test_each_option_of_the_table_is_tried(self):
        self.assertEqual({row[0].strip("`-") for row in self.rows}, set(GIVEN))

    def test_each_option_changes_the_output_or_is_refused(self):
        for row in self.rows:
            option, bodies = row[0].strip("`-"), row[9]
            for method, cell in zip(METHODS, row[2:9]):
                if method in ("sheets", "pt") and not self.has_gl:
                    continue
                with self.subTest(option=option, method=method):
                    self.check(option, method, cell == "x", bodies)

    def check(self, option, method, used, bodies):
        given, needed = self.words(option, method)
        source = self.source(option, method, bodies)
        if not used:
            more = needed if option in NEED_ANOTHER else []
            said = self.refused("render", source, "-o", "a.exr", "--size", "24x20", "--method", method, *given, *more)
            name = NEED_ANOTHER.get(option, option)
            self.assertIn(f"--{name}: has no effect with method '{method}': ", said)
            return
        if option == "memory" and method != "tets" and method != "splat":
            said = self.refused("render", source, "-o", "a.exr", "--size", "24x20", "--method", method, *given)
            self.assertIn(f"'{method}' cannot draw a folder of bricks", said)
            return
        if option == "backend" and not self.has_gl:
            return
        after = self.drawn(source, method, *given, *needed)
        if option in SAME_OUTPUT:
            return
        before = self.drawn(source, method, *needed)
        self.assertTrue(after != before, "nothing changes")

    def test_options_that_other_options_make_useless_are_refused(self):
        for words, said in (
                (["--method", "dense", "--levels", "1", "--tolerance-image", ".1"], "--tolerance-image: has no effect with --levels"),
                (["--method", "pt", "--kbuffer", "3"], "--kbuffer: has no effect without --order havs"),
                (["--method", "pt", "--lod", ".5"], "--lod: has no effect without --order havs"),
                (["--value-kernel", "compact"], "--value-kernel: has no effect without --values paper"),
                (["--footprint-size", "64x64"], "--footprint-size: has no effect without --footprint"),
                (["--scheme", "cc", "--tension", ".03"], "--tension: has no effect without --scheme mcq"),
                (["--backend", "cpu", "--device", "0"], "--device: has no effect with --backend cpu"),
                (["--look", "solid", "--shade"], "--shade: has no effect with --look solid"),
                (["--memory", "1M"], "--memory: has no effect on a mesh"),
                (["--fps", "10"], "--fps: has no effect without a video")):
            with self.subTest(words):
                self.assertIn(said, self.refused("render", "model:ball:3", "-o", "a.exr", "--size", "16", *words))

    def test_options_that_a_body_does_not_have_are_refused(self):
        self.run_ok("points", "model:ball:3", "-o", "ball.ply")
        for source, option, value, noun in (("ball.ply", "levels", "1", "points"), ("ball.ply", "per-edge", "2", "points"),
                                            ("ball.vdb", "color-field", "x", "a grid of voxels"),
                                            ("ball.bricks", "lod", "2", "a folder of bricks")):
            with self.subTest(source):
                said = self.refused("render", source, "-o", "a.exr", "--size", "16", "--" + option, value)
                self.assertIn(f"--{option}: has no effect on {noun}", said)


if __name__ == "__main__":
    unittest.main()
