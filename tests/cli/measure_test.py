# SPDX-License-Identifier: Apache-2.0
"""probe, slice and surface: their JSON, their files, what they refuse, and figures whose correct value is known."""

import base64
import csv
import math
import json
import os
import re
import struct
import unittest
from pathlib import Path
from xml.etree import ElementTree

from command import TWO_FIELDS, InFolder, subvol

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

    def test_several_fields_are_chosen_columns_and_curves(self):
        # On one cell T = 293 + 20x and P = 2000z, V from (1,0,0) to (0,0,2) along z.
        (self.folder / "two.vtk").write_text(TWO_FIELDS)
        line = ["probe", "two.vtk", "--line", "0,.5,.25,1,.5,.25", "--count", 5]
        fields = ["--field", "Temp", "--field", "2*Pres", "--field", "V.z", "--field", "Temp"]
        done = self.run_ok(*line, *fields, "-o", "a.csv")
        self.assertNotRegex(done.out, r"V [-\d.]+,")  # of the fields that are not asked for
        with open(self.folder / "a.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(list(rows[0]), ["x", "y", "z", "inside", "cell", "u", "v", "w", "Temp", "2*Pres", "V.z"])
        for row in rows:
            self.assertAlmostEqual(float(row["Temp"]), 293 + 20 * float(row["x"]), delta=1e-4)
            self.assertAlmostEqual(float(row["2*Pres"]), 1000, delta=1e-2)
            self.assertAlmostEqual(float(row["V.z"]), 0.5, delta=1e-5)
        self.run_ok(*line, "--field", "Temp", "-o", "a.csv")
        self.assertEqual((self.folder / "a.csv").read_text().splitlines()[0], "x,y,z,inside,cell,u,v,w,Temp")
        self.run_ok(*line, "-o", "a.csv")  # all of them, with gradients
        self.assertIn(",Temp,Temp_dx,Temp_dy,Temp_dz,Pres,", (self.folder / "a.csv").read_text().splitlines()[0])
        # A curve each, with its name.
        self.run_ok(*line, *fields, "-o", "a.svg")
        plot = (self.folder / "a.svg").read_text()
        for name in ("Temp", "2*Pres", "V.z", "value"):
            self.assertEqual(plot.count(f">{name}<"), 1, name)
        # In JSON the first is the chosen one, and all are there; statistics are of these alone.
        value = self.run_ok(*line, *fields, "--json").json()["values"][0]
        self.assertAlmostEqual(value["value"], 293, delta=1e-4)
        self.assertEqual(set(value["fields"]), {"Temp", "2*Pres", "V.z", "Pres", "V"})
        stats = self.run_ok("probe", "two.vtk", "--stats", *fields, "--json").json()["stats"]["whole"]["fields"]
        self.assertEqual([field["name"] for field in stats], ["Temp", "2*Pres", "V.z"])
        self.assertAlmostEqual(stats[1]["mean"], 2000, delta=1e-3)
        # Computed before the body is cut and moved, as one field is.
        moved = self.run_ok("probe", "two.vtk", "--at", "1.5,.5,.75", "--warp", "V*1", "--field", "Pres", "--field", "x", "--json").json()
        self.assertAlmostEqual(moved["values"][0]["fields"]["x"]["value"], 0.75, delta=1e-4)
        done = subvol("probe", "two.vtk", "--at", "0,0,0", "--field", "Temp", "--field", "none", folder=self.folder)
        self.assertEqual(done.code, 2)
        self.assertRegex(done.err, r"^subvol: [^\n]*none[^\n]*Temp, Pres, V[^\n]*\n$")
        # Other commands take one.
        self.assertEqual(subvol("render", "two.vtk", "-o", "a.png", "--field", "Temp", "--field", "Pres", folder=self.folder).code, 2)

    def test_several_fields_of_bricks_and_of_steps(self):
        for k, warm in enumerate((313, 333)):
            (self.folder / "step.vtk").write_text(TWO_FIELDS.replace("313", str(warm)))
            self.run_ok("subdivide", "step.vtk", "-o", f"step{k}.vtu", "--levels", 1)
        (self.folder / "run.pvd").write_text("""<VTKFile type="Collection"><Collection>
<DataSet timestep="0" file="step0.vtu"/><DataSet timestep="5" file="step1.vtu"/></Collection></VTKFile>""")
        places = ["--at", ".5,.5,.25", "--at", "1,.5,.5", "--field", "Temp", "--field", "Pres/1000"]
        self.run_ok("probe", "run.pvd", *places, "--step", "all", "-o", "a.csv")
        with open(self.folder / "a.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(list(rows[0]), ["step", "time", "of", "Temp", "Pres/1000"])
        for row, temp, pres in zip(rows, (303, 313, 313, 333), (0.5, 1, 0.5, 1)):
            self.assertAlmostEqual(float(row["Temp"]), temp, delta=1e-3)
            self.assertAlmostEqual(float(row["Pres/1000"]), pres, delta=1e-5)
        self.run_ok("probe", "run.pvd", *places, "--step", "all", "-o", "a.svg")
        for name in ("Temp at 0.5,0.5,0.25", "Pres/1000 at 1,0.5,0.5"):
            self.assertEqual((self.folder / "a.svg").read_text().count(f">{name}<"), 1, name)
        self.run_ok("probe", "run.pvd", "--stats", "--field", "Temp", "--field", "Pres", "--step", "all", "-o", "b.svg")
        self.assertEqual((self.folder / "b.svg").read_text().count(">Pres max<"), 1)
        self.run_ok("split", "step1.vtu", "-o", "b.bricks", "--bricks", 2)
        found = self.run_ok("probe", "b.bricks", "--at", ".5,.5,.25", "--field", "Temp", "--field", "V.z", "-o", "b.csv", "--json").json()
        self.assertEqual((self.folder / "b.csv").read_text().splitlines()[0], "x,y,z,inside,cell,u,v,w,Temp,V.z")
        self.assertAlmostEqual(found["values"][0]["fields"]["V.z"]["value"], 0.5, delta=1e-4)

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

    def test_histograms_are_those_of_the_body(self):
        def volume_below(value):  # of a ball, where x² is below a value
            x = math.sqrt(min(max(value, 0), 1))
            return 2 * math.pi * (x - x**3 / 3)
        words = ["probe", "model:ball:6", "--stats", "--density", "x*x", "--bins", 8]
        field = self.run_ok(*words, "-o", "h.csv", "--json").json()["stats"]["whole"]["fields"][0]
        edges = field["histogram_edges"]
        self.assertEqual((len(edges), edges[0], edges[-1]), (9, field["min"], field["max"]))
        with open(self.folder / "h.csv", newline="") as table:
            rows = list(csv.DictReader(table))
        self.assertEqual([(float(row["from"]), float(row["to"])) for row in rows], list(zip(edges, edges[1:])))
        for row, volume in zip(rows, field["histogram"]):
            self.assertEqual((row["part"], row["field"], float(row["volume"])), ("", field["name"], volume))
            self.assertAlmostEqual(volume, volume_below(float(row["to"])) - volume_below(float(row["from"])), delta=5e-3)
        self.run_ok(*words, "-o", "h.svg")
        self.assertIn("volume in each of 8 ranges", (self.folder / "h.svg").read_text())
        (self.folder / "two.vtk").write_text(
            "# vtk DataFile Version 3.0\nbox\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA 8\n"
            + "".join(f"SCALARS {name} double 1\nLOOKUP_TABLE default\n{values}\n" for name, values in (("a", "0 1 0 1 0 1 0 1"), ("b", "0 0 1 1 0 0 1 1"))))
        done = subvol("probe", "two.vtk", "--stats", "-o", "h2.svg", folder=self.folder)
        self.assertEqual((done.code, "--field NAME" in done.err, (self.folder / "h2.svg").exists()), (2, True, False), done.err)
        self.assertEqual(len({row["field"] for row in self.table("two.vtk")}), 2)

    def table(self, name):
        self.run_ok("probe", name, "--stats", "-o", "two.csv")
        with open(self.folder / "two.csv", newline="") as table:
            return list(csv.DictReader(table))

    def test_the_cells_of_the_file_stand_beside_the_limit(self):
        # Eight cells of a ball: a limit without its corners at the unit sphere has more volume than the cells.
        self.run_ok("model", "ball", "--resolution", 2, "-o", "ball.vtu", "--quiet")
        done = self.run_ok("probe", "ball.vtu", "--stats", "--density", "x*x", "--json")
        found = done.json()["stats"]["whole"]
        cells = self.run_ok("info", "model:ball:2", "--json").json()
        self.assertAlmostEqual(found["file_volume"], cells["volume"], delta=1e-9)
        self.assertGreater(found["volume"], 1.05 * found["file_volume"])
        field = found["fields"][0]
        self.assertAlmostEqual(field["file_max"], 1, delta=1e-6)
        self.assertAlmostEqual(abs(field["file_max_at"][0]), 1, delta=1e-6)
        self.assertEqual((field["file_min"], field["file_min_at"][0]), (0, 0))
        self.assertAlmostEqual(field["file_mean"] * found["file_volume"], field["file_integral"], delta=1e-9)
        self.assertTrue(any("more volume than the cells of the file" in line for line in done.json()["warnings"]), done.json()["warnings"])
        said = subvol("probe", "ball.vtu", "--stats", "--density", "x*x", folder=self.folder)
        self.assertRegex(said.out, r"volume +\S+  within \S+ of it · file \S+\n")
        self.assertRegex(said.out, r"max \S+ at \S+  within \S+ · file 1 at point \d+\n")

    def test_verbs_say_where_the_limit_is_another_body(self):
        self.run_ok("model", "ball", "--resolution", 2, "-o", "ball.vtu", "--quiet")
        corners = " ".join(f"{x} {y} {z}" for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)))
        (self.folder / "cube.vtk").write_text(
            f"# vtk DataFile Version 3.0\ncube\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n{corners}\n"
            "CELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\nPOINT_DATA 8\nSCALARS f double 1\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7\n")
        commands = (["vdb", "-o", "a.vdb", "--resolution", "16"], ["render", "-o", "a.png", "--size", "32x32"],
                    ["slice", "-o", "s.png", "--resolution", "40"], ["surface", "-o", "a.ply", "--boundary"], ["info", "--limit"])
        for command in commands:
            for mesh, expected in (("ball.vtu", True), ("cube.vtk", False), ("model:ball:2", False)):
                found = self.run_ok(command[0], mesh, *command[1:], "--json").json()["warnings"]
                self.assertEqual(any("more volume than the cells of the file" in line for line in found), expected, (command, mesh, found))
        limit = self.run_ok("info", "ball.vtu", "--limit", "--json").json()
        whole = self.run_ok("probe", "ball.vtu", "--stats", "--json").json()["stats"]["whole"]
        self.assertAlmostEqual(limit["limit_volume"], whole["volume"], delta=2e-3 * whole["volume"])
        self.assertAlmostEqual(limit["volume"], whole["file_volume"], delta=1e-9)
        self.assertAlmostEqual(limit["limit_bounds"][1][0], 1, delta=1e-9)

    def test_a_body_whose_limit_is_itself_has_no_warning(self):
        self.run_ok("model", "ball", "--resolution", 2, "-o", "ball.vtu", "--quiet")
        done = self.run_ok("probe", "ball.vtu", "--stats", "--scheme", "linear", "--density", "x*y", "--json").json()
        whole = done["stats"]["whole"]
        self.assertEqual((whole["volume"], whole["fields"][0]["mean"]), (whole["file_volume"], whole["fields"][0]["file_mean"]))
        self.assertEqual([line for line in done["warnings"] if "file" in line], [])

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
                              (["--at", "0,0,0", "-o", "a.txt"], ".csv"), (["--patch", "top", "-o", "a.csv"], "--at"),
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

    def test_contours_at_values_and_a_title(self):
        def made(*words, fails=False):
            done = subvol("slice", "model:ball:4", "-o", "c.png", "--resolution", 64, "--density", "300+100*x", "--json", *words, folder=self.folder)
            return done if fails else done.json()
        plain = made()
        size = plain["height"]
        self.assertEqual(made("--contours", "260,350.5")["contours"], [260, 350.5])
        self.assertAlmostEqual(made("--contours", "25%,")["contours"][0], .75 * plain["min"] + .25 * plain["max"])
        self.assertEqual(made("--contours", "round")["contours"], [220, 240, 260, 280, 300, 320, 340, 360, 380])
        beyond = made("--contours", "350,900,")
        self.assertEqual(beyond["contours"], [350, 900])
        self.assertIn("no place of the plane has the value of --contours 900", beyond["warnings"][0])
        for wrong, naming in ("0", "0,: one line"), ("2000", "2000,: one line"), ("few", "few"), ("1,,2", "not a number"), ("", "300,350"):
            done = made("--contours", wrong, fails=True)
            self.assertEqual((done.code, naming in done.err), (2, True), done.err)
        made("--title", "x")  # above the picture, whose places are as they were
        width, height = struct.unpack(">II", (self.folder / "c.png").read_bytes()[16:24])
        self.assertGreater(height, size)
        done = subvol("slice", BOX, "-o", "a.csv", "--title", "x", folder=self.folder)
        self.assertEqual((done.code, "--title" in done.err), (2, True), done.err)

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

    def test_vector_graphics_have_lines_and_letters_as_shapes(self):
        words = ["slice", "model:ball:4", "--resolution", 200, "--contours", "0.25,-0.5", "--contour-labels", "--density", "x", "--title", "A < B", "--json"]
        made = self.run_ok(*words, "-o", "a.svg").json()
        svg = ElementTree.parse(self.folder / "a.svg").getroot()
        name = "{http://www.w3.org/2000/svg}"
        image = svg.find(name + "image")
        png = base64.b64decode(image.get("href").removeprefix("data:image/png;base64,"))
        self.assertEqual(struct.unpack(">II", png[16:24]), (made["width"], made["height"]))
        left, top = float(image.get("x")), float(image.get("y"))
        # The lines x = .25 and x = -.5 of a ball about 0, whose picture is as wide on both sides, from rim to rim.
        lines = {}
        for path in svg.iter(name + "path"):
            if path.get("stroke-opacity"):
                places = [tuple(map(float, place.split())) for place in path.get("d")[1:].split("L")]
                lines[round((places[0][0] - left - made["width"] / 2) * made["step"], 2)] = places
        self.assertEqual(sorted(lines), [-.5, .25])
        for x, places in lines.items():
            self.assertLess(max(across for across, _ in places) - min(across for across, _ in places), .02)
            length = (max(down for _, down in places) - min(down for _, down in places)) * made["step"]
            self.assertAlmostEqual(length, 2 * math.sqrt(1 - x**2), delta=.05)
            self.assertAlmostEqual(sum(down for _, down in places) / len(places) - top, made["height"] / 2, delta=1)
        texts = [text.text for text in svg.iter(name + "text")]
        for text in "A < B", "0.25", "-0.5", "density":
            self.assertIn(text, texts)
        # The page of the .pdf is as large, in points, and the same bytes in every run.
        first = [self.run_ok(*words, "-o", "a.pdf") and (self.folder / "a.pdf").read_bytes() for _ in range(2)]
        self.assertEqual(first[0], first[1])
        box = re.search(rb"/MediaBox \[ 0 0 ([0-9.]+) ([0-9.]+) \]", first[0])
        for points, pixels in zip(box.groups(), (svg.get("width"), svg.get("height"))):
            self.assertAlmostEqual(float(points), .75 * float(pixels), delta=.01)
        self.assertIn(b"DejaVuSans", first[0])
        # Bytes that are no letters are boxes, in a .pdf too.
        for name in ("b.svg", "b.pdf"):
            done = subvol("slice", "model:ball:2", "-o", name, "--resolution", 20, "--title", os.fsdecode(b"a\xffb"), folder=self.folder)
            self.assertEqual((done.code, "boxes stand for letters" in done.err), (0, True), done.err)
        ElementTree.parse(self.folder / "b.svg")

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


