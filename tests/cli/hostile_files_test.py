# SPDX-License-Identifier: Apache-2.0
"""Files made to harm the program or its user, and volumes that nothing of is seen: each gets one sentence."""

import json
import struct
import unittest

from command import SANITIZED, InFolder, subvol, subvol_measured

HEAD = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n"
CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def block(size, at=(0, 0, 0)):
    """One cell with values from 1 to 2, as legacy VTK."""
    points = [" ".join(repr(a + s * c) for a, s, c in zip(at, size, corner)) for corner in CORNERS]
    values = [1 + 0.5 * (x + y) for x, y, _ in CORNERS]
    return (HEAD + "POINTS 8 double\n" + "\n".join(points) + "\nCELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n" +
            "POINT_DATA 8\nSCALARS heat double 1\nLOOKUP_TABLE default\n" + "\n".join(map(str, values)) + "\n")


class HostileFiles(InFolder):
    def write(self, name, content):
        (self.folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())

    def assert_refused(self, *arguments, naming):
        before = self.files()
        done = subvol_measured(*arguments, folder=self.folder, max_mib=200)
        self.assertEqual(done.code, 2, done.err)
        self.assertRegex(done.err, r"\Asubvol: [^\x00-\x1f\x7f]+\n\Z", "one sentence, which a terminal only shows")
        self.assertIn(naming, done.err)
        self.assertEqual(self.files(), before)
        if not SANITIZED:
            self.assertLess(done.peak_mib, 200)

    def grid(self):
        self.run_ok("vdb", "model:ball:2", "-o", "good.vdb", "--resolution", "20")
        data = (self.folder / "good.vdb").read_bytes()
        (self.folder / "good.vdb").unlink()
        return data

    def test_a_block_longer_than_its_buffer(self):
        data = self.grid()
        # A block for blosc that unpacks into the 512 floats of a leaf, or fewer.
        for at in range(len(data) - 24):
            size, raw, packed = struct.unpack_from("<q", data, at)[0], *struct.unpack_from("<I4xI", data, at + 12)
            if 16 < size == packed and 0 < raw <= 2048 and data[at + 8] == 2 and data[at + 11] == 4:  # version, bytes of a float
                break
        self.write("bad.vdb", data[:at] + struct.pack("<q", -60000) + data[at + 8:] + bytes(70000))
        for words in (["info", "bad.vdb"], ["render", "bad.vdb", "-o", "a.png"], ["render", "bad.vdb", "-o", "a.png", "--method", "grid"],
                      ["compare", "bad.vdb", "bad.vdb"], ["points", "bad.vdb", "-o", "a.ply"],
                      ["vdb", "model:ball:2", "-o", "a.vdb", "--like", "bad.vdb"]):
            with self.subTest(words):
                self.assert_refused(*words, naming=f"bad.vdb: is not a whole OpenVDB file: at byte {at + 8}, a block of 60000 bytes")

    def test_json_that_is_nested_too_deep(self):
        # Copied or written by recursion, these overflow the stack.
        for name, text in (("a.json", 200000 * "[" + 200000 * "]"), ("b.json", 100000 * '{"a":' + "1" + 100000 * "}"),
                           ("c.json", '[{"orbit":' + 200000 * "[" + 200000 * "]" + "}]")):
            self.write(name, text)
            for words in (["render", "model:ball:2", "-o", "r.png", "--tf", name], ["slice", "model:ball:2", "-o", "r.png", "--tf", name],
                          ["render", "model:ball:2", "-o", "r.png", "--camera", name], ["study", name, "-o", "out"],
                          ["view", "model:ball:2", "--script", name, "--screenshot", "r.png"]):
                with self.subTest(words):
                    self.assert_refused(*words, naming="nested too deep (at most 100")
        self.write("a.vtu.series", '{"files": ' + 200000 * "[" + 200000 * "]" + "}")
        self.assert_refused("info", "a.vtu.series", naming="nested too deep")
        # Brackets within texts are no nesting.
        self.write("map.json", json.dumps([{"Name": 500 * '[{\\"', "RGBPoints": [0, 0, 0, 0, 1, 1, 1, 1]}]))
        self.run_ok("render", "model:ball:2", "-o", "r.png", "--size", "8x8", "--tf", "map.json", "--quiet")

    def test_a_volume_that_overflows(self):
        for scale, words in ((1e300, True), (1e110, True), (1e90, False)):  # the cube of the last one is a number
            self.write("a.vtk", block((scale, scale, scale)))
            text = self.run_ok("info", "a.vtk").out
            self.assertEqual("beyond what can be computed" in text, words, text)
            self.assertEqual(self.run_ok("info", "a.vtk", "--json").json()["verdict"] == "sound", not words)

    def test_messages_are_short(self):
        corners = [[0, 1, 2, 3, 4 * k + 4, 4 * k + 5, 4 * k + 6, 4 * k + 7] for k in range(2000)]  # of one face
        points = "0 0 0 1 0 0 1 1 0 0 1 0 " + " ".join(f"0 0 {k} 1 0 {k} 1 1 {k} 0 1 {k}" for k in range(1, 2001))
        cells = "\n".join("8 " + " ".join(map(str, cell)) for cell in corners)
        self.write("fan.vtk", HEAD + f"POINTS 8004 double\n{points}\nCELLS 2000 18000\n{cells}\nCELL_TYPES 2000\n" + "12\n" * 2000)
        self.assert_refused("info", "fan.vtk", "--quiet", naming="and 1,990 more (points and cells")
        name = 30 * ("d" * 200 + "/") + "a.vtu"
        for words in (["info", name], ["model", "ball", "-o", name], ["points", "model:ball:2", "-o", "x." + "y" * 5000],
                      ["render", "model:ball:2", "-o", "a.png", "--field", "f" * 5000], ["x" * 5000]):
            done = subvol(*words, folder=self.folder)
            self.assertEqual(done.code, 2)
            self.assertLess(len(done.err), 600, done.err)

    def test_voxels_that_cannot_be(self):
        # Before a level of the limit is looked for that fits them, which takes gigabytes.
        for words in (["--voxel-size", "1e-9"], ["--voxel-size", "1e-99"], ["--resolution", "1048576"], ["--budget", "1000P"],
                      ["--resolution", "4000", "--sdf", "--half-width", "nan"], ["--scale", "1e-90"]):
            with self.subTest(words):
                self.assert_refused("vdb", "model:ball:4", "-o", "a.vdb", *words, naming="--half-width" if "nan" in words else "voxel")

    def test_transforms_that_cannot_be(self):
        data = self.grid()
        edge = struct.pack("<d", 0.1)
        self.assertGreaterEqual(data.count(edge), 3)
        for wrong in (float("nan"), float("inf"), 0.0, 5e-324, 1e-300, 1e300, -1e300):
            for count in (-1, 1):  # all edges, or one
                with self.subTest(wrong=wrong, count=count):
                    self.write("bad.vdb", data.replace(edge, struct.pack("<d", wrong), count))
                    self.assert_refused("vdb", "model:ball:4", "-o", "a.vdb", "--like", "bad.vdb", naming="voxel")

    def test_names_that_hide_or_turn_text(self):
        name = "a&#x1b;[2J&#7;b&#x202e;x&#x2028;&#xfffe;"
        self.run_ok("model", "ball", "-o", "a.vtu", "--resolution", "2")
        text = (self.folder / "a.vtu").read_bytes()
        self.write("a.vtu", text.replace(b'Name="density"', f'Name="{name}"'.encode()))
        forbidden = "[\x00-\x08\x0b-\x1f\x7f\u202a-\u202e\u2028\u2029\ufffe\uffff]"
        for words in (["info", "a.vtu"], ["info", "a.vtu", "--field", "none"], ["render", "a.vtu", "-o", "a.png", "--size", "16", "--legend", "l.svg"],
                      ["subdivide", "a.vtu", "-o", "b.vtu"], ["points", "a.vtu", "-o", "b.vtp"], ["points", "a.vtu", "-o", "b.ply"],
                      ["probe", "a.vtu", "--at", "0,0,0", "-o", "b.csv"], ["page", "a.vtu", "-o", "b.html"]):
            with self.subTest(words):
                done = subvol(*words, folder=self.folder)
                self.assertNotRegex(done.out + done.err, forbidden)
        for written in ("l.svg", "b.vtu", "b.vtp", "b.ply", "b.csv", "b.html"):
            with self.subTest(written):
                content = (self.folder / written).read_bytes().decode("utf-8", "replace")
                head = content.split("<AppendedData")[0].split("end_header")[0]
                self.assertNotRegex(head, forbidden)
        self.assertEqual(subvol("info", "b.vtu", folder=self.folder).code, 0)

    def test_a_length_that_the_file_does_not_have(self):
        data = self.grid()
        for text in (b"density", b"Tree_float_5_4_3", b"subvol_input"):
            with self.subTest(text):
                at = data.index(text) - 4
                self.write("bad.vdb", data[:at] + struct.pack("<I", 0x7FFFFFFF) + data[at + 4:])
                self.assert_refused("info", "bad.vdb", naming="a text of 2147483647 bytes")

    def test_openvdb_is_silent(self):
        data = bytearray(self.grid())
        data[8] = 225  # a version that is not known
        self.write("new.vdb", bytes(data))
        self.assert_refused("info", "new.vdb", naming="the file's version is 225")

    def test_bytes_that_a_terminal_obeys(self):
        self.write("a.msh", b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$No\x1b]0;x\x07de\n27\n")
        self.assert_refused("info", "a.msh", naming="$No\\x1b]0;x\\x07de")
        self.write("long.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$" + 100000 * "N")
        self.assert_refused("info", "long.msh", naming="$" + 39 * "N" + "…")
        self.run_ok("points", "model:ball:2", "-o", "a.vtp")
        text = (self.folder / "a.vtp").read_bytes()
        self.write("a.vtp", text.replace(b'<DataArray type="', b'<DataArray type="\xff\x1b', 1))
        self.assert_refused("info", "a.vtp", naming="\\xff\\x1bInt64")
        self.write("colors.json", b'[{"Name": "\xff\x1b"}]')
        self.assert_refused("render", "model:ball:2", "-o", "a.png", "--tf", "colors.json", naming="colors.json")

    def test_names_in_json(self):
        self.write("a.vtk", block((1, 1, 1)).encode().replace(b"heat", b"h\x1b%ff%00\xed\xa0\x80t"))
        done = self.run_ok("info", "a.vtk", "--json")
        self.assertRegex(done.out, r"\A[^\x00-\x09\x0b-\x1f\x7f]+\Z")
        name = done.json()["fields"][0]["name"]
        self.assertNotIn("\x1b", name)
        self.assertEqual(name, json.loads(json.dumps(name)))
        done = self.run_ok("render", "a.vtk", "-o", "a.png", "--size", "8", "--field", name, "--json")
        self.assertEqual(done.json()["field"], name, "the name that is shown is the name to give")


