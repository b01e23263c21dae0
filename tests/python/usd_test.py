# SPDX-License-Identifier: Apache-2.0
"""OpenUSD as text."""
import re

import numpy as np
import pytest
import subvol
from subvol import write_usd


def prims(text):
    """The prims of a stage by their paths, with their attributes: what this text has of USDA."""
    found, path, name = {}, [], ""
    for line in text.splitlines():
        line = line.strip()
        if made := re.match(r'def (\w+) "(\w+)"', line):
            name = made[2]
            found["/".join([*path, name])] = {"type": made[1]}
        elif line == "{":
            path.append(name)
        elif line == "}":
            path.pop()
        elif made := re.match(r"(?:custom |uniform )?(?:rel|[\w\[\]]+) ([\w:]+) = (.*)", line):
            found["/".join(path)][made[1]] = made[2] if path else None
    assert not path
    return found


def test_a_volume_names_the_grids_of_its_file(tmp_path, ball):
    twice = subvol.HexMesh(ball.points, ball.cells, {"density": ball.fields["density"], "2 x": 2 * ball.fields["density"]})
    (tmp_path / "grids").mkdir()
    grids = subvol.write_vdb(twice, tmp_path / "grids" / "ball.vdb", resolution=20, fields=["density", "2 x"])
    write_usd(tmp_path / "grids" / "ball.vdb", tmp_path / "1 ball.usda", tf="plasma")
    text = (tmp_path / "1 ball.usda").read_text()
    stage = prims(text)
    volume = stage["_1_ball/volume"]
    assert volume["type"] == "Volume" and volume["field:density"] == "</_1_ball/volume/density>"
    for grid, prim in zip(grids, ["density", "_2_x"]):
        field = stage[f"_1_ball/volume/{prim}"]
        assert field["type"] == "OpenVDBAsset" and field["filePath"] == "@./grids/ball.vdb@" and field["fieldName"] == f'"{grid["name"]}"'
    extent = np.array(eval(volume["extent"]))
    assert np.allclose(extent, ball.bounds, atol=1e-6)
    assert len(eval(volume["subvol:colors"])) == len(eval(volume["subvol:colorValues"])) > 1
    assert float(volume["subvol:opacityUnit"]) == pytest.approx(np.linalg.norm(extent[1] - extent[0]) / 100)
    assert not list(tmp_path.glob("*.part"))


def test_steps_are_time_samples(tmp_path, ball):
    for step in (3, 5):
        subvol.write_vdb(ball, tmp_path / f"a{step}.vdb", resolution=10)
    write_usd([tmp_path / "a3.vdb", tmp_path / "a5.vdb"], tmp_path / "a.usda", codes=[3, 5])
    text = (tmp_path / "a.usda").read_text()
    assert re.search(r"filePath\.timeSamples = \{\s*3: @\./a3\.vdb@,\s*5: @\./a5\.vdb@,\s*\}", text)
    assert "startTimeCode = 3" in text and "endTimeCode = 5" in text


def test_grids_whose_names_no_prim_may_have(tmp_path, ball):
    field = ball.fields["density"]
    odd = subvol.HexMesh(ball.points, ball.cells, {"a b": field, "a_b": field, 'say "x"': field})
    subvol.write_vdb(odd, tmp_path / "a@1.vdb", resolution=10, fields=list(odd.fields))
    write_usd(tmp_path / "a@1.vdb", tmp_path / "a.usda")
    text = (tmp_path / "a.usda").read_text()
    made = re.findall(r'def OpenVDBAsset "(\w+)"', text)
    assert len(set(made)) == 3 and made == re.findall(r"rel field:(\w+) =", text)
    assert text.count("@@@./a@1.vdb@@@") == 3
    for name in re.findall(r"token fieldName = (.*)", text):
        assert re.fullmatch(r'"(?:[^"\\]|\\.)*"', name), name


def rows(text):
    return np.array(eval(text))


