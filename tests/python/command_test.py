# SPDX-License-Identifier: Apache-2.0
"""What Python writes is what the command writes, byte for byte."""
import json
import warnings

import numpy as np
import pytest
import subvol


def same(a, b):
    assert a.read_bytes() == b.read_bytes()


@pytest.mark.parametrize("options", [{}, {"levels": 2, "scheme": "cc"}, {"scheme": "bsxw", "on_limit": True}, {"tension": .03},
                                     {"crease_angle": 30.0}])
def test_refined_meshes(tmp_path, command, options):
    flags = [word for name, value in options.items()
             for word in (["--" + name.replace("_", "-")] if value is True else ["--" + name.replace("_", "-"), value])]
    command("subdivide", "model:ball:3", "-o", tmp_path / "a.vtu", *flags)
    subvol.write_mesh(subvol.subdivide(subvol.model("ball", 3), **options), tmp_path / "b.vtu")
    same(tmp_path / "a.vtu", tmp_path / "b.vtu")


@pytest.mark.parametrize("options", [{}, {"per_edge": 2}, {"correction": "full"}, {"levels": 1}, {"kernel": "gaussian"}, {"spacing": .2}])
def test_points(tmp_path, command, options):
    flags = [word for name, value in options.items() for word in ("--" + name.replace("_", "-"), value)]
    command("points", "model:ball:3", "-o", tmp_path / "a.ply", *flags)
    subvol.write_points(subvol.sample(subvol.model("ball", 3), **options), tmp_path / "b.ply")
    same(tmp_path / "a.ply", tmp_path / "b.ply")


def test_splats_for_other_viewers_stand_upright(tmp_path, command):
    points = subvol.sample(subvol.model("ball", 3))
    for up in ("x", "y", None):
        command("points", "model:ball:3", "-o", tmp_path / "a.ply", "--splats", *(["--up", up] if up else []))
        subvol.write_points(points, tmp_path / "b.ply", splats=True, up=up)
        same(tmp_path / "a.ply", tmp_path / "b.ply")
    with pytest.raises(subvol.InvalidInput, match="splats"):
        subvol.write_points(points, tmp_path / "b.ply", up="y")
    with pytest.raises(subvol.InvalidInput, match="x, y, z"):
        subvol.write_points(points, tmp_path / "b.ply", splats=True, up="w")


