# SPDX-License-Identifier: Apache-2.0
"""Parts of a mesh: each block and set has its own figures, and is drawn and measured as it lies in the whole."""

import math
import unittest

from command import InFolder, subvol
from regions_test import AROUND, inp as bar_inp, CELLS as BAR_CELLS, POINTS as BAR_POINTS

# A cube, a pyramid on its right side, and a tetrahedron on its top: volumes 1, 1/3, 1/12. The hexahedron is split, as the others.
MIXED = """*NODE
1,0,0,0
2,1,0,0
3,1,1,0
4,0,1,0
5,0,0,1
6,1,0,1
7,1,1,1
8,0,1,1
9,2,0.5,0.5
10,.5,1.5,1.5
11,0,0,9
*ELEMENT,TYPE=C3D8,ELSET=BLOCK
1,1,2,3,4,5,6,7,8
*ELEMENT,TYPE=C3D5,ELSET=PYR
2,2,3,7,6,9
*ELEMENT,TYPE=C3D4,ELSET=TET
3,5,6,8,10
*ELSET,ELSET=ENDS
2,3
*ELSET,ELSET=ALL
1,2,3
"""
VOLUMES = {"BLOCK": 1, "PYR": 1 / 3, "TET": 1 / 12, "ENDS": 5 / 12, "ALL": 17 / 12}


class FiguresTest(InFolder):
    def test_blocks_of_all_kinds_of_cells_and_sets_that_overlap_have_their_volumes(self):
        (self.folder / "mixed.inp").write_text(MIXED)
        info = self.run_ok("info", "mixed.inp", "--json").json()
        cells = {one["name"]: one["cells"] for one in info["blocks"]}
        self.assertEqual(cells["ENDS"], cells["PYR"] + cells["TET"])
        self.assertEqual(cells["ALL"], info["cells"])
        self.assertEqual({one["name"]: one["elements"] for one in info["blocks"]}, {"BLOCK": 1, "PYR": 1, "TET": 1, "ENDS": 2, "ALL": 3})
        for kind in "blocks", "sets":
            self.assertEqual({one["name"] for one in info[kind]}, set(VOLUMES))
            for one in info[kind]:
                self.assertAlmostEqual(one["volume"], VOLUMES[one["name"]], delta=1e-12)
        self.assertIn(f"PYR ({cells['PYR']}, volume 0.333333)", self.run_ok("info", "mixed.inp").out)
        for more in [], ["--only", "box:-9,-9,-9,9,9,9"], ["--only", "set:ALL"]:
            with self.subTest(more):
                done = self.run_ok("probe", "mixed.inp", "--stats", "--density", "x", "--scheme", "linear", "--json", *more).json()
                parts = {part["name"]: part for part in done["stats"]["parts"]}
                self.assertEqual({name: part["cells"] for name, part in parts.items()}, cells)
                self.assertEqual(done["warnings"], [w for w in done["warnings"] if "block" not in w])
                for name, part in parts.items():
                    self.assertAlmostEqual(part["volume"], VOLUMES[name], delta=1e-6, msg=name)
                    self.assertAlmostEqual(part["file_volume"], VOLUMES[name], delta=1e-6, msg=name)
                # The centroid of a pyramid is a quarter of its height above its base.
                self.assertAlmostEqual(parts["PYR"]["fields"][0]["mean"], 1.25, delta=1e-6)
                self.assertAlmostEqual(parts["BLOCK"]["fields"][0]["mean"], .5, delta=1e-6)
        text = self.run_ok("probe", "mixed.inp", "--stats", "--density", "1").out
        self.assertIn(f"part     PYR ({cells['PYR']} cells)", text)

    def test_cells_of_no_block_are_a_part_of_their_own(self):
        (self.folder / "some.inp").write_text(MIXED.replace(",ELSET=PYR", "").replace("*ELSET,ELSET=ALL\n1,2,3\n", "")
                                              .replace("ENDS\n2,3", "ENDS\n3"))
        stats = self.run_ok("probe", "some.inp", "--stats", "--density", "1", "--scheme", "linear", "--json").json()["stats"]
        self.assertEqual([part["name"] for part in stats["parts"]][-1], "(others)")
        self.assertAlmostEqual(stats["parts"][-1]["volume"], 1 / 3, delta=1e-12)


