# SPDX-License-Identifier: Apache-2.0
"""The page of benchmarks: what others need less for is said, and the page has the figures that its run wrote."""

import csv
import importlib.machinery
import importlib.util
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TOP = Path(__file__).parents[2]


def module_of(path):
    loader = importlib.machinery.SourceFileLoader("bench_all", str(path))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("bench_all", loader))
    sys.modules["bench_all"] = module
    loader.exec_module(module)
    return module


class Benchmarks(unittest.TestCase):
    def setUp(self):
        self.bench = module_of(TOP / "bench/all")

    def test_what_others_need_less_for_is_said(self):
        row = self.bench.Row
        wins, losses = self.bench.verdicts({
            "reading": [row("subvol info", 2, 10), row("quick", 1, 20), row("small", 4, 5)],
            "pictures": [row("subvol splat", 1, error=.01), row("subvol tets", 3, error=.001), row("slow", 2, error=.02), row("exact", 9, error=1e-4),
                         row("quick and exact", 2, error=.005)],
        })
        self.assertEqual([sentence.split(": ")[1].split(" takes")[0] for sentence in wins], ["small", "slow"])
        said = " ".join(losses)
        self.assertEqual(len(losses), 4)
        self.assertIn("quick takes 0.5 times the CPU time of subvol info", said)
        self.assertIn("small takes 5 MB", said)
        self.assertIn("exact: none of our methods is as exact", said)
        self.assertIn("quick and exact takes 0.67 times the CPU time of subvol tets", said)

    def test_the_page_has_the_figures_of_its_run(self):
        page = (TOP / "docs/benchmarks.md").read_text()
        with open(TOP / "docs/benchmarks/results.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertGreater(len(rows), 8)
        for row in rows:
            self.assertIn(f"| {row['program']} | {float(row['cpu_seconds']):.3g} |", page)
        for task in {row["task"] for row in rows}:
            self.assertIn(f"benchmarks/{task}.svg", page)
            self.assertTrue((TOP / f"docs/benchmarks/{task}.svg").is_file())
        for words in ("commit", "Machine:", "Date:", "## Where others need less"):
            self.assertIn(words, page)


class Guard(unittest.TestCase):
    def run_guard(self, folder, burnt, bytes_held, name="few kernels"):
        """Its exit code and its rows: a command against one that does as much and something beside."""
        slow = folder / "slow"
        slow.write_text(f"#!{sys.executable}\nimport time\nheld = bytearray({bytes_held})\nend = time.process_time() + {burnt}\n"
                        "while time.process_time() < end: pass\n")
        quick = folder / "quick"
        quick.write_text(f"#!{sys.executable}\nimport time\nend = time.process_time() + .2\nwhile time.process_time() < end: pass\n")
        for program in (slow, quick):
            program.chmod(0o755)
        history = folder / "history.csv"
        done = subprocess.run([sys.executable, TOP / "bench/guard", "--program", slow, "--before", quick, "--only", name, "--rounds", "2",
                               "--history", history], capture_output=True, text=True)
        with open(history, newline="") as file:
            return done.returncode, list(csv.DictReader(file))

    def test_what_takes_longer_or_needs_more_than_before_is_found_and_kept(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            code, rows = self.run_guard(folder, .2, 0)
            self.assertEqual(code, 0, rows)
            self.assertAlmostEqual(float(rows[0]["cpu_before_s"]), .22, delta=.12)
            code, rows = self.run_guard(folder, .8, 0)
            self.assertEqual(code, 1, rows)
            code, rows = self.run_guard(folder, .2, 80_000_000)
            self.assertEqual(code, 1, rows)
            self.assertEqual([row["name"] for row in rows], 3 * ["few kernels"])
            self.assertGreater(float(rows[1]["cpu_ratio"]), 2)
            self.assertGreater(float(rows[2]["peak_ratio"]), 2)
            self.assertGreater(int(rows[2]["peak_now_bytes"]) - int(rows[2]["peak_before_bytes"]), 70_000_000)

    def test_what_does_more_than_before_has_a_bound_of_its_own(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            self.assertEqual(self.run_guard(folder, .3, 0, "integrals")[0], 0)
            code, rows = self.run_guard(folder, .8, 0, "integrals")
            self.assertEqual(code, 1, rows)


if __name__ == "__main__":
    unittest.main()
