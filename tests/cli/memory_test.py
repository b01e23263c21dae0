# SPDX-License-Identifier: Apache-2.0
"""The memory per cell of a large mesh, as in docs/formats.md, measured with a million cells instead of a hundred; the command keeps
some freed memory, which weighs on smaller meshes."""

import re
import unittest
from pathlib import Path

from command import SANITIZED, InFolder, subvol_measured

FORMATS = Path(__file__).resolve().parents[2] / "docs/formats.md"
RESOLUTION = 100  # cells along a side


def documented(verb):
    """Bytes per cell, from the table of large meshes."""
    row = re.search(rf"^\| `subvol {verb} .*\| *(\d+) *\|$", FORMATS.read_text(), re.M)
    return int(row[1])


@unittest.skipIf(SANITIZED, "a sanitized program takes more")
class BytesACell(InFolder):
    def peak_bytes(self, *arguments):
        done = subvol_measured(*arguments, "--quiet", "--threads", 2, folder=self.folder)
        self.assertEqual(done.code, 0, done.err)
        return done.peak_mib * 2**20

    def test_as_documented(self):
        cells = self.run_ok("model", "twist", "--resolution", RESOLUTION, "-o", "a.vtu", "--json").json()["cells"]
        for verb, *options in (["info"], ["points", "-o", "a.ply"],
                               ["vdb", "-o", "a.vdb", "--levels", 0, "--resolution", 50]):
            with self.subTest(verb):
                alone = self.peak_bytes(verb, "model:twist:2", *options)  # the program and the libraries that it loads
                self.assertLess((self.peak_bytes(verb, "a.vtu", *options) - alone) / cells, documented(verb))


    def test_a_picture_of_a_solid_takes_that_of_its_pixels(self):
        """Colours and depths in floats, the picture as it is written, and a few rows of hits; with kernels 300 bytes a pixel and more."""
        picture = ("render", "model:ball:12", "-o", "a.png", "--backend", "cpu", "--size")
        more = self.peak_bytes(*picture, "1600x1600") - self.peak_bytes(*picture, "100x100")
        self.assertLess(more / (1600**2 - 100**2), 60)


if __name__ == "__main__":
    unittest.main()
