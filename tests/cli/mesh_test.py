# SPDX-License-Identifier: Apache-2.0
"""`subvol mesh` and `approximate --shape`: surfaces and grids become control meshes."""

import math
import unittest

from command import InFolder, subvol


def cube(at, faces=6):
    """A unit cube at (at, at, at), or its first faces."""
    corners = [(at + (n & 1), at + (n >> 1 & 1), at + (n >> 2)) for n in range(8)]
    sides = ["1 3 4 2", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6", "5 6 8 7"]
    return "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in corners) + "".join(f"f {side}\n" for side in sides[:faces])


class Mesh(InFolder):
    def make(self, *words):
        return self.run_ok("mesh", *words, "--json").json()

    def ball(self, name="ball.stl"):
        self.run_ok("surface", "model:ball:4", "--boundary", "-o", name, "--tolerance", "1e-3", "--quiet")

    def test_a_surface_is_filled(self):
        for name in ("ball.stl", "ball.obj", "ball.ply"):
            self.ball(name)
            found = self.make(name, "-o", "ball.vtu", "--cells", "6", "--quiet")
            self.assertEqual((found["folds"]["cells"]["folded"], found["parts"]), (0, 1))
            self.assertLess(found["after"]["max"], .1 * found["side_world"])
            self.assertLess(found["after"]["rms"], .2 * found["before"]["rms"])
        info = self.run_ok("info", "ball.vtu", "--json").json()
        self.assertEqual((info["cells"], info["points"]), (found["cells"], found["points"]))
        filled = self.run_ok("probe", "ball.vtu", "--density", "1", "--stats", "--json").json()["stats"]["whole"]["volume"]
        ball = self.run_ok("probe", "model:ball:4", "--density", "1", "--stats", "--json").json()["stats"]["whole"]["volume"]
        self.assertLess(abs(filled / ball - 1), .02)

    def test_a_deck_has_points_of_the_surface_or_says_that_it_has_not(self):
        (self.folder / "cube.obj").write_text(cube(0))
        for scheme, off in (("mcq", False), ("cc", True)):
            done = self.run_ok("mesh", "cube.obj", "-o", "cube.inp", "--cells", "4", "--scheme", scheme, "--sharp-angle", "180")
            self.assertEqual("are not on the limit of the scheme" in done.err, off, done.err)
            corners = [float(word) for line in (self.folder / "cube.inp").read_text().split("*ELEMENT")[0].splitlines() if line[0].isdigit() for word in line.split(",")[1:]]
            # The rounded corners of the cube, .5 √3 from its middle; control points of cc are beyond what their limit meets.
            self.assertEqual(max(corners) > 1.01, off, (scheme, max(corners)))

    def test_of_several_surfaces_each_is_a_material(self):
        (self.folder / "lower.obj").write_text(cube(0))
        upper = "".join(line if line[0] == "f" else f"v {' '.join(line.split()[1:3])} {float(line.split()[3]) + 1}\n" for line in cube(0).splitlines(True))
        (self.folder / "upper.obj").write_text(upper)
        found = self.make("lower.obj", "upper.obj", "-o", "two.vtu", "--cells", "8", "--quiet")
        self.assertEqual([material["name"] for material in found["materials"]], ["lower", "upper"])
        self.assertEqual(sum(material["cells"] for material in found["materials"]), found["cells"])
        for material in found["materials"]:
            self.assertLess(abs(material["volume_world"] - 1), .01)
            self.assertLess(abs(material["enclosed_world"] - 1), 1e-9)
        stats = self.run_ok("probe", "two.vtu", "--only", "set:upper", "--density", "1", "--stats", "--json").json()["stats"]["whole"]
        self.assertLess(abs(stats["volume"] - 1), .01)
        deck = self.run_ok("mesh", "lower.obj", "upper.obj", "-o", "two.inp", "--cells", "8", "--quiet") and (self.folder / "two.inp").read_text()
        self.assertIn("*ELSET, ELSET=lower", deck)
        self.assertIn("*ELSET, ELSET=upper", deck)
        self.assertEqual(found["features"], {"points": 1, "curves": 1, "surfaces": 1})
        twice = subvol("mesh", "lower.obj", "lower.obj", "-o", "no.vtu", folder=self.folder)
        self.assertEqual(twice.code, 2)
        self.assertIn("lower: two materials have this name", twice.err)
        self.assertFalse((self.folder / "no.vtu").exists())

    def test_sides_over_holes_are_the_patch_lid(self):
        (self.folder / "open.obj").write_text(cube(0, faces=5))
        found = self.make("open.obj", "-o", "open.vtu", "--cells", "6", "--quiet")
        self.assertGreater(found["lid_sides"], 9)
        info = self.run_ok("info", "open.vtu", "--json").json()
        self.assertIn("lid", str(info["patches"]))

    def test_cells_are_divided_where_the_surface_asks_for_it(self):
        # a ball with ripples on one side, too short for large cells
        self.run_ok("surface", "model:ball:4", "--boundary", "-o", "ball.obj", "--tolerance", "1e-3", "--quiet")
        with open(self.folder / "rippled.obj", "w") as file:
            for line in (self.folder / "ball.obj").read_text().splitlines():
                if line.startswith("v "):
                    x, y, z = (float(word) for word in line.split()[1:4])
                    longer = 1 + .15 * max(x, 0) * math.sin(14 * z)
                    line = f"v {longer * x!r} {longer * y!r} {longer * z!r}"
                file.write(line + "\n")
        whole = self.make("rippled.obj", "-o", "whole.vtu", "--cells", "6", "--sharp-angle", "180")
        divided = self.make("rippled.obj", "-o", "divided.vtu", "--cells", "6", "--sharp-angle", "180", "--refine", "1", "--tolerance", ".15")
        self.assertEqual((whole["refined"], whole["divided"], divided["refined"]), (0, 0, 1))
        self.assertLess(divided["after"]["rms"], .6 * whole["after"]["rms"])
        self.assertLess(divided["after"]["missed_max"], .6 * whole["after"]["missed_max"])
        finer = self.make("rippled.obj", "-o", "finer.vtu", "--cells", "18", "--sharp-angle", "180")
        self.assertLess(divided["cells"], .6 * finer["cells"])
        self.assertEqual(divided["folds"]["cells"]["folded"], 0)
        self.assertEqual(divided["side_world"], whole["side_world"])
        # where nothing is beyond the tolerance, it is the same mesh
        same = self.make("rippled.obj", "-o", "same.vtu", "--cells", "6", "--sharp-angle", "180", "--refine", "1", "--tolerance", "10")
        self.assertEqual(same["cells"], whole["cells"])
        self.assertEqual((self.folder / "same.vtu").read_bytes(), (self.folder / "whole.vtu").read_bytes())

    def test_a_part_of_a_grid_is_filled(self):
        # density is 1 − |x|² or so inside the ball: where it is above a value is a smaller ball
        self.run_ok("vdb", "model:ball:4", "--density", "2-x*x-y*y-z*z", "-o", "fog.vdb", "--resolution", "40", "--sdf", "--quiet")
        whole = self.make("fog.vdb", "-o", "whole.vtu", "--cells", "6", "--iso", ".5")
        part = self.make("fog.vdb", "-o", "part.vtu", "--cells", "6", "--iso", "1.75")
        self.assertLess(part["side_world"], .75 * whole["side_world"])
        self.assertEqual(part["folds"]["cells"]["folded"], 0)
        distances = self.make("fog.vdb", "--field", "sdf", "-o", "set.vtu", "--cells", "6")
        self.assertAlmostEqual(distances["side_world"] / whole["side_world"], 1, 1)

    def test_a_hole_is_said(self):
        # without its face at z = 1, over which the boundary bulges
        (self.folder / "open.obj").write_text(cube(0, 5))
        found = self.make("open.obj", "-o", "open.vtu", "--cells", "6")
        self.assertEqual((found["open_edges"], found["open_length"]), (4, 4))
        self.assertTrue(any("the surface is open: 4 edges belong to one triangle alone, of the length 4" in said for said in found["warnings"]))
        after = found["after"]
        self.assertGreater(after["max"], 2 * after["covered_max"])
        x, y, z = after["max_at"]
        # the distance of that place from the five faces that are there
        outside = lambda u: max(-u, 0, u - 1)
        faces = [math.hypot(value, *(outside(other) for other in others))
                 for value, others in ((x, (y, z)), (x - 1, (y, z)), (y, (x, z)), (y - 1, (x, z)), (z, (x, y)))]
        self.assertAlmostEqual(after["max"], min(faces), 9)
        self.assertTrue(.1 < after["hole_part"] < .3)  # a sixth, and more as it is round
        self.assertTrue({"walls", "cavities", "united", "turned"} <= found["surface"].keys())

    def test_a_shape_is_fitted(self):
        self.ball()
        # Cells at the edges of a cube fold where it becomes a ball: they are kept, and said.
        fitted = subvol("approximate", "ball.stl", "--shape", "--onto", "model:twist:3", "-o", "fitted.vtu", "--keep-folds", "--json", folder=self.folder)
        found = fitted.json()
        self.assertEqual(fitted.code, 1)
        self.assertGreater(found["shape"]["folds"]["cells"]["folded"], 0)
        self.assertLess(found["shape"]["after"]["missed_rms"], .5 * found["shape"]["before"]["missed_rms"])
        self.assertNotIn("fields", found)
        # A mesh gives its shape and then its fields.
        self.run_ok("subdivide", "model:twist:4", "--density", "x+2*y", "-o", "fine.vtu", "--levels", "2", "--quiet")
        both = self.run_ok("approximate", "fine.vtu", "--shape", "--onto", "model:twist:2", "-o", "both.vtu", "--json").json()
        self.assertLess(both["shape"]["after"]["rms"], both["shape"]["before"]["rms"])
        self.assertLess(both["fields"]["density"]["max"], .05 * both["fields"]["density"]["range"])

    def test_says_what_is_wrong(self):
        self.ball()
        (self.folder / "flat.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        (self.folder / "sheet.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
        (self.folder / "cube.obj").write_text(cube(0))
        # a box without height: closed, and without volume
        (self.folder / "flatbox.obj").write_text("\n".join(line if line[0] == "f" else line.rsplit(" ", 1)[0] + " 0" for line in cube(0).splitlines()))
        (self.folder / "far.obj").write_text(cube(1e12))
        (self.folder / "bad.obj").write_text("v 0 0 0\nf 1 2 3\n")
        self.run_ok("vdb", "model:ball:2", "-o", "fog.vdb", "--resolution", "16", "--quiet")
        for words, part in ((["none.stl"], "none.stl"), (["none.glb"], "none.glb: cannot be read: No such file"), (["sheet.obj"], "it is a sheet, which encloses no volume"), (["flatbox.obj"], "no cell has its middle inside the surface"),
                            (["cube.obj", "--cells", "490"], "--cells: there would be 117649000 or more cells"), (["far.obj"], "cells away from the origin"), (["flat.obj"], "no cell has its middle inside the surface"),
                            (["bad.obj"], "bad.obj, line 2: a face has the corner 2"), (["model:ball"], "is not a surface"),
                            (["ball.stl", "--iso", "1"], "--iso: needs a grid"), (["ball.stl", "--field", "T"], "--field: needs a grid"),
                            (["ball.stl", "--cells", "1"], "--cells"), (["ball.stl", "--max-cells", "10"], "--cells: "),
                            (["ball.stl", "--tolerance", ".1"], "--tolerance"), (["ball.stl", "--refine", "4"], "--refine"), (["ball.stl", "--refine", "1", "--tolerance", "-1"], "--tolerance"),
                            (["ball.stl", "--cells", "8", "--refine", "1", "--tolerance", "0", "--max-cells", "1000"], "--cells: there would be "),
                            (["ball.stl", "--keep-folds", "--boundary-move", ".5"], "--boundary-move"),
                            (["fog.vdb", "--iso", "77"], "has the value 77 nowhere"), (["fog.vdb", "--field", "T"], "T")):
            done = subvol("mesh", *words, "-o", "made.vtu", folder=self.folder)
            self.assertEqual(done.code, 2, (words, done.err))
            self.assertIn(part, done.err)
            self.assertNotIn("made.vtu", self.files())
        for words, part in ((["ball.stl"], "ball.stl: is a surface, which has a shape but no fields (--shape with it; `subvol mesh ball.stl -o ball.vtu` makes"),
                            (["ball.stl", "--shape", "--refine", "1"], "--refine"), (["fog.vdb", "--shape"], "is fog, which has no surface of its own"),
                            (["model:ball:2", "--stiffness", "1"], "--stiffness")):
            done = subvol("approximate", *words, "--onto", "model:twist:2", "-o", "made.vtu", folder=self.folder)
            self.assertEqual(done.code, 2, (words, done.err))
            self.assertIn(part, done.err)
            self.assertNotIn("made.vtu", self.files())

    def test_a_level_set_gives_its_shape_to_a_mesh(self):
        self.run_ok("vdb", "model:ball:4", "-o", "ball.vdb", "--resolution", "40", "--sdf", "--quiet")
        # the ball again, from a block of cells with other proportions
        self.run_ok("subdivide", "model:ball:4", "-o", "egg.vtu", "--levels", "0", "--warp", "vector(0,0,.2*z)", "--quiet")
        found = self.run_ok("approximate", "ball.vdb", "--field", "sdf", "--shape", "--onto", "egg.vtu", "-o", "round.vtu", "--json").json()
        self.assertGreater(found["shape"]["before"]["max"], .1)
        self.assertLess(found["shape"]["after"]["rms"], .01)
        again = self.run_ok("probe", "round.vtu", "--stats", "--density", "1", "--json").json()["stats"]["whole"]
        ball = self.run_ok("probe", "model:ball:4", "--stats", "--density", "1", "--json").json()["stats"]["whole"]
        self.assertLess(abs(again["volume"] / ball["volume"] - 1), .01)


if __name__ == "__main__":
    unittest.main()
