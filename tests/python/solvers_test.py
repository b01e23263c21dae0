# SPDX-License-Identifier: Apache-2.0
"""Meshes for solvers: what Gmsh, meshio, CalculiX, netCDF, OpenFOAM and VTK read of the files, and patches and sets that are given."""
import os
import shutil
import subprocess

import numpy as np
import pytest
import subvol


def bar():
    """A bar of 4 x 2 x 2 cells from 0 to 4, with points inside that are moved, two patches and a set of each kind."""
    points = np.stack(np.meshgrid(np.arange(5.0), np.arange(3.0), np.arange(3.0), indexing="ij"), -1).reshape(-1, 3)
    number = np.arange(45).reshape(5, 3, 3)
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = np.stack([number[i:4 + i, j:2 + j, k:2 + k].ravel() for i, j, k in corners], 1)
    inner = ((points[:, 1:] == 1).all(1)) & (points[:, 0] > 0) & (points[:, 0] < 4)
    points[inner] += [[.2, -.1, .15], [-.1, .2, .1], [.1, .1, -.2]]
    mesh = subvol.HexMesh(points, cells, creases=np.zeros((0, 2), int))
    return mesh.with_sets(patches={"fixed": np.nonzero(points[:, 0] == 0)[0], "pulled": np.nonzero(points[:, 0] == 4)[0]},
                          sets={"first": np.arange(4)}, node_sets={"middle": np.nonzero(inner)[0]})


def test_patches_and_sets_are_given():
    mesh = bar()
    assert sorted(mesh.patches) == ["fixed", "pulled"] and list(mesh.sets["first"]) == [0, 1, 2, 3] and len(mesh.node_sets["middle"]) == 3
    for name, x in (("fixed", 0), ("pulled", 4)):
        sides = mesh.patches[name]
        corners = [(0, 4, 7, 3), (1, 2, 6, 5)]
        assert len(sides) == 4 and all((mesh.points[mesh.cells[c][list(corners[s])], 0] == x).all() for c, s in sides)
    # Those that are not named stay, and a file keeps all.
    other = mesh.with_sets(sets={"second": [5, 4]}, patches={"one": [(0, 0)]})
    assert list(other.sets) == ["second"] and list(other.sets["second"]) == [4, 5] and list(other.node_sets) == ["middle"]
    assert other.patches["one"].tolist() == [[0, 0]]
    assert mesh.with_sets(patches={}).patches == {} and len(mesh.with_sets(patches={}).sets) == 1
    for given, sentence in (({"patches": {"x": [(0, 1)]}}, "side 1 of cell 0 lies inside the mesh"), ({"patches": {"x": [(0, 6)]}}, "side 6"),
                            ({"patches": {"x": [(99, 0)]}}, "99"), ({"sets": {"x": [16]}}, "cell 16"), ({"sets": {"x": [-1]}}, "x"),
                            ({"sets": {"x": [1, 1]}}, "more than once"), ({"node_sets": {"x": [45]}}, "point 45"),
                            ({"patches": {"x": [45]}}, "point 45")):
        with pytest.raises(subvol.InvalidInput, match=sentence):
            mesh.with_sets(**given)
    with pytest.raises(AttributeError, match="with_sets"):
        mesh.sets = {}


