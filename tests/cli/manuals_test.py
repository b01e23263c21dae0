# SPDX-License-Identifier: Apache-2.0
"""The manual page and the completions name every verb and option, and the programs that read them report no errors."""

import os
import re
import shutil
import subprocess
import unittest

from command import COMMAND, HANGS_AFTER, InFolder, subvol


def verbs():
    help_text = subvol("--help").out
    return [verb for verb in re.findall(r"^  (\w+) ", help_text.split("Verbs:")[1].split("Options:")[0], re.M) if verb != "help"]


def options(verb):
    """Of a verb's full help: the first columns of its lines, as "-o, --output IMAGE"."""
    lines = re.findall(r"^  (-[^ ,]+)(?:, (-[^ ,]+))?", subvol(verb, "--help-all").out.split("Examples:")[0], re.M)
    return [name for line in lines for name in line if name]


def needs(program):
    return unittest.skipUnless(shutil.which(program), f"{program} is not installed")


class Manuals(InFolder):
    def setUp(self):
        super().setUp()
        self.text = {}
        for kind in "man", "bash", "zsh":
            done = subvol("--generate", kind)
            self.assertEqual((done.code, done.err), (0, ""))
            self.text[kind] = done.out
            (self.folder / kind).write_text(done.out)

    def run_shell(self, *command):
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=HANGS_AFTER)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        return done.stdout

    def complete_in_bash(self, *words):
        quoted = " ".join(f"'{word}'" for word in words)
        script = f"source ./bash; COMP_WORDS=({quoted}); COMP_CWORD={len(words) - 1}; _subvol; printf '%s\\n' \"${{COMPREPLY[@]}}\""
        return self.run_shell("bash", "--norc", "-c", script).split()

    def test_the_help_does_not_show_what_the_build_asks_for(self):
        self.assertNotIn("--generate", subvol("--help").out)
        self.assertEqual(subvol("--generate", "fish").code, 2)

    def test_every_verb_and_option_is_in_the_page(self):
        sections = self.text["man"].replace("\\-", "-").split(".SS subvol ")
        common = sections[-1].split(".SH OPTIONS FOR READING MESHES")[1]
        self.assertEqual([section.split()[0] for section in sections[1:]], verbs())
        for section in sections[1:]:
            for option in options(section.split()[0]):
                self.assertTrue(f"\\fB{option}\\fR" in section or f"\\fB{option}\\fR" in common, f"{section.split()[0]} {option}")

    @needs("mandoc")
    def test_the_page_is_correct(self):
        self.run_shell("mandoc", "-T", "lint", "-W", "warning", "man")

    @needs("man")
    def test_the_page_is_read(self):
        page = self.run_shell("man", "--warnings", "-l", "man")
        self.assertIn("--opacity-unit D", page)
        for chapter in ("THE VOLUME", "FIELDS", "OUTPUT FOR PROGRAMS", "A FIRST SESSION", "HOW LONG THINGS TAKE"):
            self.assertIn(chapter, page)

    def test_the_day_can_be_set(self):
        done = subprocess.run(["env", "SOURCE_DATE_EPOCH=86400", COMMAND, "--generate", "man"],
                              capture_output=True, text=True, timeout=HANGS_AFTER)
        self.assertIn(".TH SUBVOL 1 1970-01-02 ", done.stdout)

    def test_bash_completes_verbs(self):
        self.run_shell("bash", "-n", "bash")
        self.assertEqual(self.complete_in_bash("subvol", ""), [*verbs(), "help", "--help", "--version"])
        self.assertEqual(self.complete_in_bash("subvol", "re"), ["render"])

    def test_bash_completes_every_option(self):
        for verb in verbs():
            self.assertEqual(set(self.complete_in_bash("subvol", verb, "-")), set(options(verb)))

    def test_bash_completes_values(self):
        self.assertEqual(self.complete_in_bash("subvol", "info", "--progress", ""), ["auto", "on", "off"])
        self.assertEqual(self.complete_in_bash("subvol", "model", "tw"), ["twist"])
        self.assertEqual(self.complete_in_bash("subvol", "info", "model", ":", "pa"), ["pawn"])
        self.assertEqual(self.complete_in_bash("subvol", "render", "-o", ""), [])  # a file: left to bash
        self.assertEqual(self.complete_in_bash("subvol", "help", "re"), ["render"])
        for verb, option, some in (("render", "--method", {"splat", "dense"}), ("render", "--tf", {"viridis", "turbo", "xray"}),
                                   ("render", "--view", {"+x", "iso"}), ("points", "--scheme", {"mcq", "cc", "bsxw", "linear"}),
                                   ("render", "--look", {"solid", "isosurface"})):
            offered = self.complete_in_bash("subvol", verb, option, "")
            self.assertLessEqual(some, set(offered))

    def test_offered_values_are_accepted(self):
        for option, more in (("--tf", []), ("--view", []), ("--look", ["--method", "splat"]), ("--scheme", []), ("--correction", []), ("--values", [])):
            for value in self.complete_in_bash("subvol", "render", option, ""):
                self.run_ok("render", "model:ball:2", "-o", "a.png", "--size", 8, option, value, *more)

    def test_bash_completes_the_fields_of_the_file(self):
        self.run_ok("model", "ball", "-o", "ball.vtu", "--resolution", 2)
        os.symlink(COMMAND, self.folder / "subvol")
        self.assertEqual(self.complete_in_bash("./subvol", "render", "ball.vtu", "--field", "d"), ["density"])

    @needs("zsh")
    def test_zsh_completes_verbs_and_options(self):
        self.run_shell("zsh", "-n", "zsh")
        # zsh's own functions need a terminal; these replace them and print their arguments
        stubs = "_arguments() { print -l -- \"$@\"; state=$want }; _describe() { print -l -- \"${(@P)2}\" }; compdef() { : }; "
        said = self.run_shell("zsh", "-f", "-c", stubs + "want=verb; source ./zsh")
        for verb in verbs():
            self.assertRegex(said, rf"(?m)^{verb}:")
            said_of_verb = self.run_shell("zsh", "-f", "-c", stubs + f"want=argument; words=({verb}); source ./zsh")
            for option in options(verb):
                self.assertRegex(said_of_verb, rf"(?m)^(\([^)]*\)|\*)?{re.escape(option)}\[")


if __name__ == "__main__":
    unittest.main()
