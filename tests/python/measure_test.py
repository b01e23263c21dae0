# SPDX-License-Identifier: Apache-2.0
"""Values at places, integrals, slices and surfaces of the limit."""
import re
import warnings

import numpy as np
import pytest
import subvol
from conftest import grid_of


@pytest.fixture(scope="module")
def ball():
    return subvol.model("ball", 6)


def test_values_at_places_are_those_of_the_limit(ball):
    rng = np.random.default_rng(5)
    cells = rng.integers(0, len(ball.cells), 200)
    at = subvol.evaluate_limit(ball, cells, rng.random((200, 3)))
    found = subvol.probe(ball, at=at.positions)
    assert found.inside.all()
    np.testing.assert_allclose(found.fields["density"], at.fields["density"], atol=3e-5)  # the limit's tolerance, twice
    assert found.gradients["density"].shape == (200, 3)


def test_outside_there_is_nothing(ball):
    found = subvol.probe(ball, at=[[0, 0, 0], [1.05, 0, 0], [9, 9, 9]])
    assert found.inside.tolist() == [True, False, False]
    assert np.isnan(found.fields["density"][1:]).all() and found.cells[2] == -1
    near = subvol.probe(ball, at=[[1.05, 0, 0], [9, 9, 9]], reach=.1)
    assert near.inside.tolist() == [True, False]
    assert len(subvol.probe(ball, at=[]).cells) == 0


def test_the_difference_of_two_meshes_is_that_of_numpy():
    fine, coarse = grid_of(5), grid_of(3)
    a = fine.with_fields({"T": fine.points[:, 0] ** 2, "u": fine.points * 2, "other": fine.points[:, 2]})
    b = fine.with_fields({"u": fine.points, "T": fine.points[:, 1]})
    found, report = subvol.mesh_difference(a, b)
    expected = fine.points[:, 0] ** 2 - fine.points[:, 1]
    assert report["same_points"] and list(found.fields) == ["T", "u"]
    np.testing.assert_array_equal(found.fields["T"], expected)
    np.testing.assert_array_equal(found.fields["u"], fine.points)
    point = int(np.abs(expected).argmax())
    assert report["fields"]["T"] == {"max": abs(expected[point]), "at": fine.points[point].tolist(), "point": point}
    assert report["fields"]["u"]["max"] == np.linalg.norm(fine.points, axis=1).max()
    # On another mesh a linear field is met.
    found, report = subvol.mesh_difference(a, coarse.with_fields({"T": coarse.points[:, 1]}))
    assert not report["same_points"] and report["outside"] == 0
    np.testing.assert_allclose(found.fields["T"], expected, atol=1e-5)
    with pytest.raises(subvol.InvalidInput, match="no field in common"):
        subvol.mesh_difference(a, coarse.with_fields({"S": coarse.points[:, 1]}))
    with pytest.raises(TypeError, match="reference"):
        subvol.mesh_difference(a, 3)


def test_errors_of_kernels_fall_with_their_number(ball: subvol.HexMesh) -> None:
    points = subvol.sample(ball, "density")
    error = subvol.points_error(points, ball, "density")
    assert error.of_points.shape == (len(points),) and error.of_points.max() == error.max and error.gaps == 0
    assert 0 < error.rms < error.max < .5
    finer = subvol.points_error(subvol.sample(ball, "density", per_edge=2), ball, "density")
    assert finer.rms < error.rms
    with pytest.raises(subvol.InvalidInput, match="channel"):
        subvol.points_error(points, ball, channel=7)


def test_integrals_of_the_ball(ball):
    found = subvol.measure(ball, bins=8)
    assert found["volume"] == pytest.approx(4 / 3 * np.pi, rel=2e-3)
    field = found["fields"]["density"]
    assert field["min"] < field["mean"] < field["max"]
    assert field["histogram"].sum() == pytest.approx(found["volume"])
    at = subvol.probe(ball, at=[field["max_at"]])
    assert at.fields["density"][0] == pytest.approx(field["max"], abs=1e-4)


