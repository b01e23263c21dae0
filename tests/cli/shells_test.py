# SPDX-License-Identifier: Apache-2.0
"""Shells and beams beside hexahedra, through the whole command."""

import unittest
from pathlib import Path

from command import InFolder, subvol

TOP = Path(__file__).resolve().parents[2]
BRACKET = TOP / "docs/schemes/bracket.vtk"  # 48 hexahedra, 12 quads, 5 lines
VIEW = ["--size", "96x72", "--camera", "12,-9,8,3.5,2,1.8,0,0,1,35", "--backend", "cpu"]


def without_sheets():
    """The text of the same file with the hexahedra alone."""
    lines = BRACKET.read_text().splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith("CELLS"))
    types = next(i for i, line in enumerate(lines) if line.startswith("CELL_TYPES"))
    data = next(i for i, line in enumerate(lines) if line.startswith("POINT_DATA"))
    hexes = [line for line in lines[at + 1:types] if line.startswith("8 ")]
    kept = lines[:at] + [f"CELLS {len(hexes)} {9 * len(hexes)}"] + hexes
    return "\n".join(kept + [f"CELL_TYPES {len(hexes)}"] + ["12"] * len(hexes) + lines[data:]) + "\n"


class Sheets(InFolder):
    def setUp(self):
        super().setUp()
        (self.folder / "with.vtk").write_bytes(BRACKET.read_bytes())
        (self.folder / "without.vtk").write_text(without_sheets())

    def json(self, *arguments):
        return self.run_ok(*arguments, "--json").json()

    def bytes_of(self, name):
        return (self.folder / name).read_bytes()

    def test_info_counts_them(self):
        told = self.json("info", "with.vtk")
        self.assertEqual(told["sheets"], {"quads": 12, "lines": 5, "points": 25, "attached_points": 6, "free_edges": 10,
                                          "nonmanifold_edges": 0})
        self.assertEqual(told["warnings"], [])
        self.assertNotIn("sheets", self.json("info", "without.vtk"))
        self.assertIn("12 quads, 5 beams", self.run_ok("info", "with.vtk").err + self.run_ok("info", "with.vtk").out)

    def test_the_volume_is_the_same_to_the_bit(self):
        for verb, name, options in ("points", "a.ply", []), ("vdb", "a.vdb", ["--resolution", 24]), ("points", "a.vtp", []):
            for kind in "with", "without":
                done = self.run_ok(verb, f"{kind}.vtk", "-o", f"{kind}.{name}", *options)
                self.assertEqual("12 quads and 5 lines of shells and beams left out" in done.err, kind == "with", done.err)
            if verb == "points":
                self.assertEqual(self.bytes_of(f"with.{name}"), self.bytes_of(f"without.{name}"))
            else:
                hashes = [self.json("info", f"{kind}.{name}")["grids"][0]["hash"] for kind in ("with", "without")]
                self.assertEqual(*hashes)

    def test_subdivide_writes_them_beside_the_cells(self):
        for scheme in "mcq", "cc":
            told = self.json("subdivide", "with.vtk", "-o", "fine.vtu", "--levels", 2, "--scheme", scheme)
            self.assertEqual((told["cells"], told["quads"], told["lines"]), (48 * 64, 12 * 16, 5 * 4))
            again = self.json("info", "fine.vtu")
            self.assertEqual((again["cells"], again["sheets"]["quads"], again["sheets"]["lines"]), (48 * 64, 12 * 16, 5 * 4))
            # Four edges of the block, and the rod's foot.
            self.assertEqual(again["sheets"]["attached_points"], 4 * 4 + 1 + 1)
            self.run_ok("subdivide", "without.vtk", "-o", "alone.vtu", "--levels", 2, "--scheme", scheme)
            alone = self.json("info", "alone.vtu")
            self.assertEqual(alone["volume"], again["volume"])
        self.assertIn("shells and beams are written to .vtu only", self.run_ok("subdivide", "with.vtk", "-o", "fine.mesh").err)

    def test_surface_writes_the_shells_after_the_boundary(self):
        told = self.json("surface", "with.vtk", "-o", "skin.ply", "--boundary", "--color-field", "load")
        alone = self.json("surface", "without.vtk", "-o", "alone.ply", "--boundary", "--color-field", "load")
        self.assertEqual(told["sheet_triangles"], 2 * 12 * 4 ** max(3, told["level"]))
        self.assertEqual(told["triangles"], alone["triangles"] + told["sheet_triangles"])
        self.assertEqual((told["area"], told["watertight"]), (alone["area"], True))

    def test_shares_of_a_surface_have_no_shells(self):
        done = subvol("surface", "with.vtk", "-o", "a.svshare", "--boundary", "--part", "1/2", folder=self.folder)
        self.assertEqual(done.code, 2)
        self.assertIn("shells are written with the whole surface", done.err)

    def test_every_method_draws_them(self):
        for method in "splat", "dense", "tets":
            self.run_ok("render", "with.vtk", "-o", "with.png", "--method", method, *(VIEW if method == "splat" else VIEW[:-2]))
            self.run_ok("render", "without.vtk", "-o", "without.png", "--method", method, *(VIEW if method == "splat" else VIEW[:-2]))
            told = self.run_ok("compare", "with.png", "without.png", "--json").json()
            self.assertGreater(told["max"], .3, method)  # the fin is there
            self.assertLess(told["rmse"], .5, method)    # and so is the block
        self.run_ok("render", "with.vtk", "-o", "with.png", "--edges", "--look", "volume", "--scheme", "cc", *VIEW)

    def test_shells_behind_the_eye_hide_nothing(self):
        points = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)] + [(-2, -2, 3), (3, -2, 3), (3, 3, 3.8), (-2, 3, 3.8)]
        text = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 double\n"
        text += "\n".join(" ".join(map(str, p)) for p in points)
        hexahedron, quad = "8 0 1 3 2 4 5 7 6", "4 8 9 10 11"
        (self.folder / "both.vtk").write_text(f"{text}\nCELLS 2 14\n{hexahedron}\n{quad}\nCELL_TYPES 2\n12\n9\n")
        (self.folder / "cube.vtk").write_text(f"{text}\nCELLS 1 9\n{hexahedron}\nCELL_TYPES 1\n12\n")
        for rays in "0,0,1,0,40", "0,0,1,0,40,3":  # apart and parallel, from z = 2 down
            camera = ["--size", "48x48", "--camera", ".5,.5,2,.5,.5," + rays]
            for options in [], ["--method", "tets"], ["--edges"]:
                for name in "both", "cube":
                    self.run_ok("render", f"{name}.vtk", "-o", f"{name}.png", *camera, *options)
                self.assertEqual(self.bytes_of("both.png"), self.bytes_of("cube.png"), (rays, options))
            self.run_ok("render", "both.vtk", "-o", "above.png", "--size", "48x48", "--camera", ".5,.5,4,.5,.5," + rays)
            self.assertNotEqual(self.bytes_of("above.png"), self.bytes_of("cube.png"))

    def test_sheets_alone_are_drawn_and_counted(self):
        text = (TOP / "docs/schemes/bracket.vtk").read_text().splitlines()
        at = next(i for i, line in enumerate(text) if line.startswith("CELLS"))
        data = next(i for i, line in enumerate(text) if line.startswith("POINT_DATA"))
        flat = [line for line in text[at:data] if line.startswith(("4 ", "2 "))]
        kept = text[:at] + [f"CELLS {len(flat)} {12 * 5 + 5 * 3}", *flat, f"CELL_TYPES {len(flat)}"]
        (self.folder / "flat.vtk").write_text("\n".join(kept + ["9"] * 12 + ["3"] * 5 + text[data:]) + "\n")
        told = self.json("info", "flat.vtk")
        self.assertEqual((told["cells"], told["sheets"]["quads"], told["sheets"]["attached_points"]), (0, 12, 0))
        for options in [], ["--method", "dense", "--look", "volume"], ["--edges", "--views", "4"]:
            done = self.run_ok("render", "flat.vtk", "-o", "flat.png", "--size", "96x72", *options)
            self.assertNotIn("blank", done.err)
        self.run_ok("render", "without.vtk", "-o", "without.png", "--size", "96x72", "--views", 4)
        self.assertGreater(self.run_ok("compare", "flat.png", "without.png", "--json").json()["rmse"], .05)
        for verb in ["vdb", "-o", "a.vdb"], ["points", "-o", "a.ply"], ["subdivide", "-o", "a.vtu"], ["surface", "-o", "a.ply"]:
            done = subvol(verb[0], "flat.vtk", *verb[1:], folder=self.folder)
            self.assertEqual(done.code, 2)
            self.assertIn("no hexahedra, but 5 lines (VTK type 3), 12 quads (VTK type 9)", done.err)


if __name__ == "__main__":
    unittest.main()
