# SPDX-License-Identifier: Apache-2.0
"""Meshes and their refinement."""
import numpy as np
import pytest
import subvol
from conftest import grid_of


def test_a_cube_is_measured(cube):
    report = cube.report()
    assert report["points"] == 64 and report["cells"] == 27
    assert report["volume"] == pytest.approx(1, abs=1e-14)
    assert report["inverted_cells"] == 0 and report["min_scaled_jacobian"] == pytest.approx(1)
    assert report["boundary_faces"] == 54
    assert report["nonmanifold_faces"] == 0
    assert report["interior_edge_valence"] == {4: 36}
    assert np.array_equal(cube.bounds, [[0, 0, 0], [1, 1, 1]])


def test_the_boundary_is_closed_and_outward(cube):
    points, triangles = cube.boundary()
    a, b, c = (points[triangles[:, k]] for k in range(3))
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(1)
    assert np.cross(b - a, c - a).sum(0) == pytest.approx([0, 0, 0], abs=1e-12)


@pytest.mark.parametrize("scheme", ["mcq", "cc", "bsxw", "linear"])
def test_refinement_reproduces_linear_fields(cube, scheme):
    fine = subvol.subdivide(cube, 2, scheme)
    assert len(fine.cells) == 27 * 64
    assert fine.fields["x"] == pytest.approx(fine.points[:, 0], abs=1e-12)


def test_mcq_and_linear_keep_the_control_points(ball):
    for scheme in ("mcq", "linear"):
        assert np.array_equal(subvol.subdivide(ball, 1, scheme).points[:len(ball.points)], ball.points)
    assert not np.array_equal(subvol.subdivide(ball, 1, "cc").points[:len(ball.points)], ball.points)


def test_two_levels_are_one_and_one(ball):
    at_once, in_turn = subvol.subdivide(ball, 2), subvol.subdivide(subvol.subdivide(ball))
    assert at_once.points.tobytes() == in_turn.points.tobytes()
    assert at_once.fields["density"].tobytes() == in_turn.fields["density"].tobytes()


def test_level_zero_drops_unused_points(cube):
    more = subvol.HexMesh(np.vstack([cube.points, [[9, 9, 9]]]), cube.cells)
    assert len(subvol.subdivide(more, 0).points) == 64
    assert len(more.without_unused_points().points) == 64


def test_a_table_gives_the_bits_of_subdivide(ball):
    table = subvol.Refinement(ball, levels=2)
    fine, expected = table.apply(ball), subvol.subdivide(ball, 2)
    assert fine.points.tobytes() == expected.points.tobytes()
    assert fine.fields["density"].tobytes() == expected.fields["density"].tobytes()
    assert np.array_equal(fine.cells, expected.cells) and np.array_equal(table.cells, expected.cells)
    assert table.apply(np.asarray(ball.points)).tobytes() == expected.points.tobytes()
    assert table.apply(ball.fields["density"]).tobytes() == expected.fields["density"].tobytes()
    assert (table.points, table.control_points, table.levels) == (len(expected.points), len(ball.points), 2)


def test_a_table_is_applied_to_a_moved_mesh(ball):
    table = subvol.Refinement(ball)
    moved = subvol.HexMesh(ball.points * 2 + 1, ball.cells, ball.fields)
    assert table.apply(moved).points == pytest.approx(table.apply(ball).points * 2 + 1, abs=1e-12)
    with pytest.raises(subvol.InvalidInput):
        table.apply(subvol.model("ball", 2))


def test_a_table_takes_floats_and_an_array_for_the_result(ball):
    table = subvol.Refinement(ball)
    single = table.apply(ball.points.astype("f4"))
    assert single.dtype == np.float32
    assert single == pytest.approx(table.apply(ball.points), abs=1e-5)
    out = np.empty((table.points, 3))
    assert table.apply(ball.points, out=out) is not None
    assert out.tobytes() == table.apply(ball.points).tobytes()
    for wrong in (np.empty((table.points, 2)), np.empty((table.points, 3), "f4"), np.empty((3, table.points)).T):
        with pytest.raises(subvol.InvalidInput):
            table.apply(ball.points, out=wrong)
    out.flags.writeable = False
    with pytest.raises(subvol.InvalidInput):
        table.apply(ball.points, out=out)


