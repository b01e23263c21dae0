# SPDX-License-Identifier: Apache-2.0
"""Who owns the memory of arrays, and which arrays are taken."""
import gc
import pickle
import weakref

import numpy as np
import pytest
import subvol
from conftest import grid_of


def test_views_are_of_the_object_s_memory_and_read_only(cube):
    for name in ("points", "cells", "creases", "sharp_faces"):
        array = getattr(cube, name)
        assert not array.flags.writeable, name
        assert array.shape[1] == {"points": 3, "cells": 8, "creases": 2, "sharp_faces": 4}[name]
    assert cube.points.__array_interface__["data"][0] == cube.points.__array_interface__["data"][0]
    assert not cube.points.flags.owndata
    assert cube.points.dtype == np.float64 and cube.cells.dtype == np.uint32
    assert np.shares_memory(cube.fields["x"], cube.fields["x"])
    with pytest.raises(ValueError):
        cube.points[0, 0] = 1
    with pytest.raises(ValueError):
        cube.points.flags.writeable = True


def test_a_view_keeps_its_owner_alive():
    views = [grid_of(4).points, grid_of(4).fields["x"], grid_of(4).cells]
    gc.collect()
    again = grid_of(4)
    assert np.array_equal(views[0], again.points)
    assert np.array_equal(views[1], again.fields["x"])
    assert np.array_equal(views[2], again.cells)


def test_views_of_temporaries_survive_much_allocation(ball):
    kept = [subvol.sample(ball).values["density"] for _ in range(8)]
    images = [np.asarray(subvol.render(ball, size=(16, 16), samples=1)) for _ in range(4)]
    gc.collect()
    rubbish = [np.random.default_rng(i).random(100_000) for i in range(50)]
    assert all(np.array_equal(kept[0], other) for other in kept)
    assert all(np.array_equal(images[0], other) for other in images)
    assert len(rubbish) == 50


def test_the_owner_is_freed_with_its_last_view(ball):
    table = subvol.Refinement(ball)
    gone = weakref.ref(table)
    cells = table.cells
    del table
    gc.collect()
    assert gone() is not None
    del cells
    gc.collect()
    assert gone() is None


def test_results_of_calls_may_be_written_to(cube):
    values, inside = subvol.evaluate(cube, "x", at=[[.5, .5, .5]])
    values[0] = 7
    inside[0] = False
    assert values[0] == 7 and not inside[0]
    assert values.dtype == np.float64 and inside.dtype == np.bool_


def test_an_image_is_an_array_without_a_copy(ball_points):
    image = subvol.render(ball_points, size=(40, 30))
    rgba = np.asarray(image)
    assert rgba.shape == (30, 40, 4) and rgba.dtype == np.float32
    assert np.shares_memory(rgba, np.asarray(image))
    assert not rgba.flags.writeable
    kept = rgba.copy()
    del image
    gc.collect()
    assert np.array_equal(kept, rgba)


@pytest.mark.parametrize("dtype", ["f2", "f4", "f8", "g", "i1", "i4", "u8", ">f8", ">i4"])
def test_points_of_every_real_type_are_taken(dtype):
    corners = grid_of(1)
    points = np.ascontiguousarray(corners.points).astype(dtype)
    mesh = subvol.HexMesh(points, corners.cells)
    assert np.array_equal(mesh.points, corners.points)


@pytest.mark.parametrize("dtype", ["i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8", ">i4", ">u2"])
def test_cells_of_every_integer_type_are_taken(cube, dtype):
    assert np.array_equal(subvol.HexMesh(cube.points, cube.cells.astype(dtype)).cells, cube.cells)


def test_any_strides_are_taken(cube):
    wide = np.zeros((len(cube.points), 6))
    wide[:, ::2] = cube.points
    assert np.array_equal(subvol.HexMesh(wide[:, ::2], cube.cells).points, cube.points)
    assert np.array_equal(subvol.HexMesh(np.asfortranarray(cube.points), cube.cells).points, cube.points)
    assert np.array_equal(subvol.HexMesh(cube.points[::-1][::-1], np.asfortranarray(cube.cells)).cells, cube.cells)
    assert np.array_equal(subvol.HexMesh(cube.points.tolist(), cube.cells.tolist()).cells, cube.cells)
    constant = np.broadcast_to(2.5, len(cube.points))
    assert np.array_equal(subvol.HexMesh(cube.points, cube.cells, {"c": constant}).fields["c"], constant)


def test_what_goes_in_is_not_changed_and_not_kept():
    corners = grid_of(1)
    points = corners.points.copy()
    mesh = subvol.HexMesh(points, corners.cells)
    points[:] = 17
    assert np.array_equal(mesh.points, corners.points)


@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
def test_pickles_are_the_same_bits(ball, ball_points, protocol):
    mesh = pickle.loads(pickle.dumps(ball.with_creases(30), protocol))
    assert mesh.points.tobytes() == ball.points.tobytes()
    assert mesh.cells.tobytes() == ball.cells.tobytes()
    assert mesh.fields["density"].tobytes() == ball.fields["density"].tobytes()
    assert np.array_equal(mesh.creases, ball.with_creases(30).creases)
    volume = pickle.loads(pickle.dumps(ball_points, protocol))
    for name in ("values", "gradients", "moments"):
        assert getattr(volume, name)["density"].tobytes() == getattr(ball_points, name)["density"].tobytes()
    assert volume.frames.tobytes() == ball_points.frames.tobytes()
    assert volume.kernel == ball_points.kernel
    assert np.array_equal(volume.bounds, ball_points.bounds)
    assert np.array_equal(volume.boundary[1], ball_points.boundary[1])


def test_cameras_and_images_are_pickled(ball):
    camera = subvol.Camera.parse("iso", ball.bounds)
    again = pickle.loads(pickle.dumps(camera))
    assert (again.eye, again.target, again.up, again.fovy_deg) == (camera.eye, camera.target, camera.up, camera.fovy_deg)
    image = subvol.Image(np.random.default_rng(1).random((5, 7, 4)))
    assert np.array_equal(np.asarray(pickle.loads(pickle.dumps(image))), np.asarray(image))


def test_things_say_what_they_are(ball, ball_points):
    assert repr(ball) == f"<subvol.HexMesh: {len(ball.points)} points, {len(ball.cells)} cells, fields density>"
    assert "channels density" in repr(ball_points)
    assert repr(subvol.Image(np.zeros((2, 3, 3)))) == "<subvol.Image: 3 x 2 pixels>"
    assert "8" in repr(subvol.Refinement(grid_of(1))) and "1 level>" in repr(subvol.Refinement(grid_of(1)))
    assert "degrees" in repr(subvol.Camera.parse("-y", ball.bounds))
    assert repr(subvol.TransferFunction("viridis", range=(1, 2))) == "<subvol.TransferFunction: viridis, 1 to 2>"
    assert subvol.HexMesh.__module__ == "subvol"
