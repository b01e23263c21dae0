# SPDX-License-Identifier: Apache-2.0
"""A mesh in bricks gives what the mesh gives in one piece: the same bytes. What is damaged is said in one sentence."""

import json
import os
import resource
import shutil
import signal
import subprocess
import unittest

from command import COMMAND, InFolder, subvol

BALL = "model:ball:6"
CUTS = [(1, "blocks"), (2, "blocks"), (3, "slabs"), (4, "random"), (7, "blocks"), (7, "random")]


class SameAsTheWhole(InFolder):
    def cuts(self, cuts=None):
        for count, shape in cuts or CUTS:
            self.run_ok("split", BALL, "-o", "b.bricks", "--bricks", count, "--by", shape, "--quiet")
            yield f"{count} {shape}"

    def bytes_of(self, name):
        return (self.folder / name).read_bytes()

    def test_points(self):
        self.run_ok("points", BALL, "-o", "whole.ply", "--quiet")
        for cut in self.cuts():
            self.run_ok("points", "b.bricks", "-o", "parts.ply", "--quiet")
            self.assertEqual(self.bytes_of("parts.ply"), self.bytes_of("whole.ply"), cut)

    def test_files_with_levels_of_detail(self):
        self.run_ok("points", BALL, "-o", "whole.svk", "--quiet")
        for cut in self.cuts([(1, "blocks"), (7, "random")]):
            self.run_ok("points", "b.bricks", "-o", "one.svk", "--quiet")
            self.assertEqual(self.bytes_of("one.svk"), self.bytes_of("whole.svk"), cut)
            for part in (1, 2):
                self.run_ok("points", "b.bricks", "-o", f"p{part}.ply", "--part", f"{part}/2", "--quiet")
            self.run_ok("join", "p1.ply", "p2.ply", "-o", "joined.svk", "--quiet")
            self.assertEqual(self.bytes_of("joined.svk"), self.bytes_of("whole.svk"), cut)
        self.assertEqual([name for name in self.files() if "subvol-split" in name], [])

    def test_pictures(self):
        looks = [["--look", "volume"], ["--look", "solid", "--view", "iso"]]
        for look in looks:
            options = [*look, "--size", "192x160", "--backend", "cpu", "--quiet"]
            self.run_ok("render", BALL, "-o", "whole.exr", *options)
            for cut in self.cuts():
                self.run_ok("render", "b.bricks", "-o", "parts.exr", *options)
                self.assertEqual(self.bytes_of("parts.exr"), self.bytes_of("whole.exr"), f"{cut} {look}")
                # So little memory that each part of the picture is drawn alone.
                self.run_ok("render", "b.bricks", "-o", "parts.exr", "--memory", "100K", *options)
                self.assertEqual(self.bytes_of("parts.exr"), self.bytes_of("whole.exr"), f"{cut} {look} in parts")

    def test_pictures_of_tetrahedra(self):
        small = ["--size", "96x80", "--method", "tets"]
        for options, cuts in ((["--view", "iso"], [(1, "blocks"), (7, "random")]),
                              (["--look", "volume", "--clip", "0,0,0,1,1,0", "--levels", "0"], [(3, "slabs")]),
                              (["--look", "volume", "--camera", "0,0,0,1,.3,.2,0,0,1,70"], [(7, "blocks")]),  # from within
                              (["--crease-angle", "30", "--scheme", "linear", "--views", "4"], [(4, "random")])):
            whole = self.run_ok("render", BALL, "-o", "whole.exr", *small, *options, "--json").json()
            for cut in self.cuts(cuts):
                for memory in ("1G", "10M"):
                    parts = self.run_ok("render", "b.bricks", "-o", "parts.exr", *small, *options, "--memory", memory,
                                        "--json").json()
                    self.assertEqual(self.bytes_of("parts.exr"), self.bytes_of("whole.exr"), f"{cut} {options} {memory}")
                    for key in ("levels", "cells", "tets", "degenerate_tets", "inverted_tets", "rays", "lost_rays", "field"):
                        self.assertEqual(parts[key], whole[key], f"{cut} {key}")

    def test_schemes_that_do_not_interpolate(self):
        small, coarse = ["--size", "96x80", "--quiet"], ["--tolerance", 3e-3]
        for scheme, count, shape in (("cc", 5, "blocks"), ("bsxw", 4, "random")):
            own = ["--scheme", scheme]
            self.run_ok("split", BALL, "-o", "b.bricks", "--bricks", count, "--by", shape, "--halo", 4, "--quiet")
            for name, verb, *options in (("p.ply", "points"), ("s.exr", "render", *small, "--backend", "cpu"),
                                         ("l.exr", "render", *small, "--backend", "cpu", "--look", "solid"),
                                         ("t.exr", "render", *small, "--method", "tets"),
                                         ("b.ply", "surface", "--boundary", *coarse), ("i.ply", "surface", "--iso", 0.1, *coarse)):
                self.run_ok(verb, BALL, "-o", f"whole_{name}", *own, *options)
                memory = ["--memory", "10M"] if name == "t.exr" else []  # so that it is drawn in parts
                self.run_ok(verb, "b.bricks", "-o", name, *own, *options, *memory)
                self.assertEqual(self.bytes_of(name), self.bytes_of(f"whole_{name}"), f"{scheme} {verb} {options}")

    def test_grids(self):
        for options, cuts in ((["--resolution", 50], [(2, "blocks"), (7, "random")]),
                              (["--resolution", 40, "--levels", 1], [(3, "slabs")]),
                              (["--resolution", 40, "--scheme", "cc"], [(4, "blocks")]),
                              (["--resolution", 40, "--scheme", "bsxw"], [(3, "random")])):
            whole = self.run_ok("vdb", BALL, "-o", "whole.vdb", *options, "--json").json()
            for cut in self.cuts(cuts):
                (self.folder / "parts.vdb").unlink(missing_ok=True)
                parts = self.run_ok("vdb", "b.bricks", "-o", "parts.vdb", "--memory", "1M", *options, "--json").json()
                self.assertEqual(parts["output"], "parts.json" if parts["parts"] > 1 else "parts.vdb", cut)
                one = self.run_ok("vdb", "b.bricks", "-o", "one.vdb", *options, "--json").json()
                self.assertEqual([one["output"], one["parts"]], ["one.vdb", 1])
                self.assertFalse((self.folder / "one.json").exists())
                self.assertEqual(parts["active_voxels"], whole["active_voxels"], cut)
                self.assertEqual(parts["voxel_size"], whole["voxel_size"])
                listed = json.loads((self.folder / "parts.json").read_text())["parts"]
                self.assertEqual(sum(part["active_voxels"] for part in listed), whole["active_voxels"], cut)
                for key in ("min", "max"):
                    self.assertEqual(parts["grids"][0][key], whole["grids"][0][key], cut)
                for part in listed[::max(1, len(listed) // 2)]:  # a few; the leaves of all are compared below
                    self.assertEqual(self.values_in(part["file"]), self.values_in("whole.vdb", part["file"]), cut)
                self.run_ok("join", "parts.json", "-o", "joined.vdb", "--quiet")
                hashes = [self.run_ok("info", name, "--json").json()["grids"][0]["hash"]
                          for name in ("joined.vdb", "one.vdb", "whole.vdb")]
                self.assertEqual(hashes, hashes[-1:] * 3, cut)
                for part in listed:
                    os.remove(self.folder / part["file"])

    def values_in(self, grid, where=None):
        """The values of a grid at voxels' centres on the diagonals of the box of another grid's voxels, where that has some."""
        def at(name, places):
            words = [f"--at={x},{y},{z}" for x, y, z in places]
            return [one["value"] for one in self.run_ok("info", name, *words, "--json").json()["at"]]

        about = self.run_ok("info", where or grid, "--json").json()["grids"][0]
        size, (low, high) = about["voxel_size"], about["bounds"]
        centre = [[round((low[d] + t / 30 * (high[d] - low[d])) / size) * size for t in range(31)] for d in range(3)]
        places = [(x, y, z) for flip in (1, -1) for x, y, z in zip(centre[0], centre[1][::flip], centre[2])]
        here = at(where or grid, places)
        return [value for value, known in zip(at(grid, places), here) if known is not None]

    def test_a_finished_folder_whose_name_ends_as_that_of_an_unfinished_one_stays(self):
        self.run_ok("split", BALL, "-o", "run.unfinished", "--bricks", 2, "--quiet")
        before = sorted(path.name for path in (self.folder / "run.unfinished").iterdir())
        refused = subvol("split", "model:ball:5", "-o", "run", "--bricks", 2, folder=self.folder)
        self.assertEqual(refused.code, 2)
        self.assertIn("run.unfinished: exists and is a finished folder of bricks", refused.err)
        self.assertEqual(sorted(path.name for path in (self.folder / "run.unfinished").iterdir()), before)

    def test_an_index_that_lies_is_refused(self):
        self.run_ok("split", BALL, "-o", "b.bricks", "--bricks", 3, "--quiet")
        file = self.folder / "b.bricks" / "index.json"
        sound = file.read_text()

        def without_the_last(index):
            last = index["bricks"].pop()
            index["cells"] -= last["cells"]
            index["points"] -= last["points"]
            corners = [brick["bounds"] for brick in index["bricks"]]
            index["bounds"] = [[f(c[k][d] for c in corners) for d in range(3)] for k, f in ((0, min), (1, max))]
            for f, field in enumerate(index["fields"]):
                for key, choose in (("min", min), ("max", max)):
                    values = [brick["fields"][f][key] for brick in index["bricks"]]
                    field[key] = [choose(v[c] for v in values) for c in range(len(values[0]))]

        def far(index):
            index["bricks"][0]["reach"] = [[-1e300] * 3, [1e300] * 3]

        for change, said in ((lambda index: index.update(id=16 * "0"), "is a brick of another mesh"),
                             (lambda index: index.update(version=1.5), "is not an index of bricks"),
                             (lambda index: index.update(version=2**32 + 1), "has version 4294967297"),
                             (far, "has not the counts and bounds that the index gives"),
                             (without_the_last, "cells")):
            index = json.loads(sound)
            change(index)
            file.write_text(json.dumps(index))
            with self.subTest(said):
                refused = subvol("points", "b.bricks", "-o", "a.ply", folder=self.folder)
                self.assertEqual(refused.code, 2, refused.err)
                self.assertIn(said, refused.err)
                self.assertFalse((self.folder / "a.ply").exists())
        file.unlink()
        os.mkfifo(file)
        self.assertEqual(subvol("info", "b.bricks", folder=self.folder).code, 2)

    def test_the_file_that_was_asked_for(self):
        """The grids are in NAME.vdb wherever they fit into the memory; parts have a list, and no other file is replaced."""
        self.run_ok("vdb", BALL, "-o", "whole.vdb", "--resolution", 60, "--half", "--quiet")
        self.run_ok("split", BALL, "-o", "b.bricks", "--bricks", 3, "--quiet")
        wanted = self.run_ok("info", "whole.vdb", "--json").json()["grids"]
        for name, memory in (("a.vdb", []), ("b.vdb", ["--memory", "2G"])):
            self.run_ok("vdb", "b.bricks", "-o", name, "--resolution", 60, "--half", *memory, "--quiet")
            self.assertEqual(self.run_ok("info", name, "--json").json()["grids"], wanted)
        self.assertEqual(self.files(), ["a.vdb", "b.bricks", "b.json", "b.vdb", "whole.vdb"])
        self.assertEqual([part["file"] for part in json.loads((self.folder / "b.json").read_text())["parts"]], ["b.vdb"])
        few = ["vdb", "b.bricks", "--resolution", 60, "--memory", "300K", "-o"]
        parts = self.run_ok(*few, "a.vdb", "--json").json()
        self.assertGreater(parts["parts"], 1)
        self.assertEqual(parts["output"], "a.json")
        self.assertIn("a.vdb is that of an earlier run", "".join(parts["warnings"]))
        again = subvol(*few, "a.vdb", folder=self.folder)
        self.assertEqual(again.code, 0, again.err)  # the parts of an earlier run are replaced
        self.assertIn("a.json lists; `subvol join` makes a.vdb", again.err)
        # In one file meanwhile: the parts are still known as those of an earlier run.
        whole = subvol("vdb", "b.bricks", "--resolution", 60, "--memory", "2G", "-o", "a.vdb", folder=self.folder)
        self.assertIn(f"{parts['parts']} parts of an earlier run, as a_0000.vdb, remain beside a.vdb", whole.err)
        self.run_ok(*few, "a.vdb")
        before = self.files()
        (self.folder / "scene.json").write_text('{"camera": "mine"}')
        (self.folder / "shots_0001.vdb").write_text("mine")
        for name, said in (("scene.vdb", "scene.json: exists and is not a list"), ("shots.vdb", "shots_0001.vdb: exists and is not a part")):
            refused = subvol(*few, name, folder=self.folder)
            self.assertEqual(refused.code, 2)
            self.assertIn(said, refused.err)
        self.assertEqual((self.folder / "scene.json").read_text(), '{"camera": "mine"}')
        self.assertEqual((self.folder / "shots_0001.vdb").read_text(), "mine")
        self.assertEqual(self.files(), sorted([*before, "scene.json", "shots_0001.vdb"]))

    def test_figures(self):
        whole = self.run_ok("info", BALL, "--json").json()
        for cut in self.cuts():
            parts = self.run_ok("info", "b.bricks", "--json").json()
            for key in ("points", "points_used", "cells", "edges", "faces", "boundary_faces", "interior_edges",
                        "interior_edge_valence", "singular_nodes", "inverted_cells", "degenerate_cells",
                        "min_scaled_jacobian", "bounds", "fields"):
                self.assertEqual(parts[key], whole[key], f"{cut} {key}")
            self.assertAlmostEqual(parts["volume"], whole["volume"], delta=1e-12 * whole["volume"])
            self.assertEqual(parts["bricks"], int(cut.split()[0]))

    def test_places(self):
        places = ["--at", "0,0,0", "--at=-0.3,0.2,0.55", "--at", "5,0,0"]
        whole = self.run_ok("probe", BALL, *places, "--json").json()["values"]
        for cut in self.cuts():
            parts = self.run_ok("probe", "b.bricks", *places, "--json").json()["values"]
            for a, b in zip(parts, whole):
                self.assertEqual(a["inside"], b["inside"], cut)
                if b["inside"]:
                    self.assertAlmostEqual(a["value"], b["value"], delta=1e-9)

    def test_slices(self):
        plane = ["--plane", "0,0,0.01,0.2,0.1,1", "--resolution", 40]
        whole = self.run_ok("slice", BALL, "-o", "whole.csv", *plane, "--json").json()
        for cut in self.cuts():
            parts = self.run_ok("slice", "b.bricks", "-o", "b.csv", *plane, "--json").json()
            self.assertEqual(parts["bricks"], int(cut.split()[0]))
            # The frame is the box of the control points, not that of the limit.
            self.assertAlmostEqual(parts["step"], whole["step"], delta=0.1 * whole["step"])
            for key in ("min", "max"):
                self.assertAlmostEqual(parts[key], whole[key], delta=0.05)
            rows = [line.split(",") for line in (self.folder / "b.csv").read_text().splitlines()[1:]]
            self.assertEqual(len(rows), parts["inside"])
            at = rows[len(rows) // 2]
            there = self.run_ok("probe", BALL, f"--at={','.join(at[:3])}", "--json").json()["values"][0]
            self.assertAlmostEqual(float(at[6]), there["value"], delta=1e-9)

    def test_statistics(self):
        flat = ["--stats", "--scheme", "linear", "--json"]  # few pieces; those of the smooth limit are tested with the library
        whole = self.run_ok("probe", "model:twist:4", *flat).json()["stats"]["whole"]
        self.run_ok("split", "model:twist:4", "-o", "b.bricks", "--bricks", 2, "--quiet")
        parts = self.run_ok("probe", "b.bricks", "--at", "0,0,0", *flat).json()
        self.assertEqual(len(parts["values"]), 1)
        parts = parts["stats"]["whole"]
        self.assertEqual(parts["cells"], whole["cells"])
        self.assertAlmostEqual(parts["volume"], whole["volume"], delta=2e-4 * whole["volume"])
        for a, b in zip(parts["fields"], whole["fields"], strict=True):
            extent = b["max"]["value"] - b["min"]["value"] if isinstance(b["max"], dict) else b["max"] - b["min"]
            self.assertEqual(a["name"], b["name"])
            self.assertAlmostEqual(a["mean"], b["mean"], delta=2e-4 * extent)

    def test_surfaces(self):
        for options in (["--boundary"], ["--iso", 0.1, "--cap", "--tolerance", 3e-3, "--color-field", "density"]):
            whole = self.run_ok("surface", BALL, "-o", "whole.ply", *options, "--json").json()
            for cut in self.cuts([(3, "slabs"), (5, "blocks"), (4, "random")]):
                parts = self.run_ok("surface", "b.bricks", "-o", "parts.ply", *options, "--json").json()
                for key in ("points", "triangles", "area", "volume", "watertight", "euler", "components", "level", "deviation"):
                    self.assertEqual(parts[key], whole[key], f"{cut} {key}")
                self.assertEqual(self.bytes_of("parts.ply"), self.bytes_of("whole.ply"), cut)

    def test_what_holds_the_mesh_says_so(self):
        for cut in self.cuts([(3, "random")]):
            for name, verb, *options in (("a.vtu", "subdivide"), ("a.html", "page", "--title", "t"),
                                         ("a.png", "view", "--size", "64x48", "--screenshot"), ("a.bricks", "split", "--halo", 4)):
                output = [] if verb == "view" else ["-o"]
                self.run_ok(verb, BALL, *options, *output, "whole_" + name, "--quiet")
                done = self.run_ok(verb, "b.bricks", *options, *output, name)
                self.assertIn("held in memory together", done.err, verb)
                if verb != "split":
                    named = self.bytes_of(name).replace(b"b.bricks", BALL.encode())  # a page says what it shows
                    self.assertEqual(named, self.bytes_of("whole_" + name), verb)
            bricks = sorted(path.name for path in (self.folder / "a.bricks").glob("*.vtu"))
            self.assertEqual(bricks, sorted(path.name for path in (self.folder / "whole_a.bricks").glob("*.vtu")))
            for brick in bricks:
                self.assertEqual(self.bytes_of("a.bricks/" + brick), self.bytes_of("whole_a.bricks/" + brick))
            found = self.run_ok("compare", "b.bricks", BALL, "--levels", 1, "--samples", 1000, "--json").json()
            self.assertEqual((found["linf"], found["uncovered"]), (0, 0), cut)

    def test_the_twist_is_written_brick_by_brick(self):
        self.run_ok("points", "model:twist:10", "-o", "whole.ply", "--quiet")
        split = self.run_ok("split", "model:twist:10", "-o", "t.bricks", "--bricks", 8, "--json").json()
        self.assertEqual((split["cells"], split["bricks"]), (1000, 8))
        self.run_ok("points", "t.bricks", "-o", "parts.ply", "--quiet")
        self.assertEqual(self.bytes_of("parts.ply"), self.bytes_of("whole.ply"))


class WhatGoesWrong(InFolder):
    def setUp(self):
        super().setUp()
        self.run_ok("split", "model:twist:6", "-o", "t.bricks", "--bricks", 3, "--quiet")

    def assert_said(self, naming, *arguments):
        before = self.files()
        done = subvol(*arguments, folder=self.folder)
        self.assertEqual(done.code, 2, done.err)
        self.assertIn(naming, done.err)
        self.assertEqual(len(done.err.strip().splitlines()), 1, done.err)
        self.assertEqual(self.files(), before)

    def each_verb(self, naming):
        self.assert_said(naming, "points", "t.bricks", "-o", "a.ply")
        self.assert_said(naming, "vdb", "t.bricks", "-o", "a.vdb", "--resolution", 20)
        self.assert_said(naming, "render", "t.bricks", "-o", "a.png", "--size", "64x64")
        self.assert_said(naming, "surface", "t.bricks", "-o", "a.ply")
        self.assert_said(naming, "info", "t.bricks")

    def test_a_missing_folder_and_one_without_an_index(self):
        for name in ("none.bricks", "empty.bricks"):
            (self.folder / "empty.bricks").mkdir(exist_ok=True)
            for verb, *options in (["info"], ["points", "-o", "a.ply"], ["subdivide", "-o", "a.vtu"], ["view", "--screenshot", "a.png"]):
                self.assert_said(f"{name}/index.json: cannot be read: No such file or directory", verb, name, *options)

    def test_missing_changed_and_foreign_bricks(self):
        first = self.folder / "t.bricks" / "brick_00001.vtu"
        sound = first.read_bytes()
        first.unlink()
        self.each_verb("a brick is missing: brick_00001.vtu")
        first.write_bytes(sound[:-100])
        self.each_verb("in the index it has")
        changed = bytearray(sound)
        changed[len(sound) // 2] ^= 1
        first.write_bytes(changed)
        self.each_verb("has changed since the index was written")
        self.run_ok("split", "model:twist:6", "-o", "u.bricks", "--density", "x+y", "--bricks", 3, "--by", "slabs", "--quiet")
        shutil.copy(self.folder / "u.bricks" / "brick_00001.vtu", first)
        self.each_verb("is a brick of another mesh")

    def test_the_index(self):
        index = self.folder / "t.bricks" / "index.json"
        text = index.read_text()
        index.write_text(text.replace('"version": 1', '"version": 2'))
        self.each_verb("version 2 of the format of bricks")
        index.write_text(text[:200])
        self.each_verb("not well-formed JSON")
        index.write_text('{"format": "OpenSubVol bricks", "version": 1}')
        self.each_verb("not an index of bricks")

    def test_lists_that_cannot_be_joined(self):
        no_list = "is not a list of grids in several files"
        self.assert_said(no_list, "join", "t.bricks/index.json", "-o", "a.vdb")
        for text in ("[", "{}", '{"parts": []}', '{"parts": [3]}', '{"parts": [{"file": 3}]}', '{"parts": [{"file": "a"}, 3]}'):
            (self.folder / "list.json").write_text(text)
            self.assert_said(no_list, "join", "list.json", "-o", "a.vdb")
        self.assert_said("a list names all files", "join", "list.json", "list.json", "-o", "a.vdb")
        (self.folder / "list.json").write_text('{"parts": [{"file": "/none/x.vdb"}]}')
        self.assert_said("x.vdb: cannot be read", "join", "list.json", "-o", "a.vdb")

    def test_what_cannot_be_done_by_bricks(self):
        self.assert_said("settled when a mesh is split", "subdivide", "t.bricks", "-o", "a.vtu", "--weld")
        self.assert_said("misses the volume", "slice", "t.bricks", "-o", "a.png", "--plane", "0,0,9,0,0,1")
        self.assert_said("which is not refined by", "slice", "t.bricks", "-o", "a.png", "--scheme", "tetoct")
        self.assert_said("whole mesh in memory", "vdb", "t.bricks", "-o", "a.vdb", "--sdf")
        self.assert_said("whole mesh in memory", "points", "t.bricks", "-o", "a.ply", "--levels", 1)
        self.assert_said("--per-edge 1", "points", "t.bricks", "-o", "a.ply", "--per-edge", 2)
        self.assert_said("binary .ply or .svk only", "points", "t.bricks", "-o", "a.vtp")
        self.assert_said("binary .ply only", "points", "t.bricks", "-o", "a.svk", "--part", "1/2")
        self.assert_said("cannot draw a folder of bricks", "render", "t.bricks", "-o", "a.png", "--method", "dense")
        tets = ["render", "t.bricks", "-o", "a.png", "--method", "tets"]
        self.assert_said("these kernels need 4", "points", "t.bricks", "-o", "a.ply", "--scheme", "cc")
        self.assert_said("split with --halo 4", "render", "t.bricks", "-o", "a.png", "--look", "volume", "--scheme", "bsxw")
        self.assert_said("has hexahedra only", *tets, "--scheme", "tetoct")
        self.assert_said("a larger --memory", *tets, "--memory", "10K")
        self.assert_said("lights the boundary only", *tets, "--look", "isosurface")
        self.assert_said("split with --halo 4", "points", "t.bricks", "-o", "a.ply", "--correction", "full")
        self.assert_said("settled when a mesh is split", "points", "t.bricks", "-o", "a.ply", "--weld")
        self.assert_said("is not refined by", "surface", "t.bricks", "-o", "a.ply", "--scheme", "tetoct")
        self.assert_said("the limit does not take this value", "surface", "t.bricks", "-o", "a.ply", "--iso", 99)
        for scheme in ("tetoct", "boxspline"):
            for verb, name in (("points", "a.ply"), ("vdb", "a.vdb"), ("render", "a.png")):
                self.assert_said(scheme, verb, "t.bricks", "-o", name, "--scheme", scheme)
            self.assert_said("is not refined by", "probe", "t.bricks", "-o", "a.csv", "--scheme", scheme, "--at", "0,0,0")

    def test_voxels_that_are_too_small(self):
        for part in ([], ["--part", "1/2"]):
            self.assert_said("would not fit 32 bits", "vdb", "t.bricks", "-o", "a.vdb", "--voxel-size", "1e-12", *part)
            self.assert_said("more than a million blocks", "vdb", "t.bricks", "-o", "a.vdb", "--voxel-size", "1e-7", *part)
        index = self.folder / "t.bricks" / "index.json"
        found = json.loads(index.read_text())
        found["bricks"][0]["reach"][1][0] = 1e300
        index.write_text(json.dumps(found))
        self.assert_said("would not fit 32 bits", "vdb", "t.bricks", "-o", "a.vdb", "--resolution", "20")

    def test_splitting(self):
        (self.folder / "mine").mkdir()
        (self.folder / "mine" / "letter").write_text("dear")
        self.assert_said("is not a folder of bricks", "split", "model:twist:4", "-o", "mine", "--bricks", 2)
        self.assert_said("is not a resolution", "split", "model:twist:1", "-o", "a.bricks")
        self.assert_said("'12x' is not a resolution (2..4096)", "split", "model:twist:12x", "-o", "a.bricks")
        self.assert_said("bricks along a side", "split", "model:twist:4", "-o", "a.bricks", "--bricks", 101)
        self.assert_said("too few for a brick", "split", "model:twist:4", "-o", "a.bricks", "--memory", "10K")

    def everything(self):
        return {str(path.relative_to(self.folder)): path.read_bytes() if path.is_file() else b"" for path in self.folder.rglob("*")}

    def test_what_others_have_made_is_not_replaced(self):
        site = self.folder / "web"
        (site / "src").mkdir(parents=True)
        for name, text in (("index.json", '{"name": "my site"}'), ("index.html", "<html>"), ("src/main.js", "main()")):
            (site / name).write_text(text)
        thesis = self.folder / "n.bricks.unfinished"
        thesis.mkdir()
        (thesis / "progress.json").write_text('{"steps": 3}')
        (thesis / "thesis.txt").write_text("two years")
        self.run_ok("split", "model:twist:4", "-o", "own.bricks", "--bricks", 2, "--quiet")
        (self.folder / "own.bricks" / "pictures").mkdir()
        (self.folder / "own.bricks" / "notes.txt").write_text("mine")
        before = self.everything()
        for folder, said in (("web", "is not a folder of bricks"), ("n.bricks", "thesis.txt"), ("own.bricks", "none of its bricks")):
            self.assert_said(said, "split", "model:twist:4", "-o", folder, "--bricks", 3)
            self.assert_said(said, "split", "model:ball:2", "-o", folder, "--bricks", 3)
        self.assertEqual(self.everything(), before)

    def test_what_is_put_into_an_unfinished_folder_meanwhile_stays(self):
        running = subprocess.Popen([COMMAND, "split", "model:twist:40", "-o", "m.bricks", "--bricks", "64", "--quiet"],
                                   cwd=self.folder, stderr=subprocess.PIPE, text=True)
        unfinished = self.folder / "m.bricks.unfinished"
        while running.poll() is None and not (unfinished / "brick_00002.vtu").exists():
            pass
        running.send_signal(signal.SIGSTOP)
        (unfinished / "notes.txt").write_text("mine")
        running.send_signal(signal.SIGCONT)
        said = running.communicate()[1]
        self.assertEqual(running.returncode, 2, said)
        self.assertIn('holds "notes.txt"', said)
        self.assertEqual((unfinished / "notes.txt").read_text(), "mine")
        os.rename(unfinished / "notes.txt", self.folder / "notes.txt")
        again = self.run_ok("split", "model:twist:40", "-o", "m.bricks", "--bricks", 64, "--json").json()
        self.assertEqual(again["kept"], 64)

    def test_a_link_to_a_folder_stays_a_link(self):
        (self.folder / "disk").mkdir()
        (self.folder / "l.bricks").symlink_to("disk/real.bricks")
        for count in (2, 3):
            self.run_ok("split", "model:twist:4", "-o", "l.bricks", "--bricks", count, "--quiet")
            self.assertTrue((self.folder / "l.bricks").is_symlink())
            self.assertEqual(self.run_ok("info", "disk/real.bricks", "--json").json()["bricks"], count)
        self.assertEqual(os.listdir(self.folder / "disk"), ["real.bricks"])

    def test_a_full_disk(self):
        def small_files():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))

        for verb in (["split", "model:twist:20", "-o", "f.bricks", "--bricks", "2"], ["points", "t.bricks", "-o", "a.ply"],
                     ["vdb", "t.bricks", "-o", "a.vdb", "--resolution", "60"]):
            done = subprocess.run([COMMAND, *verb], cwd=self.folder, capture_output=True, text=True, preexec_fn=small_files)
            self.assertIn(done.returncode, (2, 3), done.stderr)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertIn("cannot be written", done.stderr)
        # What split has finished stays for the next run; nothing else stays.
        self.assertEqual([name for name in self.files() if name != "f.bricks.unfinished"], ["t.bricks"])
        self.assertEqual(self.run_ok("split", "model:twist:20", "-o", "f.bricks", "--bricks", 2, "--json").json()["cells"], 8000)

    def test_an_empty_unfinished_folder_is_no_obstacle(self):
        (self.folder / "e.bricks.unfinished").mkdir()  # of a run that ended before its first byte
        self.run_ok("split", BALL, "-o", "e.bricks", "--quiet")
        self.assertFalse((self.folder / "e.bricks.unfinished").exists())

    def test_a_killed_split_goes_on(self):
        running = subprocess.Popen([COMMAND, "split", "model:twist:40", "-o", "k.bricks", "--bricks", "64", "--quiet"],
                                   cwd=self.folder)
        unfinished = self.folder / "k.bricks.unfinished"
        while running.poll() is None and not (unfinished / "brick_00004.vtu").exists():
            pass
        running.kill()
        running.wait()
        self.assertFalse((self.folder / "k.bricks").exists() and unfinished.exists())
        again = self.run_ok("split", "model:twist:40", "-o", "k.bricks", "--bricks", 64, "--json").json()
        self.assertGreaterEqual(again["kept"], 4)
        self.assertFalse(unfinished.exists())
        self.assertEqual(self.run_ok("info", "k.bricks", "--json").json()["cells"], 64000)


if __name__ == "__main__":
    unittest.main()