class NothingIsSeen(InFolder):
    def write(self, name, size, at=(0.31, 0.31, 0.31)):
        (self.folder / name).write_text(block(size, at))

    def test_voxels_beside_a_thin_volume(self):
        self.write("rod.vtk", (1e6, 1, 1))
        done = subvol("vdb", "rod.vtk", "-o", "a.vdb", folder=self.folder)
        self.assertEqual((done.code, done.err), (2, "subvol: rod.vtk: no voxel centre lies inside (try --voxel-size 0.5)\n"))
        self.assertEqual(self.files(), ["rod.vtk"])
        self.assertEqual(subvol("vdb", "rod.vtk", "-o", "a.vdb", "--memory", "1M", folder=self.folder).err, done.err)
        self.assertEqual(self.files(), ["rod.vtk"])
        self.write("sheet.vtk", (1e6, 1e6, 1))
        done = subvol("vdb", "sheet.vtk", "-o", "a.vdb", folder=self.folder)
        self.assertEqual(done.code, 2)
        self.assertRegex(done.err, r"no voxel centre lies inside \(it is thinner than the voxels of any grid of its size")

    def test_the_proposed_voxels_show_it(self):
        self.write("rod.vtk", (2e3, 1, 1))
        done = subvol("vdb", "rod.vtk", "-o", "a.vdb", folder=self.folder)
        self.assertIn("(try --voxel-size 0.5)", done.err)
        done = self.run_ok("vdb", "rod.vtk", "-o", "a.vdb", "--voxel-size", "0.5", "--json")
        self.assertEqual(done.json()["active_voxels"], 4000 * 2 * 2, "8 voxels in each unit of volume")

    def test_grids_beside_an_empty_one(self):
        self.write("rod.vtk", (1e6, 1, 1))
        done = self.run_ok("vdb", "rod.vtk", "-o", "a.vdb", "--sdf", "--json")
        self.assertEqual([w for w in done.json()["warnings"] if "empty" in w],
                         ['the grid "heat" is empty: no voxel centre lies inside'])

    def test_pictures(self):
        self.write("rod.vtk", (1e6, 1, 1))
        warnings = self.run_ok("render", "rod.vtk", "-o", "a.png", "--size", "64", "--json").json()["warnings"]
        self.assertRegex(" ".join(warnings), "the picture is (nearly )?empty")
        away = ["--camera", "9,9,9,20,20,20,0,0,1,30"]
        warnings = self.run_ok("render", "model:ball:2", "-o", "a.png", "--size", "16", *away, "--json").json()["warnings"]
        self.assertRegex(" ".join(warnings), "the picture is empty: no pixel is hit")
        self.assertEqual(self.run_ok("render", "model:ball:2", "-o", "a.png", "--size", "16", "--json").json()["warnings"], [])

    def test_coordinates_whose_squares_overflow(self):
        self.write("huge.vtk", (1e300, 1, 1))
        for method in ("splat", "tets", "dense"):
            done = subvol("render", "huge.vtk", "-o", "a.png", "--method", method, folder=self.folder)
            self.assertEqual((done.code, done.err),
                             (2, "subvol: huge.vtk: point 1 has the coordinate 1e+300 (at most 1e18 can be drawn)\n"))
        self.assertEqual(self.files(), ["huge.vtk"])


if __name__ == "__main__":
    unittest.main()