def test_a_table_is_a_matrix_whose_rows_sum_to_one(cube):
    table = subvol.Refinement(cube)
    weights, columns, offsets = table.matrix()
    sums = np.add.reduceat(weights, offsets[:-1])
    assert sums == pytest.approx(np.ones(table.points), abs=1e-14)
    rows = np.repeat(np.arange(table.points), np.diff(offsets))
    dense = np.zeros((table.points, len(cube.points)))
    dense[rows, columns] = weights
    assert dense @ cube.points == pytest.approx(table.apply(cube.points), abs=1e-14)


def test_a_table_of_a_mesh_with_unused_points(cube):
    points = np.vstack([[[9, 9, 9]], cube.points])
    more = subvol.HexMesh(points, cube.cells.astype(int) + 1, {"x": points[:, 0]})
    table = subvol.Refinement(more)
    expected = subvol.subdivide(cube)
    assert table.apply(more).points.tobytes() == expected.points.tobytes()
    assert table.apply(points).tobytes() == expected.points.tobytes()
    with pytest.raises(subvol.InvalidInput):
        table.apply(points[1:, :2])


def test_creases_are_tagged(ball):
    sharp = ball.with_creases(20)
    assert len(sharp.creases) > 0 and len(ball.creases) == 0
    assert subvol.HexMesh(sharp.points, sharp.cells, creases=sharp.creases).creases.tobytes() == sharp.creases.tobytes()


def test_the_limit_at_corners_is_the_control_point(ball):
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
    at = subvol.evaluate_limit(ball, np.full(8, 5), corners)
    assert at.positions == pytest.approx(ball.points[ball.cells[5]], abs=1e-12)
    assert at.fields["density"] == pytest.approx(ball.fields["density"][ball.cells[5]], abs=1e-12)


def test_jacobians_of_a_stretched_block():
    block = grid_of(3)
    stretched = subvol.HexMesh(block.points * [3, 6, 9], block.cells, {"s": block.points @ [1, 2, 3]})
    at = subvol.evaluate_limit(stretched, [13, 0], [[.5, .5, .5], [.2, .3, .4]])
    assert at.jacobians[0] == pytest.approx(np.diag([1, 2, 3]), abs=1e-9)
    assert at.gradients("s") == pytest.approx(np.tile([1 / 3, 2 / 6, 3 / 9], (2, 1)), abs=1e-9)
    assert at.positions[0] == pytest.approx([1.5, 3, 4.5])
    assert at.report["unconverged"] == 0


def test_a_tension_of_0_is_the_linear_scheme():
    ball = subvol.model("ball", 4)
    places = [[.5, .5, .5], [.2, .3, .4]]
    tense, linear = subvol.evaluate_limit(ball, [3, 40], places, tension=0), subvol.evaluate_limit(ball, [3, 40], places, scheme="linear")
    np.testing.assert_allclose(tense.positions, linear.positions, atol=1e-6)
    assert not np.allclose(subvol.evaluate_limit(ball, [3, 40], places).positions, linear.positions, atol=1e-3)


def test_jacobians_are_derivatives_of_positions(ball):
    h, uvw = 1e-4, np.array([[.4, .5, .6]])
    at = subvol.evaluate_limit(ball, [3], uvw, scheme="cc")
    for k in range(3):
        step = h * np.eye(3)[k]
        ends = subvol.evaluate_limit(ball, [3, 3], np.vstack([uvw - step, uvw + step]), scheme="cc").positions
        assert (ends[1] - ends[0]) / (2 * h) == pytest.approx(at.jacobians[0][:, k], abs=1e-3)


def test_limits_refuse_what_is_no_place(ball):
    for cells, uvw in [([-1], [[0, 0, 0]]), ([10 ** 9], [[0, 0, 0]]), ([0], [[2, 0, 0]]), ([0, 1], [[0, 0, 0]]), ([0], [[np.nan, 0, 0]]),
                       ([0.5], [[0, 0, 0]]), ([0], [0, 0, 0])]:
        with pytest.raises(subvol.InvalidInput):
            subvol.evaluate_limit(ball, cells, uvw)


