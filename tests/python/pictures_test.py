# SPDX-License-Identifier: Apache-2.0
"""Pictures and their distance."""
import pickle
import struct
import zlib

import numpy as np
import pytest
import subvol
from conftest import grid_of


def opaque(value=1.0):
    return subvol.TransferFunction.from_knots([[0, value, value, value]], [[0, .5]])


@pytest.mark.parametrize("method", ["splat", "tets", "dense"])
def test_a_slab_has_the_opacity_of_its_thickness(method):
    block = grid_of(3)
    image = np.asarray(subvol.render(block, method=method, view="-y", ortho=True, size=(40, 40), tf=opaque(), opacity_unit=1,
                                     backend="cpu" if method == "splat" else None))
    middle = image[20, 20]
    assert middle[3] == pytest.approx(.5, abs=2e-3)  # one unit of opacity .5; splats sum halves of floats
    assert middle[:3] == pytest.approx([middle[3]] * 3, abs=1e-6)
    assert not image[0, 0].any()


@pytest.mark.parametrize("method", ["splat", "tets", "dense", "pt", "sheets"])
def test_all_methods_draw_the_same(ball, method):
    if method in ("pt", "sheets") and not subvol.gl_devices():
        pytest.skip("there is no OpenGL 4.5")
    tf = subvol.TransferFunction("viridis", opacity=[(-1, 0), (1, .3)])
    finer = {"tets": {"levels": 2}, "pt": {"levels": 2}, "splat": {"per_edge": 2}, "sheets": {"per_edge": 2}}.get(method, {})
    image = subvol.render(ball, method=method, tf=tf, size=(96, 96), **finer)
    reference = subvol.render(ball, method="dense", tf=tf, levels=3, size=(96, 96))
    assert subvol.compare(image, reference).psnr > 40  # the geometry of two levels; splats of half a cell
    assert image.report["method"] == method


def test_solids_are_lit_and_opaque(ball):
    image = np.asarray(subvol.render(ball, size=(64, 64)))
    assert image[32, 32, 3] == pytest.approx(1, abs=1e-3)
    assert image.shape == (64, 64, 4)
    flat = np.asarray(subvol.render(ball, size=(64, 64), look="volume"))
    assert not np.array_equal(image, flat)
    assert subvol.render(ball, size=(8, 8)).report["background"][0] > .5
    assert subvol.render(ball, size=(8, 8), look="volume").report["background"] == (0, 0, 0)


def test_depth_and_report(ball_points):
    image = subvol.render(ball_points, size=(32, 32), backend="cpu")
    assert image.depth.shape == (32, 32) and not image.depth.flags.writeable
    assert np.isinf(image.depth[0, 0]) and np.isfinite(image.depth[16, 16])
    assert image.report["points"] == len(ball_points) and image.report["backend"] == "cpu"
    assert subvol.Image(np.zeros((2, 2, 4))).depth is None


def test_within_a_time(ball):
    image = subvol.render(ball, seconds=0.2, size=(64, 64), backend="cpu")
    assert image.report["steps"] >= 1
    with pytest.raises(subvol.InvalidInput):
        subvol.render(ball, seconds=1, method="tets")
    with pytest.raises(subvol.InvalidInput):
        subvol.render(ball, seconds=-1)


def test_a_transfer_function():
    tf = subvol.TransferFunction("viridis", range=(300, 900), opacity=[(300, 0), (900, .5)])
    knots = tf.knots(0, 1)
    assert knots.color[0, 0] == 300 and knots.color[-1, 0] == 900
    assert np.array_equal(knots.opacity, [[300, 0], [900, .5]])
    percent = subvol.TransferFunction("grey", opacity="0%:0,50%:.2,100%:.9").knots(10, 20)
    assert percent.opacity == pytest.approx(np.array([[10, 0], [15, .2], [20, .9]]))
    assert "<svg" in tf.legend("T") and tf.legend("T") == tf._repr_svg_().replace("></svg>", "></svg>") or "T" in tf.legend("T")
    for wrong in ({"opacity": [(1, 0), (0, 1)]}, {"opacity": [(0, 2)]}, {"opacity": [1, 2]}, {"opacity": "x"}, {"range": (2, 1)},
                  {"range": (np.nan, 1)}, {"name": "nothing"}):
        with pytest.raises(subvol.InvalidInput):
            subvol.TransferFunction(**wrong)
    with pytest.raises(subvol.FileError):
        subvol.TransferFunction("no/such.json")