class EveryVerb(InFolder):
    """Where the limit is another body than the cells of the file, or leaves the range of a field, each verb says so once."""

    VERBS = (["render", "-o", "a.png", "--size", "32x32"], ["view", "--screenshot", "a.png", "--size", "32x32"], ["page", "-o", "a.html", "--no-reference"],
             ["points", "-o", "a.ply"], ["vdb", "-o", "a.vdb", "--resolution", "16"], ["slice", "-o", "a.png", "--resolution", "16"],
             ["surface", "--boundary", "-o", "a.ply"], ["probe", "--stats"], ["info", "--limit"])

    def test_another_volume(self):
        self.run_ok("model", "ball", "--resolution", 2, "-o", "ball.vtu")
        for verb, *more in self.VERBS:
            with self.subTest(verb=verb):
                said = self.run_ok(verb, "ball.vtu", *more, "--crease-angle", "none").err
                self.assertEqual(said.count("more volume than the cells of the file: a smaller --crease-angle keeps more sharp edges, --scheme linear is the cells"), 1, said)
                self.assertNotIn("volume than", self.run_ok(verb, "model:ball:2", *more).err)  # the limit is what is meant
                if verb not in ("view", "info"):
                    self.assertNotIn("volume than", self.run_ok(verb, "ball.vtu", *more, "--crease-angle", "none", "--scheme", "linear").err)

    def test_values_beyond_the_range(self):
        corners = [(x, y, z) for z in range(2) for y in range(2) for x in range(5)]
        cells = "".join("8 " + " ".join(str(x + i + 5 * (j + 2 * k)) for i, j, k in
                        ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))) + "\n" for x in range(4))
        (self.folder / "beam.vtk").write_text(
            "# vtk DataFile Version 3.0\nb\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 20 double\n" + "".join("%g %g %g\n" % p for p in corners) +
            "CELLS 4 36\n" + cells + "CELL_TYPES 4\n12\n12\n12\n12\nPOINT_DATA 20\nSCALARS T double 1\nLOOKUP_TABLE default\n" +
            "".join("%g\n" % [0, 0, 10, 10, 0][x] for x, _, _ in corners))
        for verb, *more in (["probe", "--stats"], ["slice", "-o", "a.png", "--resolution", "16"], ["points", "-o", "a.ply", "--per-edge", "2"],
                            ["page", "-o", "a.html", "--no-reference"], ["vdb", "-o", "a.vdb", "--resolution", "40"],
                            ["render", "-o", "a.png", "--size", "32x32", "--extremes"], ["render", "-o", "a.png", "--size", "32x32"],
                            ["surface", "-o", "a.ply", "--boundary"]):
            with self.subTest(verb=verb):
                said = self.run_ok(verb, "beam.vtk", *more).err
                # The cubic of MCQ between 0, 0, 10 and 10 goes down to -1.254: by 12.5 % of the range.
                self.assertRegex(said, r"T is -1\.2\d* to 11\.[24]\d* in the limit, beyond its range in the file by (at least )?1[23] %: --clamp file keeps it within")
                self.assertEqual(said.count("beyond its range"), 1)
                self.assertNotIn("beyond its range", self.run_ok(verb, "beam.vtk", *more, "--clamp", "file").err)
                # The file has no derivatives at its points, and so no range of theirs.
                self.assertNotIn("range in the file", self.run_ok(verb, "beam.vtk", *more, "--field", "grad(T).x").err)
        found = self.run_ok("slice", "beam.vtk", "-o", "a.png", "--resolution", "16", "--json").json()
        self.assertAlmostEqual(found["file_min"], 0, 12)
        self.assertAlmostEqual(found["file_max"], 10, 12)
        self.assertLess(found["min"], -1.2)
        self.assertTrue(2 - 1e-3 <= found["file_max_at"][0] <= 3 + 1e-3, found["file_max_at"])
        # The plane z = 1/2 of a beam of 4: trapezoids of T have the means 0, 5, 10, 5.
        self.assertAlmostEqual(found["file_area"], 4, 4)  # by squares, which reach a little beyond
        self.assertAlmostEqual(found["file_mean"], 5, 4)
        self.assertAlmostEqual(found["area"], 4, 4)
        self.assertNotAlmostEqual(found["mean"], 5, 2)
        kept = self.run_ok("points", "beam.vtk", "-o", "a.ply", "--per-edge", "2", "--clamp", "file", "--json").json()
        self.assertGreater(kept["clamped"], 0)

    def test_what_there_is_none_of_is_null(self):
        """Derivatives have no figures of the file: nor have these a place."""
        self.run_ok("model", "ball", "--resolution", 3, "-o", "ball.vtu", "--quiet")
        words = ["--field", "grad(density).x", "--json"]
        field = self.run_ok("probe", "ball.vtu", "--stats", *words).json()["stats"]["whole"]["fields"][0]
        sliced = self.run_ok("slice", "ball.vtu", "-o", "a.png", "--resolution", "16", *words).json()
        drawn = self.run_ok("render", "ball.vtu", "-o", "a.png", "--size", "32x32", "--extremes", *words).json()["extremes"]
        for found in (field, sliced, drawn):
            for name in ("min", "max"):
                self.assertEqual((found["file_" + name], found["file_" + name + "_at"]), (None, None))
                self.assertEqual(len(found[name + "_at"]), 3)
        self.assertEqual((field["file_mean"], sliced["file_mean"]), (None, None))
        self.assertGreater(sliced["file_area"], 1)

    def test_folds_are_said(self):
        """A box whose layers change their width at once: its cells are sound, and the limit overshoots."""
        places = (0, 1, 2, 3, 3.05, 3.1, 4, 5)
        number = lambda i, j, k: i + 8 * (j + 3 * k)
        cells = [[number(i + a, j + b, k + c) for a, b, c in ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))]
                 for k in range(2) for j in range(2) for i in range(7)]
        (self.folder / "jump.vtk").write_text(
            "# vtk DataFile Version 3.0\nb\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 72 double\n"
            + "".join(f"{x} {y} {z}\n" for z in range(3) for y in range(3) for x in places)
            + f"CELLS {len(cells)} {9 * len(cells)}\n" + "".join("8 " + " ".join(map(str, c)) + "\n" for c in cells)
            + f"CELL_TYPES {len(cells)}\n" + "12\n" * len(cells))
        folded = subvol("check", "jump.vtk", "--json", folder=self.folder).json()["cells"]["folded"]
        done = self.run_ok("probe", "jump.vtk", "--stats", "--json").json()
        self.assertGreater(folded, 0)
        self.assertTrue(0 < done["stats"]["folded_cells"] <= folded)
        self.assertEqual(sum("the limit folds in at least" in line and "subvol check" in line for line in done["warnings"]), 1, done["warnings"])
        self.assertEqual(self.run_ok("probe", "model:ball:3", "--stats", "--json").json()["stats"]["folded_cells"], 0)


if __name__ == "__main__":
    unittest.main()
