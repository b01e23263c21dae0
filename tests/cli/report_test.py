# SPDX-License-Identifier: Apache-2.0
"""The report of a study in a browser: it needs no other file, its slider works, it fits a phone and a sheet of paper."""

import json
import os
import re
import sys
import tempfile
import unittest
from pathlib import Path

from browser import Browser, find_chromium, policy_faults
from command import subvol

STUDY = {
    "name": "small",
    "title": "A <small> study & \"more\"",
    "about": "Splats against rays.",
    "inputs": [{"name": "a_ball", "model": "ball", "resolution": 4}],
    "size": 120,
    "methods": [
        {"method": "splat", "label": "<b>splat</b>", "per_edge": [1, 2]},
        {"method": "tets", "levels": [0, 1]},
        {"method": "field", "per_edge": [1, 2, 4], "places": 5000},
        {"method": "field", "every_second": True, "label": "fails"},
    ],
    "metrics": ["rmse", "psnr", "flip"],
    "reference": {"tolerance": 0.01, "max_levels": 3},
    "tables": [{"rows": ["label", "per_edge", "levels"], "columns": ["rmse", "psnr", "flip", "seconds", "peak_bytes"]}],
    "plots": [{"title": "Order", "x": "spacing", "y": "rmse", "series": "label", "fit": True}],
    "demands": [{"metric": "psnr", "least": 1000, "where": {"method": "splat"}}, {"metric": "rmse", "most": 1}],
    "pictures": True,
}

# Elements that reach beyond the right edge of the page, except in boxes that scroll.
OVERFLOWING = """
  [...document.querySelectorAll('body *')]
    .filter(e => !e.closest('.wide') && !e.closest('svg') && e.getBoundingClientRect().right > innerWidth + 1)
    .map(e => e.outerHTML.slice(0, 80))
"""


