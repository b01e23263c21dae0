# SPDX-License-Identifier: Apache-2.0
"""Meshes of tetrahedra refined as tetrahedra: --scheme tetoct and boxspline."""

import shlex
import unittest
from itertools import permutations

from command import CUBE, InFolder, subvol, on_cpu

SIDE = 3


def box_of_tetrahedra(side):
    """A box of side³ cubes, each in six tetrahedra along its diagonal; MEDIT counts from 1."""
    number = lambda x, y, z: 1 + x + (side + 1) * (y + (side + 1) * z)
    sides = range(side + 1)
    points = [f"{x} {y} {z} 0" for z in sides for y in sides for x in sides]
    cells = []
    for x in range(side):
        for y in range(side):
            for z in range(side):
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
        (self.folder / "box.mesh").write_text(box_of_tetrahedra(SIDE))
        (self.folder / "small.mesh").write_text(box_of_tetrahedra(1))
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

    # In all products the volume is that of level 2, linear between its vertices.
    def test_places_have_the_values_of_the_other_products(self):
        for scheme in ("tetoct", "boxspline"):
            asked = ("--scheme", scheme, "--density", "sin(2*x)*y+z*z")
            self.run_ok("vdb", "box.mesh", "-o", "box.vdb", "--resolution", 24, *asked)
            places = [(x, y, z) for x in (.25, 1.125, 2.625) for y in (.375, 1.625) for z in (.875, 2.125)]  # of voxels
            at = [word for place in places for word in ("--at", ",".join(map(str, place)))]
            voxels = self.run_ok("info", "box.vdb", *at, "--json").json()["at"]
            probed = self.run_ok("probe", "box.mesh", *at, *asked, "--json").json()
            for place, voxel, here in zip(places, voxels, probed["values"]):
                self.assertTrue(here["inside"])
                self.assertAlmostEqual(here["value"], voxel["value"], delta=.01)  # the grid is off by up to 1e-3 of the range of 13
                self.assertIsNone(here["parameters"])
                # The tetrahedra of a cube follow each other.
                x, y, z = map(int, place)
                self.assertEqual(here["cell"] // 6, z + SIDE * (y + SIDE * x))
            outside = self.run_ok("probe", "box.mesh", "--at", "3.1,1,1", *asked, "--json").json()["values"][0]
            self.assertEqual((outside["inside"], outside["value"], outside["cell"]), (False, None, None))

    def test_gradients_of_linear_fields_are_theirs(self):
        asked = ("--scheme", "tetoct", "--density", "2*x-y+3*z")
        probed = self.run_ok("probe", "box.mesh", "--line", "0,.1,.2,3,2.8,2.9", "--count", 40, "-o", "line.csv", *asked,
                             "--json").json()
        for here in probed["values"]:
            x, y, z = here["at"]
            self.assertAlmostEqual(here["value"], 2 * x - y + 3 * z, delta=1e-5)
            for got, right in zip(here["gradient"], (2, -1, 3)):
                self.assertAlmostEqual(got, right, delta=1e-5)
        rows = (self.folder / "line.csv").read_text().splitlines()
        self.assertEqual(len({row.count(",") for row in rows}), 1)
        stats = self.run_ok("probe", "box.mesh", "--stats", *asked, "--json").json()["stats"]["whole"]
        self.assertEqual(stats["cells"], 6 * SIDE ** 3)
        self.assertAlmostEqual(stats["volume"], SIDE ** 3, delta=1e-6)
        self.assertAlmostEqual(stats["fields"][0]["max"], 5 * SIDE, delta=1e-4)
        self.assertLess(stats["fields"][0]["max_cell"], 6 * SIDE ** 3)

    def test_levels_say_how_exact_the_probed_volume_is(self):
        asked = ("probe", "box.mesh", "--line", ".1,.2,.3,2.9,2.7,2.2", "--count", 50, "--scheme", "tetoct", "--density",
                 "sin(2*x)*y+z*z", "--json")
        values = [[here["value"] for here in self.run_ok(*asked, "--levels", level).json()["values"]] for level in (0, 1, 2)]
        off = lambda level: sum((a - b) ** 2 for a, b in zip(values[level], values[2]))
        self.assertLess(off(1), off(0) / 6)  # 1/16, as the error is that of h²
        self.refused("--levels", "probe", "box.mesh", "--at", "1,1,1", "--levels", 2)

    def test_info_has_the_figures_of_the_refined_cells(self):
        cells = 6 * SIDE ** 3
        done = self.run_ok("info", "box.mesh", "--scheme", "tetoct", "--json").json()
        refined = done["refined"]
        self.assertEqual((refined["control_cells"], refined["levels"]), (cells, 2))
        self.assertEqual((refined["tets"], refined["octahedra"]), (24 * cells, 10 * cells))
        self.assertEqual(refined["inverted_cells"], 0)
        self.assertAlmostEqual(refined["volume"], SIDE ** 3, delta=1e-6)
        self.assertEqual(done["cells"], 4 * cells)  # those of the mesh stay what they were
        said = self.run_ok("info", "box.mesh", "--scheme", "boxspline", "--levels", 1).out
        self.assertIn("boxspline", said)
        self.assertIn("level 1", said)
        self.refused("tetoct", "info", "box.mesh", "--scheme", "cc")
        self.refused("--scheme", "info", "box.mesh", "--scheme", "tetoct", "--list-fields")

    def test_a_page_has_a_kernel_at_each_point(self):
        done = self.run_ok("page", "box.mesh", "-o", "box.html", "--scheme", "tetoct", "--density", "x*y", "--no-reference",
                           "--json").json()
        self.assertEqual(done["points"], (2 * SIDE + 1) ** 3)

    def test_rays_go_through_the_tetrahedra_themselves(self):
        done = self.run_ok("render", "box.mesh", "-o", "box.png", "--method", "tets", "--scheme", "tetoct", "--size", "64x64",
                           "--json").json()
        self.assertEqual(done["tets"], 64 * 6 * SIDE ** 3)  # of level 2, with four in each octahedron
        self.assertEqual((done["inverted_tets"], done["lost_rays"]), (0, 0))

    # Levels are 1 for kernels and 2 for tetrahedra, also after another method was chosen.
    def test_a_session_shows_the_pictures_of_render(self):
        small = ("--size", "64x48", "--density", "sin(2*x)*y+z*z", "--quiet")
        (self.folder / "other.json").write_text('[{"method": "tets"}, {"wait": true}, {"clip": [[1, 1, 1, 1, 0, 0]]}]')
        (self.folder / "pick.json").write_text('[{"pick": [32, 24]}]')
        for scheme in ("tetoct", "boxspline"):
            for options in ([], ["--look", "volume", "--levels", "2"], ["--edges"], ["--method", "tets", "--axes"], ["--method", "dense"]):
                asked = ("small.mesh" if "dense" in options else "box.mesh", "--scheme", scheme, *options, *on_cpu(options), *small)
                self.run_ok("view", *asked, "--screenshot", "view.png")
                self.run_ok("render", *asked, "-o", "render.png")
                self.assertEqual((self.folder / "view.png").read_bytes(), (self.folder / "render.png").read_bytes(), asked)
            asked = ("view", "box.mesh", "--scheme", scheme, *small[:-1], "--screenshot", "view.png", "--json", "--script")
            done = self.run_ok(*asked, "other.json").json()
            self.run_ok(*shlex.split(done["render"])[1:], "--quiet")
            self.assertEqual((self.folder / "view.png").read_bytes(), (self.folder / "picture.png").read_bytes(), done["render"])
            x, y, z = (picked := self.run_ok(*asked, "pick.json").json()["picked"])["at"]
            probed = self.run_ok("probe", "box.mesh", "--at", f"{x},{y},{z}", "--scheme", scheme, "--levels", 1, *small[2:4],
                                 "--json").json()["values"][0]
            self.assertAlmostEqual(picked["value"], probed["value"], delta=.05)  # cells of level 1 have other diagonals

    def test_a_session_does_not_edit_them(self):
        for action in ('{"select": "all"}', '{"edit_level": 1}', '{"save_mesh": "a.vtu"}'):
            (self.folder / "edit.json").write_text(f"[{action}]")
            self.refused("no control points to edit", "view", "box.mesh", "--scheme", "tetoct", "--script", "edit.json")
        self.refused("--per-edge", "view", "box.mesh", "--scheme", "tetoct", "--per-edge", 2, "--screenshot", "a.png")

    def test_hexahedra_are_refined_too(self):
        done = self.run_ok("subdivide", "cube.mesh", "-o", "fine.vtu", "--scheme", "tetoct", "--json").json()
        self.assertEqual((done["cells"], done["tets"]), (8, 0))
        done = self.run_ok("subdivide", "cube.mesh", "-o", "fine.vtu", "--scheme", "boxspline", "--json").json()
        self.assertEqual((done["control_cells"], done["tets"], done["octahedra"]), (6, 24, 6))

    def test_what_cannot_be_done_is_said_in_one_sentence(self):
        self.refused("--levels", "points", "box.mesh", "-o", "a.ply", "--scheme", "tetoct", "--per-edge", 2)
        self.refused(".vtu", "subdivide", "box.mesh", "-o", "a.mesh", "--scheme", "boxspline")
        self.refused("levels", "subdivide", "box.mesh", "-o", "a.vtu", "--scheme", "boxspline", "--levels", 9)
        self.refused("tetoctt", "subdivide", "box.mesh", "-o", "a.vtu", "--scheme", "tetoctt")


if __name__ == "__main__":
    unittest.main()