def test_values_in_the_world(cube):
    places = np.random.default_rng(3).random((100, 3))
    values, inside = subvol.evaluate(cube, "x", at=places)
    assert inside.all()
    assert values == pytest.approx(places[:, 0], abs=1e-9)
    values, inside = subvol.evaluate(cube, "x", at=[[2, 0, 0], [.5, .5, .5], [np.nan, 0, 0]])
    assert inside.tolist() == [False, True, False] and np.isnan(values[[0, 2]]).all()
    values, inside = subvol.evaluate(cube, "x", at=np.empty((0, 3)))
    assert values.shape == inside.shape == (0,)


def test_a_field_is_made_once_and_has_gradients(cube):
    field = subvol.as_field(cube, "x")
    # Places within the limit's tolerance, 1e-6 of the diagonal, count as inside.
    assert field.name == "x" and np.allclose(field.bounds, cube.bounds, rtol=0, atol=2e-6)
    assert field.gradients([[.4, .5, .6]])[0] == pytest.approx([1, 0, 0], abs=1e-9)
    assert np.array_equal(field.values([[.4, .5, .6]])[0], subvol.evaluate(field, at=[[.4, .5, .6]])[0])


def test_files_keep_every_bit(tmp_path, ball):
    subvol.write_mesh(ball, tmp_path / "ball.vtu")
    again = subvol.read_mesh(tmp_path / "ball.vtu")
    assert again.points.tobytes() == ball.points.tobytes()
    assert again.fields["density"].tobytes() == ball.fields["density"].tobytes()
    with pytest.raises(subvol.InvalidInput):
        subvol.write_mesh(ball, tmp_path / "ball.obj")


def test_wavelets_keep_a_mesh_within_the_tolerance(tmp_path, ball):
    fine = subvol.subdivide(ball, 2)
    report = subvol.write_wavelets(fine, tmp_path / "ball.svw", 1e-3)
    assert report["levels"] >= 2 and report["cells"] == len(fine.cells)
    again = subvol.read_mesh(tmp_path / "ball.svw")
    assert len(again.points) == len(fine.points) and len(again.cells) == len(fine.cells)
    assert 0 < report["arrays"]["density"]["rms"] <= 1e-3
    assert report["bytes"] == (tmp_path / "ball.svw").stat().st_size < fine.fields["density"].nbytes
    with pytest.raises(subvol.InvalidInput):
        subvol.write_wavelets(fine, tmp_path / "ball.svw", 0)


def test_series_keep_every_value_within_the_error(tmp_path, ball):
    steps = [subvol.HexMesh(ball.points * (1 + k / 10), ball.cells, {"wave": np.sin(ball.points[:, 0] + k), "v": ball.points * k}) for k in range(3)]
    report = subvol.write_series(steps, tmp_path / "ball.svw", max_error=1e-4, times=[0, 2, 3], key_steps=2)
    assert report["bytes"] == (tmp_path / "ball.svw").stat().st_size and report["steps"] == 3 and report["key_steps"] == 2
    series = subvol.open_series(tmp_path / "ball.svw")
    assert series.times == [0, 2, 3]
    ranges = {name: np.ptp(np.concatenate([step.fields[name] for step in steps]), axis=0).max() for name in ("wave", "v")}
    for mesh, again in zip(steps, [series[k] for k in range(3)]):
        assert np.array_equal(again.cells, mesh.cells)
        for name in ranges:
            assert np.abs(again.fields[name] - mesh.fields[name]).max() <= 1e-4 * ranges[name]
        assert np.abs(again.points - mesh.points).max() <= 1e-5 * np.ptp(ball.points, axis=0).max() * (1 + 1e-9)
    subvol.write_series(series, tmp_path / "again.svw")
    assert len(subvol.open_series(tmp_path / "again.svw")) == 3
    one = subvol.write_series(ball, tmp_path / "one.svw", max_error=1e-3)
    assert one["steps"] == 1 and {array["name"]: array["max"] for array in one["arrays"]}["density"] <= 1e-3
    for wrong in ({"max_error": 0}, {"key_steps": 0}, {"times": [1]}, {"times": [2, 1, 3]}):
        with pytest.raises(subvol.InvalidInput):
            subvol.write_series(steps, tmp_path / "wrong.svw", **wrong)
    assert not (tmp_path / "wrong.svw").exists()