def test_a_camera(ball):
    camera = subvol.Camera(eye=(0, -4, 0), target=(0, 0, 0), fovy_deg=35)
    assert camera.up == (0, 0, 1) and camera.ortho_height == 0
    image = subvol.render(ball, camera=camera, size=(32, 32))
    assert np.asarray(image)[16, 16, 3] > .9
    turn = camera.turntable((0, 0, 0), 4)
    assert len(turn) == 4 and turn[2].eye == pytest.approx((0, 4, 0), abs=1e-12)
    assert camera.orthographic(ball.bounds).ortho_height > 0
    assert subvol.Camera.parse("+x", ball.bounds).eye[0] > 0
    for wrong in ({"target": (0, -4, 0)}, {"up": (0, 1, 0)}, {"fovy_deg": 180}, {"eye": (0, 0)}, {"eye": "abc"}, {"eye": (np.nan, 0, 0)}):
        with pytest.raises((subvol.InvalidInput, TypeError)):
            subvol.Camera(**{"eye": (0, -4, 0), "target": (0, 0, 0), **wrong})


def decoded(png):
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    at, parts = 8, {}
    while at < len(png):
        size, kind = struct.unpack(">I4s", png[at:at + 8])
        body = png[at + 8:at + 8 + size]
        assert struct.unpack(">I", png[at + 8 + size:at + 12 + size])[0] == zlib.crc32(kind + body)
        parts[kind] = body
        at += 12 + size
    width, height = struct.unpack(">II", parts[b"IHDR"][:8])
    rows = np.frombuffer(zlib.decompress(parts[b"IDAT"]), np.uint8).reshape(height, 1 + 3 * width)
    return rows[:, 1:].reshape(height, width, 3)


def test_a_notebook_shows_what_the_file_has(tmp_path, ball):
    image = subvol.render(ball, size=(20, 10))
    image.write(tmp_path / "a.png")
    shown = decoded(image._repr_png_())
    assert shown.shape == (10, 20, 3)
    back = np.asarray(subvol.read_image(tmp_path / "a.png"))
    expected = subvol.Image((shown / 255.0).astype("f8"))
    linear = np.where(np.asarray(expected) <= 0.04045, np.asarray(expected) / 12.92, ((np.asarray(expected) + .055) / 1.055) ** 2.4)
    assert back[..., :3] == pytest.approx(linear[..., :3], abs=2e-3)
    assert decoded(image.png((1, 0, 0)))[0, 0].tolist() == [255, 0, 0]


def test_pictures_are_compared():
    rng = np.random.default_rng(0)
    a = rng.random((24, 32, 4)).astype("f4")
    b = a.copy()
    b[12, 16, 0] += .5
    same, different = subvol.compare(a, a), subvol.compare(a, subvol.Image(b))
    assert same.psnr == np.inf and same.mse == 0 and same.ssim == pytest.approx(1) and same.flip == 0
    assert different.max == pytest.approx(.5) and different.mse == pytest.approx(.25 / (24 * 32 * 3), rel=1e-5)
    assert different.rmse == pytest.approx(different.mse ** .5) and different.ssim < 1 and different.ssim_linear < 1 and different.flip > 0
    assert different.ssim_map.shape == (24, 32) and different.flip_map[12, 16] > 0
    assert different.heatmap().height == 24 + 30
    assert subvol.compare(a[..., :3], a).psnr == np.inf
    for wrong in (a[1:], np.zeros((24, 32)), np.zeros((24, 32, 2)), np.zeros((24, 32, 4), int), np.zeros((0, 3, 4)), "picture", None):
        with pytest.raises((subvol.InvalidInput, TypeError)):
            subvol.compare(a, wrong)


