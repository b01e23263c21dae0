# SPDX-License-Identifier: Apache-2.0
"""Grids."""
import numpy as np
import pytest
import subvol
from conftest import grid_of


def test_the_grid_of_a_linear_field(tmp_path):
    cube = grid_of(3)
    (report,) = subvol.write_vdb(cube, tmp_path / "cube.vdb", resolution=10, fields=["x"])
    assert report["name"] == "x" and report["kind"] == "float"
    assert report["active_voxels"] == 1000 and report["voxel_size"] == pytest.approx(.1)
    (grid,) = subvol.read_vdb(tmp_path / "cube.vdb")
    values, inside = grid.values([[.42, .5, .5], [3, 3, 3]])
    assert inside.tolist() == [True, False] and values[0] == pytest.approx(.42, abs=1e-6) and np.isnan(values[1])
    assert grid.name == "x" and "1000 active voxels" in repr(grid)
    assert np.array(grid.bounds).shape == (2, 3)


def test_voxels_of_other_places_are_not_compared(cube):
    far = subvol.HexMesh(cube.points + 100, cube.cells, dict(cube.fields))
    one, other, finer = (subvol.rasterize(mesh, voxel_size=size, fields=["x"])[0] for mesh, size in ((cube, .25), (far, .25), (cube, .125)))
    difference = one.difference(other)
    assert difference["voxels"] == 0 and np.isnan(difference["rms"]) and np.isnan(difference["max"])
    with pytest.raises(subvol.InvalidInput, match="other voxels"):
        one.difference(finer)


def test_files_are_the_grids_in_memory(tmp_path, ball):
    (made,) = subvol.rasterize(ball, resolution=24)
    subvol.write_vdb(ball, tmp_path / "a.vdb", resolution=24)
    subvol.write_vdb([made], tmp_path / "b.vdb")
    (a,), (b,) = subvol.read_vdb(tmp_path / "a.vdb"), subvol.read_vdb(tmp_path / "b.vdb")
    for other in (a, b):
        assert other.difference(made)["max"] == 0
        assert other.report["active_voxels"] == made.report["active_voxels"] == made.difference(other)["voxels"]
    assert made.report["name"] == "density"  # written grids are as they were


def test_vectors_masks_and_level_sets(tmp_path):
    cube = grid_of(2)
    mesh = subvol.HexMesh(cube.points, cube.cells, {"x": cube.fields["x"], "v": cube.points})
    grids = {g.name: g for g in subvol.rasterize(mesh, fields=["x", "v"], resolution=12, mask=True, sdf="sdf")}
    assert set(grids) == {"x", "v", "mask", "sdf"}
    assert grids["v"].report["kind"] == "vector"
    assert grids["sdf"].values([[.5, .5, .04]])[0][0] == pytest.approx(-.04, abs=.01)
    with pytest.raises(subvol.InvalidInput):
        grids["v"].voxels()


def test_levels_and_schemes(ball):
    (limit,), (coarse,) = subvol.rasterize(ball, resolution=32), subvol.rasterize(ball, resolution=32, levels=0)
    assert limit.report["active_voxels"] > coarse.report["active_voxels"]  # the limit bulges
    (cc,) = subvol.rasterize(ball, resolution=32, scheme="cc")
    assert cc.report["active_voxels"] < limit.report["active_voxels"]  # Catmull-Clark shrinks


def test_voxels_of_points(ball_points):
    (grid,) = subvol.rasterize(ball_points, resolution=24)
    places = np.random.default_rng(5).uniform(-.4, .4, (20, 3))
    assert grid.values(places)[0] == pytest.approx(subvol.evaluate(ball_points, at=places)[0], abs=.05)
    with pytest.raises(subvol.InvalidInput):
        subvol.rasterize(ball_points, fields=["density"])


