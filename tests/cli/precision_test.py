#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Numbers far from 0 and bodies far from each other: results whose correct value is known, and what is said where floats cannot hold it."""

import csv
import math
import os
import struct
import unittest
from pathlib import Path

from command import InFolder, subvol, subvol_measured


def grid(n, place=lambda x, y, z: (x, y, z), fields=(), cell_fields=()):
    """A box of n[0] x n[1] x n[2] cells of side 1 as legacy VTK. place: moves its points; fields: (name, function of the place)."""
    places = [place(x, y, z) for z in range(n[2] + 1) for y in range(n[1] + 1) for x in range(n[0] + 1)]
    number = lambda x, y, z: x + (n[0] + 1) * (y + (n[1] + 1) * z)
    corners = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    cells = [[number(x + a, y + b, z + c) for a, b, c in corners] for z in range(n[2]) for y in range(n[1]) for x in range(n[0])]
    return mesh(places, cells, fields, cell_fields)


def mesh(places, cells, fields=(), cell_fields=()):
    lines = ["# vtk DataFile Version 3.0", "t", "ASCII", "DATASET UNSTRUCTURED_GRID", f"POINTS {len(places)} double"]
    lines += [f"{x!r} {y!r} {z!r}" for x, y, z in places]
    lines += [f"CELLS {len(cells)} {9 * len(cells)}"] + ["8 " + " ".join(map(str, cell)) for cell in cells]
    lines += [f"CELL_TYPES {len(cells)}"] + ["12"] * len(cells)
    if fields:
        lines.append(f"POINT_DATA {len(places)}")
    for name, value in fields:
        lines += [f"SCALARS {name} double 1", "LOOKUP_TABLE default"] + [repr(float(value(*place))) for place in places]
    if cell_fields:
        lines.append(f"CELL_DATA {len(cells)}")
    for name, value in cell_fields:
        centre = lambda cell: [sum(places[p][a] for p in cell) / 8 for a in range(3)]
        lines += [f"SCALARS {name} double 1", "LOOKUP_TABLE default"] + [repr(float(value(*centre(cell)))) for cell in cells]
    return "\n".join(lines) + "\n"


class Precision(InFolder):
    def write(self, name, text):
        (self.folder / name).write_text(text)

    def stats(self, name):
        found = self.run_ok("probe", name, "--stats", "--json").json()["stats"]["whole"]
        return {field["name"]: field for field in found["fields"]}


class LargeConstants(Precision):
    """A field that varies by little beside its value: floats without an origin keep few of its digits."""

    def setUp(self):
        super().setUp()
        self.write("off.vtk", grid((4, 4, 4), lambda x, y, z: (x / 4, y / 4, z / 4), (
            ("pa", lambda x, y, z: 101325 + .01 * x), ("big", lambda x, y, z: 1e8 + x), ("huge", lambda x, y, z: 1e300 * x),
            ("tiny", lambda x, y, z: 1e-300 * x))))

    def test_statistics_keep_their_digits(self):
        fields = self.stats("off.vtk")
        for name, low, range_ in (("pa", 101325, .01), ("big", 1e8, 1), ("huge", 0, 1e300), ("tiny", 0, 1e-300)):
            field = fields[name]
            self.assertAlmostEqual((field["min"] - low) / range_, 0, delta=1e-4, msg=name)
            self.assertAlmostEqual((field["max"] - low) / range_, 1, delta=1e-4, msg=name)
            self.assertAlmostEqual((field["mean"] - low) / range_, .5, delta=1e-4, msg=name)

    def test_what_the_floats_of_a_grid_lose_is_said(self):
        done = self.run_ok("vdb", "off.vtk", "-o", "a.vdb", "--field", "pa", "--resolution", 16, "--error", "--json")
        made = done.json()
        lost = made["limit_deviation"]["of_range"]
        self.assertGreater(lost, .1)
        self.assertTrue(any("pa-(101325)" in warning for warning in made["warnings"]), made["warnings"])
        made = self.run_ok("vdb", "off.vtk", "-o", "b.vdb", "--fields", "pa=pa-(101325)", "--resolution", 16, "--json").json()
        self.assertLess(made["limit_deviation"]["of_range"], 1e-3)
        self.assertFalse(any("floats" in warning for warning in made["warnings"]), made["warnings"])


