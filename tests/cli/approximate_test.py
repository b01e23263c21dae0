# SPDX-License-Identifier: Apache-2.0
"""`subvol approximate`: meshes, tables and grids become fields of a control mesh."""

import unittest

from command import InFolder, subvol

FIELD = "sin(2*x)+y*z"


class Approximate(InFolder):
    def fit(self, *words):
        return self.run_ok("approximate", *words, "--json").json()

    def test_a_mesh_that_is_a_limit_is_found_again(self):
        self.run_ok("subdivide", "model:twist:4", "--density", FIELD, "-o", "fine.vtu", "--levels", "2")
        found = self.fit("fine.vtu", "--onto", "model:twist:4", "-o", "fitted.vtu")
        self.assertEqual((found["points"], found["cells"], found["outside"], found["unseen"]), (125, 64, 0, 0))
        self.assertLess(found["fields"]["density"]["max"], 1e-10)
        self.assertGreater(found["fields"]["density"]["range"], 1)
        self.run_ok("subdivide", "model:twist:4", "--density", FIELD, "-o", "same.vtu", "--levels", "0")
        same = self.run_ok("compare", "fitted.vtu", "same.vtu", "--field", "density", "--json").json()
        self.assertLess(same["linf"], 1e-6)

    def test_a_table_of_measurements(self):
        rows = [f"{x / 7},{y / 7},{z / 7},{1 + 2 * x / 7 - y / 7},{z / 7}" for x in range(8) for y in range(8) for z in range(8)]
        (self.folder / "box.vtk").write_text(box_of_cells(3))
        (self.folder / "measured.csv").write_text("\n".join(["x,y,z,T,p", *rows, "5,5,5,0,0", ""]))
        found = self.fit("measured.csv", "--onto", "box.vtk", "-o", "fitted.vtu")
        self.assertEqual((found["samples"], found["outside"]), (512, 1))
        self.assertEqual(set(found["fields"]), {"T", "p"})
        self.assertLess(found["fields"]["T"]["max"], 1e-5)  # MCQ reproduces what is linear
        at = self.run_ok("probe", "fitted.vtu", "--at", ".5,.25,.75", "--field", "T", "--json").json()
        self.assertAlmostEqual(at["values"][0]["value"], 1.75, 4)

    def test_a_grid(self):
        self.run_ok("vdb", "model:twist:8", "--density", FIELD, "-o", "grid.vdb", "--resolution", "48", "--quiet")
        coarse = self.fit("grid.vdb", "--onto", "model:twist:2", "-o", "coarse.vtu")
        finer = self.fit("grid.vdb", "--onto", "model:twist:2", "-o", "finer.vtu", "--refine", "1", "--tolerance", "1e-4")
        self.assertEqual((coarse["refined"], finer["refined"], finer["cells"]), (0, 1, 64))
        self.assertLess(finer["fields"]["density"]["rms"], .5 * coarse["fields"]["density"]["rms"])

    def test_says_what_is_wrong(self):
        (self.folder / "holes.csv").write_text("x,y,z,T\n0,0,0,1\n0,0,1,\n")
        (self.folder / "T.csv").write_text("x,y,z,T\n0,0,0,1\n")
        self.run_ok("points", "model:ball:2", "-o", "a.ply")
        (self.folder / "places.csv").write_text("x,y,z\n0,0,0\n")
        for words, part in ((["holes.csv"], "holes.csv:3: column 4 has no number here"), (["places.csv"], "places.csv: has no column of values"),
                            (["none.csv"], "none.csv"), (["T.csv", "--only", "box:0,0,0,1,1,1"], "--only: needs a mesh; this is a table"),
                            (["T.csv", "--field", "T"], "--field: needs a mesh or a grid"), (["a.ply"], "a.ply: has kernels"),
                            (["model:ball", "--warp", "density"], "model:ball: --warp"),
                            (["model:ball", "--tolerance", ".1"], "--tolerance: has no effect without --refine")):
            done = subvol("approximate", *words, "--onto", "model:ball:2", "-o", "fitted.vtu", folder=self.folder)
            self.assertEqual(done.code, 2, done.err)
            self.assertIn(part, done.err)
            self.assertNotIn("fitted.vtu", self.files())
        done = subvol("approximate", "model:ball", "--onto", "model:ball:2", "-o", "fitted.stl", folder=self.folder)
        self.assertEqual(done.code, 2, done.err)


def box_of_cells(n):
    """The unit cube as n×n×n cells, legacy VTK."""
    side = n + 1
    points = [f"{x / n} {y / n} {z / n}" for z in range(side) for y in range(side) for x in range(side)]
    corners = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    cells = [" ".join(["8", *(str((x + i) + side * ((y + j) + side * (z + k))) for i, j, k in corners)])
             for z in range(n) for y in range(n) for x in range(n)]
    return "\n".join(["# vtk DataFile Version 3.0", "box", "ASCII", "DATASET UNSTRUCTURED_GRID", f"POINTS {len(points)} double", *points,
                      f"CELLS {len(cells)} {9 * len(cells)}", *cells, f"CELL_TYPES {len(cells)}", *["12"] * len(cells), ""])


if __name__ == "__main__":
    unittest.main()
