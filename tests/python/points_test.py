# SPDX-License-Identifier: Apache-2.0
"""Volumes of kernels."""
import json

import numpy as np
import pytest
import subvol
from conftest import grid_of


def test_one_kernel_for_each_control_point(ball, ball_points):
    assert len(ball_points) == len(ball.points)
    assert np.array_equal(np.sort(ball_points.centers, 0), np.sort(ball.points, 0))
    assert ball_points.centers.dtype == np.float64 and ball_points.frames.dtype == np.float32
    assert ball_points.frames.shape == (len(ball.points), 6)
    assert json.loads(ball_points.kernel)["type"] == "compact"


def test_gradients_of_a_linear_field(cube):
    volume = subvol.sample(cube, field="x")
    assert volume.gradients["x"] == pytest.approx(np.tile([1, 0, 0], (64, 1)), abs=1e-4)
    assert volume.moments["x"] == pytest.approx(np.zeros(64), abs=1e-4)
    assert volume.hessians == {}
    assert list(subvol.sample(cube, field="x", correction="full").hessians) == ["x"]
    assert not subvol.sample(cube, field="x", correction="none").gradients["x"].any()


def test_more_samples_per_edge(cube):
    assert len(subvol.sample(cube, per_edge=2)) == 7 ** 3
    assert len(subvol.sample(cube, spacing=1 / 6 + 1e-9)) == 7 ** 3
    assert len(subvol.sample(cube, levels=1)) == 7 ** 3
    assert len(subvol.sample(cube, centers=True)) == 4 ** 3 + 3 ** 3
    for wrong in ({"per_edge": 0}, {"per_edge": 65}, {"spacing": -1}, {"kernel": "box"}, {"kernel": {"type": "box"}}):
        with pytest.raises(subvol.InvalidInput):
            subvol.sample(cube, **wrong)


def test_the_field_of_points_is_the_field(cube):
    volume = subvol.sample(cube, field="x", per_edge=2)
    values, inside = subvol.evaluate(volume, at=np.full((1, 3), .4))
    assert inside[0] and values[0] == pytest.approx(.4, abs=1e-5)
    assert not subvol.evaluate(volume, at=[[1.2, .5, .5]])[1][0]


def test_a_volume_is_made_of_arrays(ball_points):
    again = subvol.RbfVolume(ball_points.centers, ball_points.frames, ball_points.values, ball_points.gradients, ball_points.moments,
                             kernel=ball_points.kernel, boundary=ball_points.boundary)
    picture = np.asarray(subvol.render(ball_points, size=(32, 32), backend="cpu"))
    assert np.array_equal(np.asarray(subvol.render(again, size=(32, 32), backend="cpu")), picture)
    assert np.array_equal(again.boundary[1], ball_points.boundary[1])


def test_volumes_refuse_wrong_arrays(ball_points):
    n = len(ball_points)
    good = {"centers": np.zeros((n, 3)), "frames": np.tile(np.float32([1, 0, 0, 1, 0, 1]), (n, 1)), "values": {"a": np.zeros(n)}}
    assert len(subvol.RbfVolume(**good)) == n
    for name, wrong in [("centers", np.zeros((n, 2))), ("centers", np.full((n, 3), np.inf)), ("frames", np.zeros((n, 6))),
                        ("frames", np.zeros((n - 1, 6))), ("values", {}), ("values", {"a": np.zeros(n - 1)}),
                        ("values", {"a": np.full(n, np.nan)}), ("values", {"a": np.zeros(n), "": None}),
                        ("gradients", {"a": np.zeros((n, 2))}), ("moments", {"a": np.zeros(n + 1)}), ("kernel", "{}"), ("kernel", "box"),
                        ("boundary", (np.zeros((3, 3)), [[0, 1, 3]])), ("boundary", (np.zeros((3, 3)), [[0, 1, -1]])),
                        ("boundary", (np.zeros((3, 3)),))]:
        with pytest.raises((subvol.InvalidInput, TypeError)):
            subvol.RbfVolume(**{**good, name: wrong})
    with pytest.raises(subvol.InvalidInput):
        subvol.RbfVolume(np.zeros((0, 3)), np.zeros((0, 6)), {"a": np.zeros(0)})


@pytest.mark.parametrize("name", ["a.ply", "a.vtp", "ascii.ply", "a.svk", "a.vdb"])
def test_files_of_points(tmp_path, ball_points, name):
    subvol.write_points(ball_points, tmp_path / name, ascii=name.startswith("ascii"))
    again = subvol.read_points(tmp_path / name)
    assert again.values["density"].tobytes() == ball_points.values["density"].tobytes()
    assert again.gradients["density"].tobytes() == ball_points.gradients["density"].tobytes()
    assert again.frames.tobytes() == ball_points.frames.tobytes()
    assert again.centers == pytest.approx(ball_points.centers, abs=1e-8)


def test_few_kernels_for_a_field():
    mesh = grid_of(6, field=lambda p: np.sin(3 * p[:, 0]) * p[:, 1])
    volume, report = subvol.reduce(mesh, "f", rmse=0.02)
    assert report["reached"] and report["rmse"] <= 0.02 and report["validation"]["rmse"] <= 0.02
    assert len(volume) == report["points"] < len(mesh.points)
    with pytest.raises(subvol.InvalidInput):
        subvol.reduce(mesh, "f", rmse=0)


def test_the_best_gaussian():
    kernel, errors = subvol.fit("gaussian", level=3)
    assert kernel["type"] == "gaussian" and .3 < kernel["sigma"] < .6
    assert errors["rmse"] == pytest.approx(errors["mse"] ** .5)
    better = subvol.fit("gaussians", level=3, terms=3)[1]
    assert better["mse"] < errors["mse"]
    assert {"compact", "gaussian", "cubic"} <= set(subvol.kernels())


def test_expressions_make_no_field_by_themselves(cube):
    assert list(cube.fields) == ["x"]