def test_a_grid_is_drawn(ball):
    (grid,) = subvol.rasterize(ball, resolution=48)
    tf = subvol.TransferFunction("viridis", range=(-1, 1))
    voxels = subvol.render(grid, method="grid", tf=tf, size=(64, 64), camera=subvol.Camera.parse("iso", ball.bounds))
    exact = subvol.render(ball, method="dense", tf=tf, size=(64, 64), opacity_unit=float(np.linalg.norm(np.diff(grid.bounds, axis=0))) / 100,
                          levels=3, camera=subvol.Camera.parse("iso", ball.bounds))
    assert subvol.compare(voxels, exact).psnr > 30  # voxels at the boundary
    assert voxels.report["rays"] > 0
    kernels = subvol.sample_grid(grid)
    assert len(kernels) == grid.report["active_voxels"]
    assert np.asarray(subvol.render(grid, size=(32, 32))).max() > 0
    with pytest.raises(subvol.InvalidInput):
        subvol.render(grid, method="tets")


def test_what_makes_no_grid(tmp_path, ball):
    for options in ({"resolution": 0}, {"resolution": -5}, {"voxel_size": 0}, {"voxel_size": np.nan}, {"voxel_size": 1e-9}, {"levels": 99}):
        with pytest.raises(subvol.Error):
            subvol.write_vdb(ball, tmp_path / "a.vdb", **options)
    assert not (tmp_path / "a.vdb").exists()
    with pytest.raises(subvol.InvalidInput):
        subvol.write_vdb(ball, tmp_path / "a.nvdb")
    with pytest.raises(subvol.InvalidInput):
        subvol.write_vdb([], tmp_path / "a.vdb")
    (grid,) = subvol.rasterize(ball, resolution=8)
    with pytest.raises(subvol.InvalidInput):
        subvol.write_vdb([grid, grid], tmp_path / "a.vdb")
    assert grid.report["active_voxels"] > 0
    with pytest.raises(TypeError):
        subvol.rasterize("ball")


def test_rasterize_takes_what_the_library_describes(ball, ball_points):
    grids = {g.name: g for g in subvol.rasterize(ball, resolution=16, cell_ids=True, coverage=True, sdf="band", half_width=2)}
    assert {"density", "cell", "coverage", "band"} <= set(grids)
    size = grids["band"].report["voxel_size"]
    assert grids["band"].report["max"] == pytest.approx(2 * size, rel=.1)  # the band ends there
    assert "sdf" in {g.name for g in subvol.rasterize(ball, resolution=8, sdf="")}  # as --sdf without a name
    with pytest.raises(subvol.InvalidInput, match="half_width: has no effect without sdf"):
        subvol.rasterize(ball, resolution=8, half_width=2)
    with pytest.raises(subvol.InvalidInput, match="voxel_size"):
        subvol.rasterize(ball, resolution=8, voxel_size=.5)
    with pytest.raises(subvol.InvalidInput, match="scheme, mask are of meshes"):
        subvol.rasterize(ball_points, resolution=8, scheme="cc", mask=True)


def test_level_sets_are_drawn_as_bodies():
    """The picture of a ball's level set is that of the ball."""
    ball = subvol.model("ball", 8)
    sdf = {g.name: g for g in subvol.rasterize(ball, resolution=64, sdf="sdf")}["sdf"]
    assert sdf.report["level_set"] and not subvol.rasterize(ball, resolution=16)[0].report["level_set"]
    body = subvol.sample_grid(sdf)
    assert set(body.values["density"]) == {1}
    one = subvol.HexMesh(ball.points, ball.cells, {"density": np.ones(len(ball.points))}, crease_angle="none")
    given = dict(camera="0,-5,0,0,0,0,0,0,1,30", size=(96, 96))
    of_set, of_mesh = (np.asarray(subvol.render(what, **given)) for what in (sdf, one))
    covered = of_mesh[..., 3].sum()
    # The surface is within some tenths of a voxel, which is about a pixel here. A pixel has 2 x 2 rays: along the rim one of them changes.
    rim = 2 * np.sqrt(np.pi * covered)
    assert np.abs(of_set[..., 3] - of_mesh[..., 3]).sum() < rim / 4 and abs(of_set[..., 3].sum() / covered - 1) < .01
    both = (of_set[..., 3] == 1) & (of_mesh[..., 3] == 1)
    assert both.sum() > 1000 and np.abs(of_set - of_mesh)[both].mean() < .01
    assert subvol.page(sdf).report["triangles"] > 1000
    with pytest.raises(subvol.InvalidInput, match="fog, which has no boundary"):
        subvol.page(subvol.rasterize(ball, resolution=16)[0])
    with pytest.raises(subvol.InvalidInput, match="method grid: draws no surface"):
        subvol.render(sdf, method="grid")
    with pytest.raises(subvol.InvalidInput, match="surface where its distance is 0"):
        subvol.render(sdf, iso="0")


