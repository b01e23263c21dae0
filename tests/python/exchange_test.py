# SPDX-License-Identifier: Apache-2.0
"""Meshes of other packages."""
import pickle
from types import SimpleNamespace

import numpy as np
import pytest
import subvol


def test_meshio_there_and_back(ball, tmp_path):
    meshio = pytest.importorskip("meshio")
    theirs = subvol.to_meshio(ball)
    assert theirs.cells[0].type == "hexahedron"
    assert np.shares_memory(theirs.points, ball.points)
    ours = subvol.from_meshio(theirs)
    assert ours.points.tobytes() == ball.points.tobytes() and np.array_equal(ours.cells, ball.cells)
    assert ours.fields["density"].tobytes() == ball.fields["density"].tobytes()
    theirs.write(tmp_path / "ball.vtu")
    assert np.array_equal(subvol.read_mesh(tmp_path / "ball.vtu").cells, ball.cells)
    assert np.array_equal(subvol.from_meshio(meshio.read(tmp_path / "ball.vtu")).points, ball.points)


def like_meshio(cells, **point_data):
    points = np.random.default_rng(0).random((8, 3))
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
    return SimpleNamespace(points=points, cells=[SimpleNamespace(type=t, data=np.array(d)) for t, d in cells], point_data=point_data)


def test_what_is_left_out_of_a_meshio_mesh_is_said():
    mixed = like_meshio([("hexahedron", [range(8)]), ("quad", [[0, 1, 2, 3]])], T=np.arange(8), names=np.array(list("abcdefgh")))
    with pytest.warns(subvol.SubvolWarning) as seen:
        mesh = subvol.from_meshio(mixed)
    assert [("quad" in str(w.message), "names" in str(w.message)) for w in seen] == [(True, False), (False, True)]
    assert np.array_equal(mesh.fields["T"], np.arange(8.0)) and list(mesh.fields) == ["T"]
    with pytest.raises(subvol.InvalidInput) as caught:
        subvol.from_meshio(like_meshio([("tetra", [[0, 1, 2, 3]])]))
    assert "tetra" in str(caught.value)


def test_tensors_are_flattened():
    mesh = subvol.from_meshio(like_meshio([("hexahedron", [range(8)])], stress=np.arange(72).reshape(8, 3, 3)))
    assert mesh.fields["stress"].shape == (8, 9) and mesh.fields["stress"][1, 0] == 9


def test_a_pyvista_grid():
    # Stands in for pyvista, which Debian does not have: the three attributes that are used.
    points = like_meshio([]).points
    grid = SimpleNamespace(points=points.astype("f4"), cells_dict={12: np.arange(8)[None], 10: np.array([[0, 1, 2, 4]])},
                           point_data={"T": np.arange(8)})
    with pytest.warns(subvol.SubvolWarning, match="10"):
        mesh = subvol.from_pyvista(grid)
    assert np.array_equal(mesh.points, points) and np.array_equal(mesh.cells, [range(8)])
    structured = SimpleNamespace(cast_to_unstructured_grid=lambda: SimpleNamespace(points=points, cells_dict={12: np.arange(8)[None]},
                                                                                   point_data={}))
    assert len(subvol.from_pyvista(structured).cells) == 1
    with pytest.raises(subvol.InvalidInput):
        subvol.from_pyvista(SimpleNamespace(points=points, cells_dict={}, point_data={}))


def test_pyvista_there_and_back(ball):
    pytest.importorskip("pyvista")
    again = subvol.from_pyvista(subvol.to_pyvista(ball))
    assert np.array_equal(again.points, ball.points) and np.array_equal(again.cells, ball.cells)


def test_vtk_there_and_back(ball):
    pytest.importorskip("vtkmodules", reason="Debian's python3-vtk9 is not installed")
    grid = subvol.to_vtk(ball)
    again = subvol.from_vtk(grid)
    assert np.array_equal(again.points, ball.points) and np.array_equal(again.cells, ball.cells)
    assert again.fields["density"].tobytes() == ball.fields["density"].tobytes()
    numpy_support = pytest.importorskip("vtkmodules.util.numpy_support")
    assert np.shares_memory(numpy_support.vtk_to_numpy(grid.GetPoints().GetData()), ball.points)
    del ball, again
    assert grid.GetCell(0).GetNumberOfPoints() == 8 and np.isfinite(grid.GetBounds()).all()