def test_a_slice_is_an_array_with_places(ball):
    cut = subvol.slice(ball, point=(0, 0, .3), normal=(0, 0, 1), resolution=40)
    assert max(cut.values.shape) == 40 and cut.values.shape == cut.cells.shape
    row, column = np.argwhere(cut.cells >= 0)[10]
    place = cut.origin + column * cut.right + row * cut.down
    assert place[2] == pytest.approx(.3)
    assert subvol.probe(ball, at=[place]).fields["density"][0] == pytest.approx(cut.values[row, column], abs=1e-5)
    assert (np.isnan(cut.values) == (cut.cells < 0)).all()


def test_surfaces_are_closed_and_point_outwards(ball, tmp_path):
    skin = subvol.surface(ball, path=tmp_path / "skin.ply")
    assert skin.report["watertight"] and skin.report["euler"] == 2
    assert (tmp_path / "skin.ply").exists()
    assert (np.einsum("ij,ij->i", skin.normals, skin.points) > .9).all()
    iso = subvol.surface(ball, iso=[0, .3], cap=True)
    assert iso.report["watertight"] and iso.triangles.max() < len(iso.points)
    assert iso.fields["density"].shape == (len(iso.points),)


def test_what_makes_no_sense_is_refused(ball):
    for call in (lambda: subvol.probe(ball, at=[[0, 0]]), lambda: subvol.probe(ball, at=[[0, 0, np.nan]]), lambda: subvol.slice(ball, point=(0, 0, 9), normal=(0, 0, 1)),
                 lambda: subvol.surface(ball, tolerance=0), lambda: subvol.surface(ball, cap=True), lambda: subvol.measure(ball, bins=0),
                 lambda: subvol.surface(ball, iso=np.nan), lambda: subvol.surface(ball, iso=0, path="a.xyz")):
        with pytest.raises(subvol.InvalidInput):
            call()


@pytest.fixture
def tetrahedra(tmp_path):
    """A box of 2³ cubes in six tetrahedra each, in its file and as the mesh with a field."""
    from itertools import permutations

    side, points, cells = 2, [], []
    number = lambda x, y, z: 1 + x + (side + 1) * (y + (side + 1) * z)
    for z in range(side + 1):
        points += [f"{x} {y} {z} 0" for y in range(side + 1) for x in range(side + 1)]
    for x, y, z in np.ndindex(side, side, side):
        for path in permutations(range(3)):
            at = np.array([x, y, z])
            corners = [number(*at)]
            for axis in path:
                at[axis] += 1
                corners.append(number(*at))
            cells.append(" ".join(map(str, corners)) + " 0")
    file = tmp_path / "box.mesh"
    file.write_text("\n".join(["MeshVersionFormatted 2", "Dimension 3", "Vertices", str(len(points)), *points, "Tetrahedra",
                               str(len(cells)), *cells, "End", ""]))
    with pytest.warns(subvol.SubvolWarning):
        mesh = subvol.read_mesh(file)
    x, y, z = mesh.points.T
    return file, subvol.HexMesh(mesh.points, mesh.cells, {"density": x * y + z * z, "x": x})


