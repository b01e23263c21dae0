# SPDX-License-Identifier: Apache-2.0
"""Values at cells: as they are, in files that are written, and beside walls."""

import random
import unittest

from command import InFolder
from patches_test import write_foam

SIZE = (4, 3, 2)


def write_box(path, arrays):
    """A box of unit cells in legacy VTK. arrays: (name, type, one value for each cell)"""
    nx, ny, nz = SIZE
    points = [(x, y, z) for z in range(nz + 1) for y in range(ny + 1) for x in range(nx + 1)]
    number = {p: i for i, p in enumerate(points)}
    around = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = [[number[x + i, y + j, z + k] for i, j, k in around] for z in range(nz) for y in range(ny) for x in range(nx)]
    lines = ["# vtk DataFile Version 3.0", "box", "ASCII", "DATASET UNSTRUCTURED_GRID", f"POINTS {len(points)} double"]
    lines += [" ".join(map(str, p)) for p in points]
    lines += [f"CELLS {len(cells)} {9 * len(cells)}"] + ["8 " + " ".join(map(str, c)) for c in cells]
    lines += [f"CELL_TYPES {len(cells)}"] + ["12"] * len(cells) + [f"CELL_DATA {len(cells)}"]
    for name, kind, values in arrays:
        lines += [f"SCALARS {name} {kind} 1", "LOOKUP_TABLE default"] + [repr(v) for v in values]
    path.write_text("\n".join(lines) + "\n")
    return [tuple(x + .5 for x in points[c[0]]) for c in cells]


