# SPDX-License-Identifier: Apache-2.0
"""A collection of malformed meshes that is not part of the repository: each is rejected with one sentence, within time and memory bounds.

The collection is the folder `bad` beside the one that SUBVOL_DATA names; its README.md has a table that says of each file whether
it must work, is an error, or needs at least a word. Without it the test is skipped (exit code 77).
"""

import os
import re
import sys
import unittest
from pathlib import Path

from command import SANITIZED, InFolder, subvol_measured

COLLECTION = Path(os.environ.get("SUBVOL_DATA", "")).resolve().parent / "bad"

# The collection's own bound of memory, of which the command's libraries take two thirds. Of its 2 s of processor time a busy
# machine may make twenty times as much.
MAX_CPU_SECONDS = 40
MAX_MIB = 200



def verdicts():
    """File name → (class, expected)."""
    pattern = r"^\| `([^`]+)`[^|]*\| ([^|]+?) \|[^|]*\| ([^|]+?) \|$"
    rows = re.findall(pattern, (COLLECTION / "README.md").read_text(), re.MULTILINE)
    return {name: (verdict, expected) for name, verdict, expected in rows}


class BadFiles(InFolder):
    def check(self, path, verdict, expected):
        (self.folder / "out.mesh").unlink(missing_ok=True)
        done = subvol_measured("subdivide", path, "-o", "out.mesh", "--json", "--threads", 2, folder=self.folder,
                               max_seconds=MAX_CPU_SECONDS, max_mib=MAX_MIB)
        written = (self.folder / "out.mesh").exists()
        self.assertIn(done.code, (0, 2), done.err)
        if not SANITIZED:
            self.assertLess(done.peak_mib, MAX_MIB)
        if done.code == 2:
            self.assertRegex(done.err, r"^subvol: [^\n]+\n$", "one sentence")
            self.assertIn(path.name, done.err)
            self.assertEqual(self.files(), [])
        if verdict == "must work":
            self.assertEqual((done.code, written), (0, True), done.err)
            if "as 00_ok" in expected or "to 00_ok" in expected:  # "after one split 125 vertices / 64 hexes"
                self.assertEqual((done.json()["points"], done.json()["cells"]), (125, 64))
        elif verdict == "error" and "documented handling" not in expected:
            self.assertEqual(done.code, 2, "is an error")
        else:
            self.assertTrue(done.code == 2 or done.json()["warnings"], "silence")

    def check_all(self, ending):
        for name, (verdict, expected) in verdicts().items():
            if name.endswith(ending):
                with self.subTest(name):
                    self.check(COLLECTION / name, verdict, expected)

    def test_medit(self):
        self.check_all(".mesh")

    def test_legacy_vtk(self):
        self.check_all(".vtk")

    def test_vtk_xml(self):
        self.check_all(".vtu")


if __name__ == "__main__":
    if "SUBVOL_DATA" not in os.environ or not (COLLECTION / "README.md").exists():
        print("skipped: SUBVOL_DATA names no folder with a collection of bad files beside it")
        sys.exit(77)
    unittest.main()