@pytest.mark.parametrize("scheme", ["tetoct", "boxspline"])
def test_tetrahedra_are_refined_as_such(tetrahedra, scheme):
    _, mesh = tetrahedra
    fine = subvol.subdivide(mesh, 2, scheme, on_limit=True)
    assert len(fine.cells) == 48 * 4 * (24 + 4 * 10)  # 24 tetrahedra and 10 octahedra of level 2, four hexahedra a tetrahedron
    assert np.ptp(fine.points, axis=0) == pytest.approx([2, 2, 2])  # right angles stay
    np.testing.assert_allclose(fine.fields["x"], fine.points[:, 0], atol=1e-12)
    at = fine.points[fine.cells[::97, 0]]  # corners of the tetrahedra
    found = subvol.probe(mesh, at=at, scheme=scheme)
    np.testing.assert_allclose(found.fields["density"], fine.fields["density"][fine.cells[::97, 0]], atol=1e-6)
    np.testing.assert_allclose(found.gradients["x"], np.tile([1, 0, 0], (len(at), 1)), atol=1e-6)
    assert found.cells.max() < 48 and np.isnan(found.parameters).all()
    same = subvol.probe(fine, at=at, scheme="linear")
    np.testing.assert_allclose(found.fields["density"], same.fields["density"], atol=1e-9)
    points = subvol.sample(mesh, "density", scheme=scheme)
    assert len(points) == 5 ** 3
    for call in (lambda: subvol.sample(mesh, "x", 2, scheme=scheme), lambda: subvol.probe(mesh, at=at, levels=1),
                 lambda: subvol.measure(mesh, scheme=scheme), lambda: subvol.probe(mesh, at=at, scheme=scheme, levels=9)):
        with pytest.raises(subvol.InvalidInput):
            call()


def test_tetrahedra_are_those_of_the_command(tetrahedra, command, tmp_path):
    import json

    file, mesh = tetrahedra
    asked = ("--scheme", "tetoct", "--density", "x*y+z*z")
    command("points", file, "-o", tmp_path / "a.ply", *asked)
    subvol.write_points(subvol.sample(mesh, "density", scheme="tetoct"), tmp_path / "b.ply")
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()
    theirs = json.loads(command("probe", file, "--at", ".3,.4,1.2", *asked, "--levels", 3, "--json"))["values"][0]
    ours = subvol.probe(mesh, at=[[.3, .4, 1.2]], scheme="tetoct", levels=3)
    assert (theirs["value"], theirs["cell"]) == (ours.fields["density"][0], ours.cells[0])
    assert theirs["gradient"] == ours.gradients["density"][0].tolist()


def test_folds_are_proved_or_placed():
    sound = subvol.check_folds(subvol.model("twist", 6))
    assert sound.verdict == "sound" and not sound.verdicts.any() and not sound.open.any()
    assert sound.cells.size == 0 and sound.positions.shape == (0, 3)
    twist = subvol.model("twist", 6)
    pulled = subvol.HexMesh(np.array(twist.points) * (-2, -3, 1), twist.cells)
    through = subvol.check_folds_between(twist, pulled, time_levels=4)
    assert (subvol.check_folds(pulled).verdict, through.verdict) == ("sound", "folded")
    assert np.all((1 - 3 * through.times) * (1 - 4 * through.times) < 0)  # the determinant between, in closed form
    assert subvol.check_folds_between(twist, twist).verdict == "sound"
    ball = subvol.check_folds(subvol.model("ball", 3), irregular_levels=1)
    assert ball.verdict == "undecided" and set(ball.verdicts) == {0, 3} and 0 < ball.open.max() <= 1
    twist = subvol.model("twist", 4)
    points = twist.points.copy()
    points[:, 0] *= -1
    mirrored = subvol.check_folds(subvol.HexMesh(points, twist.cells), levels=1)
    assert mirrored.verdict == "folded" and (mirrored.determinants < 0).all()
    np.testing.assert_array_equal(mirrored.cells, np.arange(len(twist.cells)))


def test_surfaces_become_meshes(tmp_path):
    ball = subvol.model("ball", 4)
    surface = subvol.surface(ball, path=tmp_path / "ball.stl", tolerance=5e-3)
    points, triangles = subvol.read_surface(tmp_path / "ball.stl")
    assert triangles.shape == surface.triangles.shape
    np.testing.assert_allclose(np.sort(points, axis=0), np.sort(surface.points, axis=0), atol=1e-6)
    mesh, report = subvol.control_mesh(points, triangles, cells=6)
    assert report["folds"]["cells"]["folded"] == 0
    assert report["after"]["max"] < .1 * report["side_world"]
    moved = subvol.HexMesh(mesh.points * 1.05, mesh.cells)
    shaped, fit = subvol.fit_shape(moved, points, triangles, keep_folds=True)
    assert fit["after"]["rms"] < .2 * fit["before"]["rms"]
    assert shaped.cells.shape == mesh.cells.shape
    with pytest.raises(subvol.InvalidInput, match=r"triangles: has the shape \(\d+, 2\) \(\(n, 3\)\)"):
        subvol.control_mesh(points, triangles[:, :2])
    with pytest.raises(subvol.InvalidInput, match="triangles: row 0 has the number -1; there are"):
        subvol.control_mesh(points, triangles * 0 - 1)
    with pytest.raises(subvol.InvalidInput, match="cells: 1 is out of range"):
        subvol.control_mesh(points, triangles, cells=1)


