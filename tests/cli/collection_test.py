# SPDX-License-Identifier: Apache-2.0
"""`subvol info` against the tables of the collection of real meshes that SUBVOL_DATA names.

Its README.md has one table of counts and one of fields; every figure of both is looked up in what the command prints. Without the
collection the test is skipped (exit code 77).
"""

import os
import re
import sys
import unittest
from pathlib import Path

from command import subvol

COLLECTION = Path(os.environ.get("SUBVOL_DATA", ""))


def table(title):
    """The rows of the table behind a title: file name → cells."""
    text = (COLLECTION / "README.md").read_text().split(f"## {title}")[1].split("\n## ")[0]
    rows = re.findall(r"^\| `([^`]+)` \| (.*) \|$", text, re.MULTILINE)
    return {name: [cell.strip() for cell in cells.split(" | ")] for name, cells in rows}


def integers(cell):
    return [int(word) for word in re.findall(r"\d+", cell)]


def info(name, *options):
    done = subvol("info", COLLECTION / name, "--json", *options)
    assert done.code == 0, done.err
    return done.json()


class Collection(unittest.TestCase):
    def near(self, found, expected, digits):
        """Equal to so many significant digits: those that the README gives, and one unit of the last for rounding."""
        self.assertLessEqual(abs(found - expected), abs(expected) * 10.0 ** (1 - digits), f"{found} is not {expected}")

    def check_counts(self, cells, told):
        points, hexes, edges, valences, singular, quality, boundary, volume, sizes, once, _ = cells
        self.assertEqual([told["points"], told["points_used"]], integers(points))
        self.assertEqual(told["cells"], int(hexes))
        per_valence = {number: int(count) for number, count in re.findall(r"(\d+):(\d+)", valences)}
        self.assertEqual(told["interior_edge_valence"], per_valence)
        irregular = sum(count for number, count in per_valence.items() if number != "4")
        self.assertEqual([irregular, told["interior_edges"]], integers(edges))
        self.assertEqual(told["singular_nodes"], int(singular))
        inverted, jacobian = quality.split(", ")
        self.assertEqual(told["inverted_cells"], int(inverted))
        self.assertAlmostEqual(told["min_scaled_jacobian"], float(jacobian), delta=5e-5)  # four decimals are given
        self.assertEqual([told["boundary_faces"], told["nonmanifold_edges"]], integers(boundary))
        self.near(told["volume"], float(volume), 9)  # one digit fewer than given: coordinates are floats in some files
        self.assertEqual([told["edges"], told["faces"]], integers(sizes))
        after_split = told["points_used"] + told["edges"] + told["faces"] + told["cells"]
        self.assertEqual([after_split, 8 * told["cells"]], integers(once))

    def check_fields(self, cell, told):
        pattern = r"(point|cell) `([^`]+)`(?:\[(\d+), norm\])? (\S+?)\.\.(\S+?)(?:;|$)"
        fields = re.findall(pattern, cell)
        self.assertEqual(len(fields), cell.count("`") // 2)
        for location, name, components, low, high in fields:
            with self.subTest(field=name):
                found = next(field for field in told["fields"] if field["name"] == name)
                self.assertEqual(found["location"], location)
                self.assertEqual(found["components"], int(components or 1))
                self.near(found["min"], float(low), 4)
                self.near(found["max"], float(high), 4)

    def test_meshes(self):
        counts, fields = table("Statistics"), table("Fields and notes")
        self.assertGreaterEqual(len(counts), 11)
        self.assertLessEqual(set(counts), set(fields))
        for name, cells in counts.items():
            with self.subTest(name):
                told = info(name)
                self.check_fields(fields[name][0], told)
                if not cells[1].startswith("0 "):  # only meshes with hexahedra; the others are split
                    self.check_counts(cells, told)

    def test_seam(self):
        name = "lox_post_103k.vtu"
        pairs = int(re.search(r"(\d+) coincident point pairs", table("Fields and notes")[name][1])[1])
        apart, welded = info(name), info(name, "--weld")
        self.assertEqual(welded["points_used"], apart["points_used"] - pairs)
        self.assertEqual(welded["volume"], apart["volume"])
        self.assertTrue(any(f"{pairs} points welded" in warning for warning in welded["warnings"]))
        self.assertEqual(info(name, "--weld-distance", "1e-6")["points_used"], welded["points_used"])  # no edge is that short

    def test_grid(self):
        note = table("Fields and notes")["arnold_smoke.vdb"][1]
        voxels = int(re.search(r"([\d,]+) active voxels", note)[1].replace(",", ""))
        low, high = re.search(r"values (\S+?)\.\.([\d.]+\d)", note).groups()
        (grid,) = info("arnold_smoke.vdb")["grids"]
        self.assertEqual((grid["name"], grid["active_voxels"]), ("density", voxels))
        self.near(grid["min"], float(low), 2)
        self.near(grid["max"], float(high), 4)


if __name__ == "__main__":
    if "SUBVOL_DATA" not in os.environ or not (COLLECTION / "README.md").exists():
        print("skipped: SUBVOL_DATA names no folder of real meshes")
        sys.exit(77)
    unittest.main()
