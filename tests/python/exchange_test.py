# SPDX-License-Identifier: Apache-2.0
"""Meshes of other packages."""
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