def test_several_surfaces_are_materials_of_one_mesh():
    outer, inner = (subvol.surface(subvol.model("ball", 4), tolerance=5e-3) for _ in range(2))
    middle = outer.points.mean(axis=0)
    surfaces = {"shell": (outer.points, outer.triangles), "core": (middle + .5 * (inner.points - middle), inner.triangles)}
    mesh, report = subvol.control_mesh(surfaces, cells=8)
    assert list(mesh.sets) == ["shell", "core"]
    assert sorted(np.concatenate(list(mesh.sets.values()))) == list(range(len(mesh.cells)))
    shell, core = report["materials"]
    corners = outer.points[outer.triangles]
    volume = abs(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum()) / 6
    assert shell["enclosed_world"] == pytest.approx(volume * 7 / 8, rel=1e-9)
    assert shell["volume_world"] == pytest.approx(volume * 7 / 8, rel=.02)
    assert core["volume_world"] == pytest.approx(volume / 8, rel=.03)
    with pytest.raises(subvol.InvalidInput, match="triangles: there are none"):
        subvol.control_mesh(outer.points)
    with pytest.raises(subvol.InvalidInput, match="triangles: have no effect beside surfaces by name"):
        subvol.control_mesh(surfaces, outer.triangles)


def test_labels_of_voxels_are_materials_of_one_mesh():
    i, j, k = np.meshgrid(*(np.arange(n, dtype=float) for n in (30, 24, 40)), indexing="ij")
    place = np.stack([i, 1.25 * j, .75 * k], axis=-1) - np.array([14.5, 14.375, 14.625])
    labels = np.where(np.linalg.norm(place, axis=-1) < 12, np.where(np.linalg.norm(place, axis=-1) < 7, 9, 4), 0)
    # the axes x, y, z as z, x, y of the world
    transform = np.array([[0, 1.25, 0, 100], [0, 0, .75, -7], [1, 0, 0, 3], [0, 0, 0, 1]])
    mesh, report = subvol.control_mesh(labels.astype(np.uint8), transform=transform, cells=8, label=["9=core", "4"])
    assert list(mesh.sets) == ["core", "label_4"]
    core, rest = report["labels"]
    assert (core["label"], rest["label"], core["voxels"]) == (9, 4, np.count_nonzero(labels == 9))
    assert core["voxels_world"] == pytest.approx(core["voxels"] * .9375) and core["enclosed_world"] == pytest.approx(core["voxels_world"], rel=1e-3)
    volumes = {material["name"]: material["volume_world"] for material in report["materials"]}
    assert volumes["core"] == pytest.approx(4 / 3 * np.pi * 7**3, rel=.03)
    assert volumes["label_4"] == pytest.approx(4 / 3 * np.pi * (12**3 - 7**3), rel=.03)
    middle = transform[:3] @ [14.5, 14.375 / 1.25, 14.625 / .75, 1]
    np.testing.assert_allclose(.5 * (mesh.points.min(axis=0) + mesh.points.max(axis=0)), middle, atol=.5)
    with pytest.raises(subvol.InvalidInput, match="labels: are of the type float64"):
        subvol.control_mesh(labels * .5)
    with pytest.raises(subvol.InvalidInput, match="label: no voxel has the label 3 .labels: 4, 9."):
        subvol.control_mesh(labels, label=["3"])
    with pytest.raises(subvol.InvalidInput, match="voxel_size: is not the size of a voxel"):
        subvol.control_mesh(labels, voxel_size=[1, -1, 1])
    with pytest.raises(subvol.InvalidInput, match="voxel .0, 0, 0. has the label -1"):
        subvol.control_mesh(labels - 1)
    boundary = subvol.surface(subvol.model("ball", 4), tolerance=.05)
    with pytest.raises(subvol.InvalidInput, match="smooth: has no effect on surfaces"):
        subvol.control_mesh(boundary.points, boundary.triangles, smooth=3)
    with pytest.raises(subvol.InvalidInput, match="origin: has no effect on surfaces"):
        subvol.control_mesh(boundary.points, boundary.triangles, origin=(0, 0, 0))