@pytest.mark.parametrize("flags, options", [
    ([], {}),
    (["--look", "volume"], {"look": "volume"}),
    (["--look", "xray"], {"look": "xray"}),
    (["--look", "isosurface"], {"look": "isosurface"}),
    (["--tf", "coolwarm", "--view", "-y"], {"tf": "coolwarm", "view": "-y"}),
    (["--tf", "grey", "--tf-range", "-.5,.5"], {"tf": "grey", "range": "-.5,.5"}),
    (["--tf", "grey", "--tf-range", "-.5,.5", "--look", "volume"], {"tf": subvol.TransferFunction("grey", range=(-.5, .5)), "look": "volume"}),
    (["--opacity", "0%:0,100%:.3"], {"tf": subvol.TransferFunction("viridis", opacity="0%:0,100%:.3"), "look": "volume"}),
    (["--shade", "--per-edge", "2"], {"shade": True, "per_edge": 2}),
    (["--shadows"], {"shadows": True}),
    (["--shadows", "--ambient-occlusion", ".2", "--look", "volume"], {"shadows": True, "ambient_occlusion": .2, "look": "volume"}),
    (["--look", "volume", "--opacity", "80%:0,100%:.5"],
     {"look": "volume", "tf": subvol.TransferFunction("viridis", opacity="80%:0,100%:.5")}),
    (["--method", "tets"], {"method": "tets"}),
    (["--method", "tets", "--levels", "2", "--look", "volume", "--samples", "2"],
     {"method": "tets", "levels": 2, "look": "volume", "samples": 2}),
    (["--method", "dense", "--levels", "2"], {"method": "dense", "levels": 2}),
    (["--method", "dense", "--scheme", "cc", "--look", "volume"], {"method": "dense", "scheme": "cc", "look": "volume"}),
    (["--ortho", "--opacity-unit", ".1"], {"ortho": True, "opacity_unit": .1}),
    (["--camera", "3,-3,2,0,0,0,0,0,1,30"], {"camera": "3,-3,2,0,0,0,0,0,1,30"}),
    (["--levels", "1", "--look", "volume"], {"levels": 1, "look": "volume"}),
    (["--clip", ".1,0,0,1,-.5,.3"], {"clip": (.1, 0, 0, 1, -.5, .3)}),
    (["--clip", ".1,0,0,1,0,0", "--clip", "0,0,.2,0,0,1", "--method", "tets", "--look", "volume"],
     {"clip": [(.1, 0, 0, 1, 0, 0), (0, 0, .2, 0, 0, 1)], "method": "tets", "look": "volume"}),
    (["--clip-box", "-.4,-.6,-.5,.5,.3,.6", "--slice", "0,0,0,0,1,0", "--around", "--look", "volume"],
     {"clip_box": (-.4, -.6, -.5, .5, .3, .6), "slice": (0, 0, 0, 0, 1, 0), "around": True, "look": "volume"}),
    (["--sheets", "40", "--look", "volume"], {"sheets": 40, "look": "volume"}),
    (["--streamlines", "grad(density)", "--seeds", "line:-.5,0,0,.5,0,0", "--seed-count", "4", "--glyphs", "grad(density)", "--glyph-count", "9"],
     {"streamlines": "grad(density)", "seeds": "line:-.5,0,0,.5,0,0", "seed_count": 4, "glyphs": "grad(density)", "glyph_count": 9}),
    (["--part-opacity", "half:0,0,0,1,0,0=.3", "--part-opacity", "half:0,.2,0,0,1,0=0"],
     {"part_opacity": ["half:0,0,0,1,0,0=.3", "half:0,.2,0,0,1,0=0"]}),
    (["--part-opacity", "sphere:0,0,0,9=.4"], {"part_opacity": "sphere:0,0,0,9=.4"}),
    (["--glyphs", "grad(density)", "--method", "tets", "--look", "volume"], {"glyphs": "grad(density)", "method": "tets", "look": "volume"}),
    (["--lod", "20", "--per-edge", "2", "--look", "volume"], {"lod": 20, "per_edge": 2, "look": "volume"}),
])
def test_pictures(tmp_path, command, flags, options):
    if "tets" not in flags and "dense" not in flags:
        flags, options = [*flags, "--backend", "cpu"], {**options, "backend": "cpu"}
    for ending in ("exr", "png") if not flags[:1] or "xray" in flags else ("exr",):
        command("render", "model:ball:3", "-o", tmp_path / f"a.{ending}", "--size", "48x40", *flags)
        subvol.render(subvol.model("ball", 3), size=(48, 40), **options).write(tmp_path / f"b.{ending}")
        a, b = subvol.read_image(tmp_path / f"a.{ending}"), subvol.read_image(tmp_path / f"b.{ending}")
        assert np.asarray(a).tobytes() == np.asarray(b).tobytes(), ending


def test_footprints(tmp_path, command):
    command("render", "model:ball:3", "-o", tmp_path / "a.exr", "--size", "48", "--method", "footprints", "--look", "volume")
    subvol.render(subvol.model("ball", 3), size=(48, 48), method="footprints", look="volume").write(tmp_path / "b.exr")
    a, b = subvol.read_image(tmp_path / "a.exr"), subvol.read_image(tmp_path / "b.exr")
    assert np.asarray(a).tobytes() == np.asarray(b).tobytes() and np.asarray(a).any()


def test_pictures_by_opengl(tmp_path, command):
    if not subvol.gl_devices():
        pytest.skip("there is no OpenGL 4.5")
    for method in ("pt", "sheets"):
        command("render", "model:ball:3", "-o", tmp_path / "a.exr", "--size", "48", "--method", method)
        subvol.render(subvol.model("ball", 3), size=(48, 48), method=method).write(tmp_path / "b.exr")
        a, b = subvol.read_image(tmp_path / "a.exr"), subvol.read_image(tmp_path / "b.exr")
        assert np.asarray(a).tobytes() == np.asarray(b).tobytes(), method


def test_pictures_of_points(tmp_path, command):
    command("points", "model:ball:3", "-o", tmp_path / "p.ply")
    command("render", tmp_path / "p.ply", "-o", tmp_path / "a.exr", "--size", "40", "--backend", "cpu")
    subvol.render(subvol.read_points(tmp_path / "p.ply"), size=(40, 40), backend="cpu").write(tmp_path / "b.exr")
    same(tmp_path / "a.exr", tmp_path / "b.exr")


