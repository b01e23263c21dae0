# SPDX-License-Identifier: Apache-2.0
"""The plugin in ParaView: pictures against those of the library, rays that end at slices, filters, files, states. Run by pvpython;
scripts/test-paraview does. Arguments: the plugin, and a folder for pictures."""
import os
import sys
import unittest

import numpy as np
import subvol
from paraview import servermanager, simple
from paraview.vtk.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

PLUGIN, FOLDER = sys.argv[1], sys.argv[2]
simple.LoadPlugin(PLUGIN, remote=False, ns=vars(simple))
SIZE = (300, 260)
EYE, TARGET, UP, ANGLE = (5.0, -7.0, 4.0), (0.1, 0.0, 0.0), (0.0, 0.0, 1.0), 25.0
TO_8_BITS = 1.01 / 255  # a picture in 8 bits is off by half a step; two that round differently by one


def mesh_file():
    path = os.path.join(FOLDER, "ball.vtu")
    mesh = subvol.model("ball", 4)
    x, y, z = mesh.points.T
    mesh.fields["heat"] = np.sin(3 * x) + z * y
    subvol.write_mesh(subvol.HexMesh(mesh.points, mesh.cells, {"heat": np.sin(3 * x) + z * y}), path)
    return path


def read_png(path):
    """As floats of the screen, rows from the top."""
    reader = vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)[::-1, :, :3] / 255.0


def pixels(view, name, size=SIZE):
    path = os.path.join(FOLDER, name + ".png")
    simple.SaveScreenshot(path, view, ImageResolution=size)
    return read_png(path)


def psnr(a, b):
    return -10 * np.log10(max(np.mean((a - b) ** 2), 1e-12))


def frd_of_two_steps():
    """A hexahedron in CalculiX's text, with a value at each node: ten times the step, and the node's number."""
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    text = "    1C\n    2C" + " " * 18 + "%12d" % 8 + " " * 37 + "1\n"
    for k, point in enumerate(corners):
        text += " -1%10d" % (k + 1) + "".join("%12.5E" % x for x in point) + "\n"
    text += " -3\n    3C" + " " * 18 + "%12d" % 1 + " " * 37 + "1\n -1%10d%5d%5d%5d\n -2" % (1, 1, 0, 1)
    text += "".join("%10d" % (k + 1) for k in range(8)) + "\n -3\n"
    for step in (1, 2):
        text += "  100CL%5d%12.5E%12d" % (100 + step, step, 8) + " " * 20 + "%2d%5d" % (0, step) + " " * 10 + " 1\n"
        text += " -4  NDTEMP      1    1\n -5  T           1    1    0    0\n"
        text += "".join(" -1%10d%12.5E\n" % (k + 1, 10 * step + k) for k in range(8)) + " -3\n"
    return text + " 9999\n"


