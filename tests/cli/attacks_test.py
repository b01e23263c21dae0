# SPDX-License-Identifier: Apache-2.0
"""Files of attacks, from outside the repository: SUBVOL_DATA/../attack has a folder for each, with a command in its file `cmd`.

Each command ends within 2 CPU seconds and 300 MB, with exit code 0 or 2, and shows no character that a terminal or a reader obeys.
"""

import os
import re
import resource
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

from command import COMMAND, SANITIZED, InFolder, subvol_measured

ATTACKS = Path(os.environ.get("SUBVOL_DATA", "nowhere")).parent / "attack"
MOST_SECONDS, MOST_MIB = 2, 300

# Legal files whose text is hostile: they are read, and what is written of them is harmless. All others are refused.
READ = {"028_name_ctl", "876_field_comment", "888_legend_svg_ctl", "954_duplicate_names_cubic", "953_info_ignores_density"}

# Controls but for line ends and tabs, direction marks, line separators, characters that are none.
OBEYED = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufffe\uffff]")


def commands_of(folder):
    """The words of each command of a folder, without comments."""
    lines = [line.partition("   #")[0].strip() for line in (folder / "cmd").read_text().splitlines()]
    return [line for line in lines if line]


class Attacks(InFolder):
    def assert_harmless(self, done, seconds, refused):
        self.assertIn(done.code, [2] if refused else [0, 2], done.err)
        self.assertNotRegex(done.out + done.err, OBEYED)
        self.assertNotIn("\ufffd", done.out + done.err, "bytes that are no UTF-8")
        lines = [line for line in done.err.splitlines() if not line.startswith("subvol: warning: ")]
        self.assertTrue(all(line.startswith("subvol: ") for line in lines), done.err)
        if done.code == 2:
            self.assertEqual(len(lines), 1, done.err)
        if not SANITIZED:
            self.assertLess(done.peak_mib, MOST_MIB)
            self.assertLess(seconds, MOST_SECONDS, "CPU seconds")

    def run_measured(self, *words, folder):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subvol_measured(*words, folder=folder, max_seconds=30 * MOST_SECONDS)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return done, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def test_folders(self):
        for attack in sorted(path.parent for path in ATTACKS.glob("*/cmd")):
            folder = self.folder / attack.name
            shutil.copytree(attack, folder, copy_function=shutil.copyfile)
            os.chmod(folder, 0o755)
            for line in commands_of(attack):
                with self.subTest(attack.name, command=line):
                    if line.startswith("subvol "):
                        words = [word.strip("'") for word in line.split()[1:]]
                        done, seconds = self.run_measured(*words, folder=folder)
                        self.assert_harmless(done, seconds, attack.name not in READ)
                    else:
                        self.assert_python_lives(*line.split()[-2:], folder)
            for text in [*folder.glob("*.svg"), *folder.glob("*.html")]:
                with self.subTest(attack.name, written=text.name):
                    self.assertNotRegex(text.read_text("utf-8"), OBEYED)

    def assert_python_lives(self, python, script, folder):
        package = Path(COMMAND).parent.parent / "python"
        if not (package / "subvol").is_dir():
            self.skipTest("the Python package is not built")
        done = subprocess.run([python, "-B", script], cwd=folder, capture_output=True, text=True,
                              env={**os.environ, "PYTHONPATH": str(package)}, timeout=600)
        self.assertGreaterEqual(done.returncode, 0, f"ended by a signal: {done.stderr}")

    def test_files(self):
        for attack in sorted(path for path in ATTACKS.iterdir() if path.is_file() and path.name != "README.md"):
            with self.subTest(attack.name):
                shutil.copyfile(attack, self.folder / attack.name)
                words = ["study", attack.name, "-o", "study"] if attack.suffix == ".json" else ["info", attack.name]
                done, seconds = self.run_measured(*words, folder=self.folder)
                if attack.suffix != ".json":  # a study of many cases, which has only to end
                    self.assert_harmless(done, seconds, True)
                self.assertIn(done.code, (0, 2), done.err)


if __name__ == "__main__":
    if not ATTACKS.is_dir():
        print(f"skipped: the files of attacks are not there: {ATTACKS}")
        sys.exit(77)
    unittest.main()