def test_meshio_reads_what_is_written(tmp_path):
    meshio = pytest.importorskip("meshio")
    mesh = bar().with_fields({"T": np.arange(45.0), "U": np.arange(135.0).reshape(45, 3)})
    subvol.write_mesh(mesh, tmp_path / "a.msh")
    theirs = meshio.read(tmp_path / "a.msh")
    assert np.array_equal(theirs.points, mesh.points)
    assert np.array_equal(theirs.point_data["T"], mesh.fields["T"]) and np.array_equal(theirs.point_data["U"], mesh.fields["U"])
    assert {name: tuple(int(v) for v in value)[1] for name, value in theirs.field_data.items()} == {"middle": 0, "fixed": 2, "pulled": 2, "first": 3, "cells": 3}
    assert sum(len(block.data) for block in theirs.cells if block.type == "hexahedron") == 16
    first = np.concatenate([block.data[of.astype(int)] for block, of in zip(theirs.cells, theirs.cell_sets["first"]) if len(of)])
    assert sorted(first.tolist()) == sorted(mesh.cells[:4].tolist())
    quads = np.concatenate([block.data[of.astype(int)] for block, of in zip(theirs.cells, theirs.cell_sets["pulled"]) if len(of)])
    assert (theirs.points[quads][..., 0] == 4).all()
    a, b, _, d = theirs.points[quads].transpose(1, 0, 2)
    assert (np.cross(b - a, d - a) == [1, 0, 0]).all()  # outwards
    with pytest.warns(UserWarning, match='"T", "U" not written'):
        subvol.write_mesh(mesh, tmp_path / "a.inp")
    theirs = meshio.read(tmp_path / "a.inp")
    assert np.array_equal(theirs.points, mesh.points) and np.array_equal(theirs.cells_dict["hexahedron"], mesh.cells)
    assert sorted(theirs.point_sets) == ["fixed", "middle", "pulled"]


def test_gmsh_reads_what_is_written(tmp_path):
    gmsh = shutil.which("gmsh")
    if gmsh is None:
        pytest.skip("Debian's gmsh is not installed")
    subvol.write_mesh(bar().with_fields({"T": np.arange(45.0)}), tmp_path / "a.msh")
    run = subprocess.run([gmsh, "-save", "-format", "msh22", "-o", "b.msh", "a.msh"], cwd=tmp_path, capture_output=True, text=True)
    assert run.returncode == 0 and "Error" not in run.stdout + run.stderr and "Warning" not in run.stdout + run.stderr, run.stdout + run.stderr
    theirs = subvol.read_mesh(tmp_path / "b.msh")
    assert len(theirs.cells) == 16 and {name: len(sides) for name, sides in theirs.patches.items()} == {"fixed": 4, "pulled": 4}
    assert len(theirs.sets["first"]) == 4 and len(theirs.node_sets["middle"]) == 3


MATERIAL = np.arange(16.0) ** 2
LONG_NAME = "n" * 40


def with_all_kinds(folder):
    """A bar with fields at points and at cells, names as people give them, and cells in two sets."""
    mesh = bar()
    rows = lambda values: "\n".join(" ".join(map(str, row)) for row in values)
    (folder / "bar.vtk").write_text(f"# vtk DataFile Version 3.0\na bar\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 45 double\n{rows(mesh.points.tolist())}\n"
                                    f"CELLS 16 144\n{rows([8, *cell] for cell in mesh.cells.tolist())}\nCELL_TYPES 16\n{rows([[12]] * 16)}\n"
                                    f"CELL_DATA 16\nSCALARS material double 1\nLOOKUP_TABLE default\n{rows(MATERIAL.reshape(-1, 1))}\n"
                                    f"POINT_DATA 45\nSCALARS T double 1\nLOOKUP_TABLE default\n{rows(np.sqrt(np.arange(45.0)).reshape(-1, 1))}\n"
                                    f"SCALARS {LONG_NAME} double 1\nLOOKUP_TABLE default\n{rows([[1]] * 45)}\n"
                                    f"VECTORS U double\n{rows(np.arange(135.0).reshape(45, 3) / 3)}\n")
    read = subvol.read_mesh(folder / "bar.vtk", cell_values="constant")
    (folder / "bar.vtk").unlink()
    assert np.array_equal(read.points, mesh.points) and np.array_equal(read.cells, mesh.cells)
    return read.with_sets(patches=mesh.patches, node_sets=mesh.node_sets, sets={"odd ones": [1, 3, 8], "the \"rest\"": [0, 2], "both": [2, 3]})