class Halves(Precision):
    def setUp(self):
        super().setUp()
        self.write("half.vtk", grid((7, 3, 3), fields=(("f", lambda x, y, z: 65504 if 2 <= x <= 5 else 0),)))

    def test_values_that_do_not_fit_are_refused(self):
        done = subvol("vdb", "half.vtk", "-o", "a.vdb", "--half", "--resolution", 40, folder=self.folder)
        self.assertEqual(done.code, 2, done.err)
        self.assertIn('"f"', done.err)
        self.assertIn("16-bit", done.err)
        self.assertFalse((self.folder / "a.vdb").exists())

    def test_values_within_the_range_of_the_field_fit(self):
        made = self.run_ok("vdb", "half.vtk", "-o", "a.vdb", "--half", "--clamp", "--resolution", 40, "--json").json()
        self.assertLessEqual(made["grids"][0]["max"], 65504)
        self.run_ok("vdb", "half.vtk", "-o", "b.vdb", "--resolution", 40, "--json")


class MapCoordinates(Precision):
    def setUp(self):
        super().setUp()
        self.write("utm.vtk", grid((4, 4, 4), lambda x, y, z: (5e6 + x / 100, 4e6 + y / 100, z / 100)))

    def points_of_stl(self, name):
        data = (self.folder / name).read_bytes()
        points = set()
        for t in range(struct.unpack_from("<I", data, 80)[0]):
            for k in range(3):
                points.add(struct.unpack_from("<3f", data, 84 + 50 * t + 12 + 12 * k))
        return points

    def test_collapsed_triangles_are_said_and_an_origin_keeps_them(self):
        made = self.run_ok("surface", "utm.vtk", "--boundary", "-o", "a.stl", "--json").json()
        self.assertTrue(any("--origin" in warning for warning in made["warnings"]), made["warnings"])
        self.assertLess(len(self.points_of_stl("a.stl")), 20)
        made = self.run_ok("surface", "utm.vtk", "--boundary", "-o", "b.stl", "--origin", "5e6,4e6,0", "--json").json()
        self.assertFalse(any("--origin" in warning for warning in made["warnings"]), made["warnings"])
        points = self.points_of_stl("b.stl")
        self.assertEqual(len(points), made["points"])
        self.assertAlmostEqual(max(x for x, y, z in points), .04, delta=1e-6)


class FarBodies(Precision):
    """Two cubes of side 2, a million apart: each is as exact as alone."""

    def setUp(self):
        super().setUp()
        places, cells = [], []
        for start in (0, 1e6):
            cells.append(list(range(len(places), len(places) + 8)))
            places += [(start + x, y, z) for x, y, z in ((0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0),
                                                         (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2))]
        self.write("far.vtk", mesh(places, cells, (("x", lambda x, y, z: x),)))

    def test_places_outside_are_outside(self):
        found = self.run_ok("probe", "far.vtk", "--at", "2.5,1,1", "--at", "1.9,1,1", "--at", "1000001,1,1", "--json").json()
        self.assertEqual([place["inside"] for place in found["values"]], [False, True, True])

    def test_planes_outside_are_empty(self):
        done = subvol("slice", "far.vtk", "--plane", "2.3,1,1,1,0,0", "-o", "a.csv", folder=self.folder)
        self.assertEqual(done.code, 2, done.err)
        self.run_ok("slice", "far.vtk", "--plane", "1.7,1,1,1,0,0", "-o", "a.csv")


class Handedness(Precision):
    def test_a_cell_that_a_point_was_moved_through_is_folded_and_not_turned(self):
        moved = lambda x, y, z: (2.6, 2.6, 2.6) if (x, y, z) == (1, 1, 1) else (x, y, z)
        self.write("fold.vtk", grid((3, 3, 3), moved))
        found = self.run_ok("info", "fold.vtk", "--json").json()
        self.assertAlmostEqual(found["volume"], 27, delta=1e-9)
        self.assertFalse(any("turned round" in warning for warning in found["warnings"]), found["warnings"])
        self.assertTrue(any("negative Jacobian" in warning for warning in found["warnings"]), found["warnings"])

    def test_a_part_of_the_other_hand_is_turned(self):
        mirrored = lambda x, y, z: (-x, y, z)
        self.write("left.vtk", grid((2, 2, 2), mirrored))
        found = self.run_ok("info", "left.vtk", "--json").json()
        self.assertAlmostEqual(found["volume"], 8, delta=1e-9)
        self.assertTrue(any("8 of 8 hexahedra" in warning for warning in found["warnings"]), found["warnings"])


