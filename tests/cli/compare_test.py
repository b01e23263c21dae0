# SPDX-License-Identifier: Apache-2.0
"""The verb `compare`: figures whose correct value is known, exit codes, and one sentence for inputs that cannot be compared."""

import math
import re
import struct
import unittest

from command import CUBE, TWO_FIELDS, X_AND_Z, InFolder, subvol

GREY = 0.25


def pfm(path, width, height, pixel):
    """A picture of 32-bit floats, which OpenImageIO reads: pixel(x, y) gives red, green, blue; rows from the bottom."""
    rows = [struct.pack("<3f", *pixel(x, y)) for y in reversed(range(height)) for x in range(width)]
    path.write_bytes(f"PF\n{width} {height}\n-1.0\n".encode() + b"".join(rows))


def ppm(path, width, height, pixel):
    """8 bits per channel, sRGB."""
    path.write_bytes(f"P6\n{width} {height}\n255\n".encode() + bytes(v for y in range(height) for x in range(width) for v in pixel(x, y)))


class Pictures(InFolder):
    def setUp(self):
        super().setUp()
        pfm(self.folder / "grey.pfm", 40, 30, lambda x, y: (GREY,) * 3)
        pfm(self.folder / "lighter.pfm", 40, 30, lambda x, y: (GREY + 0.125,) * 3)

    def compared(self, *arguments):
        return self.run_ok("compare", *arguments, "--json").json()

    def test_plain_pictures(self):
        figures = self.compared("lighter.pfm", "grey.pfm")
        self.assertEqual((figures["mse"], figures["rmse"], figures["mae"], figures["max"]), (1 / 64, 0.125, 0.125, 0.125))
        self.assertAlmostEqual(figures["psnr"], 20 * math.log10(8), places=9)
        a, b = GREY, GREY + 0.125
        self.assertAlmostEqual(figures["ssim_linear"], (2 * a * b + 1e-4) / (a * a + b * b + 1e-4), places=6)
        # sRGB of .25 and .375 is 137 and 165 of 255: rounded from 136.96 and 164.96. ssim is of these, as in the paper.
        seen, lighter = 137 / 255, 165 / 255
        self.assertAlmostEqual(figures["ssim"], (2 * seen * lighter + 1e-4) / (seen ** 2 + lighter ** 2 + 1e-4), places=6)
        self.assertEqual(figures["srgb8"]["ssim"], figures["ssim"])
        self.assertAlmostEqual(figures["srgb8"]["max"], (165 - 137) / 255, places=6)
        # The lightness L* of these greys is 57.08 and 67.65: HyAB 10.57, ^.7 and to the bend at .4 * 41.276 = 16.510.
        lightness = [116 * v ** (1 / 3) - 16 for v in (a, b)]
        self.assertAlmostEqual(figures["flip"], 0.95 * (lightness[1] - lightness[0]) ** 0.7 / (0.4 * 41.27610), places=4)
        self.assertIs(figures["passed"], True)
        self.assertEqual((figures["input"], figures["reference"]), ("lighter.pfm", "grey.pfm"))

    def test_eight_bits_are_decoded(self):
        # 188 of 255 is sRGB for .5029: against .5 in floats.
        ppm(self.folder / "half.ppm", 8, 8, lambda x, y: (188, 188, 188))
        pfm(self.folder / "half.pfm", 8, 8, lambda x, y: (0.5, 0.5, 0.5))
        figures = self.compared("half.ppm", "half.pfm")
        self.assertAlmostEqual(figures["max"], ((188 / 255 + 0.055) / 1.055) ** 2.4 - 0.5, places=6)
        self.assertEqual(figures["srgb8"]["max"], 0)

    def test_conditions_decide_the_exit_code(self):
        def code(*demands):
            return subvol("compare", "lighter.pfm", "grey.pfm", *(f"--fail-under={d}" for d in demands), folder=self.folder).code

        self.assertEqual(code("psnr=18", "rmse=.126", "ssim=.9", "flip=.3", "srgb8.max=.2"), 0)
        for failing in ("psnr=18.1", "rmse=.124", "ssim=.99", "flip=.2", "mse=0", "mae=0", "max=.1", "srgb8.psnr=60"):
            self.assertEqual(code("psnr=0", failing), 1, failing)

    def test_equal_pictures(self):
        figures = self.compared("grey.pfm", "grey.pfm", "--hdr", "--oiio", "--fail-under", "flip=0", "--fail-under", "ssim=1")
        self.assertEqual((figures["rmse"], figures["ssim"], figures["flip"], figures["hdr_flip"]), (0, 1, 0, 0))
        self.assertEqual(figures["oiio"], {"warnings": 0, "failures": 0, "yee_failures": 0})
        self.assertIsNone(figures["psnr"])  # infinite: no JSON number

    def test_silhouette_and_interior_are_told_apart(self):
        def disc(light, rim):
            return lambda x, y: ((light,) * 3 if (d := math.hypot(x - 20, y - 15)) <= 8 else (rim,) * 3 if d <= 9 else (0, 0, 0))

        pfm(self.folder / "disc.pfm", 40, 30, disc(0.5, 0))
        pfm(self.folder / "larger.pfm", 40, 30, disc(0.5, 0.5))
        pfm(self.folder / "darker.pfm", 40, 30, disc(0.25, 0))
        figures = self.compared("larger.pfm", "disc.pfm", "--edge-band", 2)
        self.assertEqual((figures["interior"]["max"], figures["edge"]["max"]), (0, 0.5))
        figures = self.compared("darker.pfm", "disc.pfm", "--edge-band", 2, "--fail-under", "interior.rmse=.26")
        self.assertEqual(figures["interior"]["rmse"], 0.25)

    def test_heat_maps(self):
        pfm(self.folder / "spot.pfm", 40, 30, lambda x, y: (GREY + (0.5 if (x, y) == (20, 15) else 0),) * 3)
        for metric in ("abs", "flip", "ssim"):
            self.run_ok("compare", "spot.pfm", "grey.pfm", "--heatmap", f"{metric}.exr", "--heatmap-of", metric)
            # The legend's bar runs from the first colour to the last; equal pictures have only the first.
            self.run_ok("compare", "grey.pfm", "grey.pfm", "--heatmap", "none.exr", "--heatmap-of", metric)
            figures = self.compared(f"{metric}.exr", "none.exr")
            self.assertGreater(figures["max"], 0.5, metric)
        # A difference in one pixel is a spot of one pixel; FLIP and SSIM spread it as far as their filters reach.
        self.assertLess(self.compared("abs.exr", "none.exr")["mae"], self.compared("flip.exr", "none.exr")["mae"])

    def test_optical_depth(self):
        for name, unit in (("a", 1), ("b", 0.5)):
            self.run_ok("render", "model:ball:2", "-o", f"{name}.exr", "--method", "tets", "--ortho", "--size", "32",
                        "--opacity", "0%:.1,100%:.1", "--opacity-unit", unit)
        # Half the unit is twice the extinction, everywhere.
        figures = self.compared("b.exr", "a.exr", "--optical-depth", "--fail-under", "optical_depth_error=1.01")
        self.assertAlmostEqual(figures["optical_depth_error"], 1, places=4)