def test_netcdf_and_meshio_read_exodus(tmp_path):
    mesh = with_all_kinds(tmp_path)
    subvol.write_mesh(mesh, tmp_path / "a.exo")
    if ncdump := shutil.which("ncdump"):
        header = subprocess.run([ncdump, "-h", tmp_path / "a.exo"], capture_output=True, text=True, check=True)
        assert "num_elem = 16 ;" in header.stdout and header.stderr == ""
        kind = subprocess.run([ncdump, "-k", tmp_path / "a.exo"], capture_output=True, text=True, check=True)
        assert kind.stdout == "64-bit offset\n"
    meshio = pytest.importorskip("meshio")
    pytest.importorskip("netCDF4", reason="Debian's python3-netcdf4 is not installed")
    theirs = meshio.read(tmp_path / "a.exo")
    assert np.array_equal(theirs.points, mesh.points) and np.array_equal(theirs.point_data["T"], mesh.fields["T"])
    for k, letter in enumerate("xyz"):
        assert np.array_equal(theirs.point_data["U_" + letter], mesh.fields["U"][:, k])
    order = [1, 3, 8, 0, 2, 4, 5, 6, 7, 9, 10, 11, 12, 13, 14, 15]  # by blocks
    assert [len(block.data) for block in theirs.cells] == [3, 2, 11]
    assert np.array_equal(np.concatenate([block.data for block in theirs.cells]), mesh.cells[order])
    assert np.array_equal(np.concatenate(theirs.cell_data["material"]), MATERIAL[order])
    assert sorted(np.asarray(theirs.point_sets["middle"]).ravel()) == sorted(mesh.node_sets["middle"])


def test_vtk_reads_exodus(tmp_path):
    exodus = pytest.importorskip("vtkmodules.vtkIOExodus", reason="Debian's python3-vtk9 is not installed")
    support = pytest.importorskip("vtkmodules.util.numpy_support")
    mesh = with_all_kinds(tmp_path)
    subvol.write_mesh(mesh, tmp_path / "a.e")
    reader = exodus.vtkExodusIIReader()
    reader.SetFileName(str(tmp_path / "a.e"))
    reader.UpdateInformation()
    kinds = {"Element Blocks": reader.ELEM_BLOCK, "Side Sets": reader.SIDE_SET, "Node Sets": reader.NODE_SET}
    names = {}
    for title, kind in kinds.items():
        names[title] = [reader.GetObjectName(kind, k) for k in range(reader.GetNumberOfObjects(kind))]
        for k in range(len(names[title])):
            reader.SetObjectStatus(kind, k, 1)
    assert names == {"Element Blocks": ["odd ones", "the \"rest\"", "cells"], "Side Sets": ["fixed", "pulled"], "Node Sets": ["middle"]}
    assert reader.GetObjectName(reader.ELEM_SET, 0) == "both"
    for kind in (reader.NODAL, reader.ELEM_BLOCK):
        for k in range(reader.GetNumberOfObjectArrays(kind)):
            reader.SetObjectArrayStatus(kind, reader.GetObjectArrayName(kind, k), 1)
    reader.Update()
    out = reader.GetOutput()
    groups = {out.GetMetaData(k).Get(out.NAME()): out.GetBlock(k) for k in range(out.GetNumberOfBlocks())}

    def corners_of(grid, corners):  # each grid has the points of its own cells
        numbers = support.vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, corners)
        return numbers, support.vtk_to_numpy(grid.GetPoints().GetData())[numbers]

    order = np.split([1, 3, 8, 0, 2, 4, 5, 6, 7, 9, 10, 11, 12, 13, 14, 15], [3, 5])
    for k, cells in enumerate(order):
        block = groups["Element Blocks"].GetBlock(k)
        numbers, corners = corners_of(block, 8)
        assert np.array_equal(corners, mesh.points[mesh.cells[cells]].astype(np.float32))
        assert np.array_equal(support.vtk_to_numpy(block.GetCellData().GetArray("material")), MATERIAL[cells])
        for name, theirs in (("T", "T"), ("U", "U_"), (LONG_NAME, LONG_NAME)):  # VTK takes the last letter of components off
            values = support.vtk_to_numpy(block.GetPointData().GetArray(theirs))
            assert np.array_equal(values[numbers], mesh.fields[name][mesh.cells[cells]])
    for k, x in enumerate((0, 4)):  # quads whose normals point out
        _, corners = corners_of(groups["Side Sets"].GetBlock(k), 4)
        assert len(corners) == 4 and (corners[..., 0] == x).all()
        assert (np.cross(corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0])[:, 0] == (1 if x else -1)).all()
    _, nodes = corners_of(groups["Node Sets"].GetBlock(0), 1)
    assert np.array_equal(nodes[:, 0], mesh.points[mesh.node_sets["middle"]].astype(np.float32))