def test_vtk_grids_keep_creases_and_sharp_faces(tmp_path, ball):
    pytest.importorskip("vtkmodules", reason="Debian's python3-vtk9 is not installed")
    sharp = ball.with_creases(20)
    assert len(sharp.creases) > 0
    again = subvol.from_vtk(subvol.to_vtk(sharp))
    assert np.array_equal(again.creases, sharp.creases) and len(subvol.from_vtk(subvol.to_vtk(ball)).creases) == 0
    subvol.write_mesh(sharp, tmp_path / "sharp.vtu")
    reader = pytest.importorskip("vtkmodules.vtkIOXML").vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(tmp_path / "sharp.vtu"))
    reader.Update()
    assert np.array_equal(subvol.from_vtk(reader.GetOutput()).creases, sharp.creases)
    grid = subvol.to_vtk(subvol.HexMesh(ball.points, ball.cells[:5]))  # another mesh, as filters make one and keep the array
    grid.SetFieldData(reader.GetOutput().GetFieldData())
    with pytest.warns(subvol.SubvolWarning, match="another mesh"):
        creases = subvol.from_vtk(grid).creases
    own = subvol.from_vtk(subvol.to_vtk(subvol.HexMesh(ball.points, ball.cells[:5]))).creases  # edges that bend by more than 40°
    assert np.array_equal(creases, own) and len(own) < len(sharp.creases)


def test_vtk_grids_keep_patches_and_sets(tmp_path, ball):
    vtk = pytest.importorskip("vtkmodules.vtkCommonDataModel", reason="Debian's python3-vtk9 is not installed")
    files, support = pytest.importorskip("vtkmodules.vtkIOXML"), pytest.importorskip("vtkmodules.util.numpy_support")
    grid = subvol.to_vtk(ball)
    inside = np.zeros(len(ball.cells), np.uint8)
    inside[[3, 5]] = 1
    array = support.numpy_to_vtk(inside, deep=True)
    array.SetName("set:two")
    grid.GetCellData().AddArray(array)
    mesh = subvol.from_vtk(grid)
    assert {name: list(cells) for name, cells in mesh.sets.items()} == {"two": [3, 5]} and list(mesh.fields) == ["density"]
    (tmp_path / "a.inp").write_text("""*NODE
1,0,0,0
2,1,0,0
3,1,1,0
4,0,1,0
5,0,0,1
6,1,0,1
7,1,1,1
8,0,1,1
*ELEMENT, TYPE=C3D8, ELSET=cube
1,1,2,3,4,5,6,7,8
*SURFACE, NAME=top
1, S2
*NSET, NSET=edge
1, 2
""")
    cube = subvol.read_mesh(tmp_path / "a.inp")
    subvol.write_mesh(cube, tmp_path / "a.vtu")
    reader = files.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(tmp_path / "a.vtu"))
    reader.Update()
    assert reader.GetOutput().GetCellData().GetArray("set:cube").GetTuple1(0) == 1
    for again in subvol.from_vtk(subvol.to_vtk(cube)), subvol.read_mesh(tmp_path / "a.vtu"), subvol.from_vtk(reader.GetOutput()):
        assert {name: sides.tolist() for name, sides in again.patches.items()} == {"top": [[0, 5]]}
        assert {name: list(cells) for name, cells in again.sets.items()} == {"cube": [0]}
        assert {name: list(points) for name, points in again.node_sets.items()} == {"edge": [0, 1]}
    copy = pickle.loads(pickle.dumps(cube))
    assert list(copy.node_sets["edge"]) == [0, 1] and list(subvol.read_mesh(tmp_path / "a.vtu").fields) == []
    assert len(subvol.only(copy, "nodes:edge").cells) == 1
    fine = subvol.subdivide(cube, 1)
    assert sorted(fine.points[fine.node_sets["edge"]][:, 0].tolist()) == [0, .5, 1] and not fine.points[fine.node_sets["edge"]][:, 1:].any()
    assert fine.patches["top"].tolist() == [[4, 5], [5, 5], [6, 5], [7, 5]] and list(fine.sets["cube"]) == list(range(8))
    assert np.allclose(fine.points[fine.cells[4:, 4:]][..., 2], 1)
    odd = subvol.to_vtk(ball)
    for name, values in (("patch:a", np.array([1.5])), ("patch:b", np.array([1, 2, 3, 4]))):
        array = support.numpy_to_vtk(values, deep=True)
        array.SetName(name)
        odd.GetFieldData().AddArray(array)
    with pytest.warns(subvol.SubvolWarning) as said:
        assert not subvol.from_vtk(odd).patches
    left_out = sorted(str(warning.message) for warning in said if "left out" in str(warning.message))
    assert left_out == ["arrays of field data that are no whole numbers were left out: patch:a", "patch \"b\" left out: it is of another mesh"]
    assert isinstance(grid, vtk.vtkUnstructuredGrid)