def test_folds_are_mended():
    twist = subvol.model("twist", 6)
    points = twist.points.copy()
    middle = np.argmin(np.linalg.norm(points - points.mean(axis=0), axis=1))
    points[middle] += [.25, .02, 0]
    bad = subvol.HexMesh(points, twist.cells, {"T": points[:, 0]})
    mended, check, report = subvol.mend_folds(bad, boundary_move=0)
    assert report["folded"] > 0 and report["left"] == [] and check.verdict == "sound"
    np.testing.assert_array_equal(mended.fields["T"], bad.fields["T"])
    assert report["moved"] == np.count_nonzero((mended.points != points).any(axis=1)) > 0
    with pytest.raises(subvol.InvalidInput, match="rounds"):
        subvol.mend_folds(bad, rounds=0)


def test_a_field_is_approximated():
    control = subvol.model("twist", 4)
    values = np.random.default_rng(1).normal(size=len(control.points))
    fine = subvol.subdivide(subvol.HexMesh(control.points, control.cells, {"T": values}), levels=2)
    fitted, report = subvol.approximate(control, fine)
    np.testing.assert_allclose(fitted.fields["T"], values, atol=1e-10)
    assert report["samples"] == len(fine.points) and report["fields"]["T"]["max"] < 1e-9
    coarse, report = subvol.approximate(subvol.model("twist", 2), fine.points[::3], {"T": fine.fields["T"][::3]}, smoothing=.01, refine=1, tolerance=.01)
    assert report["refined"] == 1 and len(coarse.cells) == 64
    with pytest.raises(subvol.InvalidInput, match="there is no field to approximate"):
        subvol.approximate(control, subvol.HexMesh(fine.points, fine.cells))


def test_fields_are_mapped_to_the_points_of_another_mesh():
    data, onto = subvol.model("twist", 4), subvol.model("twist", 3)
    x = data.points
    data = subvol.HexMesh(x, data.cells, {"T": 1 + 2 * x[:, 0] - x[:, 2], "U": x[:, ::-1]})
    with pytest.warns(subvol.SubvolWarning, match="lie outside of the data"):
        mapped, report = subvol.map_fields(onto, data)
    assert mapped.fields["U"].shape == onto.points.shape
    off = np.abs(mapped.fields["T"] - (1 + 2 * onto.points[:, 0] - onto.points[:, 2])) > 1e-6
    assert off.sum() <= report["outside"] < len(onto.points) / 2  # linear inside
    assert np.abs(mapped.fields["U"] - onto.points[:, ::-1]).max() <= report["farthest_world"] + 1e-12
    same, report = subvol.map_fields(data, data)
    assert report["outside"] == 0
    np.testing.assert_allclose(same.fields["T"], data.fields["T"], atol=1e-12)
    with pytest.raises(subvol.InvalidInput, match="no field"):
        subvol.map_fields(onto, onto.__class__(onto.points, onto.cells))


