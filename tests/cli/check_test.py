# SPDX-License-Identifier: Apache-2.0
"""check: its verdicts, JSON and exit codes."""

import unittest

from command import InFolder, subvol

CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def box(side, move):
    """A box of side³ unit cells as MEDIT; move(x, y, z): where a point is."""
    number = lambda i, j, k: 1 + i + (side + 1) * (j + (side + 1) * k)
    steps = range(side + 1)
    points = [move(i, j, k) for k in steps for j in steps for i in steps]
    cells = [[number(i + u, j + v, k + w) for u, v, w in CORNERS] for k in range(side) for j in range(side) for i in range(side)]
    line = lambda row: " ".join(map(str, row)) + " 0\n"
    return (f"MeshVersionFormatted 2\nDimension 3\nVertices\n{len(points)}\n" + "".join(map(line, points)) +
            f"Hexahedra\n{len(cells)}\n" + "".join(map(line, cells)) + "End\n")


class Check(InFolder):
    def check(self, *arguments):
        done = subvol("check", *arguments, "--json", folder=self.folder)
        return done.code, done.json()

    def test_sound_meshes(self):
        code, found = self.check("model:twist:6")
        self.assertEqual((code, found["verdict"]), (0, "sound"))
        self.assertEqual(found["cells"], {"proved": 216, "folded": 0, "undecided": 0, "irregular": 0})
        self.assertEqual((found["places"], found["open_volume"]), ([], 0))

    def test_a_fold_between_sound_cells_has_a_place(self):
        # Two planes beside a third: the cells are sound, and the limit overshoots.
        (self.folder / "a.mesh").write_text(box(7, lambda x, y, z: (x + {3: .85, 5: -.85}.get(x, 0), y, z)))
        code, found = self.check("a.mesh")
        self.assertEqual((code, found["verdict"]), (1, "folded"))
        self.assertEqual(len(found["places"]), found["cells"]["folded"])
        place = found["places"][0]
        self.assertLess(place["determinant"], 0)
        at = self.run_ok("probe", "a.mesh", "--at=" + ",".join(map(str, place["at"])), "--density", "x", "--json").json()["values"][0]
        self.assertTrue(at["inside"])
        for scheme in ("linear", "cc"):
            code, found = self.check("a.mesh", "--scheme", scheme)
            self.assertEqual((code, found["verdict"]), (0, "sound"))

    def series(self, *moves):
        """Steps of a box, in which each point is where a function puts it; at times 0, 2, 4, …"""
        for k, move in enumerate(moves):
            (self.folder / f"{k}.mesh").write_text(box(3, move))
        steps = "".join(f'<DataSet timestep="{2 * k}" file="{k}.mesh"/>' for k in range(len(moves)))
        (self.folder / "a.pvd").write_text(f'<VTKFile type="Collection"><Collection>{steps}</Collection></VTKFile>')

    def test_a_series_is_checked_at_its_steps_and_between(self):
        as_it_is = lambda x, y, z: (x, y, z)
        turned = lambda x, y, z: (-y + 9, x, z)
        # From there to −2 and −3 times along two axes: sound at the end, (1 − 3t)(1 − 4t) between.
        pulled = lambda x, y, z: (-2 * x, -3 * y, z)
        self.series(as_it_is, turned, as_it_is, pulled)
        for scheme in "linear", "mcq", "bsxw", "cc":
            with self.subTest(scheme):
                code, found = self.check("a.pvd", "--series", "--scheme", scheme)
                self.assertEqual((code, found["verdict"]), (1, "folded"))
                self.assertEqual([(s["step"], s["time"], s["verdict"]) for s in found["steps"]], [(k, 2 * k, "sound") for k in range(4)])
                self.assertEqual([(b["from"], b["to"], b["times"], b["verdict"]) for b in found["between"]],
                                 [(0, 1, [0, 2], "sound"), (1, 2, [2, 4], "sound"), (2, 3, [4, 6], "folded")])
                for place in found["between"][2]["places"]:
                    t = (place["time"] - 4) / 2
                    self.assertLess((1 - 3 * t) * (1 - 4 * t), 0)
                    self.assertLess(place["determinant"], 0)
        code, found = self.check("a.pvd", "--series", "--step", "0-2")
        self.assertEqual((code, found["verdict"], len(found["steps"])), (0, "sound", 3))
        lines = subvol("check", "a.pvd", "--series", folder=self.folder).out.splitlines()
        self.assertIn("between 0 and 1: 27 proved", lines)
        self.assertEqual(lines[-1].split(), ["verdict", "folded"])

    def test_a_body_pulled_through_itself_folds_although_readers_turn_its_cells(self):
        # At z → −z all cells are left-handed, which the reader mends: det = 1 − 2t between.
        self.series(lambda x, y, z: (x, y, z), lambda x, y, z: (x, y, -z))
        for scheme in "linear", "mcq":
            code, found = self.check("a.pvd", "--series", "--scheme", scheme)
            self.assertEqual((code, [s["verdict"] for s in found["steps"]], found["between"][0]["verdict"]), (1, ["sound", "sound"], "folded"))
            self.assertTrue(all(place["time"] > 1 for place in found["between"][0]["places"]))
        self.assertRegex(subvol("check", "a.pvd", "--series", folder=self.folder).out, "between 0 and 1: 27 cells folded, .*, time 1.5; 0 proved")

    def test_other_cells_of_the_same_corners_are_other_cells(self):
        self.series(lambda x, y, z: (x, y, z), lambda x, y, z: (x + 1, y, z))
        text = (self.folder / "1.mesh").read_text().splitlines()
        row = text.index("Hexahedra") + 2
        a, b, *rest = text[row].split()
        text[row] = " ".join([b, a, *rest])  # two corners exchanged: other edges
        (self.folder / "1.mesh").write_text("\n".join(text) + "\n")
        done = subvol("check", "a.pvd", "--series", "--scheme", "linear", "--json", folder=self.folder).json()
        self.assertIn("the cells change between the steps 0 and 1: nothing is said between them", done["warnings"])
        self.assertEqual(done["between"], [])

    def test_kinds_of_undecided_cells(self):
        _, found = self.check("model:ball:3")
        self.assertEqual(sum(found["undecided_kinds"].values()), found["cells"]["undecided"])
        self.assertEqual(set(found["undecided_kinds"]), {"irregular_edge", "irregular_point"})
        # A box of two layers has no window that is decided at once; nothing in it is irregular.
        (self.folder / "b.mesh").write_text(box(2, lambda x, y, z: (x, y, z)))
        _, found = self.check("b.mesh", "--irregular-levels", "0")
        self.assertLessEqual(set(found.get("undecided_kinds", {})), {"regular"})
        # Half a turn passes a determinant of 0.
        self.series(lambda x, y, z: (x, y, z), lambda x, y, z: (-x, -y, z))
        code, found = self.check("a.pvd", "--series", "--time-levels", "2")
        self.assertEqual((code, found["verdict"], found["between"][0]["undecided_kinds"]), (0, "undecided", {"regular": 27}))

    def test_what_is_no_series(self):
        self.series(lambda x, y, z: (x, y, z), lambda x, y, z: (x, y, z))
        for words, said in ((["0.mesh", "--series"], "it has one step"), (["model:ball:3", "--series"], "it has one step"), (["a.pvd", "--series", "--step", "1"], "nothing moves in one step"),
                            (["a.pvd", "--series", "--time", "1"], "nothing moves at one time"), (["a.pvd", "--time-levels", "2"], "--series"),
                            (["a.pvd", "--series", "--mend", "-o", "b.vtu"], "cannot be given together")):
            with self.subTest(words):
                done = subvol("check", *words, folder=self.folder)
                self.assertEqual((done.code, done.out), (2, ""))
                self.assertIn(said, done.err)
        (self.folder / "1.mesh").write_text(box(2, lambda x, y, z: (x, y, z)))
        done = self.run_ok("check", "a.pvd", "--series", "--json")
        self.assertIn("the cells change between the steps 0 and 1: nothing is said between them", done.json()["warnings"])
        self.assertEqual((done.json()["verdict"], done.json()["between"]), ("undecided", []))

    def test_info_counts_them_on_request(self):
        (self.folder / "a.mesh").write_text(box(7, lambda x, y, z: (x + {3: .85, 5: -.85}.get(x, 0), y, z)))
        _, found = self.check("a.mesh")
        about = self.run_ok("info", "a.mesh", "--folds", "--json").json()
        self.assertEqual(about["folds"], {key: found[key] for key in ("verdict", "cells", "open_volume", "sampled")})
        self.assertNotIn("folds", self.run_ok("info", "a.mesh", "--json").json())
        said = [line for line in self.run_ok("info", "a.mesh", "--folds").out.splitlines() if line.startswith("folds")]
        self.assertEqual(len(said), 1)
        self.assertIn(f"{found['cells']['folded']} folded", said[0])
        for arguments in (["--gl", "--folds"], ["a.mesh", "--folds", "--list-fields"], ["a.mesh", "--folds", "--json", "--part", "1/2"]):
            self.assertEqual(subvol("info", *arguments, folder=self.folder).code, 2)

    def test_folds_are_mended(self):
        pushed = lambda x, y, z: (x + 1.3 * (x == y == z == 3), y, z)
        (self.folder / "a.mesh").write_text(box(6, pushed))
        self.assertEqual(self.check("a.mesh")[0], 1)
        code, found = self.check("a.mesh", "--mend", "-o", "b.vtu", "--boundary-move", "0")
        self.assertEqual((code, found["verdict"], found["mend"]["left"]), (0, "sound", []))
        self.assertGreater(found["mend"]["folded"], 0)
        self.assertGreater(found["mend"]["moved"], 0)
        self.assertEqual(found["mend"]["boundary_edges"], 0)
        self.assertEqual(self.check("b.vtu")[1]["verdict"], "sound")
        # A lone cell has no point that could move: it is named, the exit code is that of a fold.
        (self.folder / "c.mesh").write_text(box(1, lambda x, y, z: (x + 2 * (x == y == z == 0), y, z)))
        done = subvol("check", "c.mesh", "--mend", "-o", "d.vtu", "--boundary-move", "0", folder=self.folder)
        self.assertEqual(done.code, 1)
        self.assertIn("cell 0 could not be mended: all of its points are on the boundary", done.out + done.err)
        for arguments, naming in ((["-o", "e.vtu"], "--mend"), (["--rounds", "2"], "--mend"), (["--boundary-move", ".1"], "--mend"),
                                  (["--mend"], "--output"), (["--mend", "-o", "e.png"], ".vtu")):
            done = subvol("check", "a.mesh", *arguments, folder=self.folder)
            self.assertEqual(done.code, 2, arguments)
            self.assertIn(naming, done.err)
            self.assertFalse((self.folder / "e.vtu").exists())

    def test_meshes_of_surfaces_are_proved_for_splines(self):
        # Cells of a grid under a layer: irregular points next to each other.
        self.run_ok("surface", "model:ball:6", "--boundary", "-o", "ball.obj")
        for scheme in "cc", "bsxw":
            self.run_ok("mesh", "ball.obj", "--cells", "5", "--scheme", scheme, "-o", "k.vtu")
            code, found = self.check("k.vtu", "--scheme", scheme)
            self.assertEqual((code, found["verdict"], found["cells"]["undecided"]), (0, "sound", 0))
            self.assertGreater(self.run_ok("info", "k.vtu", "--json").json()["interior_edge_valence"]["5"], 10)

    def test_irregular_edges_stay_open(self):
        code, found = self.check("model:ball:3")
        self.assertEqual((code, found["verdict"]), (0, "undecided"))
        self.assertEqual(found["cells"]["undecided"], found["cells"]["irregular"])
        self.assertGreater(found["open_volume"], 0)
        # Undecided cells are sampled: at corners, edges, sides and inside, and then near the least determinant.
        sampled = found["sampled"]
        self.assertEqual((sampled["cells"], sampled["folded"]), (found["cells"]["undecided"], 0))
        self.assertGreater(sampled["places"], 100 * sampled["cells"])
        self.assertTrue(0 < sampled["least"] < 1)
        done = self.run_ok("check", "model:ball:3")
        said = done.out + done.err
        for word in ("proved", "irregular", "sampled", "verdict"):
            self.assertIn(word, said)

    def test_what_has_no_proof_is_refused(self):
        for arguments, naming in ((["--tension", ".05"], "--tension: "), (["--levels", "9"], "levels"), (["--tests", "0"], "tests"),
                                  (["--scheme", "tetoct"], "scheme"), (["--field", "density"], "--field: has no effect")):
            done = subvol("check", "model:twist:2", *arguments, folder=self.folder)
            self.assertEqual(done.code, 2, done.err)
            self.assertIn(naming, done.err)


if __name__ == "__main__":
    unittest.main()
