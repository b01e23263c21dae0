"""Meshes of other programs through the command: what is done to them as options say, and files that VTK reads."""

import unittest

from command import CUBE, InFolder, subvol

try:  # Debian's python3-vtk9
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader
except ImportError:
    vtkXMLUnstructuredGridReader = None

GAP = 1e-3


def two_cubes(gap):
    """Side by side along x, each with points of its own."""
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

    @unittest.skipUnless(vtkXMLUnstructuredGridReader, "VTK for Python (package python3-vtk9) is missing")
    def test_vtk_reads_a_mesh_as_it_is(self):
        told = self.run_ok("model", "twist", "-o", "a.vtu", "--resolution", 24, "--json").json()  # some blocks an array
        grid = self.read_by_vtk(vtkXMLUnstructuredGridReader(), "a.vtu")
        self.assertEqual((grid.GetNumberOfPoints(), grid.GetNumberOfCells()), (told["points"], told["cells"]))
        self.assertEqual({grid.GetCellType(c) for c in range(grid.GetNumberOfCells())}, {12})
        info = self.info("a.vtu")
        density = vtk_to_numpy(grid.GetPointData().GetArray("density"))
        self.assertEqual([density.min(), density.max()], [info["fields"][0]["min"], info["fields"][0]["max"]])
        low, high = info["bounds"]
        self.assertEqual(grid.GetBounds(), (low[0], high[0], low[1], high[1], low[2], high[2]))

    @unittest.skipUnless(vtkXMLUnstructuredGridReader, "VTK for Python (package python3-vtk9) is missing")
    def test_vtk_reads_points_and_their_boundary(self):
        told = self.run_ok("points", "model:twist:8", "-o", "a.vtp", "--json").json()
        points = self.read_by_vtk(vtkXMLPolyDataReader(), "a.vtp")
        self.assertEqual((points.GetNumberOfPoints(), points.GetNumberOfVerts()), (told["points"], told["points"]))
        self.assertEqual(points.GetPointData().GetArray("ellipsoid").GetNumberOfComponents(), 9)
        surface = self.read_by_vtk(vtkXMLPolyDataReader(), "a.boundary.vtp")
        self.assertEqual(surface.GetNumberOfPolys(), self.info("a.vtp")["boundary_triangles"])


if __name__ == "__main__":
    unittest.main()
