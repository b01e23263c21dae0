# SPDX-License-Identifier: Apache-2.0
"""The JSON keys, which are a contract, and figures whose correct value is known."""

import json
import math
import re
import unittest

from command import InFolder, subvol

CELLS = 4  # along each side of the twisted block


class Results(InFolder):
    def assert_keys(self, result, *keys):
        for key in keys:
            self.assertIn(key, result)

    def test_info_counts_a_structured_block(self):
        n = CELLS
        info = self.run_ok("info", f"model:twist:{n}", "--json").json()
        self.assert_keys(info, "points_used", "interior_edge_valence", "singular_nodes", "inverted_cells", "degenerate_cells",
                         "min_scaled_jacobian", "nonmanifold_edges", "nonmanifold_faces", "volume", "bounds", "warnings")
        self.assertEqual(info["points"], (n + 1) ** 3)
        self.assertEqual(info["cells"], n**3)
        self.assertEqual(info["edges"], 3 * n * (n + 1) ** 2)
        self.assertEqual(info["faces"], 3 * n**2 * (n + 1))
        self.assertEqual(info["boundary_faces"], 6 * n**2)
        self.assertEqual(info["interior_edge_valence"], {"4": info["interior_edges"]})
        self.assertEqual([(f["name"], f["location"], f["components"]) for f in info["fields"]], [("density", "point", 1)])
        for field in info["fields"]:
            self.assertLess(field["min"], field["max"])

    def test_info_says_what_opengl_there_is(self):
        info = self.run_ok("info", "--gl", "--json").json()
        gl, devices = info["gl"], info["gl_devices"]
        self.assertEqual(gl is None, not devices)
        if gl is not None:
            self.assertIsInstance(gl["renderer"], str)
            self.assertIsInstance(gl["hardware"], bool)
            self.assertEqual(gl, {key: devices[0][key] for key in ("renderer", "hardware")})
        for index, device in enumerate(devices):
            self.assert_keys(device, "renderer", "hardware", "version", "memory_bytes")
            self.assertEqual(device["index"], index)
            self.assertGreaterEqual(device["max_ssbo_bytes"], 1 << 24)  # the least that OpenGL 4.5 allows
        # Hardware first.
        self.assertEqual(devices, sorted(devices, key=lambda device: not device["hardware"]))

    def test_model_and_subdivide_write_meshes_that_are_read_again(self):
        model = self.run_ok("model", "ball", "-o", "ball.mesh", "--resolution", 2, "--json").json()
        refined = self.run_ok("subdivide", "ball.mesh", "-o", "fine.mesh", "--levels", 2, "--json").json()
        self.assert_keys(refined, "input", "output", "seconds", "peak_bytes")
        self.assertEqual(refined["cells"], 64 * model["cells"])
        info = self.run_ok("info", "fine.mesh", "--json").json()
        self.assertEqual((info["cells"], info["points"]), (refined["cells"], refined["points"]))

    def test_points_are_the_control_points(self):
        points = self.run_ok("points", f"model:twist:{CELLS}", "-o", "a.ply", "--ascii", "--json").json()
        self.assert_keys(points, "input", "output", "seconds", "peak_bytes")
        self.assertEqual(points["points"], (CELLS + 1) ** 3)
        header, _, body = (self.folder / "a.ply").read_text().partition("end_header\n")
        self.assertIn(f"element vertex {points['points']}\n", header)
        rows = [[float(number) for number in line.split()] for line in body.splitlines()[: points["points"]]]
        self.assertTrue(all(len(row) == 14 and all(map(math.isfinite, row)) for row in rows))
        # A frame is S = R² J Jᵀ: positive definite.
        for sxx, sxy, sxz, syy, syz, szz in (row[8:] for row in rows):
            self.assertGreater(sxx, 0)
            self.assertGreater(sxx * syy - sxy * sxy, 0)
            self.assertGreater(sxx * (syy * szz - syz**2) - sxy * (sxy * szz - syz * sxz) + sxz * (sxy * syz - syy * sxz), 0)

    def test_binary_points_have_the_size_that_the_header_gives(self):
        self.run_ok("points", f"model:twist:{CELLS}", "-o", "a.ply")
        header, _, body = (self.folder / "a.ply").read_bytes().partition(b"end_header\n")
        counts = {line.split()[1]: int(line.split()[2]) for line in header.splitlines() if line.startswith(b"element")}
        expected = counts[b"vertex"] * (24 + 44) + counts[b"boundary_vertex"] * 24 + counts[b"boundary_triangle"] * 13
        self.assertEqual(len(body), expected)

    def test_a_linear_density_comes_back_from_the_grid(self):
        made = self.run_ok("vdb", f"model:twist:{CELLS}", "-o", "a.vdb", "--resolution", 48, "--density", "x+2*y-z",
                           "--json").json()
        self.assert_keys(made, "input", "output", "seconds", "peak_bytes", "active_voxels", "cells", "levels")
        info = self.run_ok("info", "a.vdb", "--at", "0.1,0.05,-.1", "--at", "9,9,9", "--json").json()
        grid = info["grids"][0]
        self.assertEqual((grid["name"], grid["active_voxels"]), ("density", made["active_voxels"]))
        self.assert_keys(grid, "voxel_size", "bounds", "min", "max")
        # The scheme and trilinear voxels both reproduce linear data, but a cell's inverse mapping and the float voxels are not
        # exact: 1e-3 is about 1e-4 of the field's range.
        self.assertAlmostEqual(info["at"][0]["value"], 0.1 + 0.1 + 0.1, delta=1e-3)
        self.assertIsNone(info["at"][1]["value"])

    def test_splats_agree_with_tetrahedra(self):
        view = ["--size", "96x64", "--json"]
        splat = self.run_ok("render", "model:twist:16", "-o", "splat.exr", "--backend", "cpu", *view).json()
        self.assert_keys(splat, "input", "output", "seconds", "peak_bytes", "points", "device", "sheets")
        self.assertEqual((splat["sheets"], splat["backend"]), (0, "cpu"))  # a solid that nothing cuts: no kernels
        kernels = self.run_ok("render", "model:twist:16", "-o", "volume.exr", "--look", "volume", "--backend", "cpu", *view).json()
        self.assertEqual(kernels["points"], 17**3)
        tets = self.run_ok("render", "model:twist:16", "-o", "tets.exr", "--method", "tets", "--levels", 2, *view).json()
        self.assert_keys(tets, "input", "output", "seconds", "peak_bytes", "rays", "backend")
        self.assertEqual((tets["cells"], tets["tets"], tets["lost_rays"]), (64 * 16**3, 6 * 64 * 16**3, 0))

        # 40 dB is a hundredth of the full scale: an error in the camera, the optics or the boundary is ten times that.
        close = subvol("compare", "splat.exr", "tets.exr", "--heatmap", "heat.png", "--fail-under", "psnr=40", "--json",
                       folder=self.folder)
        self.assert_keys(close.json(), "mse", "rmse", "mae", "max", "psnr", "passed")
        self.assertEqual(close.code, 0, close.out)
        self.assertIn("heat.png", self.files())
        failed = subvol("compare", "splat.exr", "tets.exr", "--fail-under", "rmse=0", "--json", folder=self.folder)
        self.assertEqual((failed.code, failed.json()["passed"]), (1, False))

    def test_a_picture_equals_itself(self):
        self.run_ok("render", "model:ball:2", "-o", "a.png", "--size", "32")
        same = self.run_ok("compare", "a.png", "a.png", "--fail-under", "psnr=200", "--json").json()
        self.assertEqual((same["max"], same["psnr"], same["passed"]), (0, None, True))  # infinite dB: no JSON number

    def test_demo_writes_what_its_summary_says(self):
        self.run_ok("demo", "-o", "out", "--resolution", 8, "--size", "48x32", "--quiet")
        summary = json.loads((self.folder / "out" / "summary.json").read_text())
        self.assert_keys(summary, "cases", "version", "host")
        self.assertEqual([case["name"] for case in summary["cases"]], ["pawn", "ball", "twist"])
        for case in summary["cases"]:
            self.assert_keys(case, "points", "equivalent_cells", "psnr", "seconds")
            self.assertEqual(set(case["files"]), {"picture", "vdb", "splat", "reference", "difference"})
            for name in case["files"].values():
                self.assertGreater((self.folder / "out" / name).stat().st_size, 0)
        index = (self.folder / "out" / "index.html").read_text()
        linked = set(re.findall(r'(?:src|href)="([^"]*)"', index))
        self.assertEqual(linked, {name for case in summary["cases"] for name in case["files"].values()} | {"summary.json"})

    def test_json_is_all_there_is_on_standard_output(self):
        done = self.run_ok("render", "model:ball:2", "-o", "a.png", "--size", "16", "--json", "--progress", "on")
        self.assertEqual(json.loads(done.out)["warnings"], [])


if __name__ == "__main__":
    unittest.main()