class Cells(InFolder):
    """A box of 24 cells of volume 1 with numbers by chance."""

    def setUp(self):
        super().setUp()
        numbers = random.Random(7)
        self.heat = [numbers.uniform(-3, 5) for _ in range(24)]
        self.material = [numbers.choice((1, 2, 7)) for _ in range(24)]
        self.centres = write_box(self.folder / "box.vtk", [("heat", "double", self.heat), ("material", "int", self.material)])

    def stats(self, name, field, *more):
        return self.run_ok("probe", name, "--stats", "--field", field, "--json", *more).json()["stats"]["whole"]["fields"][0]

    def at(self, place, field, *more):
        found = self.run_ok("probe", "box.vtk", "--at", ",".join(map(str, place)), "--field", field, "--json", *more).json()
        return found["values"][0]["value"]

    def test_statistics_are_those_of_the_cells(self):
        for field, of_cells in (("heat", self.heat), ("heat^2", [v * v for v in self.heat])):
            found = self.stats("box.vtk", field, "--cell-values", "constant")
            self.assertAlmostEqual(found["mean"], sum(of_cells) / 24, 12)
            self.assertAlmostEqual(found["integral"], sum(of_cells), 10)
            self.assertAlmostEqual(found["min"], min(of_cells), 12)
            self.assertAlmostEqual(found["max"], max(of_cells), 12)
        self.assertNotAlmostEqual(self.at(self.centres[5], "heat"), self.heat[5], 3)  # between means at points

    def test_labels_at_points_are_never_mixed(self):
        """Materials at points: 1 for x <= 2, else 5. The cells at x = 2 to 3 have four points of each."""
        text = (self.folder / "box.vtk").read_text()
        nx, ny, nz = SIZE
        of_points = [1 if x <= 2 else 5 for _ in range((ny + 1) * (nz + 1)) for x in range(nx + 1)]
        (self.folder / "points.vtk").write_text(
            text + f"POINT_DATA {len(of_points)}\nSCALARS MaterialId int 1\nLOOKUP_TABLE default\n" + "\n".join(map(str, of_points)) +
            "\nSCALARS grey int 1\nLOOKUP_TABLE default\n" + "\n".join(map(str, of_points)) + "\n")
        done = self.run_ok("probe", "points.vtk", "--stats", "--field", "MaterialId")
        self.assertEqual(done.err.count('point array "MaterialId" numbers things: each cell has the number of most of its points'), 1)
        found = self.stats("points.vtk", "MaterialId")
        # Of as many points the least number counts: three layers of 1, one of 5.
        self.assertAlmostEqual(found["mean"], (3 * 1 + 1 * 5) / 4, 12)
        self.assertEqual((found["min"], found["max"], found["file_min"], found["file_max"]), (1, 5, 1, 5))
        line = self.run_ok("probe", "points.vtk", "--line", "0,1.3,.7,4,1.3,.7", "--count", "41", "--field", "MaterialId", "--json").json()["values"]
        self.assertEqual({one["value"] for one in line}, {1, 5})
        grid = self.run_ok("vdb", "points.vtk", "-o", "a.vdb", "--field", "MaterialId", "--voxel-size", ".25", "--json").json()["grids"][0]
        self.assertEqual((grid["min"], grid["max"]), (1, 5))
        for x, label in ((.1, 1), (1.9, 1), (2.6, 1), (3.4, 5)):
            at = self.run_ok("info", "a.vdb", "--at", f"{x},1.1,.6", "--json").json()["at"][0]
            self.assertAlmostEqual(at["value"], label, 12)  # weights of voxels add up to 1 but for rounding
        # Integers that are measured stay smooth, and so do labels where that is asked for.
        self.assertNotIn(self.at_points_of("points.vtk", "grey"), (1, 5))
        self.assertNotIn(self.at_points_of("points.vtk", "MaterialId", "--cell-values", "mean"), (1, 5))

    def at_points_of(self, name, field, *more):
        found = self.run_ok("probe", name, "--at", "2.5,1.3,.7", "--field", field, "--json", *more).json()
        return found["values"][0]["value"]

    def test_integers_are_constant_by_themselves(self):
        done = self.run_ok("probe", "box.vtk", "--stats", "--field", "material")
        self.assertEqual(done.err.count('cell array "material" has whole numbers, constant in each cell'), 1)
        found = self.stats("box.vtk", "material")
        self.assertAlmostEqual(found["mean"], sum(self.material) / 24, 12)
        self.assertEqual((found["min"], found["max"]), (1, 7))
        self.assertNotIn("whole numbers", self.run_ok("probe", "box.vtk", "--stats", "--cell-values", "constant").err)
        at = [self.at(centre, "material", "--cell-values", "mean") for centre in self.centres[:4]]
        self.assertTrue(any(abs(value - round(value)) > .01 for value in at))

    def test_places_slices_and_voxels_have_them(self):
        for (x, y, z), value in list(zip(self.centres, self.heat))[::5]:
            self.assertAlmostEqual(self.at((x + .3, y - .4, z + .2), "heat", "--cell-values", "constant"), value, 12)
        layer = self.run_ok("slice", "box.vtk", "-o", "a.png", "--plane", "2,1.5,.5,0,0,1", "--field", "heat", "--cell-values", "constant",
                            "--extremes", "--json").json()
        self.assertAlmostEqual(layer["min"], min(self.heat[:12]), 12)
        self.assertAlmostEqual(layer["max"], max(self.heat[:12]), 12)
        self.run_ok("vdb", "box.vtk", "-o", "a.vdb", "--field", "heat", "--cell-values", "constant", "--voxel-size", ".125")
        grid = self.run_ok("info", "a.vdb", "--json").json()["grids"][0]
        self.assertAlmostEqual(grid["min"], min(self.heat), 5)  # 32-bit floats
        self.assertAlmostEqual(grid["max"], max(self.heat), 5)

    def test_written_files_have_them_at_their_cells(self):
        for name in ("fine.vtu", "fine.vtkhdf"):
            for levels in (0, 1):
                done = self.run_ok("subdivide", "box.vtk", "-o", name, "--levels", levels)
                self.assertIn("at cells", done.err)
                fields = {f["name"]: f for f in self.run_ok("info", name, "--json").json()["fields"]}
                self.assertEqual({f["location"] for f in fields.values()}, {"cell"})
                self.assertEqual((fields["heat"]["min"], fields["heat"]["max"]), (min(self.heat), max(self.heat)))
                found = self.stats(name, "heat", "--cell-values", "constant")
                self.assertAlmostEqual(found["integral"], sum(self.heat), 10)  # each parent keeps its own
                self.assertAlmostEqual(self.stats(name, "material")["mean"], sum(self.material) / 24, 12)


class Walls(InFolder):
    """A bar of one cell's width in which a flow of speed 2 passes walls at rest, half a cell from its middle."""

    def test_the_shear_is_that_of_the_first_cells(self):
        write_foam(self.folder / "case")
        file = self.folder / "case" / "0" / "U"
        boundary = "left { type zeroGradient; } right { type zeroGradient; } walls { type noSlip; }"
        file.write_text(file.read_text().replace("boundaryField {}", f"boundaryField {{ {boundary} }}"))
        for use in ("normal", "meet"):
            found = self.run_ok("probe", "case", "--patch", "walls", "--flux", "grad(U.x)", "--patch-values", use, "--json").json()
            patch = found["patches"][0]
            # 2 / .5 on each of the four sides. All points lie at edges between two of them: there it is between that and 1 / sqrt(2) of
            # it, the geometric mean. A hundredth is left of the other wall's.
            self.assertAlmostEqual(patch["flux"] / patch["area"] / -4, 2 ** -.25, delta=.02)
        ignored = self.run_ok("probe", "case", "--patch", "walls", "--flux", "grad(U.x)", "--patch-values", "ignore", "--json").json()
        self.assertAlmostEqual(ignored["patches"][0]["flux"], 0, 9)


if __name__ == "__main__":
    unittest.main()