def write_case(folder):
    """The bar as a case of OpenFOAM; returns it, too."""
    mesh = with_all_kinds(folder)
    with pytest.warns(UserWarning, match='"the "rest"" is called "the__rest_"'):
        subvol.write_mesh(mesh, folder / "a.foam")
    return mesh


SCHEMES = "default none; } gradSchemes { default Gauss linear; } divSchemes { } laplacianSchemes { } interpolationSchemes { } snGradSchemes { default corrected; }"


def test_openfoam_checks_what_is_written(tmp_path):
    program = shutil.which("checkMesh")
    if program is None:
        pytest.skip("Debian's openfoam is not installed")
    write_case(tmp_path)
    for name, text in (("fvSchemes", f"ddtSchemes {{ {SCHEMES}"), ("fvSolution", "")):
        (tmp_path / "system" / name).write_text(f"FoamFile {{ version 2.0; format ascii; class dictionary; object {name}; }}\n{text}\n")
    run = subprocess.run([program, "-allTopology", "-allGeometry"], cwd=tmp_path, capture_output=True, text=True,
                         env={**os.environ, "WM_PROJECT_DIR": "/usr/share/openfoam"})
    words = [line.split() for line in run.stdout.splitlines()]
    assert ["Mesh", "OK."] in words and "Upper triangular ordering OK." in run.stdout, run.stdout + run.stderr
    for expected in (["points:", "45"], ["internal", "faces:", "28"], ["hexahedra:", "16"]):
        assert expected in words, run.stdout
    found = {line[0]: int(line[1]) for line in words if len(line) > 4 and line[1].isdigit()}
    assert [found[name] for name in ("fixed", "pulled", "defaultFaces", "odd_ones", "the__rest_", "both")] == [4, 4, 32, 3, 2, 2]
    assert "Total volume = 16." in run.stdout


def test_vtk_reads_openfoam(tmp_path):
    files = pytest.importorskip("vtkmodules.vtkIOGeometry", reason="Debian's python3-vtk9 is not installed")
    support = pytest.importorskip("vtkmodules.util.numpy_support")
    mesh = write_case(tmp_path)
    reader = files.vtkOpenFOAMReader()
    reader.SetFileName(str(tmp_path / "a.foam"))
    reader.CreateCellToPointOff()
    reader.ReadZonesOn()
    reader.UpdateInformation()
    reader.EnableAllPatchArrays()
    reader.EnableAllCellArrays()
    reader.EnableAllPointArrays()
    reader.Update()

    def parts_of(group):
        return {group.GetMetaData(k).Get(group.NAME()): group.GetBlock(k) for k in range(group.GetNumberOfBlocks())}

    parts = parts_of(reader.GetOutput())
    inside = parts["internalMesh"]
    points = mesh.points.astype(np.float32)
    assert np.array_equal(support.vtk_to_numpy(inside.GetPoints().GetData()), points)
    cells = support.vtk_to_numpy(inside.GetCells().GetConnectivityArray()).reshape(-1, 8)
    assert np.array_equal(np.sort(cells), np.sort(mesh.cells))
    assert np.array_equal(support.vtk_to_numpy(inside.GetCellData().GetArray("material")), MATERIAL.astype(np.float32))
    for name in ("T", "U"):
        assert np.array_equal(support.vtk_to_numpy(inside.GetPointData().GetArray(name)), mesh.fields[name].astype(np.float32))
    patches = parts_of(parts["boundary"])
    for name, x in (("fixed", 0), ("pulled", 4)):
        quads = support.vtk_to_numpy(patches[name].GetPolys().GetConnectivityArray()).reshape(-1, 4)
        corners = support.vtk_to_numpy(patches[name].GetPoints().GetData())[quads]
        assert len(quads) == 4 and (corners[..., 0] == x).all()
        assert (np.cross(corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0])[:, 0] == (1 if x else -1)).all()  # outwards
    assert patches["defaultFaces"].GetNumberOfCells() == 32
    zones = parts_of(parts_of(parts["zones"])["cellZones"])
    for name, numbers in (("odd_ones", [1, 3, 8]), ("the__rest_", [0, 2]), ("both", [2, 3])):
        theirs = support.vtk_to_numpy(zones[name].GetCells().GetConnectivityArray()).reshape(-1, 8)
        assert np.array_equal(np.sort(theirs), np.sort(mesh.cells[numbers]))