def test_the_steps_of_a_series_are_approximated(tmp_path):
    control, files = subvol.model("twist", 2), []
    for k in range(3):
        fine = subvol.subdivide(subvol.model("twist", 2), levels=2)
        x = fine.points + (.05 if k == 2 else 0)  # the last step has moved
        files.append(tmp_path / f"step{k}.vtu")
        subvol.write_mesh(subvol.HexMesh(x, fine.cells, {"T": np.sin(4 * x[:, 0] + k)}), files[-1])
    series = subvol.open_series(files)
    made = list(subvol.approximate_series(control, series, smoothing=.001))
    assert [report["placements"] for _, report in made] == [1, 1, 2]
    for k, (mesh, report) in enumerate(made):
        alone, its_report = subvol.approximate(control, series[k], smoothing=.001)
        assert np.array_equal(mesh.fields["T"], alone.fields["T"])
        assert report["fields"] == its_report["fields"]
    meshes = subvol.approximate_series(control, (series[k] for k in range(3)), smoothing=.001)
    assert np.array_equal(next(meshes)[0].fields["T"], made[0][0].fields["T"])
    with pytest.raises(TypeError, match="refine"):  # all steps have the same control mesh
        subvol.approximate_series(control, series, refine=1)
    with pytest.raises(subvol.InvalidInput, match="levels: 9 is out of range"):
        subvol.approximate_series(control, series, levels=9)  # before any step is read
    with pytest.raises(subvol.InvalidInput, match="there is no field to approximate"):
        next(subvol.approximate_series(control, [subvol.HexMesh(fine.points, fine.cells)]))


def test_streamlines_are_arrays_of_points_and_times(ball, tmp_path):
    mesh = subvol.HexMesh(ball.points, ball.cells, {"U": np.tile([0.0, 0.0, 2.0], (len(ball.points), 1)), "T": ball.points[:, 2]})
    with pytest.warns(subvol.SubvolWarning, match="1 of 3 seeds"):
        lines = subvol.streamlines(mesh, "U", [[0, 0, 0], [9, 9, 9], [.3, 0, 0]], path=tmp_path / "lines.vtp")
    assert lines.seeds.tolist() == [0, 2] and lines.outside.tolist() == [1] and lines.offsets[-1] == len(lines.points)
    assert lines.ends == [("boundary", "boundary")] * 2
    assert np.allclose(lines.points[:, 2], 2 * lines.times, atol=1e-6)
    assert np.allclose(lines.fields["T"], lines.points[:, 2], atol=1e-6) and lines.fields["U"].shape == (len(lines.points), 3)
    assert "Lines" in (tmp_path / "lines.vtp").read_text()
    one = subvol.streamlines(mesh, "U", "at:0,0,0", stream_direction="forward", stream_time=.1)
    assert one.times[-1] == .1 and one.ends == [("seed", "time")]
    assert subvol.streamlines(mesh, "grad(T)", seed_count=5).report["streamlines"]["count"] == 5
    for wrong in ("nowhere", ["at:0,0,0", "line:1"]):
        with pytest.raises(subvol.InvalidInput, match="seeds"):
            subvol.streamlines(mesh, "U", wrong)
    with pytest.raises(subvol.InvalidInput, match="component"):
        subvol.streamlines(mesh, "T")
    with pytest.raises(subvol.InvalidInput, match="seeds: has no effect"):
        subvol.render(mesh, seeds="at:0,0,0", size=(8, 8))
    with pytest.raises(subvol.InvalidInput, match="streamlines: needs a mesh"):
        subvol.render(subvol.sample(ball), streamlines="U", size=(8, 8))


def beam():
    """A beam with a plateau of temperature: the limit overshoots by an eighth of its height."""
    cube = grid_of(4)
    points = np.asarray(cube.points) * [4, 1, 1]
    heat = np.array([0, 0, 10, 10, 0])[np.rint(points[:, 0]).astype(int)]
    return subvol.HexMesh(points, cube.cells, {"T": heat.astype(float)})


