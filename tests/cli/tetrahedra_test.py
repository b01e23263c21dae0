# SPDX-License-Identifier: Apache-2.0
"""Meshes of tetrahedra refined as tetrahedra: --scheme tetoct and boxspline."""

import unittest
from itertools import permutations

from command import CUBE, InFolder, subvol

SIDE = 3


def box_of_tetrahedra():
    """A box of SIDE³ cubes, each in six tetrahedra along its diagonal; MEDIT counts from 1."""
    number = lambda x, y, z: 1 + x + (SIDE + 1) * (y + (SIDE + 1) * z)
    sides = range(SIDE + 1)
    points = [f"{x} {y} {z} 0" for z in sides for y in sides for x in sides]
    cells = []
    for x in range(SIDE):
        for y in range(SIDE):
            for z in range(SIDE):
                for path in permutations(range(3)):
                    at, corners = [x, y, z], [number(x, y, z)]
                    for axis in path:
                        at[axis] += 1
                        corners.append(number(*at))
                    cells.append(" ".join(map(str, corners)) + " 0")
    return "\n".join(["MeshVersionFormatted 2", "Dimension 3", "Vertices", str(len(points)), *points, "Tetrahedra",
                      str(len(cells)), *cells, "End", ""])


class Tetrahedra(InFolder):
    def setUp(self):
        super().setUp()
        (self.folder / "box.mesh").write_text(box_of_tetrahedra())
        (self.folder / "cube.mesh").write_text(CUBE.format(last=8))

    def refused(self, part, *arguments):
        done = subvol(*arguments, "--quiet", folder=self.folder)
        self.assertEqual(done.code, 2, done.err)
        self.assertIn(part, done.err)
        self.assertEqual(len(done.err.strip().splitlines()), 1, done.err)

    def test_cells_stay_tetrahedra_and_octahedra(self):
        cells = 6 * SIDE ** 3
        for scheme in ("tetoct", "boxspline"):
            done = self.run_ok("subdivide", "box.mesh", "-o", "fine.vtu", "--scheme", scheme, "--levels", 2, "--json").json()
            self.assertEqual((done["tets"], done["octahedra"]), (24 * cells, 10 * cells))
            self.assertEqual((done["control_cells"], done["inverted_cells"]), (cells, 0))
            # VTK has no octahedra: four tetrahedra each.
            read = self.run_ok("info", "fine.vtu", "--json", "--other-cells", "split").json()
            self.assertEqual(read["cells"], 4 * (24 + 4 * 10) * cells)

    # Linear data are kept by all rules, and with sharp edges the box is kept too.
    def test_linear_fields_stay_linear_in_every_product(self):
        asked = ("--scheme", "tetoct", "--density", "2*x-y+3*z")  # right angles are sharp without --crease-angle
        done = self.run_ok("points", "box.mesh", "-o", "box.ply", "--levels", 1, *asked, "--json").json()
        self.assertEqual(done["points"], (2 * SIDE + 1) ** 3)  # those of half the spacing
        vdb = self.run_ok("vdb", "box.mesh", "-o", "box.vdb", "--resolution", 24, *asked, "--json").json()
        self.assertTrue(23 ** 3 <= vdb["active_voxels"] <= 25 ** 3, vdb)  # centres lie on the boundary
        probed = self.run_ok("info", "box.vdb", "--at", "1.5,1,2.25", "--json").json()
        self.assertAlmostEqual(probed["at"][0]["value"], 2 * 1.5 - 1 + 3 * 2.25, delta=1e-4)
        surface = self.run_ok("surface", "box.mesh", "-o", "box.stl", *asked, "--json").json()
        self.assertAlmostEqual(surface["volume"], SIDE ** 3, delta=1e-6)
        smooth = self.run_ok("surface", "box.mesh", "-o", "box.stl", *asked, "--crease-angle", 120, "--json").json()
        self.assertGreater(smooth["volume"], SIDE ** 3 + .1)  # through the corners, round in between
        for method in ("splat", "tets"):
            self.run_ok("render", "box.mesh", "-o", f"{method}.exr", "--method", method, "--size", "32x32", "--tf", "viridis",
                        *asked)
        against = self.run_ok("compare", "tets.exr", "splat.exr", "--json").json()
        self.assertLess(against["rmse"], 0.01)

    def test_hexahedra_are_refined_too(self):
        done = self.run_ok("subdivide", "cube.mesh", "-o", "fine.vtu", "--scheme", "tetoct", "--json").json()
        self.assertEqual((done["cells"], done["tets"]), (8, 0))
        done = self.run_ok("subdivide", "cube.mesh", "-o", "fine.vtu", "--scheme", "boxspline", "--json").json()
        self.assertEqual((done["control_cells"], done["tets"], done["octahedra"]), (6, 24, 6))

    def test_what_cannot_be_done_is_said_in_one_sentence(self):
        self.refused("refines tetrahedra", "probe", "box.mesh", "--at", "1,1,1", "--scheme", "tetoct")
        self.refused("--levels", "points", "box.mesh", "-o", "a.ply", "--scheme", "tetoct", "--per-edge", 2)
        self.refused(".vtu", "subdivide", "box.mesh", "-o", "a.mesh", "--scheme", "boxspline")
        self.refused("levels", "subdivide", "box.mesh", "-o", "a.vtu", "--scheme", "boxspline", "--levels", 9)
        self.refused("tetoctt", "subdivide", "box.mesh", "-o", "a.vtu", "--scheme", "tetoctt")


if __name__ == "__main__":
    unittest.main()