class Plugin(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.path = mesh_file()
        cls.mesh = subvol.read_mesh(cls.path)

    def setUp(self):
        self.reader = simple.XMLUnstructuredGridReader(FileName=[self.path])
        self.view = simple.CreateRenderView()
        self.view.ViewSize = SIZE
        self.view.OrientationAxesVisibility = 0
        self.view.UseColorPaletteForBackground = 0
        self.view.Background = [0, 0, 0]
        self.view.CameraPosition, self.view.CameraFocalPoint, self.view.CameraViewUp = EYE, TARGET, UP
        self.view.CameraViewAngle = ANGLE
        self.shown = simple.Show(self.reader, self.view)
        simple.ColorBy(self.shown, ("POINTS", "heat"))
        self.shown.SetRepresentationType("Subdivision splats")
        self.shown.SetScalarBarVisibility(self.view, False)
        self.shown.ScalarOpacityUnitDistance = 0.4
        self.colors = simple.GetColorTransferFunction("heat")
        self.opacities = simple.GetOpacityTransferFunction("heat")

    def tearDown(self):
        simple.Delete(self.view)
        simple.Delete(self.reader)

    def transfer_function(self):
        colors, opacities = self.colors.GetClientSideObject(), self.opacities.GetClientSideObject()
        low, high = colors.GetRange()
        values = np.linspace(low, high, 257)
        low, high = opacities.GetRange()
        places = np.linspace(low, high, 257)

        def color(value):
            rgb = [0.0, 0.0, 0.0]
            colors.GetColor(value, rgb)
            return rgb

        return subvol.TransferFunction.from_knots([[v, *color(v)] for v in values],
                                                  [[p, opacities.GetValue(p)] for p in places])

    def picture(self, size=SIZE, **options):
        camera = subvol.Camera(EYE, TARGET, UP, ANGLE)
        if self.view.CameraParallelProjection:
            camera = subvol.Camera(EYE, TARGET, UP, ortho_height=2 * self.view.CameraParallelScale)
        return np.asarray(subvol.render(self.mesh, camera=camera, size=size, tf=self.transfer_function(), look="volume", opacity_unit=0.4,
                                        **({"backend": "cpu"} if options.get("method", "splat") == "splat" else {}), **options))

    def assert_same(self, drawn, expected, most=TO_8_BITS):
        self.assertGreater((expected > 0.05).mean(), 0.03)  # something is seen
        self.assertLess(np.abs(drawn - expected).max(), most)

    def slice_at(self, y):
        plane = simple.Plane(Origin=[-4, y, -4], Point1=[4, y, -4], Point2=[-4, y, 4])
        shown = simple.Show(plane, self.view)
        shown.ColorArrayName = [None, ""]
        shown.AmbientColor = shown.DiffuseColor = [0.25, 0.5, 0.75]
        shown.Ambient, shown.Diffuse = 1, 0
        self.addCleanup(simple.Delete, plane)
        forward = (np.array(TARGET) - EYE) / np.linalg.norm(np.array(TARGET) - EYE)
        right = np.cross(forward, UP)
        right /= np.linalg.norm(right)
        up = np.cross(right, forward)
        pixel = 2 * np.tan(np.radians(ANGLE / 2)) / SIZE[1]
        columns, rows = np.meshgrid(np.arange(SIZE[0]) + 0.5 - SIZE[0] / 2, SIZE[1] / 2 - np.arange(SIZE[1]) - 0.5)
        direction = forward + pixel * (columns[..., None] * right + rows[..., None] * up)
        depth = (y - EYE[1]) / direction[..., 1]
        place = np.array(EYE) + depth[..., None] * direction
        met = (np.abs(place[..., 0]) < 4) & (np.abs(place[..., 2]) < 4)
        return np.where(met, depth, np.inf), met

    def test_the_picture_is_that_of_the_library(self):
        self.assert_same(pixels(self.view, "perspective"), self.picture()[..., :3])

    def test_parallel_projection(self):
        self.view.CameraParallelProjection, self.view.CameraParallelScale = 1, 1.5
        self.assert_same(pixels(self.view, "parallel"), self.picture()[..., :3])

    def test_methods_and_options(self):
        self.shown.SubvolMethod = "dense"
        self.assert_same(pixels(self.view, "dense"), self.picture(method="dense")[..., :3])
        self.shown.SubvolMethod, self.shown.SubvolScheme, self.shown.SubvolOptions = "splat", "cc", "per_edge=2"
        self.assert_same(pixels(self.view, "scheme"), self.picture(scheme="cc", per_edge=2)[..., :3])
        self.shown.SubvolShade = 1
        self.view.UseLight = 0  # the library's key light instead of ParaView's kit
        key = simple.AddLight(view=self.view)
        key.Type, key.Coords, key.Position, key.FocalPoint = "Directional", "Camera", [-0.5, 0.7, 0.5], [0, 0, 0]
        self.assert_same(pixels(self.view, "shade"), self.picture(scheme="cc", per_edge=2, shade=True)[..., :3])
        lit = []
        for place in ([-3, 0, 0.5], [0, 3, 0.5]):  # surfaces inside are lit on either side, so other sides would hardly differ
            key.Position = place
            lit.append(pixels(self.view, "light"))
        self.assertGreater(np.abs(lit[0] - lit[1]).max(), 0.05)

    def test_opaque_geometry_inside_has_no_seam(self):
        ends, met = self.slice_at(0.2)
        before = self.picture(ray_ends=ends)
        expected = before[..., :3] + (1 - before[..., 3:]) * met[..., None] * [0.25, 0.5, 0.75]
        drawn = pixels(self.view, "slice")
        rim = np.logical_or.reduce([met != np.roll(met, step, axis) for step in (1, -1) for axis in (0, 1)])
        # A depth buffer of 24 bits between ParaView's near and far plane.
        self.assert_same(drawn[~rim], expected[~rim], 2 * TO_8_BITS)
        self.assertGreater(np.abs(drawn - self.picture()[..., :3]).max(), 0.2)

    def test_what_lies_behind_shows_through_and_what_lies_before_hides(self):
        _, met = self.slice_at(3.0)
        whole = self.picture()
        expected = whole[..., :3] + (1 - whole[..., 3:]) * met[..., None] * [0.25, 0.5, 0.75]
        drawn = pixels(self.view, "behind")
        self.assertGreater(psnr(drawn, expected), 40)  # the rim of the plane is rounded to other pixels
        _, met = self.slice_at(-3.0)
        self.assertTrue(np.allclose(pixels(self.view, "before")[met][100:-100], [0.25, 0.5, 0.75], atol=TO_8_BITS))

    def test_a_moved_volume(self):
        self.shown.Position, self.shown.Scale = [0.3, 0, 0.1], [0.5, 0.5, 0.5]
        moved = subvol.HexMesh(0.5 * self.mesh.points + [0.3, 0, 0.1], self.mesh.cells, {"heat": self.mesh.fields["heat"]})
        self.mesh, whole = moved, self.mesh
        try:
            self.assert_same(pixels(self.view, "moved"), self.picture()[..., :3])
        finally:
            self.mesh = whole

    def test_stereo_is_two_cameras(self):
        """Each eye stands beside the camera, and the point that it looks at stays in the middle."""
        shift, distance = 20, np.linalg.norm(np.array(TARGET) - EYE)  # pixels that the line of sight is off the middle, doubled
        per_slope = SIZE[1] / np.tan(np.radians(ANGLE / 2))  # pixels, doubled
        slope = shift / per_slope
        forward = (np.array(TARGET) - EYE) / distance
        right = np.cross(forward, UP)
        right /= np.linalg.norm(right)
        wide = (SIZE[0] + shift, SIZE[1])
        drawn = {}
        for name, side in (("Left", -1), ("Right", 1)):
            self.view.StereoType, self.view.StereoRender = name, 1
            for angle in (1, 2 * np.degrees(np.arctan(slope))):  # VTK keeps its matrices until the camera changes
                self.view.EyeAngle = angle
                self.view.StillRender()
            drawn[name] = pixels(self.view, f"stereo_{name}")
            by = side * slope * distance * right
            moved = subvol.Camera(EYE + by, TARGET + by, UP, ANGLE)
            expected = np.asarray(subvol.render(self.mesh, camera=moved, size=wide, tf=self.transfer_function(), look="volume", opacity_unit=0.4,
                                                backend="cpu"))[..., :3]
            # The right eye sees what it looks at to the left of its line of sight.
            self.assert_same(drawn[name], expected[:, :SIZE[0]] if side > 0 else expected[:, shift:])
        self.assertGreater(np.abs(drawn["Left"] - drawn["Right"]).max(), 0.05)

    def test_a_larger_screenshot_of_tiles(self):
        large = [4 * side for side in SIZE]
        self.assert_same(pixels(self.view, "large", large), self.picture(size=large)[..., :3])

    def test_a_state_file(self):
        first = pixels(self.view, "state_before")
        path = os.path.join(FOLDER, "state.pvsm")
        simple.SaveState(path)
        simple.Delete(self.view)
        simple.LoadState(path)
        self.view = simple.GetActiveView()
        self.assertTrue(np.array_equal(first, pixels(self.view, "state_after")))

    def test_limit_surface(self):
        surface = simple.LimitSurface(Input=self.reader, Boundary=1, Isovalues=[])
        surface.UpdatePipeline()
        self.assertEqual(len(surface.Isovalues), 0)
        drawn = servermanager.Fetch(surface)
        points = vtk_to_numpy(drawn.GetPoints().GetData())
        of_library = subvol.surface(self.mesh, boundary=True)
        self.assertEqual(drawn.GetNumberOfCells(), len(of_library.triangles))
        self.assertTrue(np.allclose(points, of_library.points))
        self.assertTrue(drawn.GetPointData().GetArray("heat"))
        simple.Delete(surface)

    def test_limit_slice(self):
        cut = simple.LimitSlice(Input=self.reader, Origin=[0, 0, 0], Normal=[0, 0, 1], Resolution=64)
        cut.UpdatePipeline()
        drawn = servermanager.Fetch(cut)
        values = vtk_to_numpy(drawn.GetPointData().GetArray("heat"))
        expected = np.asarray(subvol.slice(self.mesh, (0, 0, 0), (0, 0, 1), resolution=64).values)
        self.assertTrue(np.array_equal(values, expected[~np.isnan(expected)]))
        self.assertTrue(np.allclose(vtk_to_numpy(drawn.GetPoints().GetData())[:, 2], 0, atol=1e-12))
        simple.Delete(cut)

    def test_subdivide_and_folds(self):
        fine = simple.SubdivideVolume(Input=self.reader, Levels=1)
        fine.UpdatePipeline()
        self.assertEqual(fine.GetDataInformation().GetNumberOfCells(), 8 * len(self.mesh.cells))
        fine.Levels, fine.CheckFolds = 0, 1
        fine.UpdatePipeline()
        self.assertEqual(servermanager.Fetch(fine).GetCellData().GetArray("fold").GetRange()[0], 0)
        simple.Delete(fine)

    def test_vdb(self):
        path = os.path.join(FOLDER, "ball.vdb")
        simple.SaveData(path, proxy=self.reader, Resolution=60)
        grid, = subvol.read_vdb(path)
        self.assertEqual(grid.name, "heat")
        inside = [[0.1, 0.2, 0.3], [-0.4, 0.1, 0.2], [0.0, 0.0, 0.6]]
        expected = [np.sin(3 * x) + z * y for x, y, z in inside]
        self.assertTrue(np.allclose(grid.values(inside)[0], expected, atol=0.05), grid.values(inside))

    def test_a_sequence_of_vdb(self):
        names = []
        for step in range(2):
            names.append(f"step{step}.vtu")
            fields = {"heat": self.mesh.fields["heat"] + 10 * step}
            subvol.write_mesh(subvol.HexMesh(self.mesh.points, self.mesh.cells, fields), os.path.join(FOLDER, names[-1]))
        with open(os.path.join(FOLDER, "run.pvd"), "w") as file:
            sets = "".join(f'<DataSet timestep="{step}" file="{name}"/>' for step, name in enumerate(names))
            file.write(f'<VTKFile type="Collection" version="0.1"><Collection>{sets}</Collection></VTKFile>')
        run = simple.PVDReader(FileName=os.path.join(FOLDER, "run.pvd"))
        simple.SaveData(os.path.join(FOLDER, "run.vdb"), proxy=run, Resolution=20, WriteTimeSteps=1)
        means = []
        for step in range(2):
            grid, = subvol.read_vdb(os.path.join(FOLDER, f"run_{step}.vdb"))
            means.append(grid.values([[0.0, 0.0, 0.0]])[0][0])
        self.assertAlmostEqual(means[1] - means[0], 10, places=4)
        simple.Delete(run)

    def test_limit_probe_at_the_points_of_another_mesh(self):
        places = simple.Sphere(Center=[0.8, 0, 0], ThetaResolution=12, PhiResolution=9)  # in part outside
        probe = simple.LimitProbe(Input=self.reader, Places=places, Gradients=1)
        probe.UpdatePipeline()
        drawn = servermanager.Fetch(probe)
        points = vtk_to_numpy(drawn.GetPoints().GetData()).astype(float)
        self.assert_probed(drawn.GetPointData(), points)
        places.Center = [0, 0, 0]
        probe.UpdatePipeline()
        drawn = servermanager.Fetch(probe)
        self.assertEqual(drawn.GetPointData().GetArray("vtkValidPointMask").GetRange(), (1, 1))
        self.assertEqual(drawn.GetNumberOfCells(), places.GetDataInformation().GetNumberOfCells())
        simple.Delete(probe)
        simple.Delete(places)

    def test_limit_line(self):
        line = simple.LimitLine(Input=self.reader, Point1=[-2, 0.1, 0.2], Point2=[2, 0.1, 0.2], Count=41)
        line.UpdatePipeline()
        drawn = servermanager.Fetch(line)
        self.assertEqual((drawn.GetNumberOfPoints(), drawn.GetNumberOfCells()), (41, 1))
        lengths = vtk_to_numpy(drawn.GetPointData().GetArray("arc_length"))
        self.assertTrue(np.allclose(lengths, np.linspace(0, 4, 41)))
        self.assert_probed(drawn.GetPointData(), [[-2 + 4 * k / 40, 0.1, 0.2] for k in range(41)])
        simple.Delete(line)

    def assert_probed(self, data, places):
        expected = subvol.probe(self.mesh, places)
        inside = expected.inside
        self.assertTrue(0 < inside.sum() < len(inside))
        self.assertTrue(np.array_equal(vtk_to_numpy(data.GetArray("vtkValidPointMask")) == 1, inside))
        values = vtk_to_numpy(data.GetArray("heat"))
        # Places may differ in their last bit.
        self.assertTrue(np.allclose(values[inside], expected.fields["heat"].ravel()[inside], atol=1e-9))
        self.assertTrue(np.isnan(values[~inside]).all())
        if data.GetArray("heat_gradient"):
            slopes = vtk_to_numpy(data.GetArray("heat_gradient"))[inside]
            self.assertTrue(np.allclose(slopes, expected.gradients["heat"].reshape(-1, 3)[inside], atol=1e-7))

    def test_our_formats_are_read(self):
        path = os.path.join(FOLDER, "two.mesh")
        subvol.write_mesh(subvol.HexMesh(self.mesh.points, self.mesh.cells, {}), path)
        read = simple.OpenDataFile(path)
        read.UpdatePipeline()
        drawn = servermanager.Fetch(read)
        self.assertEqual(drawn.GetNumberOfCells(), len(self.mesh.cells))
        self.assertTrue(np.allclose(vtk_to_numpy(drawn.GetPoints().GetData()), self.mesh.points))
        simple.Delete(read)

    def test_steps_of_a_format_that_paraview_lacks(self):
        path = os.path.join(FOLDER, "beam.frd")
        with open(path, "w") as file:
            file.write(frd_of_two_steps())
        read = simple.OpenDataFile(path)
        self.assertEqual(list(read.TimestepValues), [1, 2])
        for time in (1, 2):
            read.UpdatePipeline(time)
            self.assertEqual(servermanager.Fetch(read).GetPointData().GetArray("NDTEMP").GetRange(), (10 * time, 10 * time + 7))
        simple.Delete(read)

    def test_kernels_wavelets_and_bricks_are_written(self):
        kernels = os.path.join(FOLDER, "ball.svk")
        simple.SaveData(kernels, proxy=self.reader, Options="per_edge=2")
        expected = subvol.sample(self.mesh, per_edge=2)
        points = subvol.read_points(kernels)
        self.assertTrue(np.array_equal(points.centers, expected.centers))
        self.assertEqual(list(points.values), ["heat"])
        fine = simple.SubdivideVolume(Input=self.reader, Levels=1)
        wavelets = os.path.join(FOLDER, "ball.svw")
        simple.SaveData(wavelets, proxy=fine, Options="tolerance=1e-4")
        again = simple.OpenDataFile(wavelets)
        again.UpdatePipeline()
        self.assertEqual(again.GetDataInformation().GetNumberOfCells(), 8 * len(self.mesh.cells))
        bricks = os.path.join(FOLDER, "ball.bricks")
        simple.SaveData(bricks, proxy=self.reader, Options="bricks=3")
        self.assertEqual(len([name for name in os.listdir(bricks) if name.endswith(".vtu")]), 3)
        for proxy in (fine, again):
            simple.Delete(proxy)

    def test_blocks_are_one_mesh(self):
        """The ball in three blocks, one of them without the field x."""
        middles = self.mesh.points[self.mesh.cells].mean(1)
        parts = [middles[:, 0] < 0, (middles[:, 0] >= 0) & (middles[:, 2] < 0), (middles[:, 0] >= 0) & (middles[:, 2] >= 0)]
        self.assertTrue(all(part.any() for part in parts))
        names = []
        for k, part in enumerate(parts):
            used, cells = np.unique(self.mesh.cells[part], return_inverse=True)
            points = self.mesh.points[used]
            names.append(f"part{k}.vtu")
            fields = {"heat": self.mesh.fields["heat"][used], "x": points[:, 0]}
            if k == 2:
                del fields["x"]
            subvol.write_mesh(subvol.HexMesh(points, cells.reshape(-1, 8), fields), os.path.join(FOLDER, names[-1]))
        path = os.path.join(FOLDER, "parts.vtm")
        with open(path, "w") as file:
            sets = "".join(f'<DataSet index="{k}" file="{name}"/>' for k, name in enumerate(names))
            file.write(f'<VTKFile type="vtkMultiBlockDataSet" version="1.0"><vtkMultiBlockDataSet>{sets}</vtkMultiBlockDataSet></VTKFile>')
        expected = subvol.read_mesh(path)
        self.assertEqual(expected.points.shape, self.mesh.points.shape)
        simple.Hide(self.reader, self.view)
        blocks = simple.XMLMultiBlockDataReader(FileName=[path])
        shown = simple.Show(blocks, self.view)
        simple.ColorBy(shown, ("POINTS", "heat"))
        shown.SetRepresentationType("Subdivision splats")
        shown.SetScalarBarVisibility(self.view, False)
        shown.ScalarOpacityUnitDistance = 0.4
        self.mesh, whole = expected, self.mesh
        try:
            self.assert_same(pixels(self.view, "blocks"), self.picture()[..., :3])
        finally:
            self.mesh = whole
        simple.ColorBy(shown, ("POINTS", "x"))  # two of the blocks have it
        colored = pixels(self.view, "blocks_x")
        shown.SetScalarBarVisibility(self.view, False)
        self.assertTrue(0.02 < (colored.max(-1) > 0.05).mean() < (self.picture()[..., 3] > 0.05).mean())
        surface = simple.LimitSurface(Input=blocks, Boundary=1, Isovalues=[])
        surface.UpdatePipeline()
        self.assertEqual(surface.GetDataInformation().GetNumberOfCells(), len(subvol.surface(expected, boundary=True).triangles))
        joined = simple.SubdivideVolume(Input=blocks, Levels=0)
        joined.UpdatePipeline()
        self.assertEqual(joined.GetDataInformation().GetNumberOfPoints(), len(whole.points))
        for proxy in (surface, joined, blocks):
            simple.Delete(proxy)

    def test_bad_input_is_said(self):
        self.shown.SubvolOptions = "per_edges=2"
        pixels(self.view, "refused")  # the error is in ParaView's log; nothing is drawn
        self.shown.SubvolOptions = ""
        self.assert_same(pixels(self.view, "again"), self.picture()[..., :3])


if __name__ == "__main__":
    outcome = unittest.TextTestRunner(verbosity=2).run(unittest.defaultTestLoader.loadTestsFromTestCase(Plugin))
    os._exit(0 if outcome.wasSuccessful() else 1)  # pvpython's own end fails in its X context