def test_parts_of_pictures_are_compared_where_they_overlap(tmp_path, command):
    whole = tmp_path / "whole.exr"
    command("render", "model:ball:3", "-o", whole, "--size", "48x40", "--look", "volume")
    for part in (1, 2):
        command("render", "model:ball:3", "-o", tmp_path / f"{part}.exr", "--size", "48x40", "--look", "volume", "--part", f"{part}/2")
    one, two, all_rows = (subvol.read_image(path) for path in (tmp_path / "1.exr", tmp_path / "2.exr", whole))
    assert all_rows.data_window == all_rows.display_window == one.display_window == (0, 0, 48, 40)
    assert one.data_window == (0, 0, 48, one.height) and two.data_window == (0, one.height, 48, 40 - one.height)
    for call in (subvol.compare, subvol.compare_images):
        with pytest.raises(subvol.InvalidInput, match="no pixel in common"):
            call(one, two)
    for part in (one, two):
        for a, b in ((part, all_rows), (all_rows, part)):
            same = subvol.compare(a, b)
            assert same.max == 0 and same.flip == 0 and same.ssim_map.shape == (part.height, 48) and same.heatmap().width == 48
    # The windows are kept in files and in pickles; an array has none.
    two.write(tmp_path / "again.exr")
    for again in (subvol.read_image(tmp_path / "again.exr"), pickle.loads(pickle.dumps(two))):
        assert again.data_window == two.data_window and again.display_window == two.display_window
        with pytest.raises(subvol.InvalidInput, match="no pixel in common"):
            subvol.compare(one, again)
    with pytest.raises(subvol.InvalidInput, match="display window"):
        subvol.compare(one, np.asarray(one))


def test_infinite_pixels_are_white_and_no_numbers_black(tmp_path):
    row = np.array([np.inf, np.nan, 3e38, -1], "f4")
    picture = np.repeat(row[None, :, None], 3, axis=2)
    subvol.write_image(picture, tmp_path / "a.png")
    back = np.asarray(subvol.read_image(tmp_path / "a.png"))
    assert back[0, :, :3].tolist() == [[1] * 3, [0] * 3, [1] * 3, [0] * 3]


def test_fields_are_compared(cube):
    doubled = subvol.HexMesh(cube.points, cube.cells, {"x": 2 * cube.fields["x"]})
    difference = subvol.compare(doubled, cube, field="x", samples=20_000)
    assert difference.l1 == pytest.approx(.5, abs=.01) and difference.linf <= 1 + 1e-9
    assert difference.l2 == pytest.approx(3 ** -.5, abs=.01)
    assert difference.gradient_rmse == pytest.approx(1, abs=1e-6) and difference.uncovered == 0
    assert subvol.compare(cube, cube, field="x", samples=100).linf == 0
    assert np.isnan(subvol.compare(cube, cube, field="x", samples=100, gradients=False).gradient_rmse)


def test_coverage_says_how_much_of_the_reference_was_compared(cube):
    quarter = subvol.HexMesh(cube.points * [.25, 1, 1], cube.cells, {"x": cube.points[:, 0] * .25})
    part = subvol.compare(quarter, cube, field="x", samples=2000)
    # The pieces of the limit are 32-bit floats, which keep 7 digits of x.
    assert part.linf < 1e-7 and part.coverage == part.samples / 2000 == pytest.approx(.25, abs=.05)
    assert subvol.compare(cube, quarter, field="x", samples=200).coverage == 1
    assert f"{part.samples} of 2000" in repr(part)
    far = subvol.HexMesh(cube.points + 50, cube.cells, {"x": cube.fields["x"]})
    none = subvol.compare_fields(far, cube, field="x", samples=100)
    assert none.samples == 0 and none.coverage == 0 and np.isnan([none.l1, none.l2, none.linf, none.gradient_rmse]).all()


def test_other_things_than_fields_are_refused(cube):
    with pytest.raises(subvol.InvalidInput):
        subvol.compare(cube, np.zeros((2, 2, 4)))
    with pytest.raises(subvol.InvalidInput):
        subvol.compare(cube, cube, samples=0)


def test_colours_of_a_second_channel(ball, ball_points):
    both = subvol.RbfVolume(ball_points.centers, ball_points.frames,
                            {"a": ball_points.values["density"], "b": ball_points.centers[:, 0].astype("f4")}, kernel=ball_points.kernel,
                            boundary=ball_points.boundary)
    one = np.asarray(subvol.render(both, field="a", size=(32, 32), backend="cpu"))
    two = np.asarray(subvol.render(both, field="a", color_field="b", size=(32, 32), backend="cpu"))
    assert one[..., 3] == pytest.approx(two[..., 3], abs=2e-3)
    assert not np.allclose(one[..., :3], two[..., :3], atol=.01)


def test_what_cannot_be_drawn(ball, ball_points, cube):
    for what, options in [(ball_points, {"method": "tets"}), (ball, {"method": "grid"}), (ball, {"method": "tets", "shade": True}),
                          (ball, {"size": (0, 5)}), (ball, {"size": (5, 70000)}), (ball, {"samples": 0}), (ball, {"samples": 17}),
                          (ball, {"levels": -1}), (ball, {"levels": 11}), (ball, {"opacity_unit": -1}), (ball, {"sheets": -5}),
                          (subvol.as_field(cube, "x"), {})]:
        with pytest.raises((subvol.InvalidInput, TypeError)):
            subvol.render(what, **options)
    with pytest.raises(TypeError):
        subvol.render("ball.vtu")