def test_a_vtk_grid_of_other_cells_is_that_of_its_file(tmp_path):
    vtk = pytest.importorskip("vtkmodules.vtkCommonDataModel", reason="Debian's python3-vtk9 is not installed")
    core, files = pytest.importorskip("vtkmodules.vtkCommonCore"), pytest.importorskip("vtkmodules.vtkIOXML")
    grid, points, values = vtk.vtkUnstructuredGrid(), core.vtkPoints(), core.vtkFloatArray()
    for p in [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1), (.5, .5, 2)]:
        points.InsertNextPoint(*p)
        values.InsertNextValue(p[0] + 2 * p[2])
    values.SetName("f")
    grid.SetPoints(points)
    faces = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    stream = core.vtkIdList()
    for number in [6, *(n for face in faces for n in (4, *face))]:
        stream.InsertNextId(number)
    grid.InsertNextCell(42, stream)  # a cube as a polyhedron
    grid.InsertNextCell(14, 5, [4, 5, 6, 7, 8])  # a pyramid
    grid.GetPointData().AddArray(values)
    writer = files.vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(tmp_path / "a.vtu"))
    writer.SetInputData(grid)
    writer.SetDataModeToAscii()
    writer.Write()
    with pytest.warns(subvol.SubvolWarning):
        ours, theirs = subvol.from_vtk(grid), subvol.read_mesh(tmp_path / "a.vtu")
    assert len(ours.cells) > 8 and np.array_equal(ours.cells, theirs.cells)
    assert np.allclose(ours.points, theirs.points) and np.allclose(ours.fields["f"], theirs.fields["f"])
    with pytest.raises(subvol.InvalidInput, match="1 pyramid"):
        subvol.from_vtk(grid, other_cells="refuse")
    with pytest.raises(subvol.InvalidInput, match="has no cells"):
        subvol.from_vtk(vtk.vtkUnstructuredGrid())
    with pytest.raises(subvol.InvalidInput, match="takes a vtkUnstructuredGrid"):
        subvol.from_vtk(vtk.vtkPolyData())


def test_the_accessor_of_pyvista(tmp_path, ball):
    pytest.importorskip("pyvista")
    import subvol.pyvista  # noqa: F401

    grid = subvol.to_pyvista(ball)
    drawn = np.asarray(grid.subvol.render(size=(24, 24), backend="cpu"))
    assert np.array_equal(drawn, np.asarray(subvol.render(ball, field="density", size=(24, 24), backend="cpu")))
    surface = grid.subvol.limit_surface()
    assert surface.n_cells == len(subvol.surface(ball, boundary=True).triangles) and "density" in surface.point_data
    assert grid.subvol.limit_surface(iso=0).n_points == len(subvol.surface(ball, 0, "density").points)
    assert [report["name"] for report in grid.subvol.to_vdb(tmp_path / "a.vdb", resolution=20)] == ["density"]
