# SPDX-License-Identifier: Apache-2.0
"""The same classes as a module of VTK for Python, where VTK's own Python module is installed; scripts/test-paraview runs it. PYTHONPATH
names the folder of subvol_vtk."""
import os
import sys
import unittest

import numpy as np
import subvol
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 (what draws)
from subvol_vtk.SubvolVtk import vtkSubvolLimitLine, vtkSubvolLimitProbe, vtkSubvolLimitSurface, vtkSubvolReader, vtkSubvolSubdivide, \
    vtkSubvolVdbWriter, vtkSubvolVolumeMapper, vtkSubvolWriter
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet, vtkPiecewiseFunction, vtkPlane, vtkPlaneCollection
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction, vtkRenderer, vtkRenderWindow, vtkVolume, vtkVolumeProperty, vtkWindowToImageFilter

SIZE = (200, 160)
KNOTS = [[-2, .1, .2, .9], [0, .9, .9, .3], [2, .9, .2, .1]]
OPACITIES = [[-2, .05], [2, .6]]
FOLDER = sys.argv[1]


class Scene:
    def __init__(self, grid):
        self.mapper = vtkSubvolVolumeMapper()
        self.mapper.SetInputDataObject(grid)
        self.mapper.SelectScalarArray("heat")
        self.mapper.SetScalarModeToUsePointFieldData()
        colors, opacities, self.property = vtkColorTransferFunction(), vtkPiecewiseFunction(), vtkVolumeProperty()
        for knot in KNOTS:
            colors.AddRGBPoint(*knot)
        for knot in OPACITIES:
            opacities.AddPoint(*knot)
        self.property.SetColor(colors)
        self.property.SetScalarOpacity(opacities)
        self.property.SetScalarOpacityUnitDistance(.5)
        volume = vtkVolume()
        volume.SetMapper(self.mapper)
        volume.SetProperty(self.property)
        self.renderer, self.window = vtkRenderer(), vtkRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetSize(*SIZE)
        self.window.AddRenderer(self.renderer)
        self.renderer.AddVolume(volume)
        camera = self.renderer.GetActiveCamera()
        camera.SetPosition(4, -5, 3)
        camera.SetFocalPoint(0, 0, 0)
        camera.SetViewUp(0, 0, 1)
        camera.SetViewAngle(25)
        self.renderer.ResetCameraClippingRange()

    def pixels(self):
        self.window.Render()
        reader = vtkWindowToImageFilter()
        reader.SetInput(self.window)
        reader.ReadFrontBufferOff()
        reader.ShouldRerenderOff()
        reader.Update()
        image = reader.GetOutput()
        width, height, _ = image.GetDimensions()
        return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, 3)[::-1] / 255.0