class Parts(InFolder):
    """Crops: pictures whose data window is a part of their display window, as shares of a picture are."""

    def setUp(self):
        super().setUp()
        options = ["--size", "48x40", "--look", "volume"]
        self.run_ok("render", "model:ball:3", "-o", "whole.exr", *options)
        for part in (1, 2):
            self.run_ok("render", "model:ball:3", "-o", f"part{part}.exr", *options, "--part", f"{part}/2")

    def test_shares_have_no_pixel_in_common(self):
        done = subvol("compare", "part1.exr", "part2.exr", "--heatmap", "h.png", folder=self.folder)
        self.assertEqual(done.code, 2, done.err)
        self.assertRegex(done.err, r"^subvol: part1\.exr: [^\n]*part2\.exr[^\n]*no pixel in common[^\n]*\n$")
        self.assertNotIn("h.png", self.files())

    def test_a_share_is_compared_with_its_part_of_the_whole(self):
        for part in (1, 2):
            for a, b in ((f"part{part}.exr", "whole.exr"), ("whole.exr", f"part{part}.exr")):
                figures = self.run_ok("compare", a, b, "--json").json()
                self.assertEqual(figures["max"], 0, (a, b))
                self.assertEqual((figures["window"]["left"], figures["window"]["width"]), (0, 48))
        self.assertIn("where the two overlap", self.run_ok("compare", "part1.exr", "whole.exr").out)
        self.run_ok("compare", "part2.exr", "whole.exr", "--heatmap", "h.exr")
        self.assertNotIn("window", self.run_ok("compare", "whole.exr", "whole.exr", "--json").json())

    def test_parts_of_other_pictures_are_refused(self):
        self.run_ok("render", "model:ball:3", "-o", "other.exr", "--size", "48x44", "--look", "volume", "--part", "1/2")
        for a, b in (("part1.exr", "other.exr"), ("whole.exr", "other.exr")):
            done = subvol("compare", a, b, folder=self.folder)
            self.assertEqual(done.code, 2, done.err)
            self.assertRegex(done.err, r"^subvol: [^\n]*48 x 40[^\n]*48 x 44[^\n]*\n$")


