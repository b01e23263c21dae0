# SPDX-License-Identifier: Apache-2.0
"""Files of points have the same contents as the mesh gives, and an independent reader finds them."""

import array
import base64
import re
import shutil
import struct
import subprocess
import unittest
import xml.etree.ElementTree
import zlib

from command import InFolder, subvol

TRANSFER_FUNCTION = """[{"ColorSpace": "RGB", "Name": "t", "RGBPoints": [-1, 0, 0, 1, 0, 0, 1, 0, 1, 1, 0, 0],
                         "Points": [-1, 0, 0.5, 0, 1, 0.5, 0.5, 0]}]"""

# Everything that would otherwise depend on the mesh's box and range.
VIEW = ["--camera", "3,2,2.5,0,0,0,0,0,1,40", "--opacity-unit", ".02", "--tf", "tf.json", "--size", "96", "--backend", "cpu"]

# Positions in a .vdb are floats within voxels, 1e-8 of the ball's size; the sum over 200 sheets is in floats, which round to
# 6e-8 each: 2e-5 is what both can come to at a pixel on the rim, where a sheet may change sides.
VDB_TOLERANCE = 2e-5


def vtk_arrays(path):
    """The compressed arrays of a VTK XML file by name: (type, components, bytes)."""
    root = xml.etree.ElementTree.parse(path).getroot()
    assert root.get("compressor") == "vtkZLibDataCompressor" and root.get("header_type") == "UInt64"
    assert root.get("byte_order") == "LittleEndian"
    return {node.get("Name"): (node.get("type"), int(node.get("NumberOfComponents")), unpacked(node.text.strip()))
            for node in root.iter("DataArray") if node.get("format") == "binary"}


