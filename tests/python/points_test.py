# SPDX-License-Identifier: Apache-2.0
"""Volumes of kernels."""
import json
import struct
import zipfile

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


def ply_table(path):
    """The vertices of a binary .ply of kernels, read without the library."""
    head, _, body = path.read_bytes().partition(b"end_header\n")
    lines = head.decode().split("\n")
    start = next(k for k, line in enumerate(lines) if line.startswith("element vertex"))
    names = []
    for line in lines[start + 1:]:
        if not line.startswith("property"):
            break
        _, kind, name = line.split()
        names.append((name, {"double": "<f8", "float": "<f4"}[kind]))
    return np.frombuffer(body, np.dtype(names), int(lines[start].split()[2]))


def columns(table, *names):
    return np.stack([table[name] for name in names], -1)


def test_kernels_of_the_command_are_arrays_of_numpy(tmp_path, command):
    for options in ([], ["--correction", "full", "--per-edge", "2"]):
        command("points", "model:ball:3", "-o", tmp_path / "k.npz", *options)
        command("points", "model:ball:3", "-o", tmp_path / "k.ply", *options)
        command("points", "model:ball:3", "-o", tmp_path / "k.svk", *options)
        table = ply_table(tmp_path / "k.ply")
        with np.load(tmp_path / "k.npz", allow_pickle=False) as k:
            assert np.array_equal(k["centers"], columns(table, "x", "y", "z")) and k["centers"].dtype == np.float64
            assert np.array_equal(k["frames"], columns(table, "sxx", "sxy", "sxz", "syy", "syz", "szz")) and k["frames"].dtype == np.float32
            assert k["channels"].tolist() == [b"density"]
            assert np.array_equal(k["values"], [table["value"]]) and np.array_equal(k["moments"], [table["moment"]])
            assert np.array_equal(k["gradients"], [columns(table, "gx", "gy", "gz")])
            assert ("hessians" in k) == bool(options)
            if options:
                assert np.array_equal(k["hessians"], [columns(table, "hxx", "hxy", "hxz", "hyy", "hyz", "hzz")])
            assert json.loads(k["kernel"].item())["type"] == "compact"
            corners = k["boundary_points"][k["boundary_triangles"]]
            assert np.array_equal(k["bounds"], [corners.min((0, 1)), corners.max((0, 1))])
            volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
            assert volume == pytest.approx(4 / 3 * np.pi, rel=.15)  # outward, of a ball of radius 1
            library = subvol.read_points(tmp_path / "k.svk")
            assert np.array_equal(k["centers"], library.centers) and np.array_equal(k["values"][0], library.values["density"])
        again = subvol.read_points(tmp_path / "k.npz")
        assert again.kernel == library.kernel and np.array_equal(again.frames, library.frames)
        assert np.array_equal(again.gradients["density"], library.gradients["density"]) and set(again.hessians) == set(library.hessians)
        assert np.array_equal(again.boundary[0], library.boundary[0]) and np.array_equal(again.boundary[1], library.boundary[1])


def test_arrays_of_kernels_written_by_python(tmp_path, ball_points):
    given = subvol.RbfVolume(ball_points.centers, ball_points.frames,
                             {"Dichte ρ/ρ₀": ball_points.values["density"], "b": np.arange(len(ball_points))}, kernel=ball_points.kernel)
    subvol.write_points(given, tmp_path / "a.npz")
    subvol.write_points(given, tmp_path / "b.npz")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    assert zipfile.ZipFile(tmp_path / "a.npz").testzip() is None
    arrays = np.load(tmp_path / "a.npz")
    assert [name.decode() for name in arrays["channels"]] == ["Dichte ρ/ρ₀", "b"]
    assert arrays["values"][1].tolist() == list(range(len(given))) and arrays["boundary_triangles"].shape == (0, 3)
    again = subvol.read_points(tmp_path / "a.npz")
    assert list(again.values) == ["Dichte ρ/ρ₀", "b"] and np.array_equal(again.centers, given.centers)

    kept = dict(arrays)
    for name, change in (("missing", {"frames": None}), ("short", {"values": kept["values"][:, :3]}), ("texts", {"centers": np.array(["a"])}),
                         ("objects", {"channels": np.array([b"a", {}], object)})):
        made = {key: value for key, value in {**kept, **change}.items() if value is not None}
        np.savez(tmp_path / f"{name}.npz", **made)
        with pytest.raises(subvol.InvalidInput, match=f"{name}.npz"):
            subvol.read_points(tmp_path / f"{name}.npz")
    (tmp_path / "cut.npz").write_bytes((tmp_path / "a.npz").read_bytes()[:5000])
    (tmp_path / "text.npz").write_text("no archive")
    damaged = bytearray((tmp_path / "a.npz").read_bytes())
    damaged[1000] ^= 255
    (tmp_path / "damaged.npz").write_bytes(damaged)
    for name in ("cut", "text", "damaged"):
        with pytest.raises(subvol.InvalidInput, match=f"{name}.npz"):
            subvol.read_points(tmp_path / f"{name}.npz")
    with pytest.raises(subvol.FileError, match="no such file"):
        subvol.read_points(tmp_path / "none.npz")
    with pytest.raises(subvol.InvalidInput, match="only .ply files"):
        subvol.write_points(given, tmp_path / "c.npz", ascii=True)


