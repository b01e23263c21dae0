# SPDX-License-Identifier: Apache-2.0
"""Sets of nodes: read from the files that have them, written, drawn, measured and cut out."""

import math
import unittest

from command import InFolder, subvol
from patches_test import CELLS, INP, LEFT, MSH2, POINTS, RIGHT, netcdf
from regions_test import AROUND


def numbers(nodes):
    return ", ".join(str(n + 1) for n in nodes)


FRONT = [n for n, p in enumerate(POINTS) if p[1] == 0]  # 8 nodes, the side y = 0 of all three cells
# Sets by lists, ranges, other sets, of *NODE, in capitals and not; one that is empty, one of an unknown set, one of no node.
DECK = INP.replace("*NODE\n", "*NODE, NSET=Every\n", 1) + f"""*NSET, NSET=left
{numbers(LEFT[:2])},
{numbers(LEFT[2:])}
*NSET, NSET=ends
LEFT, {numbers(RIGHT)}
*NSET, NSET=front, GENERATE
1, 4
9, 12, 1
*Nset, nset="one of it", unsorted
1, 1, 1
*NSET, NSET=nothing
*NSET, NSET=unknown
1, NOWHERE
*NSET, NSET=of unknown
unknown
*NSET, NSET=far
999
*ELSET, ELSET=middle, GENERATE
2, 2
*NSET, NSET=by elements, ELSET=Middle
*NSET, NSET=by none, ELSET=front
*NSET
1, 2
"""
COUNTS = {"by elements": 8, "Every": 16, "left": 4, "ends": 8, "front": 8, "one of it": 1}