def test_surfaces_are_refused_with_the_command_that_helps(tmp_path):
    (tmp_path / "a.stl").write_text("solid\nendsolid\n")
    (tmp_path / "a.gltf").write_text("{}")
    with pytest.raises(subvol.InvalidInput, match=r"`subvol mesh \S*a.stl -o a.vtu` makes a control mesh of it"):
        subvol.read_mesh(tmp_path / "a.stl")
    with pytest.raises(subvol.InvalidInput, match=r"exported as a.stl, `subvol mesh a.stl -o a.vtu` makes"):
        subvol.read_mesh(tmp_path / "a.gltf")


def array_grid(tmp_path, grid):
    """What OpenVDB's own module reads of a grid that was written: its array from the first active voxel on, activity, and the grid."""
    vdb = pytest.importorskip("pyopenvdb")
    subvol.write_vdb([grid], tmp_path / "of_grid.vdb")
    read = vdb.read(str(tmp_path / "of_grid.vdb"), grid.name)
    lower, upper = read.evalActiveVoxelBoundingBox()
    shape = [b - a + 1 for a, b in zip(lower, upper)]
    values = np.zeros(shape + ([3] if isinstance(read.background, tuple) else []), np.float32)
    read.copyToArray(values, ijk=lower)
    accessor = read.getConstAccessor()
    active = np.array([accessor.isValueOn(tuple(int(a + b) for a, b in zip(lower, index))) for index in np.ndindex(*shape)]).reshape(shape)
    return values, active, read


def test_an_array_becomes_a_grid_that_other_programs_read(tmp_path):
    random = np.random.default_rng(3)
    array = random.normal(size=(13, 9, 17)).astype(np.float32)
    array[random.uniform(size=array.shape) < .3] = np.nan
    array[0, 0, 0] = array[-1, -1, -1] = 2  # the box of the active voxels is the whole array
    grid = subvol.Grid(array, .25, (1.5, -2, .125), name="noise")
    values, active, read = array_grid(tmp_path, grid)
    assert np.array_equal(active, ~np.isnan(array)) and np.array_equal(values[active], array[active])
    assert read.gridClass == "fog volume" and read.name == "noise"
    first = read.evalActiveVoxelBoundingBox()[0]
    assert read.transform.indexToWorld(first) == (1.5, -2, .125)
    assert grid.origin.tolist() == [1.5, -2, .125] and grid.voxel_size == .25 and grid.shape == array.shape
    assert grid.transform.tolist() == [[.25, 0, 0, 1.5], [0, .25, 0, -2], [0, 0, .25, .125], [0, 0, 0, 1]]
    for again in (grid, *subvol.read_vdb(tmp_path / "of_grid.vdb")):
        assert np.array_equal(again.array(), array, equal_nan=True) and again.array().dtype == np.float32
        assert again.origin.tolist() == [1.5, -2, .125] and again.voxel_size == .25
    place = (1.5 + 3 * .25, -2 + 4 * .25, .125 + 5 * .25)
    expected = array[3, 4, 5]
    assert np.array_equal(grid.values([place])[0], [expected], equal_nan=True)


