# SPDX-License-Identifier: Apache-2.0
"""Meshes from other programs: the command treats them as its options say, and VTK reads the files that it writes."""

import unittest

from command import CUBE, InFolder, subvol

try:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkDoubleArray
    from vtkmodules.vtkCommonDataModel import vtkImageData, vtkRectilinearGrid
    from vtkmodules.vtkIOExodus import vtkExodusIIWriter
    from vtkmodules.vtkIOLegacy import vtkRectilinearGridWriter, vtkStructuredPointsWriter
    from vtkmodules.vtkIOXML import (vtkXMLImageDataWriter, vtkXMLPolyDataReader, vtkXMLRectilinearGridWriter,
                                     vtkXMLUnstructuredGridReader)
    HAS_VTK = True
except ImportError:
    HAS_VTK = False

needs_vtk = unittest.skipUnless(HAS_VTK, "VTK for Python (Debian's package python3-vtk9) is missing")

GAP = 1e-3


def two_cubes(gap):
    """Side by side along x, each with its own points."""
    points = [(x + (x // 2) * (gap - 1), y, z) for x in range(4) for z in (0, 1) for y in (0, 1)]
    lines = ["MeshVersionFormatted 2\nDimension 3\nVertices 16\n"]
    lines += [f"{x} {y} {z} 0\n" for x, y, z in points]
    lines.append("Hexahedra 2\n1 5 6 2 3 7 8 4 0\n9 13 14 10 11 15 16 12 0\nEnd\n")
    return "".join(lines)


class Meshes(InFolder):
    def info(self, name, *options):
        return self.run_ok("info", name, "--json", *options).json()

    def test_coincident_points_stay_apart_unless_they_are_welded(self):
        (self.folder / "a.mesh").write_text(two_cubes(0))
        (self.folder / "b.mesh").write_text(two_cubes(GAP))
        self.assertEqual(self.info("a.mesh")["points_used"], 16)
        welded = self.info("a.mesh", "--weld")
        self.assertEqual((welded["points_used"], welded["faces"], welded["volume"]), (12, 11, 2))
        self.assertTrue(any("4 points welded" in warning for warning in welded["warnings"]))
        self.assertEqual(self.info("b.mesh", "--weld")["points_used"], 16)
        self.assertEqual(self.info("b.mesh", "--weld-distance", GAP / 2)["points_used"], 16)
        self.assertEqual(self.info("b.mesh", "--weld-distance", 2 * GAP)["points_used"], 12)
        refined = self.run_ok("subdivide", "a.mesh", "-o", "fine.mesh", "--weld", "--json").json()
        self.assertEqual((refined["points"], refined["cells"]), (45, 16))

    def test_sharp_groups_divide_the_volume(self):
        # Two cells with a bend between them, where the groups 4 (their common face) and 9 (an edge of it) are.
        points = [(x, y, z + (x == 1)) for x in range(3) for z in (0, 1) for y in (0, 1)]
        cells = ["1 5 6 2 3 7 8 4 0\n", "5 9 10 6 7 11 12 8 0\n"]

        def mesh(count, cells, groups=""):
            vertices = "".join(f"{x} {y} {z} 0\n" for x, y, z in points[:count])
            return (f"MeshVersionFormatted 2\nDimension 3\nVertices {count}\n{vertices}Hexahedra {len(cells)}\n" + "".join(cells) +
                    groups + "End\n")

        (self.folder / "bar.mesh").write_text(mesh(12, cells, "Quadrilaterals 1\n5 6 8 7 4\nEdges 1\n7 8 9\n"))
        (self.folder / "half.mesh").write_text(mesh(8, cells[:1]))

        def refined(name, *options):
            self.run_ok("subdivide", name, "-o", "fine.mesh", "--levels", 2, "--scheme", "cc", "--crease-angle", "none", "--quiet", *options)
            return self.info("fine.mesh")

        def height(told):
            return told["bounds"][1][2]

        half = refined("half.mesh")
        self.assertLess(height(refined("bar.mesh")), 1.9)  # the bend is round
        creased = refined("bar.mesh", "--sharp", 9)
        self.assertEqual(height(creased), 2)
        # As if each side were a mesh of its own.
        divided = refined("bar.mesh", "--sharp", 4)
        self.assertAlmostEqual(divided["volume"], 2 * half["volume"], places=12)
        self.assertEqual(height(divided), height(half))
        # What is written is read again.
        again = self.info("fine.mesh", "--sharp", 1)
        self.assertEqual((again["volume"], again["points"]), (divided["volume"], divided["points"]))
        refused = subvol("info", "bar.mesh", "--sharp", "wall", folder=self.folder)
        self.assertEqual(refused.code, 2)
        self.assertIn('bar.mesh: there is no group "wall" of faces or edges (it has: 4, 9)', refused.err)

    def test_other_cells_are_split_left_out_or_refused(self):
        (self.folder / "a.mesh").write_text(CUBE.format(last=8).replace("End", "Tetrahedra 1\n1 2 4 5 0\nEnd"))
        split = self.info("a.mesh")
        self.assertEqual(split["cells"], 8 + 4)
        self.assertTrue(any("1 hexahedron and 1 tetrahedron split into 12" in warning for warning in split["warnings"]))
        ignored = self.info("a.mesh", "--other-cells", "ignore")
        self.assertEqual(ignored["cells"], 1)
        self.assertTrue(any("ignored" in warning for warning in ignored["warnings"]))
        refused = subvol("info", "a.mesh", "--other-cells", "refuse", folder=self.folder)
        self.assertEqual(refused.code, 2)
        self.assertRegex(refused.err, r"^subvol: a.mesh: the mesh has 1 hexahedron and 1 tetrahedron[^\n]*\n$")

    def read_by_vtk(self, reader, name):
        reader.SetFileName(str(self.folder / name))
        reader.Update()
        self.assertEqual(reader.GetErrorCode(), 0)
        return reader.GetOutput()

    @needs_vtk
    def test_vtk_reads_a_mesh_as_it_is(self):
        told = self.run_ok("model", "twist", "-o", "a.vtu", "--resolution", 24, "--json").json()  # several blocks per array
        grid = self.read_by_vtk(vtkXMLUnstructuredGridReader(), "a.vtu")
        self.assertEqual((grid.GetNumberOfPoints(), grid.GetNumberOfCells()), (told["points"], told["cells"]))
        self.assertEqual({grid.GetCellType(c) for c in range(grid.GetNumberOfCells())}, {12})
        info = self.info("a.vtu")
        density = vtk_to_numpy(grid.GetPointData().GetArray("density"))
        self.assertEqual([density.min(), density.max()], [info["fields"][0]["min"], info["fields"][0]["max"]])
        low, high = info["bounds"]
        self.assertEqual(grid.GetBounds(), (low[0], high[0], low[1], high[1], low[2], high[2]))

    @needs_vtk
    def test_vtk_reads_points_and_their_boundary(self):
        told = self.run_ok("points", "model:twist:8", "-o", "a.vtp", "--json").json()
        points = self.read_by_vtk(vtkXMLPolyDataReader(), "a.vtp")
        self.assertEqual((points.GetNumberOfPoints(), points.GetNumberOfVerts()), (told["points"], told["points"]))
        self.assertEqual(points.GetPointData().GetArray("ellipsoid").GetNumberOfComponents(), 9)
        surface = self.read_by_vtk(vtkXMLPolyDataReader(), "a.boundary.vtp")
        self.assertEqual(surface.GetNumberOfPolys(), self.info("a.vtp")["boundary_triangles"])

    def write_by_vtk(self, writer, grid, name):
        writer.SetFileName(str(self.folder / name))
        writer.SetInputData(grid)
        self.assertEqual(writer.Write(), 1)

    def counted_up(self, grid):
        """The grid with an array `s` of its points' numbers."""
        values = vtkDoubleArray()
        values.SetName("s")
        for i in range(grid.GetNumberOfPoints()):
            values.InsertNextValue(i)
        grid.GetPointData().AddArray(values)
        return grid

    @needs_vtk
    def test_blocks_that_vtk_writes(self):
        image = vtkImageData()
        image.SetExtent(-1, 2, 0, 2, 3, 7)
        image.SetOrigin(1, 2, 3)
        image.SetSpacing(2, 1, 0.5)
        grid = vtkRectilinearGrid()
        grid.SetExtent(-1, 2, 0, 2, 3, 7)
        for set_axis, cuts in ((grid.SetXCoordinates, (-1, 1, 3, 5)), (grid.SetYCoordinates, (2, 3, 4)),
                               (grid.SetZCoordinates, (4.5, 5, 5.5, 6, 6.5))):
            array = vtkDoubleArray()
            for cut in cuts:
                array.InsertNextValue(cut)
            set_axis(array)
        for name, writer, data in [("a.vti", vtkXMLImageDataWriter(), image), ("b.vtk", vtkStructuredPointsWriter(), image),
                                   ("c.vtr", vtkXMLRectilinearGridWriter(), grid), ("d.vtk", vtkRectilinearGridWriter(), grid)]:
            with self.subTest(name):
                if name.endswith(".vtk"):
                    writer.SetFileTypeToBinary()
                self.write_by_vtk(writer, self.counted_up(data), name)
                told = self.info(name)
                self.assertEqual((told["points"], told["cells"], told["volume"]), (60, 24, 24))
                self.assertEqual(told["bounds"], [[-1, 2, 4.5], [5, 4, 6.5]])
                self.assertEqual([(f["name"], f["min"], f["max"]) for f in told["fields"]], [("s", 0, 59)])

    @needs_vtk
    def test_exodus_that_vtk_writes(self):
        self.run_ok("model", "twist", "-o", "a.vtu", "--resolution", 4)
        grid = self.counted_up(self.read_by_vtk(vtkXMLUnstructuredGridReader(), "a.vtu"))
        writer = vtkExodusIIWriter()
        writer.WriteAllTimeStepsOff()
        self.write_by_vtk(writer, grid, "a.exo")
        expected, told = self.info("a.vtu"), self.info("a.exo")
        for key in ("points", "cells", "edges", "faces", "volume", "bounds"):
            self.assertEqual(told[key], expected[key])
        fields = {field["name"]: (field["min"], field["max"]) for field in told["fields"]}
        self.assertEqual(fields["s"], (0, 124))
        self.assertEqual(fields["density"], (expected["fields"][0]["min"], expected["fields"][0]["max"]))


if __name__ == "__main__":
    unittest.main()