class Fields(InFolder):
    def compared(self, *arguments):
        return self.run_ok("compare", *arguments, "--json").json()

    def test_linear_fields_of_a_cube(self):
        # The cube of one cell stays a cube at every level. Its voxels of .05 have centres from 0 to .95, hence fill 0 - .025 to
        # 1 - .025 along each axis: where both fields have a value, 1+x against 1 has mean .4875 and mean square .975^2/3. Cells of .025
        # fit both: the integrals are exact.
        (self.folder / "cube.mesh").write_text(CUBE.format(last=8))
        self.run_ok("vdb", "cube.mesh", "-o", "one.vdb", "--density", "1", "--resolution", 20)
        figures = self.compared("cube.mesh", "one.vdb", "--density", "1+x", "--levels", 0, "--samples", 40000, "--resolution", 41)
        self.assertAlmostEqual(figures["l1"], 0.4875, delta=4 * 0.29 / 190)  # four standard deviations
        self.assertAlmostEqual(figures["l2"] ** 2, 0.975**2 / 3, delta=4 * 0.3 / 190)
        self.assertAlmostEqual(figures["mass"], 0.5, places=6)
        self.assertAlmostEqual(figures["gradient_rmse"], 1, places=6)
        self.assertEqual(figures["samples"] + figures["uncovered"], 40000)
        self.assertAlmostEqual(figures["samples"] / 40000, 0.975**3, delta=4 * 0.26 / 200)
        self.assertEqual((figures["a"]["input"], figures["b"]["input"]), ("cube.mesh", "one.vdb"))

    def test_a_part_of_the_reference_is_not_the_reference(self):
        # The first mesh covers a quarter of the second, and is equal to it there.
        (self.folder / "cube.mesh").write_text(CUBE.format(last=8))
        points, cells = CUBE.format(last=8).split("Hexahedra")
        (self.folder / "slab.mesh").write_text(points.replace("\n1 ", "\n.25 ") + "Hexahedra" + cells)
        self.assertNotIn("\n1 ", points.replace("\n1 ", "\n.25 "))
        options = ["--density", "x", "--levels", 0, "--samples", 2000, "--resolution", 8]
        for demands in (["--fail-under", "linf=10"], ["--coverage", 0.9], ["--coverage", 0.9, "--fail-under", "linf=10"]):
            done = subvol("compare", "slab.mesh", "cube.mesh", *options, *demands, "--json", folder=self.folder)
            self.assertEqual(done.code, 1, done.err)
            figures = done.json()
            self.assertIs(figures["passed"], False)
            self.assertLess(figures["linf"], 1e-12)
            self.assertAlmostEqual(figures["coverage"], 0.25, delta=0.05)
            self.assertEqual(figures["coverage"], figures["samples"] / 2000)
            self.assertIn(f"{figures['samples']} of 2000 places", figures["warnings"][0])
            done = subvol("compare", "slab.mesh", "cube.mesh", *options, *demands, folder=self.folder)
            self.assertEqual(done.code, 1, done.err)
            self.assertIn(f"{figures['samples']} of 2000 places", done.err)
            self.assertRegex(done.out, rf"covered +{figures['samples']} of 2000 places")
            self.assertRegex(done.out, r"verdict +failed: [^\n]*coverage")
        # Without a demand it measures only, and says the same.
        done = self.run_ok("compare", "slab.mesh", "cube.mesh", *options, "--json")
        self.assertIs(done.json()["passed"], False)
        self.assertIn("of 2000 places", done.json()["warnings"][0])
        figures = self.compared("slab.mesh", "cube.mesh", *options, "--coverage", 0.2, "--fail-under", "linf=1e-9")
        self.assertIs(figures["passed"], True)
        self.assertIn("passed", self.run_ok("compare", "slab.mesh", "cube.mesh", *options, "--coverage", 0, "--fail-under", "linf=1").out)
        # The other way round the whole domain of the reference is covered.
        self.assertEqual(self.compared("cube.mesh", "slab.mesh", *options, "--coverage", 1)["coverage"], 1)

    def test_a_mesh_equals_itself(self):
        figures = self.compared("model:ball:2", "model:ball:2", "--levels", 1, "--iso", 0.5, "--samples", 2000, "--resolution",
                                24, "--fail-under", "l2=0")
        for name in ("l1", "l2", "linf", "gradient_rmse", "mass"):
            self.assertEqual(figures[name], 0, name)
        self.assertLess(figures["hausdorff"], 1e-12)

    def test_every_mesh_format_is_a_field(self):
        # A grid of VTK's, for which no list of extensions was needed when it came: eight values, one at each corner of a cube.
        grid = """<VTKFile type="ImageData"><ImageData WholeExtent="0 1 0 1 0 1" Origin="0 0 0" Spacing="1 1 1">
<Piece Extent="0 1 0 1 0 1"><PointData><DataArray Name="x" type="Float64" format="ascii">0 1 0 1 0 1 0 1</DataArray></PointData>
</Piece></ImageData></VTKFile>"""
        for name in ("grid.vti", "GRID.VTI"):
            (self.folder / name).write_text(grid)
        (self.folder / "cube.mesh").write_text(CUBE.format(last=8))
        for name in ("grid.vti", "GRID.VTI"):
            figures = self.compared(name, "cube.mesh", "--density", "1+x", "--levels", 0, "--samples", 1000, "--resolution", 8)
            self.assertLess(figures["linf"], 1e-12)
            self.assertLess(self.compared(name, name, "--levels", 0, "--samples", 1000, "--resolution", 8)["linf"], 1e-12)
        # Files that are no meshes: the reader of their format says so, and nothing calls them pictures.
        (self.folder / "no.format").write_text("")
        formats = re.search(r"a mesh \(([^)]*)\)", self.run_ok("info", "--help").out)[1]
        extensions = re.findall(r"\.[a-z0-9]+", formats)
        self.assertGreaterEqual(len(extensions), 21, formats)
        for extension in extensions:
            (self.folder / f"no{extension}").write_text("no mesh")
            done = subvol("compare", "cube.mesh", f"no{extension}", "--density", "1", folder=self.folder)
            self.assertEqual(done.code, 2, done.err)
            self.assertNotIn("picture", done.err)
            self.assertIn(f"no{extension}", done.err)

    def test_points_and_grids_of_a_mesh_are_close_to_it(self):
        self.run_ok("points", "model:ball:4", "-o", "ball.ply")
        self.run_ok("points", "model:ball:4", "-o", "ball.vdb")
        self.run_ok("vdb", "model:ball:4", "-o", "grid.vdb", "--resolution", 60)
        options = ["--levels", 2, "--samples", 20000, "--resolution", 32, "--iso", 0.5]
        by_points = self.compared("ball.ply", "model:ball:4", *options)
        # The position of a point in a .vdb file is rounded to 1.5e-8 of a voxel.
        again = self.compared("ball.vdb", "ball.ply", *options[2:])
        self.assertLess(again["linf"], 1e-5)
        for figures in (by_points, self.compared("grid.vdb", "model:ball:4", *options)):
            self.assertLess(figures["l2"], 0.02)  # of a field between 0 and 1; another field would differ by some .3
            self.assertLess(figures["mass"], 0.02)
            self.assertLess(figures["hausdorff"], 0.1)
            self.assertLess(figures["new_vertex_rmse"], 0.05)
            self.assertGreater(figures["l2"], 0)

    def test_the_difference_of_two_meshes_is_a_mesh(self):
        quick = ["--samples", 500, "--resolution", 8]
        (self.folder / "b.vtk").write_text(TWO_FIELDS)
        # One corner, at 1,1,1, is 7.25 warmer in A.
        (self.folder / "a.vtk").write_text(TWO_FIELDS.replace("293 313 313 293 293 313 313 293", "293 313 313 293 293 313 320.25 293"))
        figures = self.compared("a.vtk", "b.vtk", *quick, "-o", "d.vtu")
        found = figures["difference"]
        self.assertEqual((figures["output"], found["same_points"], found["outside"]), ("d.vtu", True, 0))
        self.assertEqual(found["fields"]["Temp"], {"max": 7.25, "at": [1, 1, 1], "point": 6})
        self.assertEqual({name: field["max"] for name, field in found["fields"].items()}, {"Temp": 7.25, "Pres": 0, "V": 0})
        fields = {field["name"]: field for field in self.run_ok("info", "d.vtu", "--json").json()["fields"]}
        self.assertEqual((fields["Temp"]["min"], fields["Temp"]["max"], fields["V"]["components"]), (0, 7.25, 3))
        # The difference 7.25 xyz is largest at 1,1,1; some of the random places is near it.
        self.assertGreater(math.prod(figures["linf_at"]), 0.5)
        self.assertAlmostEqual(figures["linf"], 7.25 * math.prod(figures["linf_at"]), delta=1e-4)
        done = self.run_ok("compare", "a.vtk", "b.vtk", *quick, "-o", "d.vtu")
        self.assertRegex(done.out, r"Temp +differs at most by 7\.25 at point 6 \(1,1,1\)")
        self.assertRegex(done.out, r"linf +[\d.]+ at 0?\.?\d")
        # One field, also a computed one.
        figures = self.compared("a.vtk", "b.vtk", *quick, "-o", "d.vtkhdf", "--field", "2*Temp")
        self.assertEqual(figures["difference"]["fields"], {"2*Temp": {"max": 14.5, "at": [1, 1, 1], "point": 6}})

    def test_the_difference_from_another_mesh_is_at_the_points_of_the_first(self):
        # A has 64 points in half of the cube of B, where x + z² is known.
        grid = """<VTKFile type="ImageData"><ImageData WholeExtent="0 3 0 3 0 3" Origin="0 0 0" Spacing=".2 .2 .2">
<Piece Extent="0 3 0 3 0 3"><PointData><DataArray Name="x" type="Float64" format="ascii">%s</DataArray></PointData>
</Piece></ImageData></VTKFile>"""
        places = [(i * 0.2, k * 0.2) for k in range(4) for _ in range(4) for i in range(4)]
        (self.folder / "a.vti").write_text(grid % " ".join(repr(x + z * z) for x, z in places))
        (self.folder / "b.vtk").write_text(X_AND_Z)
        found = self.compared("a.vti", "b.vtk", "--samples", 500, "--resolution", 8, "-o", "d.vtu")["difference"]
        self.assertEqual((found["same_points"], found["outside"]), (False, 0))
        self.assertAlmostEqual(found["fields"]["x"]["max"], 0.36, places=5)
        self.assertAlmostEqual(found["fields"]["x"]["at"][2], 0.6, places=12)
        values = self.run_ok("probe", "d.vtu", "--at", "0.2,0.4,0.4", "--json").json()["values"]
        self.assertAlmostEqual(values[0]["value"], 0.16, places=5)
        # The other way round most of the points are outside, and people hear of it.
        done = self.run_ok("compare", "b.vtk", "a.vti", "--samples", 500, "--resolution", 8, "-o", "d.vtu", "--field", "x")
        self.assertRegex(done.err, r"7 points of A lie outside B, by at most 0\.69")  # √3 · .4

    def test_two_steps_of_one_file(self):
        for k, warm in enumerate(("313", "319")):
            (self.folder / "step.vtk").write_text(TWO_FIELDS.replace("293 313 313", f"293 {warm} 313"))
            self.run_ok("subdivide", "step.vtk", "-o", f"step{k}.vtu", "--levels", 0)
        (self.folder / "run.pvd").write_text("""<VTKFile type="Collection"><Collection>
<DataSet timestep="0" file="step0.vtu"/><DataSet timestep="5" file="step1.vtu"/></Collection></VTKFile>""")
        quick = ["--samples", 500, "--resolution", 8]
        for choice in (["--step", 1, "--step-b", 0], ["--step-b", 0], ["--time", 5, "--step-b", 0]):
            found = self.compared("run.pvd", "run.pvd", *choice, *quick, "-o", "d.vtu")["difference"]
            self.assertEqual(found["fields"]["Temp"], {"max": 6, "at": [1, 0, 0], "point": 1}, choice)
        self.assertEqual(self.compared("run.pvd", "run.pvd", "--step", 1, *quick)["linf"], 0)
        for wrong in ("all", "2", "-1", "x"):
            done = subvol("compare", "run.pvd", "run.pvd", "--step-b", wrong, folder=self.folder)
            self.assertEqual(done.code, 2, wrong)
            self.assertRegex(done.err, r"^subvol: [^\n]*\n$")
            self.assertIn("--step-b", done.err)

    def test_the_seed_chooses_the_places(self):
        def l2(seed, threads):
            return self.compared("model:twist:4", "model:twist:8", "--levels", 1, "--samples", 3000, "--resolution", 16, "--seed",
                                 seed, "--threads", threads)["l2"]

        self.assertEqual(l2(1, 1), l2(1, 2))
        self.assertNotEqual(l2(1, 1), l2(2, 1))