def test_kernels_are_gaussian_splats(tmp_path, ball):
    """The Gaussians of the .ply with splats, without its logarithms, and unturned."""
    kernels = subvol.sample(ball)
    write_usd(kernels, tmp_path / "a.usda")
    splats = prims((tmp_path / "a.usda").read_text())["a/splats"]
    assert splats["type"] == "ParticleField3DGaussianSplat" and splats["radiance:sphericalHarmonicsDegree"] == "0"
    assert np.allclose(rows(splats["positions"]), kernels.centers, rtol=1e-6, atol=1e-6)
    assert np.allclose(rows(splats["subvol:value:density"]), kernels.values["density"])
    axes, turned = rows(splats["scales"]), rows(splats["orientations"])
    assert np.allclose(np.linalg.norm(turned, axis=1), 1, atol=1e-6)
    w, x, y, z = turned.T
    first = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)], 1)  # where the rotation takes the x-axis
    xx, xy, xz, yy, yz, zz = kernels.frames.T
    frames = np.stack([np.stack([xx, xy, xz], 1), np.stack([xy, yy, yz], 1), np.stack([xz, yz, zz], 1)], 1)
    along = np.sqrt(np.einsum("ni,nij,nj->n", first, frames, first))  # the support along the longest axis
    assert np.allclose(axes[:, 0] / along, axes[0, 0] / along[0], rtol=1e-4)
    opacities = rows(splats["opacities"])
    values = kernels.values["density"]
    assert np.allclose(opacities, np.maximum(0.5 * (values - values.min()) / np.ptp(values), 1 / 255), atol=1e-5)
    colors = 0.5 + 0.28209479 * rows(splats["radiance:sphericalHarmonicsCoefficients"])
    assert colors.min() > -1e-6 and colors.max() < 1 + 1e-6
    extent = rows(splats["extent"])
    assert (extent[0] < kernels.centers.min(0)).all() and (extent[1] > kernels.centers.max(0)).all()
    write_usd([kernels, subvol.sample(ball, per_edge=2)], tmp_path / "b.usda", codes=[1, 4])
    assert re.search(r"positions\.timeSamples = \{\s*1: \[\(", (tmp_path / "b.usda").read_text())
    with pytest.raises(subvol.InvalidInput, match="of volumes"):
        write_usd(kernels, tmp_path / "c.usda", opacity_unit=1)


def test_a_stage_says_which_axis_is_up(tmp_path, ball):
    subvol.write_vdb(ball, tmp_path / "a.vdb", resolution=8)
    for what in (tmp_path / "a.vdb", subvol.sample(ball)):
        subvol.write_usd(what, tmp_path / "a.usda", up="y")
        assert '\n    upAxis = "Y"\n' in (tmp_path / "a.usda").read_text()
        with pytest.raises(subvol.InvalidInput, match="y or z"):
            subvol.write_usd(what, tmp_path / "a.usda", up="x")
    with pytest.raises(subvol.InvalidInput, match="up"):
        subvol.write_usd(tmp_path / "a.vdb", tmp_path / "a.usda", up="w")


def test_what_is_no_stage_is_refused(tmp_path, ball):
    subvol.write_vdb(ball, tmp_path / "a.vdb", resolution=10)
    with pytest.raises(subvol.InvalidInput, match="unknown extension"):
        write_usd(tmp_path / "a.vdb", tmp_path / "a.usdc")
    with pytest.raises(subvol.InvalidInput, match="there are 2 for 1 files"):
        write_usd(tmp_path / "a.vdb", tmp_path / "a.usda", codes=[1, 2])
    with pytest.raises(subvol.InvalidInput, match="ascending"):
        write_usd([tmp_path / "a.vdb"] * 2, tmp_path / "a.usda", codes=[2, 1])
    with pytest.raises(subvol.FileError):
        write_usd(tmp_path / "b.vdb", tmp_path / "a.usda")
    assert not (tmp_path / "a.usda").exists()
