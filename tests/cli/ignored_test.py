# SPDX-License-Identifier: Apache-2.0
"""What a file has that is not taken: `info --ignored` lists it, for every format, with what the file itself says of it."""

import unittest

from command import CUBE, InFolder, X_AND_Z, subvol
from patches_test import CELLS, INP, MSH2, POINTS, foam, netcdf, write_foam

VTU = """<VTKFile type="UnstructuredGrid" version="1.0"><UnstructuredGrid>
<FieldData><DataArray type="Float64" Name="energy" NumberOfTuples="1" format="ascii">7</DataArray></FieldData>
<Piece NumberOfPoints="8" NumberOfCells="1"><Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
{x} 0 0 {y} 0 0 {y} 1 0 {x} 1 0 {x} 0 1 {y} 0 1 {y} 1 1 {x} 1 1</DataArray></Points><Cells>
<DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3 4 5 6 7</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">8</DataArray><DataArray type="UInt8" Name="types" format="ascii">12</DataArray>
</Cells><CellData><Array type="String" Name="names" format="ascii">65 0</Array></CellData></Piece></UnstructuredGrid></VTKFile>"""

FIELD_DATA = """<FieldData><DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">2.5</DataArray>
<DataArray type="Int64" Name="runs" NumberOfTuples="2" format="ascii">3 4</DataArray></FieldData>"""


