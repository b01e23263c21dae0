# SPDX-License-Identifier: Apache-2.0
"""The Blender add-on, without a window."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))
from command import COMMAND, TWO_FIELDS, subvol  # noqa: E402

MAP = [{"Name": "mine", "ColorSpace": "RGB", "RGBPoints": [0, 0, 0, 1, 0.5, 1, 1, 1, 1, 1, 0, 0], "Points": [0, 0, .5, 0, 1, .8, .5, 0]}]


class Blender(unittest.TestCase):
    def test_imports(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(os.environ.get("SUBVOL_SCREENSHOTS") or name)
            folder.mkdir(parents=True, exist_ok=True)
            (folder / "two.vtk").write_text(TWO_FIELDS)
            (folder / "map.json").write_text(json.dumps(MAP))
            entries = ""
            for step in range(3):
                done = subvol("subdivide", "model:ball:4", "-o", f"run{step}.vtu", "--levels", "0", folder=folder)
                self.assertEqual(done.code, 0, done.err)
                entries += f'<DataSet timestep="{step}" file="run{step}.vtu"/>'
            (folder / "run.pvd").write_text(f'<VTKFile type="Collection" version="0.1"><Collection>{entries}</Collection></VTKFile>')
            done = subprocess.run(["blender", "-b", "--factory-startup", "-noaudio", "-t", "2", "--python-exit-code", "9", "--python",
                                   str(Path(__file__).with_name("scene.py")), "--", str(folder)],
                                  env=os.environ | {"SUBVOL_COMMAND": COMMAND}, capture_output=True, text=True, timeout=3000)
            self.assertEqual(done.returncode, 0, done.stdout[-2000:] + done.stderr[-2000:])
            facts = json.loads((folder / "facts.json").read_text())
        self.assertEqual(facts["objects"], ["ball", "nozzle", "two"])
        self.assertEqual(facts["grids"], ["Pres", "Temp", "coverage"])
        self.assertEqual(facts["scale"], [1.5] * 3)
        self.assertEqual(facts["stops"], 3)
        self.assertEqual(facts["first_color"], [0, 0, 1, 1])
        self.assertAlmostEqual(facts["opacity"], 0.8, places=5)
        self.assertEqual(facts["again"], [3, 7, "nozzle"])
        self.assertEqual(facts["sequence"], [True, 3, 1, "vel", "SECOND", 3])
        self.assertEqual(facts["frame_files"], [f"run_000{k}.vdb" for k in range(3)])
        self.assertIn("gone.vtu", facts["error"])
        self.assertGreater(facts["lit"], 0.02)
        self.assertLess(facts["lit"], 0.8)


if __name__ == "__main__":
    if not shutil.which("blender"):
        print("skipped: no blender here", file=sys.stderr)
        sys.exit(77)
    unittest.main()