class Steps(Precision):
    """Sections of Gmsh with one name and several times are steps."""

    def setUp(self):
        super().setUp()
        corners = "0 0 0,1 0 0,0 1 0,1 1 0,0 0 1,1 0 1,0 1 1,1 1 1".split(",")
        text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n"
        text += "".join(f"{k + 1} {corner}\n" for k, corner in enumerate(corners))
        text += "$EndNodes\n$Elements\n1\n1 5 2 1 1 1 2 4 3 5 6 8 7\n$EndElements\n"
        def data(name, time, step, first):
            values = "".join(f"{k + 1} {first + k}\n" for k in range(8))
            return f'$NodeData\n1\n"{name}"\n1\n{time}\n3\n{step}\n1\n8\n{values}$EndNodeData\n'
        text += data("T", 0, 0, 0) + data("once", 0, 0, 50) + data("T", .5, 1, 100) + data("T", 1, 2, 200)
        self.write("steps.msh", text)

    def test_the_last_step_is_read_and_others_can_be_chosen(self):
        found = self.run_ok("info", "steps.msh", "--json").json()
        self.assertEqual((found["steps"], found["times"], found["step"]), (3, [0, .5, 1], 2))
        for words, first in (([], 200), (["--step", 1], 100), (["--time", .1], 0)):
            fields = {field["name"]: field for field in self.run_ok("info", "steps.msh", *words, "--json").json()["fields"]}
            self.assertEqual(sorted(fields), ["T", "once"])
            self.assertEqual((fields["T"]["min"], fields["T"]["max"]), (first, first + 7), words)
            self.assertEqual(fields["once"]["min"], 50)
        self.assertEqual(subvol("info", "steps.msh", "--step", 3, folder=self.folder).code, 2)


class Fractions(Precision):
    """A tank half full of water: values between points stay between 0 and 1, too."""

    def setUp(self):
        super().setUp()
        water = lambda x, y, z: min(1, max(0, 4.3 + .2 * x - z))
        self.write("tank.vtk", grid((6, 6, 10), cell_fields=(("alpha", water),)))

    def test_values_are_clamped_where_they_are_evaluated(self):
        options = ["--cell-values", "fit", "--json"]
        line = self.run_ok("probe", "tank.vtk", "--line", "3.3,3.3,0,3.3,3.3,10", "--count", 201, "-o", "a.csv", *options).json()
        self.assertEqual(line["cell_values"]["method"], "fit")
        with open(self.folder / "a.csv", newline="") as file:
            values = [float(row["alpha"]) for row in csv.DictReader(file) if row["inside"] == "1"]
        self.assertGreater(len(values), 150)
        self.assertGreaterEqual(min(values), 0)
        self.assertLessEqual(max(values), 1)
        made = self.run_ok("vdb", "tank.vtk", "-o", "a.vdb", "--resolution", 60, *options).json()
        self.assertGreaterEqual(made["grids"][0]["min"], 0)
        self.assertLessEqual(made["grids"][0]["max"], 1)
        stats = self.run_ok("probe", "tank.vtk", "--stats", *options).json()["stats"]["whole"]["fields"][0]
        self.assertGreaterEqual(stats["min"], 0)
        self.assertLessEqual(stats["max"], 1)
        self.run_ok("split", "tank.vtk", "-o", "tank.bricks", "--bricks", 3, "--cell-values", "fit")
        parts = self.run_ok("probe", "tank.bricks", "--stats", "--json").json()["stats"]["whole"]["fields"][0]
        self.assertEqual((parts["min"], parts["max"]), (stats["min"], stats["max"]))
        made = self.run_ok("vdb", "tank.bricks", "-o", "b.vdb", "--resolution", 60, "--json").json()
        self.assertGreaterEqual(made["grids"][0]["min"], 0)
        self.assertLessEqual(made["grids"][0]["max"], 1)
        exact = self.run_ok("probe", "tank.vtk", "--stats", "--cell-values", "exact", "--json").json()["stats"]["whole"]["fields"][0]
        self.assertGreater(exact["max"], 1)


# Files with known results lie in a folder beside that of the collection of meshes.
DATA = Path(os.environ.get("SUBVOL_DATA", "/nowhere"))
NUMBERS = DATA.parent / "numbers"