def test_vectors_and_wide_fields(cube):
    wide = np.random.default_rng(2).random((64, 5))
    mesh = subvol.HexMesh(cube.points, cube.cells, {"v": cube.points, "w": wide, "s": wide[:, 0]})
    assert mesh.fields["v"].shape == (64, 3) and mesh.fields["w"].shape == (64, 5) and mesh.fields["s"].shape == (64,)
    assert np.array_equal(mesh.fields["w"], wide)
    assert list(mesh.fields) == ["v", "w", "s"]


def test_a_series_of_files(tmp_path, cube):
    for k in range(3):
        subvol.write_mesh(subvol.HexMesh(cube.points + k, cube.cells, cube.fields), tmp_path / f"{k}.vtu")
    series = subvol.open_series([tmp_path / f"{k}.vtu" for k in range(3)], times=[0, .5, 1])
    assert len(series) == 3 and series.times == [0, .5, 1]
    assert [time for time, _ in series] == [0, .5, 1]
    assert [mesh.bounds[0, 0] for _, mesh in series] == [0, 1, 2]
    one = list(subvol.open_series(tmp_path / "1.vtu"))
    assert len(one) == 1 and one[0][0] == 0 and np.array_equal(one[0][1].points, cube.points + 1)
    with pytest.raises(subvol.InvalidInput):
        subvol.open_series([tmp_path / "0.vtu"], times=[0, 1])


def test_a_file_with_steps(tmp_path, cube):
    for k in range(3):
        subvol.write_mesh(subvol.HexMesh(cube.points + k, cube.cells, cube.fields), tmp_path / f"{k}.vtu")
    sets = "".join(f'<DataSet timestep="{k / 4}" file="{k}.vtu"/>' for k in range(3))
    pvd = tmp_path / "run.pvd"
    pvd.write_text(f'<VTKFile type="Collection"><Collection>{sets}</Collection></VTKFile>')
    series = subvol.open_series(pvd)
    assert series.times == [0, .25, .5] and "3 steps" in repr(series)
    assert [mesh.bounds[0, 0] for _, mesh in series] == [0, 1, 2]
    assert series[1].bounds[0, 0] == 1 == subvol.read_mesh(pvd, step=1).bounds[0, 0]
    assert subvol.read_mesh(pvd).bounds[0, 0] == 2  # the last one
    for wrong in (3, -1):
        with pytest.raises(subvol.InvalidInput):
            subvol.read_mesh(pvd, step=wrong)
    with pytest.raises(subvol.InvalidInput):
        subvol.open_series(pvd, times=[0, 1, 2])
    with pytest.raises(subvol.InvalidInput):
        subvol.read_mesh(pvd, blocks=["nothing"])


def test_models():
    assert {"pawn", "ball", "twist"} <= set(subvol.models())
    assert subvol.model("twist", 4).report()["cells"] == 64


def test_a_time_takes_the_nearest_step(tmp_path, cube):
    for k in range(3):
        subvol.write_mesh(subvol.HexMesh(cube.points, cube.cells, {"x": cube.fields["x"] + k}), tmp_path / f"{k}.vtu")
    sets = "".join(f'<DataSet timestep="{k / 4}" file="{k}.vtu"/>' for k in range(3))
    pvd = tmp_path / "run.pvd"
    pvd.write_text(f'<VTKFile type="Collection"><Collection>{sets}</Collection></VTKFile>')
    assert subvol.read_mesh(pvd, time=.3).fields["x"].min() == 1
    with pytest.warns(UserWarning, match="time 7 is beyond the steps"):
        assert subvol.read_mesh(pvd, time=7).fields["x"].min() == 2
    with pytest.raises(subvol.InvalidInput, match="time"):
        subvol.read_mesh(pvd, time=.3, step=1)
    with pytest.warns(UserWarning, match="one step"):
        subvol.read_mesh(tmp_path / "0.vtu", time=.3)
    with pytest.raises(subvol.InvalidInput, match="corners"):
        subvol.read_mesh(tmp_path / "0.vtu", curved="sharp")
    for curved in ("corners", 1e-3, "1e-3"):
        assert len(subvol.read_mesh(tmp_path / "0.vtu", curved=curved).cells) == len(cube.cells)