@pytest.mark.parametrize("ending", ["e", "foam", "inp", "msh"])
def test_a_full_disk_and_a_missing_folder_leave_no_file(tmp_path, ending):
    subvol.write_mesh(with_all_kinds(tmp_path), tmp_path / "bar.vtu")
    program = [os.environ["SUBVOL_COMMAND"], "subdivide", "bar.vtu", "--levels", "1", "--scheme", "linear", "-o"]
    for target, limit, sentence in ((f"fine.{ending}", "ulimit -f 4; ", "cannot be written"), (f"none/fine.{ending}", "", "does not exist")):
        run = subprocess.run(["bash", "-c", limit + 'exec "$@"', "bash", *program, target], cwd=tmp_path, capture_output=True, text=True,
                             restore_signals=False)  # so that the limit is an error of the write, as a full disk is
        assert run.returncode == 2 and sentence in run.stderr and f"fine.{ending}" in run.stderr, run.stderr
        assert [path.name for path in tmp_path.iterdir()] == ["bar.vtu"]


STEP = """*INCLUDE, INPUT={mesh}
*MATERIAL, NAME=M
*ELASTIC
210000., 0.
*SOLID SECTION, ELSET=Eall, MATERIAL=M
*STEP
*STATIC
*BOUNDARY
fixed, 1, 3
*DSLOAD
pulled, P, -100.
*NODE FILE
U
*EL FILE
S
*END STEP
"""


def test_calculix_computes_with_what_is_written(tmp_path):
    """Under a pull of 100, without lateral strain, the stress is 100 everywhere and the displacement is linear, whatever the cells."""
    ccx = shutil.which("ccx")
    if ccx is None:
        pytest.skip("Debian's calculix-ccx is not installed")
    mesh = bar()
    subvol.write_mesh(mesh, tmp_path / "mesh.inp")
    (tmp_path / "job.inp").write_text(STEP.format(mesh="mesh.inp"))
    run = subprocess.run([ccx, "job"], cwd=tmp_path, capture_output=True, text=True)
    assert run.returncode == 0 and "*ERROR" not in run.stdout, run.stdout[-2000:]
    result = subvol.read_mesh(tmp_path / "job.frd")
    assert np.abs(result.fields["DISP"][:, 0] - mesh.points[:, 0] * 100 / 210000).max() < 1e-8
    stress = result.fields["STRESS"]
    assert np.abs(stress[:, 0] - 100).max() < 1e-2 and np.abs(stress[:, 1:]).max() < 1e-3


@pytest.mark.parametrize("ending", ["e", "foam", "inp", "msh"])
def test_the_command_writes_them(command, tmp_path, ending):
    subvol.write_mesh(bar(), tmp_path / "bar.vtu")
    command("subdivide", tmp_path / "bar.vtu", "-o", tmp_path / f"fine.{ending}", "--levels", 1, "--scheme", "linear")
    fine = subvol.read_mesh(tmp_path / f"fine.{ending}")
    assert len(fine.cells) == 128 and len(fine.patches["pulled"]) == 16 and len(fine.sets["first"]) == 32
    if ending == "foam":  # points of zones are not read
        return
    assert (fine.points[fine.node_sets["middle"], 1] > 0).all()