class InTheWholeTest(InFolder):
    """Half of a ball, by cells: by symmetry half of all that is measured of the ball, although the half alone has another limit."""

    HALF = "--only", "where:x>0", "--density", "y*y"

    def test_what_is_left_is_measured_in_the_limit_of_the_whole(self):
        whole = self.run_ok("probe", "model:ball:6", "--stats", "--density", "y*y", "--json").json()["stats"]["whole"]
        part = self.run_ok("probe", "model:ball:6", "--stats", *self.HALF, "--json").json()["stats"]["whole"]
        # Both are within 1e-4 of their volumes.
        self.assertAlmostEqual(part["volume"], whole["volume"] / 2, delta=2e-4 * whole["volume"])
        self.assertAlmostEqual(part["fields"][0]["mean"], whole["fields"][0]["mean"], delta=2e-4)
        lower = self.run_ok("probe", "model:ball:6", "--stats", *self.HALF, "--only", "half:0,0,0,0,0,-1", "--json").json()["stats"]["whole"]
        self.assertAlmostEqual(lower["volume"], whole["volume"] / 4, delta=2e-4 * whole["volume"])

    def test_surfaces_and_slices_end_where_the_cells_end(self):
        # Half of the ball's boundary, and a disk: the triangles lie within 1e-3 of 2 of the limit, which is round to 1e-3.
        found = self.run_ok("surface", "model:ball:6", "-o", "a.stl", "--boundary", *self.HALF, "--json").json()
        self.assertTrue(found["watertight"])
        self.assertAlmostEqual(found["area"], 3 * math.pi, delta=.02)
        self.assertAlmostEqual(found["volume"], 2 * math.pi / 3, delta=.01)
        plane = "--plane", "0,0,.3,0,0,1", "--resolution", 200
        whole, part = (self.run_ok("slice", "model:ball:6", "-o", "a.csv", *plane, *asked, "--json").json()
                       for asked in (["--density", "y*y"], self.HALF))
        area = [one["inside"] * one["step"]**2 for one in (whole, part)]
        self.assertAlmostEqual(area[1], area[0] / 2, delta=.03)  # a row of places
        self.assertAlmostEqual(part["max"], whole["max"], delta=1e-3)

    def test_a_place_where_the_part_ends_is_in_it(self):
        found = self.run_ok("probe", "model:ball:6", "--at", "0,.2,.1", "--at", "-.1,.2,.1", "--at", ".1,.2,.1", *self.HALF[:2], "--density", "x+10*y", "--json").json()
        self.assertEqual([value["inside"] for value in found["values"]], [True, False, True])
        self.assertAlmostEqual(found["values"][0]["value"], 2, delta=1e-6)


# A bar of 2 x 2 x 6 unit cubes as CalculiX has it: a deck with sets and the loaded end, and results without.
END = [n for n in range(len(BAR_CELLS)) if all(BAR_POINTS[p][2] == 6 for p in BAR_CELLS[n][4:])]
DECK = (bar_inp(range(len(BAR_CELLS))) + "*SURFACE, NAME=load, TYPE=ELEMENT\n" + "".join(f"{n + 1}, S2\n" for n in END))


def results(points=BAR_POINTS, cells=BAR_CELLS, first=1):
    """A result S = 2 + z at the nodes. first: the number of the first element"""
    lines = ["    1C", f"    2C                  {len(points):12d}                                     1"]
    lines += [f" -1{i + 1:10d}" + "".join(f"{x:12.5E}" for x in p) for i, p in enumerate(points)] + [" -3"]
    lines += [f"    3C                  {len(cells):12d}                                     1"]
    for n, cell in enumerate(cells):
        lines += [f" -1{n + first:10d}    1    0    1", " -2" + "".join(f"{p + 1:10d}" for p in cell)]
    lines += [" -3", f"  100CL  101{1:12.5E}{len(points):12d}                     0    1           1", " -4  S           1    1",
              " -5  S           1    1    0    0"]
    lines += [f" -1{i + 1:10d}{2 + p[2]:12.5E}" for i, p in enumerate(points)] + [" -3", " 9999"]
    return "\n".join(lines) + "\n"


class DeckTest(InFolder):
    def setUp(self):
        super().setUp()
        (self.folder / "bar.inp").write_text(DECK)
        (self.folder / "bar.frd").write_text(results())

    def run_fails(self, *arguments):
        return subvol(*arguments, folder=self.folder)

    def test_sets_and_surfaces_of_the_deck_are_those_of_the_results(self):
        deck = self.run_ok("info", "bar.inp", "--json").json()
        info = self.run_ok("info", "bar.frd", "--mesh", "bar.inp", "--json").json()
        for key in "blocks", "sets", "patches":
            self.assertEqual(info[key], deck[key])
        self.assertEqual(info["patches"], [{"name": "load", "faces": 4}])
        self.assertEqual(self.run_ok("info", "bar.frd", "--json").json()["sets"], [])
        [patch] = self.run_ok("probe", "bar.frd", "--mesh", "bar.inp", "--patch", "load", "--flux", "vector(0,0,S)", "--json").json()["patches"]
        self.assertAlmostEqual(patch["area"], 4, delta=1e-9)
        self.assertAlmostEqual(patch["flux"], 4 * 8, delta=1e-6)  # S is 8 at the end
        parts = self.run_ok("probe", "bar.frd", "--mesh", "bar.inp", "--stats", "--field", "S", "--json").json()["stats"]["parts"]
        upper = next(part for part in parts if part["name"] == "upper")
        self.assertAlmostEqual(upper["fields"][0]["mean"], 2 + 4.5, delta=1e-6)

    def test_a_deck_of_something_else_is_refused(self):
        moved = [(x + (i == 5), y, z) for i, (x, y, z) in enumerate(BAR_POINTS)]
        for text, words in ((results(points=moved), "node 6 lies elsewhere"), (results(first=100), "none of its elements"),
                            (results(cells=BAR_CELLS[:1] + BAR_CELLS[2:3] + BAR_CELLS[2:]), "element 2 has other nodes")):
            (self.folder / "other.frd").write_text(text)
            refused = self.run_fails("info", "other.frd", "--mesh", "bar.inp")
            self.assertIn(words, refused.err)
            self.assertEqual(refused.code, 2)
        (self.folder / "few.frd").write_text(results(cells=BAR_CELLS[:20]))
        self.assertIn("4 of 24 elements of the deck are not in the results", self.run_ok("info", "few.frd", "--mesh", "bar.inp").err)
        for mesh, deck, words in (("bar.inp", "bar.inp", "have their own sets and patches"), ("bar.frd", "none.inp", "none.inp"),
                                  ("bar.frd", "bar.frd", "bar.frd")):
            self.assertIn(words, self.run_fails("info", mesh, "--mesh", deck).err)


if __name__ == "__main__":
    unittest.main()