@pytest.mark.parametrize("options", [{}, {"levels": 1}, {"scheme": "cc"}, {"half": True}])
def test_grids(tmp_path, command, options):
    flags = [word for name, value in options.items() for word in (["--" + name] if value is True else ["--" + name, value])]
    report = json.loads(command("vdb", "model:ball:3", "-o", tmp_path / "a.vdb", "--resolution", "30", "--json", *flags))
    (mine,) = subvol.write_vdb(subvol.model("ball", 3), tmp_path / "b.vdb", resolution=30, **options)
    (a,), (b,) = subvol.read_vdb(tmp_path / "a.vdb"), subvol.read_vdb(tmp_path / "b.vdb")
    difference = a.difference(b)
    assert difference["max"] == 0 and difference["voxels"] == mine["active_voxels"] == report["active_voxels"]


def test_figures(tmp_path, command):
    info = json.loads(command("info", "model:ball:3", "--json"))
    report = subvol.model("ball", 3).report()
    for key in ("points", "cells", "edges", "faces", "boundary_faces", "singular_nodes", "inverted_cells", "min_scaled_jacobian", "volume"):
        assert report[key] == info[key], key
    for name, view in (("a", "iso"), ("b", "-y")):
        command("render", "model:ball:3", "-o", tmp_path / f"{name}.exr", "--size", "40", "--view", view)
    theirs = json.loads(command("compare", tmp_path / "a.exr", tmp_path / "b.exr", "--json"))
    mine = subvol.compare(subvol.read_image(tmp_path / "a.exr"), subvol.read_image(tmp_path / "b.exr"))
    for key in ("mse", "rmse", "mae", "max", "psnr", "ssim", "flip"):
        assert getattr(mine, key) == theirs[key], key


def test_a_field_chosen_by_default_is_the_command_s(tmp_path, command):
    cube = subvol.model("twist", 4)
    mesh = subvol.HexMesh(cube.points, cube.cells, {"NodeId": np.arange(len(cube.points)), "Temp": cube.points[:, 2] + 1})
    subvol.write_mesh(mesh, tmp_path / "m.vtu")
    command("render", tmp_path / "m.vtu", "-o", tmp_path / "a.exr", "--size", "32", "--backend", "cpu")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        subvol.render(subvol.read_mesh(tmp_path / "m.vtu"), size=(32, 32), backend="cpu").write(tmp_path / "b.exr")
    same(tmp_path / "a.exr", tmp_path / "b.exr")


def test_fields_of_meshes_are_compared_on_the_limit(tmp_path, command):
    """By the pieces of the command, at its places; a mesh and its first refinement have one limit, up to the error of the pieces."""
    coarse = subvol.model("ball", 2)
    subvol.write_mesh(coarse, tmp_path / "coarse.vtu")
    subvol.write_mesh(subvol.subdivide(coarse, 1), tmp_path / "fine.vtu")
    made = json.loads(command("compare", tmp_path / "coarse.vtu", tmp_path / "fine.vtu", "--samples", 5000, "--json"))
    found = subvol.compare_fields(subvol.read_mesh(tmp_path / "coarse.vtu"), subvol.read_mesh(tmp_path / "fine.vtu"), samples=5000)
    for name in ("l1", "l2", "linf", "gradient_rmse", "samples", "uncovered"):
        assert getattr(found, name) == made[name], name
    low, high = coarse.fields["density"].min(), coarse.fields["density"].max()
    assert found.l2 < 5e-4 * (high - low)


def test_surfaces_relative_to_an_origin(tmp_path, command):
    ball = subvol.model("ball", 2)
    subvol.write_mesh(subvol.HexMesh(ball.points * 1e-3 + [5e6, 4e6, 0], ball.cells, ball.fields), tmp_path / "far.vtu")
    far = subvol.read_mesh(tmp_path / "far.vtu")
    for extension in ("stl", "ply"):
        command("surface", tmp_path / "far.vtu", "--boundary", "--origin", "5e6,4e6,0", "-o", tmp_path / f"a.{extension}")
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            subvol.surface(far, path=tmp_path / f"b.{extension}", origin=(5e6, 4e6, 0))
        same(tmp_path / f"a.{extension}", tmp_path / f"b.{extension}")
    with pytest.warns(subvol.SubvolWarning, match="lose a side"):
        subvol.surface(far, path=tmp_path / "c.stl")
    for wrong in ((1, 2), (0, 0, np.nan)):
        with pytest.raises(subvol.InvalidInput, match="origin"):
            subvol.surface(far, path=tmp_path / "c.stl", origin=wrong)
    with pytest.raises(subvol.InvalidInput, match="origin"):
        subvol.surface(far, origin=(0, 0, 0))
