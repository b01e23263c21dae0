# SPDX-License-Identifier: Apache-2.0
"""Every option that takes a number refuses what is none or is out of its range: one sentence that names the option, and no file."""

import re
import unittest

from command import InFolder, subvol

# What each verb is given besides the option. What is wrong is found before anything is read, so that the files need not exist.
GIVEN = {
    "model": ["ball", "-o", "a.vtu"],
    "info": ["model:ball:2"],
    "subdivide": ["model:ball:2", "-o", "a.vtu"],
    "fit": [],
    "points": ["model:ball:2", "-o", "a.ply"],
    "vdb": ["model:ball:2", "-o", "a.vdb"],
    "render": ["model:ball:2", "-o", "a.png"],
    "view": ["model:ball:2", "--screenshot", "a.png"],
    "page": ["model:ball:2", "-o", "a.html"],
    "probe": ["model:ball:2", "-o", "a.csv", "--at", "0,0,0"],
    "slice": ["model:ball:2", "-o", "a.png"],
    "surface": ["model:ball:2", "-o", "a.ply"],
    "split": ["model:ball:2", "-o", "a.bricks"],
    "join": ["a.ply", "-o", "b.ply"],
    "compare": ["model:ball:2", "model:ball:2"],
    "study": ["table2", "-o", "out"],
    "demo": ["-o", "out"],
}

# The names of values in the help that are no numbers.
WORDS = {
    "FILE", "FILE.json", "FILE|NAME", "[FILE.svg]", "DIR", "NAME", "[NAME]", "NAME|JSON", "TEXT", "IMAGE", "WHAT", "HOW", "WHEN", "WHERE", "SIDE",
    "AXIS", "SHAPE", "METRIC", "EXPR", "A,B", "A,B,…", "A,B=C", "COLOR", "KIND", "A",
}

# Numbers among other things: how a wrong one is written.
WITHIN = {"METRIC=VALUE": "l2={}", "V:A,V:A,…": "{}:1", "MIN,MAX|field": "{},1", "[GRID=]LO,HI[:A,B]": "{},1", "K/N": "{}/2", "CAMERA": "{},0,0,0,0,0,0,0,1,30",
          "A-B": "{}-3", "WxH": "{}x8"}

WRONG = ["nan", "inf", "-inf", "1e999", "-1e999", "abc", "", "1 2", "0x10", "12abc", "99999999999999999999999e999"]


def options_of(verb):
    """The options of a verb with the names of their values, as its help lists them: "  -o, --output FILE   the file"."""
    entries = (re.match(r"  ((?:-[^\s,]+, )*-[^\s,]+) (\S+)(?:  |$)", line) for line in subvol(verb, "--help-all").out.splitlines())
    return [(entry[1].split(", ")[0], entry[2]) for entry in entries if entry]


class Numbers(InFolder):
    def assert_refused(self, arguments, option):
        done = subvol(*arguments, folder=self.folder)
        self.assertEqual(done.code, 2, (arguments, done.out, done.err))
        self.assertRegex(done.err, r"\Asubvol: [^\x00-\x1f\x7f]+\n\Z", arguments)
        self.assertIn(option, done.err, arguments)
        self.assertEqual(self.files(), [], arguments)

    def test_every_option(self):
        count, seen = 0, set()
        for verb, given in GIVEN.items():
            for option, value in options_of(verb):
                if value in WORDS:
                    continue
                wrongs = WRONG if (option, value) not in seen else WRONG[:1]  # most options are those of several verbs
                seen.add((option, value))
                for wrong in wrongs:
                    if value == "[V]" and (wrong == "" or wrong.startswith("-")):  # no value, or another option
                        continue
                    words = [verb, *given, option, WITHIN.get(value, "{}").format(wrong)]
                    if option == "--footprint-size":
                        words += ["--footprint", "+x"]
                    with self.subTest(verb=verb, option=option, wrong=wrong):
                        self.assert_refused(words, option)
                    count += 1
        self.assertGreater(count, 700)  # the help was understood

    def test_ranges_are_said(self):
        for verb, option, value, words in (
            ("vdb", "--voxel-size", "0", "'0' is out of range (more than 0)"),
            ("vdb", "--voxel-size", "1e-320", "'1e-320' is out of range (1e-100 to 1e+100)"),
            ("render", "--reduce", "nan", "'nan' is not a number (more than 0)"),
            ("points", "--per-edge", "65", "'65' is out of range (1 to 64)"),
            ("points", "--per-edge", "1.5", "'1.5' is not a whole number (1 to 64)"),
            ("points", "--per-edge", "99999999999999999999", "'99999999999999999999' is out of range (1 to 64)"),
            ("render", "--tension", ".2", "'.2' is out of range (0 to 0.125)"),
            ("render", "--device", "-1", "'-1' is out of range (0 to 1000)"),
            ("info", "--seed", "-1", "'-1' is"),
            ("info", "--curved", "0", "'0' is out of range (more than 0, or corners)"),
            ("split", "--memory", "-5", "'-5' is out of range (a number of bytes"),
            ("split", "--memory", "16E", "'16E' is out of range (a number of bytes"),
            ("split", "--memory", "5X", "'5X' is not a number of bytes"),
            ("render", "--size", "100000x1", "'100000x1' is too large a picture (1 to 65536 pixels a side"),
            ("render", "--size", "65536x65536", "'65536x65536' is too large a picture"),
            ("surface", "--iso", "inf", "'inf' is out of range (-1e+300 to 1e+300)"),
            ("vdb", "--frames", "0-2000000000", "'0-2000000000' has too many frames (at most a million)"),
        ):
            with self.subTest(option=option, value=value):
                done = subvol(verb, *GIVEN[verb], option, value, folder=self.folder)
                self.assertEqual(done.code, 2)
                self.assertIn(f"subvol: {option}: {words}", done.err)
                self.assertEqual(self.files(), [])

    def test_numbers_are_decimal(self):
        # Leading zeros and a plus are no other base.
        self.assertEqual(self.run_ok("model", "ball", "-o", "a.vtu", "--resolution", "010", "--json").json()["cells"],
                         self.run_ok("model", "ball", "-o", "b.vtu", "--resolution", "+10", "--json").json()["cells"])
        self.run_ok("info", "model:ball:2", "--seed", "18446744073709551615")
        self.run_ok("info", "a.vtu", "--curved", "corners")
        self.run_ok("split", "model:ball:2", "-o", "a.bricks", "--memory", "2MiB")


if __name__ == "__main__":
    unittest.main()
