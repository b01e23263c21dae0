# SPDX-License-Identifier: Apache-2.0
"""`subvol mesh` of voxels with labels: .vdb, .vti and .nrrd."""

import math
import sys
import unittest

from command import InFolder, subvol

try:
    import numpy

    from label_files import TURN, voxels, write_nrrd, write_vdb, write_vti
except ImportError:
    print("skipped: no numpy")
    sys.exit(77)

EDGES = TURN @ numpy.diag([1, 1.25, .75])  # of voxels that are turned and no cubes
ORIGIN = numpy.array([5, -3, 100])
MIDDLE, RADIUS, CORE = numpy.array([17.3, 14.1, 23.6]), 12, 6.5  # of a ball within a ball; the middle in voxels


def ball(*place):
    away = numpy.sqrt(sum((edge * (x - middle)) ** 2 for edge, x, middle in zip((1, 1.25, .75), place, MIDDLE)))
    return numpy.where(away < CORE, 7, numpy.where(away < RADIUS, 2, 0))


class Labels(InFolder):
    def make(self, *words):
        return self.run_ok("mesh", *words, "-o", "out.vtu", "--quiet", "--json").json()

    def test_a_ball_within_a_ball_from_each_format(self):
        labels = voxels((35, 29, 48), ball)
        write_vdb(self.folder / "a.vdb", labels, voxel=EDGES, origin=ORIGIN)
        write_vdb(self.folder / "b.vdb", labels, voxel=EDGES, origin=ORIGIN - EDGES @ [-8, 16, 4096], first=(-8, 16, 4096), kind="int64", tiles=False)
        for at in ("CellData", "PointData"):
            write_vti(self.folder / f"{at}.vti", labels, (1, 1.25, .75), ORIGIN, TURN, at=at)
        write_vti(self.folder / "bytes.vti", labels, (1, 1.25, .75), ORIGIN, TURN, kind="UInt8")
        write_nrrd(self.folder / "a.nrrd", labels, EDGES, ORIGIN)
        for encoding, kind in (("raw", "short"), ("ascii", "uchar"), ("raw", "int64")):
            write_nrrd(self.folder / f"{encoding}_{kind}.nrrd", labels, EDGES, ORIGIN, encoding, kind)
        volumes = {2: 4 / 3 * math.pi * (RADIUS**3 - CORE**3), 7: 4 / 3 * math.pi * CORE**3}
        points = None
        for file in ("a.vdb", "b.vdb", "CellData.vti", "PointData.vti", "bytes.vti", "a.nrrd", "raw_short.nrrd", "ascii_uchar.nrrd", "raw_int64.nrrd"):
            if file not in ("a.vdb", "CellData.vti", "a.nrrd"):  # the surfaces alone: no mesh of two cells holds the core
                done = subvol("mesh", file, "-o", "no.vtu", "--cells", "2", "--label", "7=core", "--quiet", "--json", folder=self.folder)
                self.assertIn(done.code, (0, 1), done.err)
                self.assertEqual([label["voxels"] for label in done.json()["labels"]], [int((labels == 7).sum())], file)
                continue
            found = self.make(file, "--cells", "6", "--label", "7=core", "--label", "2=rest")
            self.assertEqual([material["name"] for material in found["materials"]], ["core", "rest"])
            for label, material in zip(found["labels"], found["materials"]):
                count = int((labels == label["label"]).sum())
                self.assertEqual(label["voxels"], count)
                self.assertLess(abs(label["voxels_world"] / (count * 1.25 * .75) - 1), 1e-12)
                self.assertLess(abs(label["enclosed_world"] / label["voxels_world"] - 1), 1e-3)
                self.assertLess(abs(label["enclosed_world"] / volumes[label["label"]] - 1), .02)
                self.assertLess(abs(material["volume_world"] / volumes[label["label"]] - 1), .04)
            box = self.run_ok("info", "out.vtu", "--json").json()["bounds"]
            middle = EDGES @ MIDDLE + ORIGIN
            self.assertLess(numpy.abs(numpy.mean(box, axis=0) - middle).max(), .3, file)
            points = points or found["points"]
            self.assertEqual(found["points"], points)

    def test_boxes_are_exact(self):
        write_vdb(self.folder / "two.vdb", voxels((24, 16, 12), lambda x, y, z: numpy.where(x < 10, 1, 2)), voxel=.5)
        found = self.make("two.vdb", "--cells", "8")
        for material, volume in zip(found["materials"], (10 * 16 * 12 / 8, 14 * 16 * 12 / 8)):
            self.assertLess(abs(material["enclosed_world"] / volume - 1), 1e-6)
            self.assertLess(abs(material["volume_world"] / volume - 1), .005)
        self.assertEqual(found["features"], {"points": 1, "curves": 1, "surfaces": 1})
        one = self.make("two.vdb", "--cells", "6", "--label", "2=right")
        self.assertNotIn("materials", one)
        self.assertLess(abs(one["volume_world"] / (14 * 16 * 12 / 8) - 1), .005)

    def refused(self, words, *parts):
        done = subvol("mesh", *words, "-o", "no.vtu", folder=self.folder)
        self.assertEqual(done.code, 2, done.err)
        lines = [line for line in done.err.splitlines() if line.startswith("subvol: ")]
        self.assertEqual(len(lines), 1, done.err)
        for part in parts:
            self.assertIn(part, done.err)
        self.assertEqual([file.name for file in self.folder.iterdir() if file.name.startswith("no.")], [])

    def test_what_has_no_labels_is_refused(self):
        labels = voxels((16, 16, 16), lambda x, y, z: numpy.where(x < 8, 1, 2))
        write_vdb(self.folder / "a.vdb", labels)
        write_vdb(self.folder / "floats.vdb", labels, kind="float")
        write_vdb(self.folder / "many.vdb", numpy.arange(1, 48**3 + 1, dtype=numpy.int32).reshape(48, 48, 48))
        write_vdb(self.folder / "below.vdb", labels - 5)
        write_vdb(self.folder / "none.vdb", 0 * labels)
        self.refused(["a.vdb", "--label", "3=a"], "--label: no voxel has the label 3 (labels: 1, 2)")
        self.refused(["a.vdb", "--label", "bone"], "is not a label (a number from 1, or 3=NAME)")
        self.refused(["a.vdb", "--label", "1=a", "--label", "2=a"], "two labels have the name")
        self.refused(["a.vdb", "a.vdb"], "is a grid, which has to be the only file")
        self.refused(["a.vdb", "--label", "1", "--iso", ".5"], "--label: has no effect with --iso")
        self.refused(["floats.vdb", "--label", "1"], "has no grid of integers")
        self.refused(["many.vdb"], "have 110592 labels (up to 1000 become materials: --label chooses them)")
        self.refused(["below.vdb"], "has the label -")
        self.refused(["none.vdb"], "no active voxels")
        (self.folder / "cube.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
        self.refused(["cube.obj", "--smooth", "3"], "--smooth: needs a grid; this is a surface")
        self.refused(["cube.obj", "a.vdb"], "is a grid, which has to be the only file")

    def test_images_that_are_not_whole_are_refused(self):
        labels = voxels((16, 16, 16), lambda x, y, z: numpy.where(x < 8, 1, 2))
        path = self.folder / "a.vti"
        write_vti(path, labels, kind="Float32")
        self.refused(["a.vti"], "a.vti", "no array has integers, which are labels")
        write_vti(path, labels, extra='<DataArray type="Int32" Name="more" format="appended" offset="0"/>')
        self.refused(["a.vti"], "several arrays could be labels (choose one of")
        self.make("a.vti", "--field", "more", "--cells", "4")
        self.refused(["a.vti", "--field", "none"], '"none" is not there')
        self.refused(["a.vti", "--iso", "1"], "--iso")
        write_vti(path, 0 * labels)
        self.refused(["a.vti"], "none has a label")
        write_vti(path, labels, spacing=(1, 0, 1))
        self.refused(["a.vti"], "a.vti: voxels: are flat")
        write_vti(path, labels)
        whole = path.read_bytes()
        for cut in (len(whole) // 2, 300):
            path.write_bytes(whole[:cut])
            self.refused(["a.vti"], "a.vti")
        for extent in ("0 4000000000 0 4000000000 0 4000000000", "0 16 0 16 0 17", "0 0 0 16 0 16", "0 1e9 0 1 0 1"):
            path.write_bytes(whole.replace(b"0 16 0 16 0 16", extent.encode()))
            self.refused(["a.vti"], "a.vti")

    def test_nrrd_files_that_are_not_whole_are_refused(self):
        labels = voxels((16, 16, 16), lambda x, y, z: numpy.where(x < 8, 1, 2))
        path = self.folder / "a.nrrd"
        write_nrrd(path, labels, kind="float")
        self.refused(["a.nrrd"], "a.nrrd", '"type" is "float" (integers, which are labels)')
        write_nrrd(path, labels)
        self.refused(["a.nrrd", "--field", "x"], "has one array without a name")
        whole = path.read_bytes()
        changes = [(b"sizes: 16 16 16", b"sizes: 16 16 17", "4096 labels for 4352 voxels"), (b"sizes: 16 16 16", b"sizes: 16 16 15", "more labels than its 3840 voxels"),
                   (b"sizes: 16 16 16", b"sizes: 2000000000 2000000000 2000000000", "1 to 2^31 in all"), (b"sizes: 16 16 16", b"sizes: 16 16", "three whole numbers"),
                   (b"sizes: 16 16 16", b"sizes: 1e99 -3 nan", "three whole numbers"), (b"dimension: 3", b"dimension: 4", '"dimension" is "4" (3)'),
                   (b"encoding: gzip", b"encoding: bzip2", "raw, gzip or ascii"), (b"encoding: gzip", b"data file: b.raw", "values in the file itself"),
                   (b"(1.0,0.0,0.0)", b"(1.0,0.0)", "three numbers"), (b"(1.0,0.0,0.0)", b"none", "three numbers"), (b"(1.0,0.0,0.0)", b"(0.0,1.0,0.0)", "voxels: are flat"),
                   (b"endian: little", b"endian: middle", "little or big"), (b"type: int32", b"typ: int32", 'the header has no field "type"'),
                   (b"type: int32", b"type: int32\ntype: int32", "there twice"), (b"NRRD0004", b"NRRX0004", "is not a NRRD file")]
        for old, new, part in changes:
            path.write_bytes(whole.replace(old, new, 1))
            self.refused(["a.nrrd"], "a.nrrd", part)
        for cut in (4, 100, len(whole) - 20, len(whole) - 2):
            path.write_bytes(whole[:cut])
            self.refused(["a.nrrd"], "a.nrrd")
        write_nrrd(path, labels - 5)
        self.refused(["a.nrrd"], "a.nrrd: voxel (0, 0, 0): has the label -4")
        write_nrrd(path, labels, encoding="ascii")
        path.write_bytes(path.read_bytes()[:-1] + b"1.5")
        self.refused(["a.nrrd"], "a.nrrd")


if __name__ == "__main__":
    unittest.main()