def test_colours_by_keywords_are_those_of_a_transfer_function(ball):
    named = np.asarray(subvol.render(ball, size=(32, 32), tf="plasma", range="-.5,.5", opacity="0%:0,100%:.6", backend="cpu"))
    tf = subvol.TransferFunction("plasma", range=(-.5, .5), opacity="0%:0,100%:.6")
    assert np.array_equal(named, np.asarray(subvol.render(ball, size=(32, 32), tf=tf, backend="cpu")))
    with pytest.raises(subvol.InvalidInput, match="range: has no effect with a TransferFunction"):
        subvol.render(ball, size=(8, 8), tf=tf, range="0,1")
    with pytest.raises(subvol.InvalidInput, match="range: '5,3' is not ascending"):
        subvol.render(ball, size=(8, 8), range="5,3")


@pytest.mark.parametrize("method", ["splat", "tets", "dense"])
def test_rays_end_where_another_program_has_drawn(method):
    block = grid_of(3)
    camera = subvol.Camera((.5, -2, .5), (.5, 0, .5), (0, 0, 1), ortho_height=1.5)
    options = dict(method=method, camera=camera, size=(40, 30), tf=opaque(), opacity_unit=1)
    ends = np.full((30, 40), np.inf)
    ends[:, 20:] = 2.25  # a quarter of the block
    image = np.asarray(subvol.render(block, ray_ends=ends, **options))
    assert np.array_equal(image[:, :20], np.asarray(subvol.render(block, **options))[:, :20])
    assert image[15, 25, 3] == pytest.approx(1 - .5 ** .25, abs=2e-3)  # splats sum halves of floats
    for wrong, message in [(ends.T, r"ray_ends: has the shape \(40, 30\)"), (ends[1:], "there are 1160 depths"),
                           (ends * np.nan, "not a number")]:
        with pytest.raises(subvol.InvalidInput, match=message):
            subvol.render(block, ray_ends=wrong, **options)


def test_a_camera_object_is_its_text(ball):
    camera = subvol.Camera((5.2, -8.4, 4.2), (0, .1, 0), (0, 0, 1), 33.3)
    drawn = np.asarray(subvol.render(ball, size=(32, 24), camera=camera, backend="cpu"))
    assert np.array_equal(drawn, np.asarray(subvol.render(ball, size=(32, 24), camera=camera.text, backend="cpu")))
    near = np.asarray(subvol.render(ball, size=(32, 24), camera=camera, fit=True, backend="cpu"))
    assert (near[..., 3] > 0).sum() > (drawn[..., 3] > 0).sum()  # the ball fills more of the picture
    with pytest.raises(subvol.InvalidInput, match="view: cannot be given with camera|camera"):
        subvol.render(ball, size=(8, 8), camera=camera, view="+x")


def test_scales_bands_and_isosurfaces_are_those_of_the_command(tmp_path, command):
    mesh = subvol.model("ball", 2)
    for given in {"bands": 4, "tf": "Cool to Warm"}, {"symlog": .1}, {"iso": "40%,80%"}, {"range": ".1,.6", "below": "blue", "above": "#ff00ff", "log": True}:
        words = [word for name, value in given.items() for word in ([f"--{name}"] if value is True else [f"--{name}", str(value)])]
        command("render", "model:ball:2", "-o", tmp_path / "a.exr", "--size", "40x30", *words)
        drawn = subvol.render(mesh, size=(40, 30), **given)
        np.testing.assert_array_equal(drawn, subvol.read_image(tmp_path / "a.exr"))
        assert not np.array_equal(drawn, subvol.render(mesh, size=(40, 30)))
    with pytest.raises(subvol.InvalidInput, match="opacity"):
        subvol.render(mesh, iso=1, opacity="0:1", size=(8, 8))


