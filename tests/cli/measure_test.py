# SPDX-License-Identifier: Apache-2.0
"""probe, slice and surface: their JSON, their files, what they refuse, and figures whose correct value is known."""

import csv
import math
import json
import os
import struct
import unittest
from pathlib import Path

from command import InFolder, subvol

BOX = "model:twist:4"
POST = Path(os.environ.get("SUBVOL_DATA", "/nowhere")) / "vtkdata_post_tet.vtk"


class Refusing(InFolder):
    def assert_refused(self, *arguments, naming):
        done = subvol(*arguments, folder=self.folder)
        self.assertEqual(done.code, 2, done.err)
        self.assertIn(naming, done.err)
        self.assertEqual(self.files(), [])


class Probe(Refusing):
    def test_places_have_values_gradients_cells_and_parameters(self):
        found = self.run_ok("probe", BOX, "--at", "0,0,0", "--at", "9,0,0", "--density", "x+2*y-z", "--json").json()
        self.assertEqual((found["places"], found["inside"]), (2, 1))
        here, away = found["values"]
        self.assertEqual(here["at"], [0, 0, 0])
        self.assertTrue(here["inside"])
        self.assertAlmostEqual(here["value"], 0, delta=1e-5)
        # A linear field is linear in the limit, whatever the mesh.
        for got, exact in zip(here["gradient"], (1, 2, -1)):
            self.assertAlmostEqual(got, exact, delta=1e-5)
        self.assertIsInstance(here["cell"], int)
        self.assertTrue(all(0 <= t <= 1 for t in here["parameters"]))
        self.assertEqual(here["fields"]["density"]["value"], here["value"])
        self.assertFalse(away["inside"])
        self.assertIsNone(away["value"])
        self.assertIsNone(away["cell"])

    def test_a_line_is_a_table_or_a_plot(self):
        self.run_ok("probe", "model:ball:4", "--line=-2,0,0,2,0,0", "--count", 41, "-o", "a.csv", "--quiet")
        with open(self.folder / "a.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 41)
        for row in rows:
            self.assertEqual(row["inside"] == "1", abs(float(row["x"])) <= 1.000001, row)
            self.assertEqual(row["density"] == "", row["inside"] == "0")
        self.run_ok("probe", "model:ball:4", "--line=-2,0,0,2,0,0", "-o", "a.svg", "--quiet")
        self.assertIn("<svg", (self.folder / "a.svg").read_text())

    def test_tables_of_places_with_and_without_a_header(self):
        for text in ("0,0,0\n.1;.2;.3\n", "# places\nid z y x\n7 0 0 0\n8 .3 .2 .1\n", "\ufeffx,y,z\r\n0,0,0\r\n.1,.2,.3\r\n"):
            (self.folder / "in.csv").write_text(text, encoding="utf-8")
            found = self.run_ok("probe", "model:ball:4", "--points", "in.csv", "--json").json()
            self.assertEqual([v["at"] for v in found["values"]], [[0, 0, 0], [.1, .2, .3]], text)

    def test_stats_are_those_of_the_body(self):
        found = self.run_ok("probe", "model:ball:6", "--stats", "--density", "x*x", "--json").json()["stats"]
        whole = found["whole"]
        self.assertAlmostEqual(whole["volume"] / (4 / 3 * math.pi), 1, delta=1e-3)
        field = whole["fields"][0]
        self.assertAlmostEqual(field["mean"], 1 / 5, delta=2e-3)
        self.assertAlmostEqual(field["max"], 1, delta=2e-3)
        self.assertAlmostEqual(abs(field["max_at"][0]), 1, delta=1e-2)
        self.assertAlmostEqual(sum(field["histogram"]), whole["volume"], delta=1e-6)
        self.assertEqual(found["parts"], [])

    def test_stats_of_a_named_field_are_its_alone(self):
        self.run_ok("model", "twist", "--resolution", 3, "-o", "a.vtu")
        every, alone, places = (self.run_ok("probe", "a.vtu", "--stats", *more, "--json").json()["stats"]["whole"] for more in
                                ([], ["--density", "x"], ["--density", "x", "--at", "0,0,0"]))
        names = [[field["name"] for field in found["fields"]] for found in (every, alone, places)]
        self.assertEqual(names[1], ["density"])
        self.assertEqual(names[2][0], "density")
        self.assertEqual(len(names[2]), len(names[0]) + ("density" not in names[0]))
        for found in (every, alone):
            self.assertLessEqual(found["error"], 1e-4)
            self.assertTrue(all(field["extreme_error"] >= 0 for field in found["fields"]))

    @unittest.skipUnless(POST.is_file(), "SUBVOL_DATA names no collection with vtkdata_post_tet.vtk")
    def test_extremes_are_said_to_a_ten_thousandth_of_the_range(self):
        # At level 4 the limit could still go beyond the values that were found, by half as much again.
        field = self.run_ok("probe", POST, "--stats", "--field", "Pressure", "--json").json()["stats"]["whole"]["fields"][0]
        self.assertLessEqual(field["extreme_error"], 1e-4 * (field["max"] - field["min"]))

    def test_what_makes_no_sense_is_refused(self):
        (self.folder / "bad.csv").write_text("0,0,0\n1,two,3\n")
        (self.folder / "empty.csv").write_text("# nothing\n")
        for words, naming in [([], "--at"), (["--at", "1,2"], "--at"), (["--line", "0,0,0,1,1"], "--line"),
                              (["--points", "bad.csv"], "bad.csv:2"), (["--points", "empty.csv"], "no places"),
                              (["--points", "none.csv"], "none.csv"), (["--at", "0,0,0", "-o", "a.svg"], "--line"),
                              (["--at", "0,0,0", "-o", "a.txt"], ".csv"), (["--stats", "-o", "a.csv"], "--at"),
                              (["--line", "5,5,5,6,6,6", "-o", "a.svg"], "outside"), (["--at", "nan,0,0"], "--at")]:
            done = subvol("probe", BOX, *words, folder=self.folder)
            self.assertIn(done.code, (2, 3), words)
            self.assertIn(naming, done.err, words)


class Slice(Refusing):
    def test_pictures_and_tables(self):
        for name in ("a.png", "a.exr", "a.csv", "a.vtp"):
            made = self.run_ok("slice", "model:ball:4", "-o", name, "--resolution", 32, "--contours", 3, "--json").json()
            self.assertEqual(made["output"], name)
            self.assertEqual(max(made["width"], made["height"]), 32)
            self.assertEqual(len(made["contours"]), 3)
            self.assertGreater((self.folder / name).stat().st_size, 500)
        self.assertAlmostEqual(made["inside"] * made["step"]**2, math.pi, delta=.25)

    def test_coordinates_labels_and_marks(self):
        plain = self.run_ok("slice", "model:ball:4", "-o", "a.png", "--resolution", 200, "--contours", 4, "--density", "x", "--json").json()
        sizes = set()
        for words in [], ["--axes"], ["--contour-labels"], ["--extremes"]:
            made = self.run_ok("slice", "model:ball:4", "-o", "b.png", "--resolution", 200, "--contours", 4, "--density", "x", *words, "--json").json()
            sizes.add((self.folder / "b.png").read_bytes())
            self.assertEqual((made["width"], made["height"], made["min"]), (plain["width"], plain["height"], plain["min"]))
        self.assertEqual(len(sizes), 4)
        self.assertAlmostEqual(made["extremes"]["min_at"][0], made["min"], delta=1e-6)
        for wrong, naming in (["--contour-labels"], "--contours"), (["--axes", "-o", "a.csv"], "--axes"), (["--extremes", "-o", "a.vtp"], "--extremes"):
            done = subvol("slice", BOX, *([] if "-o" in wrong else ["-o", "a.png"]), *wrong, folder=self.folder)
            self.assertEqual((done.code, naming in done.err), (2, True), done.err)

    def test_what_makes_no_sense_is_refused(self):
        for words, naming in [(["--plane", "0,0,0,0,0,0"], "direction"), (["--plane", "0,0,9,0,0,1"], "misses"),
                              (["--plane", "0,0,0"], "--plane"), (["--range", "1,0"], "--range"), (["--tf", "vridis"], "viridis"),
                              (["--background", "whit"], "white")]:
            done = subvol("slice", BOX, "-o", "a.png", *words, folder=self.folder)
            self.assertEqual(done.code, 2, words)
            self.assertIn(naming, done.err, words)
            self.assertFalse((self.folder / "a.png").exists())
        self.assert_refused("slice", BOX, "-o", "a.jpg", naming=".png")


def stl_triangles(path):
    data = path.read_bytes()
    count = struct.unpack_from("<I", data, 80)[0]
    assert len(data) == 84 + 50 * count
    for t in range(count):
        numbers = struct.unpack_from("<12f", data, 84 + 50 * t)
        yield numbers[:3], (numbers[3:6], numbers[6:9], numbers[9:12])


class Surface(Refusing):
    def test_a_boundary_is_closed_with_the_volume_that_info_has(self):
        made = self.run_ok("surface", "model:ball:6", "-o", "a.stl", "--json").json()
        self.assertTrue(made["watertight"])
        self.assertEqual(made["euler"], 2)
        self.assertAlmostEqual(made["volume"] / (4 / 3 * math.pi), 1, delta=5e-3)
        self.assertGreater(made["min_angle"], 5)
        triangles = list(stl_triangles(self.folder / "a.stl"))
        self.assertEqual(len(triangles), made["triangles"])
        edges = {}
        for normal, corners in triangles:
            self.assertGreater(sum(n * sum(c[k] for c in corners) for k, n in enumerate(normal)), 0)
            for k in range(3):
                edge = (corners[k], corners[(k + 1) % 3])
                edges[edge] = edges.get(edge, 0) + 1
        self.assertTrue(all(n == 1 and edges.get((b, a)) == 1 for (a, b), n in edges.items()))

    def test_isosurfaces_in_all_formats(self):
        for end in ("ply", "vtp", "obj", "glb"):
            made = self.run_ok("surface", BOX, "-o", f"a.{end}", "--iso", 0, "--iso", .3, "--cap", "--color-field", "density",
                               "--json").json()
            self.assertTrue(made["watertight"])
            self.assertGreater((self.folder / f"a.{end}").stat().st_size, 1000)
        self.assertTrue((self.folder / "a.obj").read_text().startswith("# OpenSubVol\nv "))
        glb = (self.folder / "a.glb").read_bytes()
        self.assertEqual(struct.unpack_from("<4sII", glb), (b"glTF", 2, len(glb)))
        length, = struct.unpack_from("<I", glb, 12)
        scene = json.loads(glb[20:20 + length])
        self.assertEqual(struct.unpack_from("<I4s", glb, 20 + length), (scene["buffers"][0]["byteLength"], b"BIN\0"))
        primitive = scene["meshes"][0]["primitives"][0]
        self.assertEqual(sorted(primitive["attributes"]), ["COLOR_0", "NORMAL", "POSITION"])
        place = scene["accessors"][primitive["attributes"]["POSITION"]]
        view = scene["bufferViews"][place["bufferView"]]
        points = list(struct.iter_unpack("<3f", glb[28 + length:][view["byteOffset"]:view["byteOffset"] + view["byteLength"]]))
        self.assertEqual(len(points), place["count"])
        self.assertEqual([min(p[k] for p in points) for k in range(3)], place["min"])  # as floats, exactly
        self.assertEqual([max(p[k] for p in points) for k in range(3)], place["max"])

    def test_what_makes_no_sense_is_refused(self):
        for words, naming in [(["--iso", 99], "--iso"), (["--iso", "x"], "--iso"), (["--cap"], "--iso"),
                              (["--tolerance", 0, "--boundary"], "--tolerance"), (["--boundary", "--color-field", "dens"], "density"),
                              (["--iso", "nan"], "finite")]:
            done = subvol("surface", BOX, "-o", "a.ply", *words, folder=self.folder)
            self.assertEqual(done.code, 2, words)
            self.assertIn(naming, done.err, words)
            self.assertFalse((self.folder / "a.ply").exists())
        self.assert_refused("surface", BOX, "-o", "a.off", naming=".ply")
        self.assert_refused("surface", BOX, "-o", "a.stl", "--color-field", "density", naming=".ply")


class Points(Refusing):
    def test_errors_are_a_channel_and_figures(self):
        made = self.run_ok("points", BOX, "-o", "a.ply", "--error", "--json").json()
        self.assertLess(made["error_rms"], made["error_max"])
        channels = self.run_ok("info", "a.ply", "--json").json()["channels"]
        self.assertEqual([channel["name"] for channel in channels], ["density", "density_error"])
        self.assertAlmostEqual(channels[1]["max"], made["error_max"], 6)

    def test_only_meshes_have_a_limit(self):
        self.run_ok("vdb", BOX, "-o", "a.vdb", "--resolution", 10)
        done = subvol("points", "a.vdb", "-o", "a.ply", "--error", folder=self.folder)
        self.assertEqual(done.code, 2)
        self.assertIn("needs a mesh", done.err)


if __name__ == "__main__":
    unittest.main()