class Mapper(unittest.TestCase):
    def setUp(self):
        ball = subvol.model("ball", 4)
        x, y, z = ball.points.T
        self.mesh = subvol.HexMesh(ball.points, ball.cells, {"heat": np.sin(3 * x) + z * y})
        self.scene = Scene(subvol.to_vtk(self.mesh))

    def picture(self, **options):
        tf = subvol.TransferFunction.from_knots(KNOTS, OPACITIES)
        camera = subvol.Camera((4, -5, 3), (0, 0, 0), (0, 0, 1), 25)
        return np.asarray(subvol.render(self.mesh, camera=camera, size=SIZE, tf=tf, look="volume", opacity_unit=.5, backend="cpu",
                                        **options))[..., :3]

    def assert_same(self, drawn, expected):
        self.assertGreater((expected > .05).mean(), .1)
        self.assertLess(np.abs(drawn - expected).max(), 1.01 / 255)

    def test_the_picture_is_that_of_the_library(self):
        self.assert_same(self.scene.pixels(), self.picture())

    def test_our_opengl_has_a_thread_of_its_own(self):
        mapper, first = self.scene.mapper, self.scene.pixels()
        cpu = [device for device in subvol.gl_devices() if device["hardware"]] == []
        self.assertEqual(mapper.GetBackend(), "cpu" if cpu else "gl", "software OpenGL is slower than the CPU")
        mapper.SetRenderer("cpu")
        by_cpu = self.scene.pixels()
        mapper.SetRenderer("gl")
        for _ in range(2):
            by_gl = self.scene.pixels()
            self.assertEqual(mapper.GetBackend(), "gl")
            self.assert_same(by_gl, by_cpu)  # 140 dB before it is put into 8 bits
            self.scene.renderer.GetActiveCamera().Azimuth(10)
            mapper.SetRenderer("cpu")
            by_cpu = self.scene.pixels()
            mapper.SetRenderer("gl")
        self.assertEqual(first.shape, by_gl.shape)

    def test_clipping_planes(self):
        planes, plane = vtkPlaneCollection(), vtkPlane()
        plane.SetOrigin(.1, 0, 0)
        plane.SetNormal(-1, .5, 0)
        planes.AddItem(plane)
        self.scene.mapper.SetClippingPlanes(planes)
        self.assert_same(self.scene.pixels(), self.picture(clip=[[.1, 0, 0, 1, -.5, 0]]))

    def test_a_picture_is_kept_until_something_changes(self):
        mapper, first = self.scene.mapper, self.scene.pixels()
        self.assertFalse(mapper.GetKept())
        self.assertTrue(np.array_equal(self.scene.pixels(), first))
        self.assertTrue(mapper.GetKept())
        self.scene.property.SetScalarOpacityUnitDistance(.2)
        self.assertFalse(np.array_equal(self.scene.pixels(), first))
        self.assertFalse(mapper.GetKept())
        self.scene.renderer.GetActiveCamera().Azimuth(10)
        self.scene.pixels()
        self.assertFalse(mapper.GetKept())

    def test_coarse_pictures_while_the_view_turns(self):
        fine = self.scene.pixels()
        self.scene.window.SetDesiredUpdateRate(15)
        coarse = self.scene.pixels()
        self.assertFalse(np.array_equal(fine, coarse))
        self.assertLess(np.sqrt(np.mean((fine - coarse) ** 2)), .05)  # the rim is a pixel of the coarse picture wide
        self.scene.window.SetDesiredUpdateRate(.001)
        self.assertTrue(np.array_equal(fine, self.scene.pixels()))

    def test_filter_and_writer(self):
        surface = vtkSubvolLimitSurface()
        surface.SetInputDataObject(subvol.to_vtk(self.mesh))
        surface.Update()
        self.assertEqual(surface.GetOutput().GetNumberOfCells(), len(subvol.surface(self.mesh, boundary=True).triangles))
        writer = vtkSubvolVdbWriter()
        writer.SetInputDataObject(subvol.to_vtk(self.mesh))
        writer.SetFileName(os.path.join(FOLDER, "heat.vdb"))
        writer.SetResolution(40)
        writer.Write()
        self.assertEqual([grid.name for grid in subvol.read_vdb(os.path.join(FOLDER, "heat.vdb"))], ["heat"])

    def test_bricks_of_blocks(self):
        """Blocks become one mesh; the bricks of it are what subvol opens."""
        blocks = vtkMultiBlockDataSet()
        corners = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], float)
        for k in range(2):
            blocks.SetBlock(k, subvol.to_vtk(subvol.HexMesh(corners + [k, 0, 0], [range(8)], {"heat": corners[:, 1].copy()})))
        writer = vtkSubvolWriter()
        writer.SetInputDataObject(blocks)
        writer.SetFileName(os.path.join(FOLDER, "two.bricks"))
        writer.SetOptions("bricks=2")
        writer.Write()
        self.assertEqual(sorted(name for name in os.listdir(writer.GetFileName()) if name.endswith(".vtu")),
                         ["brick_00000.vtu", "brick_00001.vtu"])
        line = vtkSubvolLimitLine()
        line.SetInputDataObject(blocks)
        line.SetPoint1(.5, .5, .5)
        line.SetPoint2(1.5, .5, .5)
        line.SetCount(5)
        line.Update()
        self.assertEqual(line.GetOutput().GetPointData().GetArray("vtkValidPointMask").GetRange(), (1, 1))

    def test_reader_and_probe(self):
        path = os.path.join(FOLDER, "ball.mesh")
        subvol.write_mesh(subvol.HexMesh(self.mesh.points, self.mesh.cells, {}), path)
        reader, probe = vtkSubvolReader(), vtkSubvolLimitProbe()
        self.assertTrue(vtkSubvolReader.CanReadFile(path))
        self.assertFalse(vtkSubvolReader.CanReadFile(os.path.join(FOLDER, "missing")))
        reader.SetFileName(path)
        probe.SetPlacesConnection(reader.GetOutputPort())
        probe.SetMeshConnection(reader.GetOutputPort())
        probe.SetReach(10)
        probe.Update()
        self.assertEqual(probe.GetOutput().GetPointData().GetArray("vtkValidPointMask").GetRange(), (1, 1))
        self.assertEqual(probe.GetOutput().GetNumberOfCells(), len(self.mesh.cells))

    def test_creases_and_sharp_faces_of_files_shape_the_limit(self):
        block = subvol.model("twist", 3)
        sharp = block.with_creases(30)
        self.assertGreater(len(sharp.creases), 0)
        path = os.path.join(FOLDER, "sharp.vtu")
        subvol.write_mesh(sharp, path)
        by_vtk, by_us = vtkXMLUnstructuredGridReader(), vtkSubvolReader()
        for reader in (by_vtk, by_us):
            reader.SetFileName(path)
            surface = vtkSubvolLimitSurface()
            surface.SetInputConnection(reader.GetOutputPort())
            surface.SetBoundary(True)
            surface.Update()
            points = vtk_to_numpy(surface.GetOutput().GetPoints().GetData())
            self.assertTrue(np.allclose(points, subvol.surface(sharp, boundary=True).points))
            round_ones = subvol.surface(block, boundary=True).points
            self.assertFalse(len(points) == len(round_ones) and np.allclose(points, round_ones))
            self.assertTrue(np.array_equal(subvol.from_vtk(reader.GetOutput()).creases, sharp.creases))

    def test_patches_and_sets_go_through_filters(self):
        path = os.path.join(FOLDER, "named.inp")
        with open(path, "w") as file:
            file.write("*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n"
                       "*ELEMENT, TYPE=C3D8, ELSET=cube\n1,1,2,3,4,5,6,7,8\n*SURFACE, NAME=top\n1, S2\n")
        reader, subdivide = vtkSubvolReader(), vtkSubvolSubdivide()
        reader.SetFileName(path)
        subdivide.SetInputConnection(reader.GetOutputPort())
        subdivide.SetLevels(1)
        subdivide.Update()
        fine = subvol.from_vtk(subdivide.GetOutput())
        self.assertEqual({name: len(sides) for name, sides in fine.patches.items()}, {"top": 4})
        self.assertEqual({name: len(cells) for name, cells in fine.sets.items()}, {"cube": 8})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
