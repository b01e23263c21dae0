# SPDX-License-Identifier: Apache-2.0
"""An option that would have no effect is refused. The pairs are read from the help, which is made from the options' descriptions."""

import re
import unittest

from command import InFolder, subvol
from numbers_test import GIVEN

VALUES = {"R,G,B": "0,0,0", "WxH": "8x8"}  # of options whose value is looked at first


def entries(verb):
    """(option, the name of its value or nothing, its sentence) of a verb, as its help lists them."""
    found = []
    for line in subvol(verb, "--help-all").out.splitlines():
        start = re.match(r"  (?:-[^\s,]+, )*(--[^\s,]+)(?:, --[^\s,]+)*(?: (\S+))?(?:  +(.*))?$", line)
        if start:
            found.append([start[1], start[2] or "", start[3] or ""])
        elif found and line.startswith("      "):
            found[-1][2] += " " + line.strip()
    return found


class Options(InFolder):
    def test_an_option_without_effect_is_refused(self):
        pairs = []
        for verb, given in GIVEN.items():
            listed = entries(verb)
            sentences = {option: sentence for option, _, sentence in listed}
            for option, value, sentence in listed:
                for need in re.findall(r"; with (--\S+(?: [a-z]\w*(?: or \w+)*)?)(?=[;,]|$)", sentence):
                    other, *allowed = need.replace(" or ", " ").split()
                    default = re.search(r"\(default (\S+)\)", sentences[other])
                    if other in given or (default and default[1] in allowed):
                        continue
                    words = [option] + ([VALUES.get(value, "1")] if value else [])
                    done = subvol(verb, *given, *words, folder=self.folder)
                    self.assertEqual(done.code, 2, (verb, words, done.out, done.err))
                    self.assertIn(f"{option}: has no effect without {need}", done.err, (verb, words))
                    self.assertEqual(self.files(), [], (verb, words))
                    pairs.append((verb, option, need))
        for pair in [("points", "--footprint-size", "--footprint"), ("points", "--value-kernel", "--values paper"),
                     ("points", "--up", "--splats"), ("points", "--refine", "--reduce"), ("vdb", "--half-width", "--sdf"),
                     ("vdb", "--fps", "--velocity"), ("vdb", "--per-edge", "--from points"), ("surface", "--cap", "--iso"),
                     ("surface", "--tf", "--color-field"), ("probe", "--count", "--line"), ("probe", "--bins", "--stats"),
                     ("info", "--levels", "--scheme"), ("compare", "--heatmap-of", "--heatmap")]:
            self.assertIn(pair, pairs)

    def test_a_default_counts_as_well_as_a_given_word(self):
        done = subvol("subdivide", "model:ball:2", "-o", "a.vtu", "--levels", "0", "--tension", "0.05", folder=self.folder)
        self.assertEqual(done.code, 0, done.err)
        done = subvol("subdivide", "model:ball:2", "-o", "b.vtu", "--scheme", "cc", "--tension", "0.05", folder=self.folder)
        self.assertEqual(done.code, 2)
        self.assertIn("--tension: has no effect without --scheme mcq", done.err)

    def test_options_that_replace_each_other_are_not_given_together(self):
        done = subvol("points", "model:ball:2", "-o", "a.ply", "--per-edge", "2", "--spacing", "0.1", folder=self.folder)
        self.assertEqual(done.code, 2)
        self.assertIn("--per-edge: cannot be given together with --spacing", done.err)
        self.assertEqual(self.files(), [])

    def test_an_unknown_option_is_said_before_a_wrong_value(self):
        done = subvol("points", "model:ball:2", "-o", "a.ply", "--per-edge", "0", "--spaceing", "1", folder=self.folder)
        self.assertEqual(done.code, 2)
        self.assertIn("--spaceing", done.err)


if __name__ == "__main__":
    unittest.main()