def test_slices_have_their_extremes_and_those_of_the_cells():
    cut = subvol.slice(beam(), point=(0, 0, .4), normal=(0, 0, 1), resolution=16)
    # The field depends on x alone: its extremes are those along a fine line.
    line = np.stack([np.linspace(0, 4, 20001), np.full(20001, .4), np.full(20001, .4)], 1)
    values = subvol.probe(beam(), at=line).fields["T"]
    assert cut.min == pytest.approx(values.min(), abs=1e-5) and cut.max == pytest.approx(values.max(), abs=1e-5)
    assert (cut.file_min, cut.file_max) == pytest.approx((0, 10), abs=1e-12) and cut.max > 11
    assert subvol.probe(beam(), at=[cut.max_at]).fields["T"][0] == pytest.approx(cut.max, abs=1e-9)
    assert cut.max_at[2] == pytest.approx(.4) and cut.file_max_at[0] == pytest.approx(2.5, abs=.501)


def test_a_warning_says_where_the_limit_is_another_body_or_leaves_the_range():
    with pytest.warns(subvol.SubvolWarning, match=r"T is -1\.\d+ to 11\.\d+ in the limit, beyond its range in the file by 13 %: clamp='file' keeps it within"):
        subvol.measure(beam())
    ball = subvol.model("ball", 2)
    with pytest.warns(subvol.SubvolWarning, match="the limit has .* more volume than the cells of the file: a smaller crease_angle"):
        subvol.measure(subvol.HexMesh(ball.points, ball.cells, {}, crease_angle="none"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        subvol.measure(ball)  # the limit of a model is what is meant
        subvol.measure(beam(), clamp="file")


def test_clamp_keeps_fields_in_the_range_of_the_file():
    mesh, line = beam(), np.stack([np.linspace(0, 4, 401), np.full(401, .4), np.full(401, .3)], 1)
    free, kept = subvol.probe(mesh, at=line).fields["T"], subvol.probe(mesh, at=line, clamp="file").fields["T"]
    assert free.min() < -1 and free.max() > 11
    assert np.array_equal(kept, np.clip(free, 0, 10))
    whole = subvol.measure(mesh, clamp="file")["fields"]["T"]
    assert (whole["min"], whole["max"]) == (0, 10)
    cut = subvol.slice(mesh, point=(0, 0, .4), normal=(0, 0, 1), resolution=16, clamp="file")
    assert (cut.min, cut.max) == (0, 10)
    values = subvol.sample(mesh, "T", 2, clamp="file").values["T"]
    assert values.min() == 0 and values.max() == 10 and subvol.sample(mesh, "T", 2).values["T"].max() > 11
    report = subvol.rasterize(mesh, fields=["T"], voxel_size=.1, clamp="file")[0].report
    assert (report["min"], report["max"]) == (0, 10)
    faces = subvol.surface(mesh, boundary=True, field="T", clamp="file").fields["T"]
    assert faces.min() == 0 and faces.max() == 10
    square = subvol.slice(mesh, point=(0, 0, .4), normal=(0, 0, 1), field="T*T", resolution=16, clamp="file")
    assert (square.min, square.max) == (0, 100)
    with pytest.raises(subvol.InvalidInput, match="clamp: 'points' is unknown"):
        subvol.probe(mesh, at=line, clamp="points")


def test_parts_lie_in_the_whole_and_may_overlap(tmp_path):
    """Half of a ball, by cells: half of its volume, by symmetry. Sets of a deck, that have cells in common."""
    ball = subvol.model("ball", 6)
    whole, half = subvol.measure(ball), subvol.measure(ball, only="where:x>0")
    assert half["volume"] == pytest.approx(whole["volume"] / 2, rel=4e-4)  # both are within 1e-4
    deck = "*NODE\n" + "".join(f"{1 + x + 4 * y + 8 * z},{x},{y},{z}\n" for z in range(2) for y in range(2) for x in range(4))
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    deck += "*ELEMENT,TYPE=C3D8,ELSET=ALL\n" + "".join(
        f"{n + 1}," + ",".join(str(1 + n + x + 4 * y + 8 * z) for x, y, z in corners) + "\n" for n in range(3))
    (tmp_path / "bar.inp").write_text(deck + "*ELSET,ELSET=LEFT\n1,2\n*ELSET,ELSET=RIGHT\n2,3\n")
    parts = subvol.measure(subvol.read_mesh(tmp_path / "bar.inp"))["parts"]
    assert {name: part["volume"] for name, part in parts.items()} == pytest.approx({"ALL": 3, "LEFT": 2, "RIGHT": 2})
    with pytest.raises(subvol.InvalidInput, match="their own sets"):
        subvol.read_mesh(tmp_path / "bar.inp", mesh=str(tmp_path / "bar.inp"))


def test_all_calls_take_the_field_first_and_the_old_order_warns(ball):
    mesh = subvol.HexMesh(ball.points, ball.cells, {"density": ball.fields["density"], "z": ball.points[:, 2]})
    places = [[.1, .2, .3], [0, 0, -.4], [9, 9, 9]]
    heights = np.array(places)[:2, 2]
    values, inside = subvol.evaluate(mesh, "z", places)
    assert values[:2] == pytest.approx(heights, abs=1e-6) and inside.tolist() == [True, True, False]
    found = subvol.probe(mesh, "z", places)
    assert list(found.fields) == ["z"] and found.fields["z"][:2] == pytest.approx(heights, abs=1e-6)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        plane = subvol.slice(mesh, "z", (0, 0, .25), (0, 0, 1), resolution=8)
        level = subvol.surface(mesh, "z", .25)
        both = subvol.surface(mesh, "z", [.1, .2])
        everywhere = subvol.probe(mesh, at=places)
    assert np.nanmin(plane.values) == pytest.approx(.25, abs=1e-6) and plane.field == "z"
    assert level.points[:, 2] == pytest.approx(.25, abs=1e-6)
    assert np.unique(both.points[:, 2].round(5)).tolist() == [.1, .2]
    assert set(everywhere.fields) == {"density", "z"}

    old = {"surface(mesh, field, iso)": (lambda: subvol.surface(mesh, .25, "z"), lambda: subvol.surface(mesh, .25, field="z")),
           "slice(mesh, field, point, normal)": (lambda: subvol.slice(mesh, (0, 0, .25), (0, 0, 1), "z", resolution=8),
                                                 lambda: subvol.slice(mesh, (0, 0, .25), (0, 0, 1), field="z", resolution=8)),
           "probe(mesh, field, at)": (lambda: subvol.probe(mesh, places), lambda: subvol.probe(mesh, places=places))}
    for written, calls in old.items():
        for call in calls:
            with pytest.warns(DeprecationWarning, match=f"write {re.escape(written)}") as said:
                made = call()
            assert said[0].filename == __file__
            if written.startswith("surface"):
                assert np.array_equal(made.points, level.points)
            elif written.startswith("slice"):
                assert np.array_equal(made.values, plane.values, equal_nan=True)
            else:
                assert all(np.array_equal(made.fields[name], everywhere.fields[name], equal_nan=True) for name in made.fields)
    with pytest.warns(DeprecationWarning):
        assert len(subvol.surface(mesh, None, "z").points) == len(subvol.surface(mesh, "z").points)

    for wrong, message in ((lambda: subvol.evaluate(mesh, places), r"field: a name is needed, not list; write evaluate\(what, field, at\)"),
                           (lambda: subvol.surface(mesh, .25, .5), r"field: a name is needed, not float; write surface\(mesh, field, iso\)"),
                           (lambda: subvol.surface(mesh, "z", .5, iso=3), r"surface: iso is given twice"),
                           (lambda: subvol.surface(mesh, "z", .5, 3), r"takes 3 arguments by position, not 4"),
                           (lambda: subvol.slice(mesh, "z"), r"a plane has both .*slice\(mesh, field, point, normal\)"),
                           (lambda: subvol.probe(mesh, "z"), r"at: is missing .*probe\(mesh, field, at\)")):
        with pytest.raises((TypeError, subvol.InvalidInput), match=message):
            wrong()
    with pytest.raises(TypeError, match=r"takes 3 arguments"):
        subvol.probe(mesh, "z", places, places=places)