class NodeSets(InFolder):
    def sets(self, file, *more):
        return {one["name"]: one["nodes"] for one in self.run_ok("info", file, "--json", *more).json()["node_sets"]}

    def deck(self):
        (self.folder / "a.inp").write_text(DECK)

    def test_abaqus(self):
        self.deck()
        self.assertEqual(self.sets("a.inp"), COUNTS)
        done = self.run_ok("info", "a.inp")
        self.assertRegex(done.out, r"nodes +by elements \(8\), ends \(8\), Every \(16\), front \(8\), left \(4\), one of it \(1\)")
        for words in ('4 sets of nodes left out ("unknown", "of unknown", "by none", ""): a.inp, line', 'there is no set "NOWHERE"',
                      '2 sets of nodes left out ("far", "nothing"): no node of it is a corner of a cell',
                      "1 number in sets of nodes that no node has", 'surface "nodes" left out: a.inp, line', "it is of type NODE"):
            self.assertIn(words, done.err)
        self.assertEqual({one["name"] for one in self.run_ok("info", "a.inp", "--json").json()["sets"]}, {"all", "ends", "middle"})

    def test_parts_and_instances(self):
        part = DECK.replace("\n*NSET\n1, 2\n", "\n")
        (self.folder / "a.inp").write_text("*PART, NAME=bar\n" + part + "*END PART\n*ASSEMBLY, NAME=all\n*INSTANCE, NAME=one, PART=bar\n*END INSTANCE\n"
                                           "*INSTANCE, NAME=two, PART=bar\n0, 0, 9\n*END INSTANCE\n*NSET, NSET=of two, INSTANCE=two\n1, 2\n"
                                           "*NSET, NSET=of both\none.1, two.left\n*END ASSEMBLY\n")
        found = self.sets("a.inp")
        self.assertEqual({name: 2 * count for name, count in COUNTS.items()}, {name: found[name] for name in COUNTS})
        self.assertEqual((found["of two"], found["of both"]), (2, 5))
        text = (self.folder / "a.inp").read_text().replace("*END ASSEMBLY", "*ELSET, ELSET=far, INSTANCE=two\n2, 3\n*NSET, NSET=at far, ELSET=far\n"
                                                           "*NSET, NSET=ends of one, ELSET=one.ends\n*NSET, NSET=no, ELSET=one.far\n*END ASSEMBLY")
        (self.folder / "a.inp").write_text(text)
        found = self.sets("a.inp")
        self.assertEqual((found["at far"], found["ends of one"]), (12, 16))
        self.assertIn('"by none", "no"): a.inp, line', self.run_ok("info", "a.inp").err)

    def test_files_of_ours_keep_them(self):
        self.deck()
        # Of the refined sides, each as many points as a grid of them has; "one of it" has no edge.
        grid = {"Every": lambda n: (3 * n + 1) * (n + 1) ** 2, "left": lambda n: (n + 1) ** 2, "front": lambda n: (3 * n + 1) * (n + 1),
                "ends": lambda n: 2 * (n + 1) ** 2, "by elements": lambda n: (n + 1) ** 3, "one of it": lambda n: 1}
        for end in ".vtu", ".vtkhdf":
            for levels in 0, 1, 2:
                with self.subTest(end=end, levels=levels):
                    done = self.run_ok("subdivide", "a.inp", "--levels", levels, "-o", "b" + end, "--json").json()
                    self.assertNotIn("not written", str(done["warnings"]))
                    self.assertEqual(self.sets("b" + end), {name: count(2 ** levels) for name, count in grid.items()})
        fields = self.run_ok("info", "b.vtu", "--json").json()["fields"]
        self.assertFalse([f for f in fields if f["name"].startswith("nodes:")], fields)
        for name, words in ("b.mesh", []), ("b.svw", ["--max-error", "1e-3"]):
            verb = "compress" if words else "subdivide"
            warnings = self.run_ok(verb, "a.inp", "--density", "x", *words, "-o", name, "--json").json()["warnings"]
            self.assertEqual(len([w for w in warnings if "6 sets of nodes (by elements, ends, Every, front, left, one of it) not written" in w]), 1, warnings)

    def test_regions_are_the_cells_at_the_nodes(self):
        self.deck()
        for name, volume in ("left", 1), ("LEFT", 1), ("ends", 2), ("front", 3), ("left,one of it", 1):
            with self.subTest(name):
                done = self.run_ok("probe", "a.inp", "--stats", "--density", "x", "--scheme", "linear", "--only", f"nodes:{name}", "--json").json()
                self.assertAlmostEqual(done["stats"]["whole"]["volume"], volume, delta=1e-9)
        self.assertEqual(self.sets("a.inp", "--only", "nodes:left"), {"by elements": 4, "Every": 8, "left": 4, "ends": 4, "front": 4, "one of it": 1})
        for name, words in ("nope", 'there is no set of nodes "nope" (the mesh has: by elements, ends, Every, front'), ("", "is not a region"):
            done = subvol("render", "a.inp", "-o", "a.png", "--only", f"nodes:{name}", folder=self.folder)
            self.assertEqual(done.code, 2)
            self.assertIn(words, done.err)

    def test_patches_are_the_faces_between_the_nodes(self):
        self.deck()
        found = self.run_ok("probe", "a.inp", *(w for name in ("left", "ends", "front", "Every") for w in ("--patch", f"nodes:{name}")),
                            "--density", "x", "--scheme", "linear", "--json").json()["patches"]
        self.assertEqual([round(one["area"], 9) for one in found], [1, 2, 3, 14])
        self.assertEqual([round(one["fields"][0]["mean"], 9) for one in found], [0, 1.5, 1.5, 1.5])
        self.run_ok("render", "a.inp", "-o", "a.png", "--size", "32x32", "--patch", "nodes:front")
        done = subvol("render", "a.inp", "-o", "a.png", "--patch", "nodes:one of it", folder=self.folder)
        self.assertEqual(done.code, 2)
        self.assertIn('no face of patch "nodes:one of it" is left', done.err)

    def test_curved_and_split_cells(self):
        """The points that are made between nodes of a set belong to it."""
        middle = [(a, b) for a, b in ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))]
        nodes = list(AROUND) + [tuple((u + v) / 2 for u, v in zip(AROUND[a], AROUND[b])) for a, b in middle]
        nodes = [(x, y, z + .3 * x * (1 - x)) for x, y, z in nodes]
        listed = "*NODE\n" + "\n".join(f"{i + 1}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(nodes)) + "\n"
        top = "*NSET, NSET=top\n" + numbers(n for n, p in enumerate(nodes) if p[2] >= 1) + "\n*SURFACE, NAME=top\n1, S2\n"
        (self.folder / "a.inp").write_text(listed + "*ELEMENT, TYPE=C3D20\n1, " + ", ".join(str(k + 1) for k in range(20)) + "\n" + top)
        found = self.run_ok("probe", "a.inp", "--patch", "top", "--patch", "nodes:top", "--density", "x", "--json").json()["patches"]
        self.assertEqual(found[0]["area"], found[1]["area"])
        self.assertGreater(self.sets("a.inp")["top"], 4)
        # A cube of two prisms becomes 6 hexahedra, whose top has 4 corners, 5 middles of edges and 2 of triangles.
        (self.folder / "b.inp").write_text("*NODE\n" + "\n".join(f"{i + 1}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(AROUND)) +
                                           "\n*ELEMENT, TYPE=C3D6\n1, 1, 2, 3, 5, 6, 7\n2, 1, 3, 4, 5, 7, 8\n*NSET, NSET=top, GENERATE\n5, 8\n")
        self.assertEqual(self.sets("b.inp"), {"top": 4 + 5 + 2})
        patch = self.run_ok("probe", "b.inp", "--patch", "nodes:top", "--density", "z", "--json").json()["patches"][0]
        self.assertAlmostEqual(patch["fields"][0]["mean"], 1, delta=1e-9)

    def test_gmsh(self):
        names = '5\n0 3 "tip"\n1 4 "edge"\n'
        elements = "\n".join(["9", "7 15 2 3 1 1", "8 1 2 4 1 1 2", "9 1 2 4 1 2 3", ""])
        text = MSH2.replace("$PhysicalNames\n3\n", "$PhysicalNames\n" + names).replace("$Elements\n6\n", "$Elements\n" + elements)
        (self.folder / "a.msh").write_text(text)
        self.assertEqual(self.sets("a.msh"), {"tip": 1, "edge": 3})
        self.assertNotIn("point", self.run_ok("info", "a.msh").err)
        done = self.run_ok("probe", "a.msh", "--stats", "--density", "x", "--scheme", "linear", "--only", "nodes:edge", "--json").json()
        self.assertAlmostEqual(done["stats"]["whole"]["volume"], 3, delta=1e-9)
        (self.folder / "b.msh").write_text(text.replace("8 1 2 4 1 1 2", "8 1 2 4 1 1 99"))
        self.assertEqual(self.sets("b.msh"), {"tip": 1, "edge": 2})

    def exodus(self, **changes):
        sets = {"node_ns1": [n + 1 for n in LEFT], "node_ns2": [n + 1 for n in FRONT], "node_ns3": [1], **changes}
        (self.folder / "a.exo").write_bytes(netcdf(
            {"num_dim": 3, "num_nodes": len(POINTS), "num_elem": 3, "num_el_blk": 1, "num_el_in_blk1": 3, "num_nod_per_el1": 8,
             "num_node_sets": 3, "len": 8, **{"num_nod_ns" + name[7:]: len(nodes) for name, nodes in sets.items()}},
            [("coord" + "xyz"[a], ["num_nodes"], "d", [p[a] for p in POINTS]) for a in range(3)] +
            [("connect1", ["num_el_in_blk1", "num_nod_per_el1"], "i", [p + 1 for cell in CELLS for p in cell]),
             ("ns_names", ["num_node_sets", "len"], "c", b"".join(n.ljust(8, b"\0") for n in (b"left", b"", b"left"))),
             ("ns_prop1", ["num_node_sets"], "i", [4, 9, 11])] +
            [(name, ["num_nod_ns" + name[7:]], "i", nodes) for name, nodes in sets.items()]))

    def test_exodus(self):
        self.exodus()
        self.assertEqual(self.sets("a.exo"), {"left": 4, "node set 9": 8, "left_2": 1})
        self.assertIn('there is more than one set of nodes "left": another is called "left_2"', self.run_ok("info", "a.exo").err)
        self.exodus(node_ns2=[1, 99])
        done = self.run_ok("info", "a.exo")
        self.assertIn("node sets ignored: node_ns2: there is no node 99", done.err)
        self.assertRegex(done.out, r"nodes +left \(4\)")

    def test_results_of_a_deck(self):
        """A .frd file has no sets: those of its deck are taken by the numbers of the nodes."""
        from field_gaps_test import frd
        self.deck()
        (self.folder / "a.frd").write_text(frd(POINTS, CELLS, [[("T", {n: p[0] for n, p in enumerate(POINTS)})]]))
        self.assertEqual(self.sets("a.frd", "--mesh", "a.inp"), COUNTS)
        found = self.run_ok("probe", "a.frd", "--mesh", "a.inp", "--patch", "nodes:ends", "--field", "T", "--json").json()["patches"][0]
        self.assertAlmostEqual(found["fields"][0]["mean"], 1.5, delta=1e-9)

    def test_pieces_and_welded_points(self):
        """Nodes of pieces keep their places in the whole."""
        self.deck()
        for name, region in ("p0", "box:-1,-1,-1,1,2,2"), ("p1", "box:1,-1,-1,4,2,2"):
            self.run_ok("subdivide", "a.inp", "--levels", "0", "--only", region, "--scheme", "linear", "-o", f"{name}.vtu")
        (self.folder / "a.vtm").write_text('<VTKFile type="vtkMultiBlockDataSet" version="1.0"><vtkMultiBlockDataSet>'
                                           '<DataSet index="0" file="p0.vtu"/><DataSet index="1" file="p1.vtu"/></vtkMultiBlockDataSet></VTKFile>')
        found = self.sets("a.vtm", "--weld")
        self.assertEqual({name: found[name] for name in ("Every", "left", "ends", "front")}, {"Every": 16, "left": 4, "ends": 8, "front": 8})


if __name__ == "__main__":
    unittest.main()
