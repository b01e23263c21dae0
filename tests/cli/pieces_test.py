# SPDX-License-Identifier: Apache-2.0
"""A mesh in pieces gives the bricks of the whole mesh, and is not held as a whole."""

import resource
import signal
import subprocess
import unittest

from command import COMMAND, SANITIZED, InFolder, subvol

BALL = "model:ball:6"


class FromPieces(InFolder):
    """Bricks of a mesh with a halo are also its pieces with ghost cells, numbered as in the whole."""

    def pieces(self, count, shape, source=BALL):
        self.run_ok("split", source, "-o", "pieces", "--bricks", count, "--by", shape, "--halo", 1, "--quiet")
        names = sorted(path.name for path in (self.folder / "pieces").glob("*.vtu"))
        listed = "".join(f'<Piece Source="pieces/{name}"/>' for name in names)
        (self.folder / "all.pvtu").write_text(
            f'<VTKFile type="PUnstructuredGrid"><PUnstructuredGrid GhostLevel="1">{listed}</PUnstructuredGrid></VTKFile>')
        return names

    def test_however_it_was_cut_it_is_the_same_mesh(self):
        grid, picture = ["--resolution", 60, "--quiet"], ["--size", "160x128", "--backend", "cpu", "--quiet"]
        self.run_ok("points", BALL, "-o", "whole.ply", "--quiet")
        self.run_ok("vdb", BALL, "-o", "whole.vdb", *grid)
        self.run_ok("render", BALL, "-o", "whole.exr", *picture)
        leaves = self.run_ok("info", "whole.vdb", "--json").json()["grids"][0]["hash"]
        for count, shape in ((3, "slabs"), (5, "blocks"), (4, "random")):
            self.pieces(count, shape)
            split = self.run_ok("split", "all.pvtu", "-o", "b.bricks", "--bricks", 4, "--json").json()
            order = '; cells in the order of "GlobalCellId"'
            self.assertTrue(any(order in said for said in split["warnings"]), split["warnings"])
            self.run_ok("points", "b.bricks", "-o", "parts.ply", "--quiet")
            self.run_ok("render", "b.bricks", "-o", "parts.exr", *picture)
            self.run_ok("vdb", "all.pvtu", "-o", "joined.vdb", *grid)
            self.assertEqual((self.folder / "parts.ply").read_bytes(), (self.folder / "whole.ply").read_bytes(), shape)
            self.assertEqual((self.folder / "parts.exr").read_bytes(), (self.folder / "whole.exr").read_bytes(), shape)
            self.assertEqual(self.run_ok("info", "joined.vdb", "--json").json()["grids"][0]["hash"], leaves, shape)
            for part in (1, 2):
                self.run_ok("vdb", "b.bricks", "-o", f"p{part}.vdb", "--part", f"{part}/2", *grid)
            self.run_ok("join", "p1.vdb", "p2.vdb", "-o", "joined.vdb", "--quiet")
            self.assertEqual(self.run_ok("info", "joined.vdb", "--json").json()["grids"][0]["hash"], leaves, shape)

    def test_a_density_comes_into_each_brick(self):
        self.pieces(3, "blocks")
        self.run_ok("split", "all.pvtu", "-o", "b.bricks", "--bricks", 2, "--density", "x*y+z", "--quiet")
        self.run_ok("points", "b.bricks", "-o", "parts.ply", "--quiet")
        self.run_ok("points", BALL, "-o", "whole.ply", "--density", "x*y+z", "--quiet")
        self.assertEqual((self.folder / "parts.ply").read_bytes(), (self.folder / "whole.ply").read_bytes())

    def test_never_in_memory_as_a_whole(self):
        self.pieces(27, "blocks", "model:twist:60")
        split = self.run_ok("split", "all.pvtu", "-o", "a.bricks", "--bricks", 27, "--json").json()
        whole = self.run_ok("split", "all.pvtu", "-o", "b.bricks", "--bricks", 27, "--weld", "--json").json()
        self.assertEqual((split["cells"], split["points"]), (216000, 226981))
        if not SANITIZED:
            self.assertLess(split["peak_bytes"], whole["peak_bytes"])

    def a_cell_beside_hexahedra(self, points, corners, vtk_type):
        """all.pvtu: eight hexahedra, and far from them a cell of another kind."""
        def array(name, kind, numbers, components=1):
            return (f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="ascii">'
                    f'{" ".join(map(str, numbers))}</DataArray>')

        self.run_ok("model", "twist", "--resolution", 2, "-o", "a.vtu", "--quiet")
        (self.folder / "b.vtu").write_text(
            f'<VTKFile type="UnstructuredGrid"><UnstructuredGrid><Piece NumberOfPoints="{len(points)}" NumberOfCells="1"><Points>'
            f'{array("Points", "Float64", (x for point in points for x in point), 3)}</Points><Cells>'
            f'{array("connectivity", "Int64", corners)}{array("offsets", "Int64", [len(corners)])}'
            f'{array("types", "UInt8", [vtk_type])}</Cells></Piece></UnstructuredGrid></VTKFile>')
        (self.folder / "all.pvtu").write_text('<VTKFile type="PUnstructuredGrid"><PUnstructuredGrid><Piece Source="a.vtu"/>'
                                              '<Piece Source="b.vtu"/></PUnstructuredGrid></VTKFile>')

    def test_tetrahedra_in_pieces_are_split_piece_by_piece(self):
        self.a_cell_beside_hexahedra([(9, 0, 0), (10, 0, 0), (9, 1, 0), (9, 0, 1)], range(4), 10)
        # Sharp edges are those of the tetrahedron, which pieces that are split no longer have.
        for held, angle in ((False, ("--crease-angle", "none")), (True, ())):
            bricks = f"{held}.bricks"
            done = self.run_ok("split", "all.pvtu", "-o", bricks, "--bricks", 2, *angle)
            self.assertEqual("held in memory" in done.err, held, done.err)
            self.assertIn("8 hexahedra and 1 tetrahedron split into 68 hexahedra", done.err)
            self.assertEqual(self.run_ok("info", bricks, "--json").json()["cells"], 68)
            self.run_ok("points", bricks, "-o", "bricks.ply", "--quiet")
            self.run_ok("points", "all.pvtu", "-o", "all.ply", "--quiet", *angle)
            self.assertEqual((self.folder / "bricks.ply").read_bytes(), (self.folder / "all.ply").read_bytes())

    def test_cells_that_repeat_points_are_held_whole(self):
        prism = [(9, 0, 0), (10, 0, 0), (9, 1, 0), (9, 0, 1), (10, 0, 1), (9, 1, 1)]
        self.a_cell_beside_hexahedra(prism, (0, 1, 2, 2, 3, 4, 5, 5), 12)
        done = self.run_ok("split", "all.pvtu", "-o", "b.bricks", "--bricks", 2)
        self.assertIn("all pieces are held in memory: it has cells that repeat points", done.err)
        self.assertEqual(self.run_ok("info", "b.bricks", "--json").json()["cells"],
                         self.run_ok("info", "all.pvtu", "--json").json()["cells"])

    def test_what_goes_wrong_leaves_nothing(self):
        names = self.pieces(3, "slabs")
        first = self.folder / "pieces" / names[1]
        sound = first.read_bytes()

        def said(naming, *options):
            before = self.files()
            done = subvol("split", "all.pvtu", "-o", "b.bricks", "--bricks", 3, *options, folder=self.folder)
            self.assertEqual(done.code, 2, done.err)
            self.assertIn(naming, done.err)
            self.assertEqual(len(done.err.strip().splitlines()), 1, done.err)
            self.assertEqual(self.files(), before)

        first.write_bytes(sound[:len(sound) // 2])
        said(names[1])
        first.write_bytes(sound.replace(b'Name="connectivity"', b'Name="consectivity"'))
        said("connectivity")
        first.unlink()
        said("there is no file")
        first.write_bytes(sound)
        said("Unexpected end of expression", "--density", "x+")
        (self.folder / "b.bricks").mkdir()
        said("is not a folder of bricks")
        (self.folder / "b.bricks").rmdir()
        self.run_ok("split", "all.pvtu", "-o", "b.bricks", "--bricks", 3, "--quiet")

    def test_a_full_disk(self):
        for room in (0, 20000):
            with self.subTest(room):
                self.a_disk_with(room)

    def a_disk_with(self, room):
        def small_files():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))

        self.pieces(3, "slabs")
        before = self.files()
        done = subprocess.run([COMMAND, "split", "all.pvtu", "-o", "b.bricks"], cwd=self.folder, capture_output=True, text=True,
                              preexec_fn=small_files)
        self.assertIn(done.returncode, (2, 3), done.stderr)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        self.assertIn("cannot be written", done.stderr)
        self.assertEqual(self.files(), before)

    def test_a_killed_split_goes_on(self):
        self.pieces(8, "blocks", "model:twist:40")
        running = subprocess.Popen([COMMAND, "split", "all.pvtu", "-o", "k.bricks", "--bricks", "64", "--quiet"], cwd=self.folder)
        while running.poll() is None and not (self.folder / "k.bricks.unfinished" / "brick_00004.vtu").exists():
            pass
        running.kill()
        running.wait()
        again = self.run_ok("split", "all.pvtu", "-o", "k.bricks", "--bricks", 64, "--json").json()
        self.assertGreaterEqual(again["kept"], 4)
        self.assertEqual(self.files(), ["all.pvtu", "k.bricks", "pieces"])


if __name__ == "__main__":
    unittest.main()