def test_the_array_of_a_grid_is_a_copy_of_its_voxels(tmp_path):
    mesh = grid_of(2, field=lambda p: p[:, 0] + 10 * p[:, 1])
    (grid,) = subvol.rasterize(mesh, resolution=8, fields=["f"])
    array = grid.array()
    i, j, _ = np.indices(array.shape)
    assert array.shape == (8, 8, 8) and np.allclose(array, grid.origin[0] + i / 8 + 10 * (grid.origin[1] + j / 8), atol=1e-5)  # values to 11 in 32 bits
    array[:] = 0
    assert grid.array().max() > 9  # ours does not change
    given = np.ones((2, 2, 2))
    made = subvol.Grid(given, 1)
    given[:] = 5
    assert made.array().max() == 1
    with pytest.raises(ValueError):
        grid.origin[0] = 3
    again = subvol.Grid(grid.array(), grid.voxel_size, grid.origin, "f")
    difference = again.difference(grid)  # the same voxels
    assert difference["voxels"] == 512 and difference["max"] == 0
    values, active, _ = array_grid(tmp_path, subvol.rasterize(subvol.model("ball", 3), resolution=20)[0])
    ours = subvol.read_vdb(tmp_path / "of_grid.vdb")[0].array()
    assert np.array_equal(np.isnan(ours), ~active) and np.array_equal(ours[active], values[active]) and not active.all()


def test_vectors_cuboids_and_turned_voxels(tmp_path):
    vectors = np.random.default_rng(4).normal(size=(5, 4, 3, 3))
    vectors[2, 2, 2] = np.nan
    grid = subvol.Grid(vectors, (.5, 1, 2), (10, 20, 30), name="v")
    assert grid.report["kind"] == "vector" and grid.shape == (5, 4, 3, 3)
    subvol.write_vdb([grid], tmp_path / "v.vdb")
    (read,) = subvol.read_vdb(tmp_path / "v.vdb", "v")
    assert np.array_equal(read.array(), vectors.astype(np.float32), equal_nan=True)
    assert np.allclose(read.transform, [[.5, 0, 0, 10], [0, 1, 0, 20], [0, 0, 2, 30], [0, 0, 0, 1]], atol=1e-15)
    with pytest.raises(subvol.InvalidInput, match="no cubes along the axes.*transform"):
        _ = read.voxel_size
    with pytest.raises(subvol.InvalidInput, match="has no grid 'w' \\(it has v\\)"):
        subvol.read_vdb(tmp_path / "v.vdb", ["w"])
    turn = np.array([[0, -.5, 0, 1], [.5, 0, 0, 2], [0, 0, .5, 3], [0, 0, 0, 1]])
    values = np.arange(24.).reshape(4, 3, 2)
    turned = subvol.Grid(values, transform=turn)
    assert np.allclose(turned.transform, turn, atol=1e-15)
    for index in np.ndindex(4, 3, 2):
        place = (turn @ [*index, 1])[:3]
        assert turned.values([place])[0][0] == pytest.approx(values[index], abs=1e-5)