def unpacked(data):
    def decoded(start, size):
        return base64.b64decode(data[start : start + (size + 2) // 3 * 4])[:size]

    count = struct.unpack("<Q", decoded(0, 8))[0]
    header = struct.unpack(f"<{3 + count}Q", decoded(0, 8 * (3 + count)))
    blocks = decoded((8 * (3 + count) + 2) // 3 * 4, sum(header[3:]))
    result = b""
    for i, size in enumerate(header[3:]):
        block = zlib.decompress(blocks[:size])
        assert len(block) == (header[2] if i == count - 1 and header[2] else header[1])
        result += block
        blocks = blocks[size:]
    return result


class PointsFiles(InFolder):
    def setUp(self):
        super().setUp()
        (self.folder / "tf.json").write_text(TRANSFER_FUNCTION)

    def write(self, name, *options):
        return self.run_ok("points", "model:ball:4", "-o", name, "--json", *options).json()

    def test_the_boundary_is_inside_or_beside(self):
        self.assertNotIn("boundary", self.write("a.ply"))
        self.assertEqual(self.files(), ["a.ply", "tf.json"])
        for name, options in [("b.vtp", []), ("c.vdb", []), ("d.ply", ["--splats"])]:
            beside = name.split(".")[0] + ".boundary.vtp"
            self.assertEqual(self.write(name, *options)["boundary"], beside)
            self.assertIn(beside, self.files())

    def test_info_says_what_is_in_them(self):
        expected = None
        for name, options in [("a.ply", []), ("b.ply", ["--ascii"]), ("c.ply", ["--splats"]), ("d.vtp", []), ("e.vdb", [])]:
            made = self.write(name, *options)
            info = self.run_ok("info", name, "--json").json()
            self.assertEqual(info["points"], made["points"])
            self.assertEqual([channel["name"] for channel in info["channels"]], ["density"])
            self.assertLess(info["channels"][0]["min"], info["channels"][0]["max"])
            self.assertEqual(info["kernel"], {"type": "compact", "radius": 1.43})
            found = [info[key] for key in ("points", "channels", "kernel", "bounds", "boundary_triangles")]
            expected = expected or found
            self.assertEqual(found, expected, name)
        self.assertGreater(expected[-1], 0)

    def test_pictures_of_them_are_those_of_the_mesh(self):
        self.run_ok("render", "model:ball:4", "-o", "mesh.exr", *VIEW)
        for name, options in [("a.ply", []), ("b.ply", ["--ascii"]), ("c.ply", ["--splats"]), ("d.vtp", []), ("e.vdb", [])]:
            self.write(name, *options)
            picture = name + ".exr"
            drawn = self.run_ok("render", name, "-o", picture, *VIEW, "--json").json()
            self.assertEqual((drawn["method"], drawn["field"]), ("splat", "density"))
            difference = self.run_ok("compare", "mesh.exr", picture, "--json").json()["max"]
            self.assertLessEqual(difference, VDB_TOLERANCE if name.endswith(".vdb") else 0, name)

    def test_without_the_boundary_the_picture_ends_where_weights_do(self):
        self.run_ok("points", "model:ball:16", "-o", "a.vtp")
        self.run_ok("render", "a.vtp", "-o", "with.exr", *VIEW)
        (self.folder / "a.boundary.vtp").unlink()
        self.assertEqual(self.run_ok("info", "a.vtp", "--json").json()["boundary_triangles"], 0)
        self.run_ok("render", "a.vtp", "-o", "without.exr", *VIEW)
        # Without the boundary, kernels at the rim reach beyond it: the picture is about half a cell larger all around, else the same.
        psnr = self.run_ok("compare", "with.exr", "without.exr", "--json").json()["psnr"]
        self.assertGreater(psnr, 18)
        self.assertLess(psnr, 40)

    def test_another_reader_finds_the_points_in_a_vtp(self):
        points = self.write("a.vtp")["points"]
        arrays = vtk_arrays(self.folder / "a.vtp")
        expected = {"Points": ("Float64", 3), "connectivity": ("Int64", 1), "offsets": ("Int64", 1), "density": ("Float32", 1),
                    "density.gradient": ("Float32", 3), "density.moment": ("Float32", 1), "frame": ("Float32", 6),
                    "ellipsoid": ("Float32", 9), "pscale": ("Float32", 1)}
        self.assertEqual({name: values[:2] for name, values in arrays.items()}, expected)
        for kind, components, data in arrays.values():
            self.assertEqual(len(data), points * components * (4 if kind == "Float32" else 8))
        self.assertEqual(list(array.array("q", arrays["connectivity"][2])), list(range(points)))
        self.assertEqual(list(array.array("q", arrays["offsets"][2])), list(range(1, points + 1)))
        # Against the text form: x y z, value, gradient, moment, the frame in the order xx xy xz yy yz zz.
        self.write("a.ply", "--ascii")
        body = (self.folder / "a.ply").read_text().partition("end_header\n")[2]
        rows = [[float(number) for number in line.split()] for line in body.splitlines()[:points]]
        self.assertEqual(list(array.array("d", arrays["Points"][2])), [x for row in rows for x in row[:3]])
        in_order = [row[8 + k] for row in rows for k in (0, 3, 5, 1, 4, 2)]
        as_floats = array.array("f", in_order)  # the text has just enough digits to distinguish floats
        self.assertEqual(array.array("f", arrays["frame"][2]), as_floats)
        self.assertEqual(array.array("f", arrays["density"][2]), array.array("f", [row[3] for row in rows]))
        surface = vtk_arrays(self.folder / "a.boundary.vtp")
        corners = array.array("q", surface["connectivity"][2])
        edges = set()
        for a, b, c in zip(corners[::3], corners[1::3], corners[2::3]):
            edges |= {(a, b), (b, c), (c, a)}
        self.assertEqual(edges, {(b, a) for a, b in edges}, "closed")

    def test_hessians_are_in_the_files(self):
        for name in ("a.ply", "b.vtp", "c.vdb"):
            self.write(name, "--correction", "full", *(["--ascii"] if name == "a.ply" else []))
            self.run_ok("info", name)
        header, _, body = (self.folder / "a.ply").read_text().partition("end_header\n")
        vertex = header.partition("element vertex ")[2].partition("element")[0]
        names = re.findall(r"^property \w+ (\w+)$", vertex, re.MULTILINE)
        rows = [dict(zip(names, map(float, line.split()))) for line in body.splitlines()[:int(vertex.split()[0])]]
        kind, components, data = vtk_arrays(self.folder / "b.vtp")["density.hessian"]
        self.assertEqual((kind, components), ("Float32", 6))
        in_order = [row[name] for row in rows for name in ("hxx", "hyy", "hzz", "hxy", "hyz", "hxz")]
        self.assertEqual(array.array("f", data), array.array("f", in_order))
        self.assertGreater(max(map(abs, in_order)), 0)

    @unittest.skipUnless(shutil.which("vdb_print"), "OpenVDB's vdb_print (package openvdb-tools) is missing")
    def test_openvdbs_own_tool_finds_the_points_in_a_vdb(self):
        self.write("a.vdb")
        told = subprocess.run(["vdb_print", "-l", self.folder / "a.vdb"], capture_output=True, text=True, check=True).stdout
        for part in ("Name: points", "ptdataidx32", "channel_0: density", "creator: OpenSubVol", "kernel: "):
            self.assertIn(part, told)

    def test_viewers_of_splats_find_theirs(self):
        """Such viewers take all properties in the header as those of the vertex, so no other element may follow."""
        points = self.write("a.ply", "--splats")["points"]
        header, _, body = (self.folder / "a.ply").read_bytes().partition(b"end_header\n")
        properties = re.findall(r"^property (\w+) (\w+)$", header.decode(), re.MULTILINE)
        self.assertEqual(len(body), points * sum({"float": 4, "double": 8}[kind] for kind, _ in properties))
        floats = {name for kind, name in properties if kind == "float"}
        self.assertLessEqual({"x", "y", "z", "opacity", *(f"scale_{k}" for k in range(3)), *(f"rot_{k}" for k in range(4)),
                              *(f"f_dc_{k}" for k in range(3))}, floats)
        self.assertNotIn(b"property list", header)

    def test_options_that_cannot_be_followed_are_refused(self):
        self.write("a.ply")
        for arguments in (["render", "a.ply", "-o", "a.png", "--levels", "1"],
                          ["render", "a.ply", "-o", "a.png", "--per-edge", "2"],
                          ["render", "a.ply", "-o", "a.png", "--density", "x"],
                          ["render", "a.ply", "-o", "a.png", "--reduce", "0.1"],
                          ["render", "a.ply", "-o", "a.png", "--seconds", "1"],
                          ["render", "a.ply", "-o", "a.png", "--method", "tets"],
                          ["render", "a.ply", "-o", "a.png", "--field", "none"],
                          ["info", "a.ply", "--at", "0,0,0"],
                          ["points", "model:ball:2", "-o", "b.vtp", "--ascii"],
                          ["points", "model:ball:2", "-o", "b.vdb", "--splats"]):
            with self.subTest(arguments):
                done = subvol(*arguments, folder=self.folder)
                self.assertEqual(done.code, 2)
                self.assertRegex(done.err, r"^subvol: [^\n]+\n$", "one sentence")
        self.assertEqual(self.files(), ["a.ply", "tf.json"])

    def test_lying_and_cut_off_files_get_one_sentence(self):
        lie = "ply\nformat binary_little_endian 1.0\ncomment kernel {\"type\":\"compact\"}\nelement vertex 1000000000000\n"
        (self.folder / "lie.ply").write_text(lie + "property float x\nend_header\n" + "0" * 100)
        (self.folder / "empty.vtp").write_text("")
        for name in ("cut.ply", "cut.vtp", "cut.vdb"):
            self.write(name)
            data = (self.folder / name).read_bytes()
            (self.folder / name).write_bytes(data[: len(data) // 2])
        for name in ("lie.ply", "empty.vtp", "cut.ply", "cut.vtp", "cut.vdb", "missing.ply"):
            with self.subTest(name):
                done = subvol("info", name, folder=self.folder)
                self.assertEqual(done.code, 2)
                self.assertRegex(done.err, rf"^subvol: {name}[^\n]+\n$", "one sentence")


if __name__ == "__main__":
    unittest.main()