class Ignored(InFolder):
    def listed(self, file, *more):
        """(kind, name, count) of each part, and that the lines say the same as --json, alone and beside the figures."""
        found = self.run_ok("info", file, "--ignored", "--json", *more).json()
        self.assertNotIn("cells", found)
        self.assertEqual(self.run_ok("info", file, "--json", *more).json()["ignored"], found["ignored"])
        lines = self.run_ok("info", file, "--ignored", *more).out.splitlines()
        self.assertEqual(lines, ["  ".join(str(part[key]) for key in ("kind", "name", "count", "reason") if key in part)
                                 for part in found["ignored"]])
        self.reasons = {part["name"]: part.get("reason", "") for part in found["ignored"]}
        return {(part["kind"], part["name"], part["count"]) for part in found["ignored"]}

    def write(self, name, text):
        (self.folder / name).write_text(text)
        return name

    def test_abaqus(self):
        text = (INP + "*ELEMENT, TYPE=S4R\n7, 1, 2, 6, 5\n*ELEMENT, TYPE=MASS\n8, 1\n*NSET, NSET=lost\nnowhere\n*SURFACE, TYPE=NODE, NAME=s\nends\n"
                "*Material, name=steel\n*Elastic\n210000, .3\n*STEP\n*STATIC\n*Boundary\n1, 1, 3\n*Boundary\n2, 1\n*Dload\nends, P1, 1\n*END STEP\n")
        found = self.listed(self.write("a.inp", text))
        self.assertEqual(found, {("keyword", "*MATERIAL", 1), ("keyword", "*ELASTIC", 1), ("keyword", "*STEP", 1), ("keyword", "*STATIC", 1),
                                 ("keyword", "*BOUNDARY", 2), ("keyword", "*DLOAD", 1), ("keyword", "*END STEP", 1), ("element type", "S4R", 1),
                                 ("element type", "MASS", 1), ("set of nodes", "lost", 1), ("surface", "s", 1),
                                 ("surface", "nodes", 1), ("patch", "inside", 1)})
        self.assertIn("it is of type NODE", self.reasons["s"])
        self.assertNotIn("BOUNDARY", self.run_ok("info", "a.inp").err)

    def test_exodus(self):
        sizes = {"num_dim": 3, "num_nodes": len(POINTS), "num_elem": 3, "num_el_blk": 1, "num_el_in_blk1": 3, "num_nod_per_el1": 8, "len": 4}
        (self.folder / "a.exo").write_bytes(netcdf(
            sizes, [("coord" + "xyz"[a], ["num_nodes"], "d", [p[a] for p in POINTS]) for a in range(3)] +
            [("connect1", ["num_el_in_blk1", "num_nod_per_el1"], "i", [p + 1 for cell in CELLS for p in cell]),
             ("elem_map", ["num_elem"], "i", [3, 2, 1]), ("info_records", ["len"], "c", b"none")]))
        self.assertEqual(self.listed("a.exo"), {("variable", "elem_map", 1), ("variable", "info_records", 1)})

    def test_gmsh(self):
        text = MSH2 + "$Periodic\n0\n$EndPeriodic\n$InterpolationScheme\n0\n$EndInterpolationScheme\n$ElementNodeData\n0\n$EndElementNodeData\n"
        found = self.listed(self.write("a.msh", text))
        self.assertLessEqual({("section", "$Periodic", 1), ("section", "$InterpolationScheme", 1), ("section", "$ElementNodeData", 1)}, found)
        err = self.run_ok("info", "a.msh").err
        self.assertIn('section "$ElementNodeData" ignored', err)
        self.assertNotIn("$Periodic", err)

    def test_medit(self):
        text = CUBE.format(last=8).replace("End\n", "Corners\n2\n1\n2\nTetrahedra\n1\n1 2 3 5 0\nEnd\n")
        self.assertEqual(self.listed(self.write("a.mesh", text), "--other-cells", "ignore"), {("section", "Corners", 2), ("section", "Tetrahedra", 1)})

    def test_legacy_vtk(self):
        text = (X_AND_Z + "LOOKUP_TABLE reds 1\n1 0 0 1\nFIELD more 2\nnames 1 8 string\na\nb\nc\nd\ne\nf\ng\nh\nless 1 3 double\n1 2 3\n")
        text = text.replace("POINTS 8", "FIELD FieldData 1\nTIME 1 1 double\n2.5\nPOINTS 8")
        found = self.listed(self.write("a.vtk", text))
        self.assertEqual(found - {("array", "TIME", 1)}, {("lookup table", "reds", 1), ("array", "names", 1), ("field", "less", 1)})
        self.assertIn("has 3 tuples (8 are needed)", self.reasons["less"])

    def test_vtu_alone_and_in_pieces(self):
        alone = {("array", "energy", 1), ("array", "names", 1)}
        self.assertEqual(self.listed(self.write("a.vtu", VTU.format(x=0, y=1))), alone)
        self.write("b.vtu", VTU.format(x=1, y=2))
        self.write("c.vtp", '<VTKFile type="PolyData"><PolyData/></VTKFile>')
        files = "".join(f'<DataSet index="{i}" file="{name}"/>' for i, name in enumerate(("a.vtu", "b.vtu", "c.vtp")))
        self.write("a.vtm", f'<VTKFile type="vtkMultiBlockDataSet" version="1.0"><vtkMultiBlockDataSet>{files}</vtkMultiBlockDataSet></VTKFile>')
        self.assertEqual(self.listed("a.vtm"), {(kind, name, 2) for kind, name, _ in alone} | {("file", "c.vtp", 1)})

    def test_the_time_of_one_file(self):
        vtu = VTU.format(x=0, y=1).replace('"energy"', '"TimeValue"')
        vtk = X_AND_Z.replace("POINTS 8", "FIELD FieldData 2\nCYCLE 1 1 int\n4\nTIME 1 1 double\n2.5\nPOINTS 8")
        for name, text, time, others in (("a.vtu", vtu, 7, {"names"}), ("a.vtk", vtk, 2.5, {"CYCLE"}), ("n.vtu", vtu.replace(">7<", ">nan<"), 0, {"names", "TimeValue"}),
                                         ("two.vtu", vtu.replace('NumberOfTuples="1" format="ascii">7', 'NumberOfTuples="2" format="ascii">7 8'), 0,
                                          {"names", "TimeValue"})):
            with self.subTest(name):
                self.assertEqual({part[1] for part in self.listed(self.write(name, text))}, others)
                self.assertEqual(self.run_ok("info", name, "--json").json()["times"], [time])
                done = subvol("probe", name, "--at", ".5,.5,.5", "--field", "2*time", "--json", folder=self.folder)
                if time == 0:
                    self.assertEqual(done.code, 2)
                    self.assertIn("the mesh has no time", done.err)
                else:
                    self.assertAlmostEqual(done.json()["values"][0]["value"], 2 * time, delta=1e-12)

    def test_ensight(self):
        columns = "".join(f"{c:12.5e}\n" for axis in zip(*POINTS) for c in axis)
        cells = "".join("".join(f"{n + 1:10d}" for n in cell) + "\n" for cell in CELLS)
        self.write("a.geo", f"a\nb\nnode id off\nelement id off\npart\n{1:10d}\np\ncoordinates\n{len(POINTS):10d}\n{columns}hexa8\n{3:10d}\n{cells}"
                            f"quad4\n{1:10d}\n" + "".join(f"{n:10d}" for n in (1, 2, 6, 5)) + "\n")
        self.write("a.case", "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: a.geo\nVARIABLE\nconstant per case: gamma 1.4\n"
                             "scalar per measured node: drops a.d\nMATERIAL\nmaterial id count: 2\n")
        self.assertEqual(self.listed("a.case"), {("constant", "gamma", 1), ("variable", "drops a.d", 1), ("section", "material", 1), ("element type", "quad4", 1)})
        self.assertIn('variable "drops a.d" ignored', self.run_ok("info", "a.case").err)

    def test_xdmf(self):
        points = " ".join(f"{x} {y} {z}" for x, y, z in POINTS)
        cells = " ".join(str(n) for cell in CELLS for n in cell)
        self.write("a.xmf", f"""<Xdmf><Domain><Grid><Information Name="who" Value="me"/><Topology TopologyType="Hexahedron" NumberOfElements="3">
<DataItem Dimensions="3 8" Format="XML">{cells}</DataItem></Topology><Geometry GeometryType="XYZ"><DataItem Dimensions="16 3" Format="XML">{points}</DataItem></Geometry>
<Attribute Name="whole" Center="Grid"><DataItem Dimensions="1" Format="XML">5</DataItem></Attribute></Grid></Domain></Xdmf>""")
        self.assertEqual(self.listed("a.xmf"), {("Information", "who", 1), ("array", "whole", 1)})

    def test_xdmf_above_the_grid_and_beside_the_steps(self):
        points = " ".join(f"{x} {y} {z}" for x, y, z in POINTS)
        cells = " ".join(str(n) for cell in CELLS for n in cell)

        def grid(name, time, field):
            values = " ".join(str(p[2]) for p in POINTS)
            return f"""<Grid Name="{name}">{f'<Time Value="{time}"/>' if time else ""}<Topology TopologyType="Hexahedron" NumberOfElements="3">
<DataItem Dimensions="3 8" Format="XML">{cells}</DataItem></Topology><Geometry GeometryType="XYZ"><DataItem Dimensions="16 3" Format="XML">{points}</DataItem></Geometry>
<Attribute Name="{field}" Center="Node"><DataItem Dimensions="16" Format="XML">{values}</DataItem></Attribute></Grid>"""

        note = '<Information Name="{}" Value="x"/>'.format
        self.write("a.xmf", f'<Xdmf>{note("root")}<Domain>{note("domain")}<Grid GridType="Collection" CollectionType="Spatial">{note("parts")}'
                   f'{grid("a", "2.5", "T")}</Grid></Domain></Xdmf>')
        self.assertEqual(self.listed("a.xmf"), {("Information", name, 1) for name in ("root", "domain", "parts")})
        self.assertEqual(self.run_ok("info", "a.xmf", "--json").json()["times"], [2.5])
        self.write("b.xmf", f'<Xdmf><Domain>{grid("mesh", None, "kept_out")}<Grid GridType="Collection" CollectionType="Temporal">{note("steps")}'
                   f'{grid("a", "1", "T")}{grid("b", "3", "T")}</Grid></Domain></Xdmf>')
        self.assertEqual(self.listed("b.xmf"), {("Information", "steps", 1), ("grid", "mesh", 1), ("array", "kept_out", 1)})
        alone = grid("other", "1", "T").replace('<Attribute Name="T"', '<Information Name="T"').replace("</Attribute>", "</Information>")
        self.write("c.xmf", f'<Xdmf><Domain>{alone}<Grid GridType="Collection" CollectionType="Temporal">{grid("a", "1", "T")}</Grid></Domain></Xdmf>')
        self.assertEqual(self.listed("c.xmf"), {("grid", "other", 1)})
        done = self.run_ok("info", "b.xmf")
        self.assertIn('array "kept_out" ignored: its grid is beside the steps', done.err)
        self.assertEqual(self.run_ok("info", "b.xmf", "--json").json()["times"], [1, 3])

    def test_empty_sets_and_surfaces(self):
        text = (INP + "*ELSET, ELSET=nobody\n*ELSET, ELSET=strangers\n99\n*SURFACE, TYPE=ELEMENT, NAME=bare\n*SURFACE, TYPE=ELEMENT\n1, S1\n"
                "*NSET, NSET=hollow\n")
        found = self.listed(self.write("a.inp", text))
        self.assertLessEqual({("set", "nobody", 1), ("set", "strangers", 1), ("patch", "bare", 1), ("surface", "", 1),
                              ("set of nodes", "hollow", 1)}, found)
        self.assertEqual(self.reasons["nobody"], "no cell belongs to it")

    def test_nodes_between_corners_of_curved_cells(self):
        from field_gaps_test import bar
        nodes, cells = bar(True)
        lines = ["*NODE"] + [f"{n}, " + ", ".join(f"{c:.17g}" for c in p) for n, p in enumerate(nodes, 1)] + ["*ELEMENT, TYPE=C3D20"]
        for c, cell in enumerate(cells, 1):
            numbers = [str(n + 1) for n in cell]
            lines += [f"{c}, " + ", ".join(numbers[:15]) + ",", ", ".join(numbers[15:])]
        middles = sorted({n + 1 for cell in cells for n in cell[8:]})
        lines += ["*NSET, NSET=middles"] + [str(n) for n in middles] + ["*NSET, NSET=first", "1"]
        self.write("a.inp", "\n".join(lines) + "\n")
        self.assertEqual(self.listed("a.inp"), {("set of nodes", "middles", 1)})
        self.assertEqual(self.reasons["middles"], "no node of it is a corner of a cell")

    def test_lists_of_files(self):
        for ending, root, files in (("vtm", "vtkMultiBlockDataSet", '<DataSet index="0" file="a.vtu"/>'),
                                    ("pvtu", "PUnstructuredGrid", '<Piece Source="a.vtu"/>')):
            for inside in True, False:  # VTK 9.1 writes field data of blocks beside the list of them, those of pieces inside
                with self.subTest(ending, inside=inside):
                    self.write("a.vtu", VTU.format(x=0, y=1))
                    self.write(f"a.{ending}", f'<VTKFile type="{root}" version="1.0"><{root}>{FIELD_DATA if inside else ""}{files}</{root}>'
                               f'{"" if inside else FIELD_DATA}</VTKFile>')
                    self.assertEqual(self.listed(f"a.{ending}"), {("array", "names", 1), ("array", "energy", 1), ("array", "runs", 1)})
                    about = self.run_ok("info", f"a.{ending}", "--json").json()
                    self.assertEqual((about["times"], [w for w in about["warnings"] if "time" in w]), ([2.5], []))
        # Files of other times, of which the list's counts.
        for k, time in enumerate((1, 3)):
            self.write(f"{k}.vtu", VTU.format(x=k, y=k + 1).replace('"energy"', '"TimeValue"').replace(">7<", f">{time}<"))
        for data, times, said in ((FIELD_DATA, [2.5], []), ("", [1], ["not every block is of the same time: that of the first is taken"])):
            self.write("a.vtm", '<VTKFile type="vtkMultiBlockDataSet" version="1.0"><vtkMultiBlockDataSet><DataSet index="0" file="0.vtu"/>'
                       f'<DataSet index="1" file="1.vtu"/></vtkMultiBlockDataSet>{data}</VTKFile>')
            about = self.run_ok("info", "a.vtm", "--json").json()
            self.assertEqual((about["times"], [w for w in about["warnings"] if "time" in w]), (times, said))

    def test_frd(self):
        from field_gaps_test import frd
        text = frd(POINTS, CELLS, [[("T", {n: p[0] for n, p in enumerate(POINTS)})]])
        first, rest = text.split("\n", 1)
        self.write("a.frd", f"{first}\n    1UPGM               CalculiX\n{rest}")
        self.assertIn(("record", "1UPGM               CalculiX", 1), self.listed("a.frd"))

    def test_openfoam(self):
        write_foam(self.folder / "case")
        (self.folder / "case" / "0" / "phi").write_text(foam("phi", "surfaceScalarField", "internalField uniform 0;"))
        self.write("case/0/notes.txt", "nothing of OpenFOAM")
        self.assertEqual(self.listed("case"), {("field", "phi", 1), ("file", "notes.txt", 1)})
        self.assertEqual(self.reasons["phi"], "it is of class surfaceScalarField")

    def test_what_has_no_such_parts(self):
        done = self.run_ok("info", self.write("a.mesh", CUBE.format(last=8)), "--ignored")
        self.assertEqual(done.out, "")
        self.assertIn("no part of the file", done.err)
        self.run_ok("points", "model:twist", "-o", "a.ply")
        done = subvol("info", "a.ply", "--ignored", folder=self.folder)
        self.assertEqual(done.code, 2)
        self.assertIn("--ignored", done.err)
        self.assertEqual(subvol("info", "--gl", "--ignored", folder=self.folder).code, 2)
        for other in ["--folds"], ["--limit"], ["--list-fields"], ["--gl"], ["--scheme", "tetoct"]:
            done = subvol("info", "a.mesh", "--ignored", *other, folder=self.folder)
            self.assertEqual(done.code, 2, other)
            self.assertIn(f"{other[0]}: has no effect with --ignored", done.err)


if __name__ == "__main__":
    unittest.main()
