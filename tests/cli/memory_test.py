"""What a cell of a large mesh costs in memory, as docs/formats.md says: 300 000 cells stand for a hundred million."""

import re
import unittest
from pathlib import Path

from command import SANITIZED, InFolder, subvol_measured

FORMATS = Path(__file__).resolve().parents[2] / "docs/formats.md"
RESOLUTION = 66  # cells along a side


def documented(verb):
    """Bytes a cell, of the table of large meshes."""
    row = re.search(rf"^\| `{verb}\b[^|]*\| *(\d+) *\|", FORMATS.read_text(), re.M)
    return int(row[1])


@unittest.skipIf(SANITIZED, "a sanitized program takes more")
class BytesACell(InFolder):
    def setUp(self):
        super().setUp()
        done = self.run_ok("model", "twist", "--resolution", RESOLUTION, "-o", "a.vtu", "--json").json()
        self.cells = done["cells"]
        self.alone = self.peak_bytes("info", "model:twist:2")  # the program and its libraries

    def peak_bytes(self, *arguments):
        done = subvol_measured(*arguments, "--quiet", "--threads", 2, folder=self.folder)
        self.assertEqual(done.code, 0, done.err)
        return done.peak_mib * 2**20

    def assert_as_documented(self, verb, *arguments):
        peak = self.peak_bytes(verb, *arguments)
        self.assertLess((peak - self.alone) / self.cells, documented(verb), verb)

    def test_info(self):
        self.assert_as_documented("info", "a.vtu")

    def test_points(self):
        self.assert_as_documented("points", "a.vtu", "-o", "a.ply")

    def test_vdb(self):
        self.assert_as_documented("vdb", "a.vtu", "-o", "a.vdb", "--levels", 0, "--resolution", 50)


if __name__ == "__main__":
    unittest.main()
