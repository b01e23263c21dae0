# SPDX-License-Identifier: Apache-2.0
"""Studies do not mislead: what references cannot tell is marked, nothing is its own reference, and pictures made elsewhere have the same camera."""

import csv
import hashlib
import json
import shutil
import unittest
from pathlib import Path

from command import InFolder, subvol

STUDY = {
    "name": "small",
    "inputs": [{"model": "twist", "resolution": 4}],
    "cameras": ["iso", "+x"],
    "size": 48,
    "methods": [{"method": "splat", "per_edge": [1, 2]}],
    "metrics": ["rmse", "psnr", "flip", "ssim", "max", "psnr_edge"],
    "reference": {"tolerance": 0.01, "max_levels": 4},
    "tables": [{"rows": ["view", "label", "per_edge"], "columns": ["rmse", "psnr", "flip", "ssim", "max"]}],
    "pictures": True,
}


class Honest(InFolder):
    def ran(self, *options, code=0, **changes):
        (self.folder / "s.json").write_text(json.dumps(STUDY | changes))
        done = subvol("study", "s.json", "-o", "out", "--json", *options, folder=self.folder)
        self.assertEqual(done.code, code, done.err)
        return done.json() if code != 2 else done

    def rows(self):
        return list(csv.DictReader((self.folder / "out/small/results.csv").read_text().splitlines()))

    def page(self):
        return (self.folder / "out/report.html").read_text()

    def test_every_metric_has_a_floor(self):
        self.ran(methods=[{"method": "tets", "levels": [0, 3]}], tables=[{"rows": ["view", "levels"], "columns": STUDY["metrics"]}],
                 plots=[{"x": "levels", "y": "psnr", "series": "label", "panels": "view", "log_x": False, "log_y": False}])
        page = self.page()
        for metric in STUDY["metrics"]:
            self.assertIn(f"<th>floor of {metric}</th>", page)
            for row in self.rows():
                self.assertGreater(float(row["floor_" + metric]), 0, metric)
        # The levels of tetrahedra and of the reference agree in the limit: what is beyond a floor is marked in table, .tex and plot.
        beyond = [row for row in self.rows() if float(row["rmse"]) <= float(row["floor_rmse"])]
        self.assertTrue(beyond)
        self.assertEqual({row["levels"] for row in beyond}, {"3"})
        self.assertIn("≤ ", page)
        self.assertIn("$\\leq$", (self.folder / "out/small/small.tex").read_text())
        self.assertIn('class="band"', (self.folder / "out/small/small_plot.svg").read_text())
        self.assertIn("floor of each metric", page)

    def test_floors_bound_the_error_of_the_reference_by_another_renderer(self):
        self.ran(reference={"tolerance": 1e-9, "max_levels": 2}, transfer_functions=[{"name": "viridis", "colors": "viridis", "opacity_unit": 0.05}])
        for row in self.rows():
            if row["per_edge"] != "1":
                continue
            reference = json.loads((self.folder / f"out/small/cases/{row['id']}.json").read_text())["notes"]["reference"]
            folder = self.folder / "out/references"
            self.run_ok("render", "model:twist:4", "-o", "finer.exr", "--camera", str(folder / f"cameras/{reference}.json"), "--size", "48x48", "--method",
                        "tets", "--levels", "4", "--tf", "viridis", "--opacity-unit", "0.05", "--look", "volume")  # two levels finer, by tetrahedra
            error = subvol("compare", folder / f"{reference}.exr", self.folder / "finer.exr", "--json").json()
            for metric in ("rmse", "flip", "max"):
                self.assertLess(error[metric], float(row["floor_" + metric]), metric)
            for metric in ("psnr", "ssim"):
                self.assertGreater(error[metric], float(row["floor_" + metric]), metric)

    def test_regions_and_displacements_of_inputs(self):
        vectors = "VECTORS D double\n" + "".join(f"{.5 * z} 0 0\n" for z in (0, 1, 2) for _ in range(4))
        corners = "".join(f"{x} {y} {z}\n" for z in (0, 1, 2) for y in (0, 1) for x in (0, 1))
        cells = "".join("8 " + " ".join(str(4 * k + i) for i in (0, 1, 3, 2, 4, 5, 7, 6)) + "\n" for k in (0, 1))
        (self.folder / "a.vtk").write_text(
            f"# vtk DataFile Version 3.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 double\n{corners}CELLS 2 18\n{cells}"
            f"CELL_TYPES 2\n12\n12\nPOINT_DATA 12\n{vectors}")
        whole = {"file": "a.vtk", "name": "whole", "field": "D.x"}
        inputs = [whole, whole | {"name": "half", "only": "half:0,0,1,0,0,-1"}, whole | {"name": "moved", "warp": "D*2"}]
        self.ran(inputs=inputs, cameras=["+y"], methods=[{"method": "tets", "levels": [0]}], metrics=["rmse"], pictures=False,
                 tables=[{"rows": ["input"], "columns": ["rmse"]}])
        rows = {row["input"]: row for row in self.rows()}
        self.assertEqual({name: int(row["cells"]) for name, row in rows.items()}, {"whole": 2, "half": 1, "moved": 2})
        used = {json.loads(case.read_text())["values"]["input"]: json.loads(case.read_text())["notes"]["camera_used"]
                for case in (self.folder / "out/small/cases").glob("*.json")}
        self.assertNotEqual(used["whole"], used["moved"])  # another box
        self.ran(inputs=[whole | {"only": "half:0,0,9,0,0,1"}], code=1)
        self.assertIn("no cell", self.page())

    def test_a_reference_that_did_not_converge_is_said(self):
        never = {"tolerance": 1e-9, "max_levels": 2}
        result = self.ran(reference=never)
        self.assertEqual([one["reference"] for one in result["not_converged"]], ["twist, iso, viridis", "twist, +x, viridis"])
        self.assertIn("did not converge", " ".join(result["warnings"]))
        page = self.page()
        self.assertIn("2 of 2 references did not converge", page)  # in the paragraph for a paper
        self.assertIn("<td class=\"words\">no</td>", page)
        self.ran("--require-converged", code=1, reference=never)
        self.ran("--require-converged")  # the other reference did

    def test_nothing_is_its_own_reference(self):
        self.ran(cameras=["iso"], methods=[{"method": "dense", "levels": [1, 2, 3, 4]}],
                 tables=[{"rows": "levels", "columns": ["psnr", "flip", "ssim"]}])
        level = int(self.rows()[0]["reference_level"])
        for row in self.rows():
            self.assertEqual(row["psnr"] == "", int(row["levels"]) >= level, row["levels"])
        table = (self.folder / "out/small/small.txt").read_text()
        self.assertIn("= reference", table)
        self.assertNotIn("∞", table)
        self.assertIn("nothing is compared", self.page())

    def test_a_closed_form_is_a_reference(self):
        self.ran(cameras=["iso"], methods=[{"method": "dense", "levels": [0, 3]}, {"method": "exact"}], reference={"method": "exact"},
                 inputs=[{"model": model, "resolution": n} for model, n in (("twist", 4), ("twist", 12), ("ball", 8), ("nozzle", 12), ("pawn", 24))],
                 tables=[{"rows": ["input", "input.resolution", "label", "levels"], "columns": ["psnr"]}])
        psnr = {(row["input"], row["input.resolution"], row["levels"]): row["psnr"] for row in self.rows()}
        self.assertEqual(psnr["twist", "4", ""], "")  # the exact picture has no other reference
        self.assertGreater(float(psnr["twist", "12", "3"]), float(psnr["twist", "4", "3"]) + 10)  # finer meshes come nearer
        for model, n in (("ball", "8"), ("nozzle", "12"), ("pawn", "24")):
            self.assertGreater(float(psnr[model, n, "3"]), 25, model)
        self.assertEqual(self.ran(code=2, methods=[{"method": "exact"}], inputs=[{"model": "cell"}]).err.count("has no closed form"), 1)

    def test_pictures_made_elsewhere_are_a_method(self):
        self.ran()
        theirs = self.folder / "theirs"
        theirs.mkdir()
        cameras = {}
        for row in self.rows():
            reference = json.loads((self.folder / f"out/small/cases/{row['id']}.json").read_text())["notes"]["reference"]
            cameras[row["view"]] = self.folder / f"out/references/cameras/{reference}.json"
        for view, camera in cameras.items():  # another program would draw with this camera
            self.run_ok("render", "model:twist:4", "-o", str(theirs / f"twist_{view}.exr"), "--camera", str(camera), "--size", "48x48", "--method",
                        "tets", "--levels", "3", "--tf", "viridis", "--opacity-unit", "0.05", "--look", "volume")
            shutil.copy(camera, theirs / f"twist_{view}.json")
        methods = STUDY["methods"] + [{"method": "file", "label": "theirs", "file": "theirs/{input}_{view}.exr"}]
        tf = [{"name": "viridis", "colors": "viridis", "opacity_unit": 0.05}]
        self.ran(methods=methods, transfer_functions=tf)
        for row in self.rows():
            if row["method"] == "file":
                self.assertGreater(float(row["psnr"]), 40)
        self.assertIn("theirs", self.page())
        shutil.copy(cameras["iso"], theirs / "twist_+x.json")  # not the camera of the case
        result = self.ran(code=1, methods=methods, transfer_functions=tf)
        self.assertEqual(result["studies"][0]["failed"], 1)
        self.assertIn("the camera is not that of the case", " ".join(result["warnings"]))
        (theirs / "twist_+x.json").unlink()  # its header has the camera
        self.ran(methods=methods, transfer_functions=tf)
        shutil.copy(theirs / "twist_iso.exr", theirs / "twist_+x.exr")
        result = self.ran(code=1, methods=methods, transfer_functions=tf)
        self.assertIn("the camera is not that of the case", " ".join(result["warnings"]))
        (theirs / "twist_+x.exr").unlink()
        self.assertIn("cannot be read", self.ran(code=2, methods=methods, transfer_functions=tf).err)

    def test_a_manifest_names_what_made_the_pictures(self):
        self.ran("--exr")
        first = json.loads((self.folder / "out/small/manifest.json").read_text())
        self.assertEqual(len(first["pictures"]), 4 + 2)  # cases and references
        self.assertIn("subvol study s.json --exr -o out", first["command"])
        self.assertIn("commit", first["versions"])
        for one in first["pictures"]:
            self.assertEqual(hashlib.sha256((self.folder / "out" / one["file"]).read_bytes()).hexdigest(), one["sha256"])
        shutil.rmtree(self.folder / "out")
        self.ran("--exr", "--jobs", "3")
        self.assertEqual(json.loads((self.folder / "out/small/manifest.json").read_text())["pictures"], first["pictures"])

    def test_plots_are_for_print(self):
        self.ran(plots=[{"x": "per_edge", "y": "psnr", "series": "label", "average": "view", "log_y": False},
                        {"x": "seconds", "y": "own_bytes", "series": "label", "panels": "view"}])
        folder = self.folder / "out/small"
        svg = (folder / "small_plot.svg").read_text()
        for words in ("PSNR of linear RGB, dB", ">per edge<", ">1<", ">2<", 'class="bars"'):
            self.assertIn(words, svg)
        self.assertIn("time, s", (folder / "small_plot_2.svg").read_text())
        self.assertIn("memory of the method, bytes", (folder / "small_plot_2.svg").read_text())
        for name in ("small_plot", "small_plot_2", "small_plot_3"):
            for width in ("84mm", "174mm"):
                pdf = (folder / f"{name}_{width}.pdf").read_bytes()
                self.assertGreater(pdf.count(b"/FontFile"), 0)
                self.assertEqual(pdf.count(b"/FontFile"), pdf.count(b"/FontDescriptor\n"))  # each font is embedded
            self.assertIn("\\begin{tikzpicture}", (folder / f"{name}.tex").read_text())
        data = list(csv.DictReader((folder / "small_plot.csv").read_text().splitlines()))
        self.assertEqual([row["x"] for row in data], ["1", "2"])
        self.assertTrue(all(float(row["spread"]) > 0 for row in data))

    def test_keys_have_a_table(self):
        keys = self.run_ok("study", "--keys").out
        for words in ("| `ssim` |", "8-bit sRGB", "| `ssim_linear` |", "67.02 pixels per degree", "| `own_bytes` |", "| `splat` |"):
            self.assertIn(words, keys)
        document = (Path(__file__).parents[2] / "docs/studies.md").read_text()
        self.assertEqual(document.split("<!-- keys: begin -->\n")[1].split("<!-- keys: end -->")[0], keys, "subvol study --keys prints docs/studies.md's tables")


if __name__ == "__main__":
    unittest.main()