class ReportInBrowser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        folder = Path(temporary.name)
        (folder / "s.json").write_text(json.dumps(STUDY))
        cls.ended = subvol("study", "s.json", "figure4", "-o", "out", "--json", folder=folder)
        cls.page = folder / "out/report.html"
        cls.browser = Browser(find_chromium())
        cls.addClassCleanup(cls.browser.close)

    def setUp(self):
        self.assertEqual(self.ended.code, 1, self.ended.err)  # the case that must fail
        self.browser.send("Emulation.setEmulatedMedia", media="")

    def shot(self, name):
        """Saved in the folder that SUBVOL_SCREENSHOTS names, for people to look at."""
        folder = os.environ.get("SUBVOL_SCREENSHOTS")
        if folder:
            Path(folder).mkdir(parents=True, exist_ok=True)
            self.browser.screenshot(Path(folder) / name)

    def test_loads_alone(self):
        self.browser.resize(1280)
        self.browser.open(self.page.as_uri())
        self.assertEqual(self.browser.requests(), [])
        self.assertEqual(self.browser.complaints(), [])
        self.assertEqual(policy_faults(self.page.read_text()), [])
        text = self.browser.evaluate("document.body.innerText")
        for said in ("A <small> study", "<b>splat</b>", "1 case failed", "of 2 demands met", "subvol study s.json figure4", "processor"):
            self.assertIn(said, text)
        self.assertEqual(self.browser.evaluate("document.querySelectorAll('b, small').length"), 0)  # text is not interpreted as HTML
        broken = "[...document.images].filter(i => !i.complete || i.naturalWidth === 0).length"
        self.assertEqual(self.browser.evaluate(broken), 0)
        self.assertGreaterEqual(self.browser.evaluate("document.images.length"), 4 * 3 + 5 * 3 + 1)
        self.assertNotRegex(self.page.read_text(), r"(src|href)=\"(?!data:|#)")
        self.shot("test_1280.png")

    def test_slider_moves_the_border(self):
        self.browser.resize(1280)
        self.browser.open(self.page.as_uri())
        clip = "getComputedStyle(document.querySelector('.triple .reference')).clipPath"
        self.assertIn("50%", self.browser.evaluate(clip))
        self.browser.evaluate("document.querySelector('.slide input').scrollIntoView({block: 'center'})")
        x, y, width, height = self.browser.evaluate(
            "(r => [r.x, r.y, r.width, r.height])(document.querySelector('.slide input').getBoundingClientRect())")
        self.assertGreater(width, 80)
        for kind in ("mousePressed", "mouseReleased"):  # as a hand would
            self.browser.send("Input.dispatchMouseEvent", type=kind, x=x + 0.8 * width, y=y + height / 2, button="left", clickCount=1)
        value = float(self.browser.evaluate("document.querySelector('.slide input').value"))
        self.assertAlmostEqual(value, 80, delta=6)
        moved = self.browser.evaluate(clip)
        self.assertAlmostEqual(float(re.search(r"([\d.]+)%", moved).group(1)), value, delta=0.01, msg=moved)
        # One picture is on top of the other, the difference beside them.
        boxes = self.browser.evaluate("""['.ours img', '.reference img', '.difference img'].map(name =>
            (r => [r.x, r.y, r.width])(document.querySelector('.triple ' + name).getBoundingClientRect()))""")
        self.assertEqual(boxes[0], boxes[1])
        self.assertGreaterEqual(boxes[2][0], boxes[0][0] + boxes[0][2])
        self.assertEqual(self.browser.complaints(), [])

    def test_fits_its_width(self):
        for width in (1280, 390, 320):
            self.browser.resize(width, mobile=width < 500)
            self.browser.open(self.page.as_uri())
            self.assertEqual(self.browser.evaluate(OVERFLOWING), [], width)
            self.assertLessEqual(self.browser.evaluate("document.documentElement.scrollWidth"), width)
            self.shot(f"test_{width}.png")

    def test_without_scripts_pictures_stand_side_by_side(self):
        self.browser.send("Emulation.setScriptExecutionDisabled", value=True)
        self.browser.resize(1280)
        self.browser.open(self.page.as_uri())
        self.assertEqual(self.browser.complaints(), [])
        self.shot("test_noscript.png")
        self.browser.send("Emulation.setScriptExecutionDisabled", value=False)
        self.assertEqual(self.browser.evaluate("document.documentElement.className"), "")
        self.assertEqual(self.browser.evaluate("getComputedStyle(document.querySelector('.reference')).clipPath"), "none")
        self.assertEqual(self.browser.evaluate("getComputedStyle(document.querySelector('.slide')).display"), "none")

    def test_on_paper_no_table_is_cut(self):
        # A4 between Chromium's margins of .4 inch, 96 pixels an inch; US letter is wider.
        self.browser.resize(718)
        self.browser.open(self.page.as_uri())
        self.browser.send("Emulation.setEmulatedMedia", media="print")
        self.assertGreater(self.browser.evaluate("document.querySelectorAll('.wide td').length"), 50)
        self.assertEqual(self.browser.evaluate(OVERFLOWING.replace("!e.closest('.wide') && ", "")), [])
        # Nor where a study measures much: forty columns of numbers.
        self.browser.evaluate("""document.querySelectorAll('.wide').forEach(box => {
            box.className = 'wide densest broken';
            for (const row of box.querySelectorAll('tr'))
                for (let k = 0; k < 40; ++k) row.append(Object.assign(document.createElement(row.parentNode.tagName === 'THEAD' ? 'th' : 'td'),
                                                                      {textContent: '1.234e-05'})); })""")
        self.assertEqual(self.browser.evaluate(OVERFLOWING.replace("!e.closest('.wide') && ", "")), [])

    def test_on_paper_all_pictures_are_seen(self):
        self.browser.resize(1280)
        self.browser.open(self.page.as_uri())
        self.browser.send("Emulation.setEmulatedMedia", media="print")
        self.assertEqual(self.browser.evaluate("getComputedStyle(document.querySelector('.reference')).clipPath"), "none")
        places = self.browser.evaluate("""['.ours img', '.reference img', '.difference img'].map(name =>
            document.querySelector('.triple ' + name).getBoundingClientRect().x)""")
        self.assertEqual(len({round(x) for x in places}), 3)
        self.shot("test_print.png")


if __name__ == "__main__":
    if not find_chromium():
        print("skipped: no chromium here", file=sys.stderr)
        sys.exit(77)
    unittest.main()
