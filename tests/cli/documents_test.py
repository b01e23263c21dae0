# SPDX-License-Identifier: Apache-2.0
"""What the documents point at is there."""

import re
import unittest
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
DOCUMENTS = [*TOP.glob("*.md"), *(TOP / "docs").rglob("*.md")]


class Documents(unittest.TestCase):
    def test_links_lead_somewhere(self):
        for document in DOCUMENTS:
            for target in re.findall(r"\]\(([^)#\s]+)\)", document.read_text()):
                if not target.startswith("http"):
                    self.assertTrue((document.parent / target).exists(), f"{document}: {target}")

    def test_citations_are_in_the_bibliography(self):
        keys = set(re.findall(r"^@\w+\{(\w+),", (TOP / "docs/references.bib").read_text(), re.M))
        for document in DOCUMENTS:
            cited = re.findall(r"(?<=[\[ ])([a-z]+(?:19|20)\d\d)(?=[\],])", document.read_text())
            self.assertLessEqual(set(cited), keys, document)

    def test_every_decision_is_in_the_index(self):
        listed = re.findall(r"\((\d{4}-[^)]*)\)", (TOP / "docs/adr/README.md").read_text())
        self.assertEqual(listed, sorted(path.name for path in (TOP / "docs/adr").glob("0*.md")))

    def test_pictures_are_small_and_can_be_drawn_anew(self):
        script = (TOP / "scripts/pictures").read_text()
        for picture in (TOP / "docs").glob("*.png"):
            self.assertLess(picture.stat().st_size, 200_000)
            self.assertIn(" " + picture.name + " ", script)

    def test_examples_are_short(self):
        examples = sorted((TOP / "examples").glob("*.cpp"))
        self.assertEqual([path.name[:2] for path in examples], [f"{i:02}" for i in range(1, len(examples) + 1)])
        for example in examples:
            self.assertLess(len(example.read_text().splitlines()), 100, example.name)


if __name__ == "__main__":
    unittest.main()