def test_a_transparent_png_keeps_its_alpha(tmp_path):
    image = subvol.render(subvol.model("ball", 2), look="volume", size=(40, 30))
    subvol.write_image(image, tmp_path / "a.png", "none")
    again = np.asarray(subvol.read_image(tmp_path / "a.png"))
    np.testing.assert_allclose(again[..., 3], np.asarray(image)[..., 3], atol=1 / 255)
    np.testing.assert_allclose(again[..., :3], np.asarray(image)[..., :3], atol=.02)
    with pytest.raises(subvol.InvalidInput, match="transparent"):
        subvol.write_image(image, tmp_path / "a.jpg", "none")


def test_opacities_of_parts_are_of_solids(ball):
    for wrong, words in (({"look": "volume"}, "surfaces of a solid"), ({"opacity": "0%:.2"}, "surfaces of a solid"), ({"streamlines": "grad(density)"}, "streamlines: goes through a whole body"),
                         ({"scheme": "tetoct"}, "hexahedra")):
        with pytest.raises(subvol.InvalidInput, match=words):
            subvol.render(ball, size=(8, 8), part_opacity="half:0,0,0,1,0,0=.3", **wrong)
    with pytest.raises(subvol.InvalidInput, match="part_opacity: there is no set"):
        subvol.render(ball, size=(8, 8), part_opacity=["casing=.3"])
    with pytest.raises(subvol.InvalidInput, match="part_opacity: needs a mesh"):
        subvol.render(subvol.sample(ball), size=(8, 8), part_opacity="half:0,0,0,1,0,0=.3")


def test_tubes_leave_no_gaps_in_an_opaque_body(ball):
    for clip in ((0, 0, 0, 0, 1, 0), (0, 0, 0, 0, -1, 0)):
        options = {"size": (120, 90), "look": "solid", "clip": clip, "field": "density"}
        body = np.asarray(subvol.render(ball, **options))
        tubes = np.asarray(subvol.render(ball, streamlines="grad(density)", seeds="box:-.6,-.6,-.6,.6,.6,.6", tube_radius=.01, **options))
        assert np.abs(tubes - body).max() > .1, "some lie before the body"
        lost = body[..., 3] - tubes[..., 3]
        assert lost.max() <= .25 + 1e-6 and (lost > 1e-3).sum() <= 4, "at most one of four samples, where a tube goes through the surface"


def srgb_bytes(linear):
    """The transfer function of IEC 61966-2-1, in bytes."""
    linear = np.clip(linear.astype("f8"), 0, 1)
    return np.round(255 * np.where(linear <= .0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - .055))


def test_a_picture_as_srgb_is_what_a_png_has(tmp_path, ball):
    ramp = np.zeros((16, 4096, 3), "f4")
    ramp[..., 0] = np.arange(16 * 4096).reshape(16, 4096) / (16 * 4096 - 1)  # fine steps, so that each byte is met near its bounds
    ramp[..., 1] = ramp[..., 0] ** 4
    ramp[..., 2] = 1 - ramp[..., 0]
    shown = subvol.Image(ramp).to_srgb()
    assert shown.dtype == np.uint8 and shown.shape == ramp.shape and shown.flags.writeable
    # Half a step of a byte is where rounding changes: 1e-6 of them lie within the rounding of a 32-bit float.
    assert np.abs(shown - srgb_bytes(ramp)).max() <= 1 and np.count_nonzero(shown != srgb_bytes(ramp)) < 10
    image = subvol.render(ball, size=(40, 30))
    for background in (None, (.2, .4, .6), "none"):
        image.write(tmp_path / "a.png", background)
        pixels = plt_read(tmp_path / "a.png")
        assert np.array_equal(pixels[..., :image.to_srgb(background).shape[2]], image.to_srgb(background))
    rgba, behind = np.asarray(image), np.array([.2, .4, .6])
    over = rgba[..., :3] + (1 - rgba[..., 3:]) * behind
    assert np.abs(image.to_srgb(behind) - srgb_bytes(over)).max() <= 1
    some = rgba[..., 3] > 0
    clear = image.to_srgb("none")
    assert clear.shape == (30, 40, 4) and np.array_equal(clear[..., 3], np.round(255 * rgba[..., 3].astype("f8")))
    assert np.abs(clear[some][:, :3] - srgb_bytes(rgba[some][:, :3] / rgba[some][:, 3:])).max() <= 1
    for wrong in ("blue", (1, 2), (np.nan, 0, 0)):
        with pytest.raises(subvol.InvalidInput, match="background"):
            image.to_srgb(wrong)


def plt_read(path):
    """The bytes of a .png, by a reader that is not ours."""
    image = pytest.importorskip("PIL.Image")
    return np.asarray(image.open(path))