class Mistakes(InFolder):
    def assert_refused(self, *arguments, naming):
        before = self.files()
        done = subvol("compare", *arguments, folder=self.folder)
        self.assertEqual(done.code, 2, done.err)
        self.assertEqual(done.out, "")
        self.assertRegex(done.err, r"^subvol: [^\n]+\n$")
        for name in naming:
            self.assertIn(name, done.err)
        self.assertEqual(self.files(), before)

    def setUp(self):
        super().setUp()
        pfm(self.folder / "a.pfm", 4, 3, lambda x, y: (0, 0, 0))
        pfm(self.folder / "b.pfm", 3, 4, lambda x, y: (0, 0, 0))
        pfm(self.folder / "nan.pfm", 4, 3, lambda x, y: (math.nan if x > 1 else 0, math.inf if y == 0 else 0, 0))

    def test_what_cannot_be_compared(self):
        self.assert_refused("a.pfm", "b.pfm", naming=["a.pfm", "4 x 3", "3 x 4"])
        self.assert_refused("a.pfm", "nan.pfm", naming=["nan.pfm", "8 pixels"])
        self.assert_refused("a.pfm", "model:ball:2", naming=["a.pfm", "model:ball:2", "picture"])
        self.assert_refused("model:ball:2", "a.pfm", naming=["a.pfm", "picture"])
        (self.folder / "text.png").write_text("no picture")
        self.assert_refused("a.pfm", "text.png", naming=["text.png"])
        self.assert_refused("model:ball:2", "missing.vtu", naming=["missing.vtu"])
        # A field in another place.
        (self.folder / "cube.mesh").write_text(CUBE.format(last=8))
        points, cells = CUBE.format(last=8).split("Hexahedra")
        points = points.replace("\n1 ", "\n91 ").replace("\n0 ", "\n90 ")
        (self.folder / "far.mesh").write_text(points + "Hexahedra" + cells)
        self.assert_refused("far.mesh", "cube.mesh", "--density", "x", "--levels", "0", "--samples", "100", naming=["far.mesh", "in common"])

    def test_options_that_do_not_fit(self):
        self.assert_refused("a.pfm", "a.pfm", "--fail-under", "psnr=much", naming=["much"])
        self.assert_refused("a.pfm", "a.pfm", "--fail-under", "psnr", naming=["psnr=40"])
        self.assert_refused("a.pfm", "a.pfm", "--fail-under", "l2=1", naming=["l2", "psnr"])
        self.assert_refused("a.pfm", "a.pfm", "--fail-under", "interior.rmse=1", naming=["interior.rmse"])
        self.assert_refused("a.pfm", "a.pfm", "--iso", "1", naming=["--iso", "fields"])
        self.assert_refused("a.pfm", "a.pfm", "--levels", "1", naming=["--levels", "fields"])
        self.assert_refused("a.pfm", "a.pfm", "--coverage", "0", naming=["--coverage", "fields"])
        self.assert_refused("model:ball:2", "model:ball:2", "--coverage", "1.5", naming=["--coverage"])
        self.assert_refused("a.pfm", "a.pfm", "--heatmap", "h.jpg", naming=[".jpg"])
        self.assert_refused("a.pfm", "a.pfm", "--heatmap", "h.png", "--heatmap-of", "psnr", naming=["abs, flip, ssim"])
        self.assert_refused("a.pfm", "a.pfm", "--edge-band", "2", naming=["--edge-band", "interior"])
        self.assert_refused("model:ball:2", "model:ball:2", "--heatmap", "h.png", naming=["--heatmap", "pictures"])
        self.assert_refused("model:ball:2", "model:ball:2", "--fail-under", "psnr=1", naming=["psnr", "l2"])
        self.assert_refused("model:ball:2", "model:ball:2", "--fail-under", "hausdorff=1", naming=["hausdorff"])
        self.assert_refused("a.pfm", "a.pfm", "-o", "d.vtu", naming=["--output", "fields"])
        self.assert_refused("model:ball:2", "model:ball:2", "-o", "d.csv", naming=["d.csv", ".vtu"])
        self.assert_refused("model:ball:2", "model:ball:2", "-o", "d.vtu", "--levels", "1", naming=["--output", "--levels"])
        self.assert_refused("model:ball:2", "model:ball:2", "--step-b", "1", naming=["--step-b", "steps"])
        self.assert_refused("model:ball:2", "model:ball:2", "--iso", "77", "--levels", "0", "--resolution", "8", naming=["77"])


if __name__ == "__main__":
    unittest.main()