@unittest.skipUnless(NUMBERS.is_dir(), "SUBVOL_DATA names no collection that has meshes with known numbers beside it")
class KnownNumbers(Precision):
    """The files of that folder, each with what once was wrong with it."""

    def test_values_beside_large_constants(self):
        fields = self.stats(NUMBERS / "off.vtk")
        for name, low, range_ in (("pa", 101325, .01), ("big", 1e8, 1), ("mid", 1e6, 1), ("small", 0, 1)):
            for key, part in (("min", 0), ("mean", .5), ("max", 1)):
                self.assertAlmostEqual((fields[name][key] - low) / range_, part, delta=1e-4, msg=f"{name} {key}")
        for name, lost in (("pa", .1), ("big", .5)):
            made = self.run_ok("vdb", NUMBERS / "off.vtk", "-o", "a.vdb", "--field", name, "--resolution", 16, "--json").json()
            self.assertGreater(made["limit_deviation"]["of_range"], lost)
            self.assertTrue(any("floats" in warning and f"{name}-(" in warning for warning in made["warnings"]), made["warnings"])

    def test_bodies_far_from_each_other(self):
        found = self.run_ok("probe", NUMBERS / "far6.vtk", "--at", "2.5,1,1", "--at", "1.5,1,1", "--json").json()
        self.assertEqual([place["inside"] for place in found["values"]], [False, True])
        done = subvol("slice", NUMBERS / "far6.vtk", "--plane", "2.3,1,1,1,0,0", "-o", "a.csv", folder=self.folder)
        self.assertEqual(done.code, 2, done.err)

    def test_triangles_at_map_coordinates(self):
        made = self.run_ok("surface", NUMBERS / "utm.vtk", "--boundary", "-o", "u.stl", "--json").json()
        self.assertTrue(any("--origin" in warning for warning in made["warnings"]), made["warnings"])
        made = self.run_ok("surface", NUMBERS / "utm.vtk", "--boundary", "-o", "u.stl", "--origin", "5e6,4e6,0", "--json").json()
        self.assertEqual(made["warnings"], [])

    def test_values_beyond_halves(self):
        done = subvol("vdb", NUMBERS / "half2.vtk", "-o", "a.vdb", "--half", folder=self.folder)
        self.assertEqual(done.code, 2, done.err)
        self.assertIn("16-bit", done.err)

    def test_folded_cells_keep_their_hand(self):
        self.assertAlmostEqual(self.run_ok("info", NUMBERS / "fold.vtk", "--json").json()["volume"], 27, delta=1e-9)

    def test_steps_of_one_name(self):
        found = self.run_ok("info", NUMBERS / "st.msh", "--json").json()
        self.assertEqual((found["steps"], found["step"], [field["name"] for field in found["fields"]]), (3, 2, ["T"]))
        self.run_ok("info", NUMBERS / "st.msh", "--step", 1)

    def measured(self, *arguments):
        """Once these took half a minute or never ended, in up to 8.5 GB."""
        done = subvol_measured(*arguments, "--json", folder=self.folder, max_seconds=90)
        self.assertEqual(done.code, 0, done.err)
        self.assertLess(done.json()["peak_bytes"], 300e6)
        return done.json()

    def test_many_cells_around_an_axis(self):
        """The field is x, which the limit has exactly; the boundary is that of the integral over the cells."""
        for name, cells in (("fan60.vtk", 60), ("axis60.vtk", 360), ("fan200.vtk", 200)):
            with self.subTest(name):
                whole = self.measured("probe", NUMBERS / name, "--stats")["stats"]["whole"]
                self.assertEqual(whole["cells"], cells)
                field = whole["fields"][0]
                self.assertAlmostEqual(field["mean"], 0, delta=1e-4)
                self.assertAlmostEqual(field["max"], field["max_at"][0], delta=1e-6)
                surface = self.measured("surface", NUMBERS / name, "--boundary", "-o", "a.ply")
                self.assertTrue(surface["watertight"])
                # The deviation is an estimate, so twice of it; it is 0 where all sides are flat, and what is left is rounding.
                self.assertAlmostEqual(surface["volume"], whole["volume"],
                                       delta=2 * surface["deviation"] * surface["area"] + 1e-12 * whole["volume"])
                made = self.measured("slice", NUMBERS / name, "--plane", "0,0,.5,0,0,1", "--resolution", 96, "-o", "a.csv")
                with open(self.folder / "a.csv", newline="") as file:
                    rows = list(csv.DictReader(file))
                self.assertEqual(len(rows), made["inside"])
                for row in rows:
                    self.assertAlmostEqual(float(row["h"]), float(row["x"]), delta=1e-4)
                # All are one thick, so the area is the volume; of the pixels at the rim, of no more than a few hundred, half are
                # inside by chance.
                area = len(rows) * made["step"] ** 2
                self.assertAlmostEqual(area, whole["volume"], delta=.02 * whole["volume"])

    @unittest.skipUnless((DATA / "amanzi_hexes_192.mesh").is_file(), "the collection lacks amanzi_hexes_192.mesh")
    def test_statistics_of_few_cells(self):
        whole = self.measured("probe", DATA / "amanzi_hexes_192.mesh", "--stats")["stats"]["whole"]
        self.assertAlmostEqual(whole["volume"], 1, delta=1e-9)

    @unittest.skipUnless((DATA / "lox_post_103k.vtu").is_file(), "the collection lacks lox_post_103k.vtu")
    def test_statistics_of_one_field_of_many_cells(self):
        whole = self.measured("probe", DATA / "lox_post_103k.vtu", "--stats", "--field", "StagnationEnergy")["stats"]["whole"]
        self.assertEqual([field["name"] for field in whole["fields"]], ["StagnationEnergy"])
        self.assertLess(whole["error"], 1e-4)


if __name__ == "__main__":
    unittest.main()