def test_level_sets_of_arrays(tmp_path):
    h, radius, band = .1, .7, .3
    x = np.arange(-12, 13) * h
    distance = np.sqrt(x[:, None, None] ** 2 + x[None, :, None] ** 2 + x[None, None, :] ** 2) - radius
    grid = subvol.Grid(distance.clip(-band, band), h, (x[0],) * 3, name="sdf", level_set=True)
    assert grid.report["level_set"] and grid.background == pytest.approx(band)
    assert grid.report["active_voxels"] == np.count_nonzero(abs(distance.astype(np.float32)) < np.float32(band))
    values, active, read = array_grid(tmp_path, grid)
    assert read.gridClass == "level set" and read.background == pytest.approx(band)
    assert read.getConstAccessor().getValue((0, 0, 0)) in (pytest.approx(-band), pytest.approx(band))
    inner = grid.array()
    assert np.array_equal(inner, values) and not np.isnan(inner).any() and inner.min() == pytest.approx(-band)
    again = subvol.Grid(inner, grid.voxel_size, grid.origin, "sdf", level_set=True, background=grid.background)
    assert again.difference(grid)["max"] == 0 and again.report["active_voxels"] == grid.report["active_voxels"]
    (made,) = [g for g in subvol.rasterize(subvol.model("ball", 3), resolution=20, sdf="sdf") if g.name == "sdf"]
    same = subvol.Grid(made.array(), made.voxel_size, made.origin, "sdf", level_set=True, background=made.background)
    assert same.difference(made)["max"] == 0 and same.report["active_voxels"] == made.report["active_voxels"]
    assert same.values([[0, 0, 0]])[0] == made.values([[0, 0, 0]])[0] == pytest.approx(-made.background)


def test_what_makes_no_grid_of_an_array():
    good = np.zeros((2, 2, 2))
    bad = good.copy()
    bad[0, 1, 0] = np.inf
    nan = good.copy()
    nan[1, 1, 1] = np.nan
    flat = np.diag([1., 1, 0, 1])
    for arguments, keywords, message in (
            ((np.zeros((2, 2)), 1), {}, r"array: is not an array of voxels .*\(nx, ny, nz\)"),
            ((np.zeros((2, 2, 2, 2)), 1), {}, r"array: is not an array of voxels"),
            ((np.zeros((2, 0, 2)), 1), {}, r"array: is not an array of voxels"),
            ((good > 1, 1), {}, r"array: is not an array of voxels"),
            ((good * 1j, 1), {}, r"array: is not an array of voxels"),
            (("abc", 1), {}, r"array: is not an array of voxels"),
            ((bad, 1), {}, r"array: has the value inf at \[0, 1, 0\]"),
            ((nan, 1), {"level_set": True}, r"array: has the value nan at \[1, 1, 1\]"),
            ((good, 1), {"level_set": True}, r"background: the largest distance is 0"),
            ((good,), {}, r"voxel_size: is missing"),
            ((good, 0), {}, r"voxel_size: is not above 0"),
            ((good, np.nan), {}, r"voxel_size: is not above 0"),
            ((good, (1, 2)), {}, r"voxel_size: is not the size of a voxel"),
            ((good, "big"), {}, r"voxel_size: cannot be made an array"),
            ((good, 1e-9), {}, r"an edge of its voxels is 1e-09 long"),
            ((good, 1, (1, 2)), {}, r"origin: is not a place"),
            ((good, 1, (1, 2, np.nan)), {}, r"its transform moves by nan"),
            ((good, 1), {"transform": np.eye(4)}, r"transform: places no voxels"),
            ((good,), {"transform": np.eye(3)}, r"transform: places no voxels"),
            ((good,), {"transform": flat}, r"an edge of its voxels is 0 long"),
            ((good, 1), {"background": 3}, r"background: is of level sets"),
            ((good + 1, (1, 2, 1)), {"level_set": True}, r"array: has voxels that are no cubes"),
            ((np.ones((2, 2, 2, 3)), 1), {"level_set": True}, r"array: has vectors")):
        with pytest.raises(subvol.InvalidInput, match=message):
            subvol.Grid(*arguments, **keywords)
    with pytest.raises(TypeError):
        subvol.Grid()
    (mask,) = [g for g in subvol.rasterize(grid_of(2), fields=["x"], resolution=4, mask=True) if g.name == "mask"]
    with pytest.raises(subvol.InvalidInput, match="its voxels are of the kind mask .*floats or vectors"):
        mask.array()
    empty = subvol.Grid(np.full((2, 2, 2), np.nan), 1)
    assert empty.report["active_voxels"] == 0 and empty.array().shape == (0, 0, 0)
