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
