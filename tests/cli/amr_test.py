# SPDX-License-Identifier: Apache-2.0
"""Adaptive mesh refinement in blocks: VTK writes the files, and says which cells are visible."""

import random
import unittest

from command import InFolder, subvol_measured

try:
    import numpy as np
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import VTK_XYZ_GRID, vtkAMRBox, vtkAMRUtilities, vtkOverlappingAMR, vtkUniformGrid
    from vtkmodules.vtkIOXML import vtkXMLUniformGridAMRReader, vtkXMLUniformGridAMRWriter
    HAS_VTK = True
except ImportError:
    HAS_VTK = False

needs_vtk = unittest.skipUnless(HAS_VTK, "VTK for Python (Debian's package python3-vtk9) is missing")

REFINED = 8


def disjoint_boxes(draw, inside, count):
    """Boxes that do not meet, each in a box of a list."""
    boxes = []
    for _ in range(200):
        if len(boxes) == count:
            break
        low, high = draw.choice(inside)
        box = [], []
        for a in range(3):
            first = draw.randrange(low[a], high[a] + 1)
            box[0].append(first)
            box[1].append(draw.randrange(first, high[a] + 1))
        meets = lambda other: all(box[0][a] <= other[1][a] and box[1][a] >= other[0][a] for a in range(3))
        if not any(map(meets, boxes)):
            boxes.append(box)
    return boxes


def amr_of(draw, levels, shift):
    """The first level has two blocks of 4 x 6 x 5 cells; each further one divides some of the cells."""
    boxes = [[((shift, 0, -2), (shift + 3, 5, 2)), ((shift + 4, 0, -2), (shift + 7, 5, 2))]]
    for _ in range(levels - 1):
        divided = disjoint_boxes(draw, boxes[-1], 3)
        boxes.append([([2 * i for i in low], [2 * i + 1 for i in high]) for low, high in divided])
    amr = vtkOverlappingAMR()
    amr.Initialize(levels, [len(of_level) for of_level in boxes])
    amr.SetGridDescription(VTK_XYZ_GRID)
    origin = (.5, -3., 1.25)
    amr.SetOrigin(origin)
    for level, of_level in enumerate(boxes):
        h = .75 / 2 ** level
        amr.SetSpacing(level, (h, h, h))
        amr.SetRefinementRatio(level, 2)
        for block, (low, high) in enumerate(of_level):
            amr.SetAMRBox(level, block, vtkAMRBox(low, high))
            grid = vtkUniformGrid()
            grid.SetOrigin([origin[a] + h * low[a] for a in range(3)])
            grid.SetSpacing(h, h, h)
            grid.SetDimensions([high[a] - low[a] + 2 for a in range(3)])
            cells = np.array([np.array(grid.GetCell(c).GetBounds()).reshape(3, 2).mean(1) for c in range(grid.GetNumberOfCells())])
            points = np.array([grid.GetPoint(p) for p in range(grid.GetNumberOfPoints())])
            for data, at in (grid.GetCellData(), cells), (grid.GetPointData(), points):
                array = numpy_to_vtk(at @ [1., 2., -3.], deep=True)
                array.SetName("c" if at is cells else "p")
                data.AddArray(array)
            amr.SetDataSet(level, block, grid)
    return amr


def write(amr, name):
    writer = vtkXMLUniformGridAMRWriter()
    writer.SetFileName(name)
    writer.SetInputData(amr)
    assert writer.Write() == 1


def visible(name):
    """The number of cells that VTK shows, their volume, and the sum of values times volumes."""
    reader = vtkXMLUniformGridAMRReader()
    reader.SetFileName(name)
    reader.SetMaximumLevelsToReadByDefault(0)
    reader.Update()
    amr = reader.GetOutput()
    vtkAMRUtilities.BlankCells(amr)
    cells = volume = integral = 0
    for level in range(amr.GetNumberOfLevels()):
        for block in range(amr.GetNumberOfDataSets(level)):
            grid = amr.GetDataSet(level, block)
            ghost = grid.GetCellData().GetArray("vtkGhostType")
            shown = np.ones(grid.GetNumberOfCells(), bool) if ghost is None else vtk_to_numpy(ghost) & REFINED == 0
            size = np.prod(grid.GetSpacing())
            cells += int(shown.sum())
            volume += size * shown.sum()
            integral += size * vtk_to_numpy(grid.GetCellData().GetArray("c"))[shown].sum()
    return cells, volume, integral


class Amr(InFolder):
    @needs_vtk
    def test_cells_volume_and_integral_are_those_of_vtk(self):
        draw = random.Random(73)
        for levels in 1, 2, 3, 4:
            for blanked in False, True:
                amr = amr_of(draw, levels, draw.randrange(-5, 5))
                if blanked:
                    vtkAMRUtilities.BlankCells(amr)  # the file has marks of the refined cells
                name = str(self.folder / f"{levels}_{blanked}.vth")
                write(amr, name)
                cells, volume, integral = visible(name)
                info = self.run_ok("info", name, "--json").json()
                stats = self.run_ok("probe", name, "--stats", "--json", "--field", "c", "--cell-values", "constant").json()
                with self.subTest(levels=levels, blanked=blanked):
                    self.assertAlmostEqual(volume, 8 * 6 * 5 * .75 ** 3, delta=1e-9 * volume)  # no cell twice, none missing
                    self.assertEqual(info["cells"], cells)
                    self.assertAlmostEqual(info["volume"], volume, delta=1e-9 * volume)
                    field = stats["stats"]["whole"]["fields"][0]
                    self.assertAlmostEqual(field["file_integral"], integral, delta=1e-8 * volume)
                    self.assertFalse([warning for warning in info["warnings"] if "vtkGhostType" in warning])
                    self.assertEqual({field["name"] for field in info["fields"]}, {"c", "p"})

    def test_hostile_lists_are_refused_in_a_sentence(self):
        begin = '<VTKFile type="vtkOverlappingAMR" version="1.1"><vtkOverlappingAMR origin="0 0 0">'
        end = "</Block></vtkOverlappingAMR></VTKFile>"
        (self.folder / "a.vti").touch()
        for blocks, sentence in (
                ('<Block level="0" spacing="1 1 1"><DataSet amr_box="0 1 0 1 0 1" file="b.vti"/>', 'there is no file "b.vti"'),
                ('<Block level="0" spacing="1 1 1"><DataSet amr_box="0 1 0 1 0 1"/>', "block 0 of level 0 has no file"),
                ('<Block level="0" spacing="1 1 1"><DataSet amr_box="0 4000000000 0 1 0 1" file="a.vti"/>', "is out of range"),
                ('<Block level="0" spacing="1 1 1">' + '<DataSet amr_box="0 1 0 1 0 1" file="a.vti"/>' * 20000,
                 "block 1 of level 0 overlaps block 0 of level 0")):
            (self.folder / "a.vth").write_text(begin + blocks + end)
            done = subvol_measured("info", "a.vth", folder=self.folder, max_seconds=20, max_mib=200)
            self.assertEqual(done.code, 2, done.err)
            self.assertIn(sentence, done.err)
            self.assertEqual(len(done.err.splitlines()), 1, done.err)


if __name__ == "__main__":
    unittest.main()