def glb_arrays(path):
    """The attributes of the only primitive of a .glb file, its JSON, and the world's matrix of its node."""
    data = path.read_bytes()
    magic, version, size, length, kind = struct.unpack("<4sIII4s", data[:20])
    assert (magic, version, size, kind) == (b"glTF", 2, len(data), b"JSON")
    file, rest = json.loads(data[20:20 + length]), data[20 + length:]
    assert struct.unpack("<I4s", rest[:8]) == (file["buffers"][0]["byteLength"], b"BIN\0") and len(rest) - 8 == file["buffers"][0]["byteLength"]
    arrays = {}
    for name, index in file["meshes"][0]["primitives"][0]["attributes"].items():
        accessor = file["accessors"][index]
        view = file["bufferViews"][accessor["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        assert accessor["componentType"] == 5126 and view["byteLength"] == 4 * width * accessor["count"]
        arrays[name.removeprefix("KHR_gaussian_splatting:")] = np.frombuffer(rest[8:], "<f4", width * accessor["count"], view["byteOffset"]).reshape(-1, width)
        if "min" in accessor:
            assert np.array_equal(arrays["POSITION"].min(0), np.float32(accessor["min"])) and np.array_equal(arrays["POSITION"].max(0), np.float32(accessor["max"]))
    return arrays, file


def matrices_of(quaternions):
    x, y, z, w = np.asarray(quaternions, float).T
    return np.moveaxis(np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                                 [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                                 [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]), -1, 0)


def test_splats_of_gltf_are_the_kernels(tmp_path, command):
    command("points", "model:nozzle:6", "-o", tmp_path / "k.npz")
    command("points", "model:nozzle:6", "-o", tmp_path / "k.ply", "--splats")
    kernels, ply = np.load(tmp_path / "k.npz", allow_pickle=False), ply_table(tmp_path / "k.ply")
    for up, to_y in (None, [[1, 0, 0], [0, 0, 1], [0, -1, 0]]), ("y", np.eye(3)), ("x", [[0, -1, 0], [1, 0, 0], [0, 0, 1]]):
        command("points", "model:nozzle:6", "-o", tmp_path / "k.glb", *(["--splats", "--up", up] if up else []))
        splats, file = glb_arrays(tmp_path / "k.glb")
        primitive, node = file["meshes"][0]["primitives"][0], file["nodes"][0]
        assert file["extensionsUsed"] == ["KHR_gaussian_splatting"] and primitive["mode"] == 0
        assert primitive["extensions"]["KHR_gaussian_splatting"] == {"kernel": "ellipse", "colorSpace": "srgb_rec709_display"}
        turn = matrices_of([node["rotation"]])[0]
        assert np.allclose(turn, to_y)
        assert np.allclose(splats["POSITION"] @ turn.T + node["translation"], kernels["centers"] @ np.transpose(to_y), atol=1e-6)
        # The covariance is the kernel's frame times a number that is the same for all.
        assert np.allclose(np.linalg.norm(splats["ROTATION"], axis=1), 1, atol=1e-6)
        spread = matrices_of(splats["ROTATION"]) * splats["SCALE"][:, None, :]
        covariance = spread @ spread.transpose(0, 2, 1)
        frames = kernels["frames"].astype(float)[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3)
        factor = np.trace(covariance, axis1=1, axis2=2) / np.trace(frames, axis1=1, axis2=2)
        assert np.ptp(factor) < 1e-5 * factor.mean()
        assert np.abs(covariance - factor[:, None, None] * frames).max() < 1e-5 * np.abs(covariance).max()
        # Scale and opacity are those of the .ply without its logarithms; colours are the same.
        assert np.allclose(splats["SCALE"], np.exp(columns(ply, "scale_0", "scale_1", "scale_2")), rtol=1e-5)
        assert np.allclose(splats["OPACITY"][:, 0], 1 / (1 + np.exp(-ply["opacity"].astype(float))), atol=1e-6)
        assert np.array_equal(splats["SH_DEGREE_0_COEF_0"], columns(ply, "f_dc_0", "f_dc_1", "f_dc_2"))
        screen = np.clip(.5 + .28209479177387814 * splats["SH_DEGREE_0_COEF_0"].astype(float), 0, 1)
        linear = np.where(screen <= .04045, screen / 12.92, ((screen + .055) / 1.055)**2.4)
        assert np.allclose(splats["COLOR_0"], linear, atol=1e-6)


def test_splats_of_gltf_written_by_python(tmp_path, ball_points):
    subvol.write_points(ball_points, tmp_path / "a.glb")
    assert len(glb_arrays(tmp_path / "a.glb")[0]["POSITION"]) == len(ball_points)
    with pytest.raises(subvol.InvalidInput, match="only .ply"):
        subvol.write_points(ball_points, tmp_path / "b.glb", ascii=True)
    with pytest.raises(subvol.InvalidInput):
        subvol.read_points(tmp_path / "a.glb")
    assert [path.name for path in tmp_path.iterdir()] == ["a.glb"]
