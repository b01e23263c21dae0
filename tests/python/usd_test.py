# SPDX-License-Identifier: Apache-2.0
"""OpenUSD as text."""
import re
import subprocess
import sys

import numpy as np
import pytest
import subvol
from subvol.usd import write_usd


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
        elif made := re.match(r"(?:custom )?(?:rel|[\w\[\]]+) ([\w:]+) = (.*)", line):
            found["/".join(path)][made[1]] = made[2] if path else None
    assert not path
    return found


def test_a_volume_names_the_grids_of_its_file(tmp_path, ball):
    twice = subvol.HexMesh(ball.points, ball.cells, {"density": ball.fields["density"], "2 x": 2 * ball.fields["density"]})
    (tmp_path / "grids").mkdir()
    grids = subvol.write_vdb(twice, tmp_path / "grids" / "ball.vdb", resolution=20, fields=["density", "2 x"])
    write_usd(tmp_path / "1 ball.usda", tmp_path / "grids" / "ball.vdb", tf="plasma")
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
    write_usd(tmp_path / "a.usda", [tmp_path / "a3.vdb", tmp_path / "a5.vdb"], codes=[3, 5])
    text = (tmp_path / "a.usda").read_text()
    assert re.search(r"filePath\.timeSamples = \{\s*3: @\./a3\.vdb@,\s*5: @\./a5\.vdb@,\s*\}", text)
    assert "startTimeCode = 3" in text and "endTimeCode = 5" in text


def test_grids_whose_names_no_prim_may_have(tmp_path, ball):
    field = ball.fields["density"]
    odd = subvol.HexMesh(ball.points, ball.cells, {"a b": field, "a_b": field, 'say "x"': field})
    subvol.write_vdb(odd, tmp_path / "a@1.vdb", resolution=10, fields=list(odd.fields))
    write_usd(tmp_path / "a.usda", tmp_path / "a@1.vdb")
    text = (tmp_path / "a.usda").read_text()
    made = re.findall(r'def OpenVDBAsset "(\w+)"', text)
    assert len(set(made)) == 3 and made == re.findall(r"rel field:(\w+) =", text)
    assert text.count("@@@./a@1.vdb@@@") == 3
    for name in re.findall(r"token fieldName = (.*)", text):
        assert re.fullmatch(r'"(?:[^"\\]|\\.)*"', name), name


def test_what_is_no_stage_is_refused(tmp_path, ball):
    subvol.write_vdb(ball, tmp_path / "a.vdb", resolution=10)
    with pytest.raises(subvol.InvalidInput, match="unknown extension"):
        write_usd(tmp_path / "a.usdc", tmp_path / "a.vdb")
    with pytest.raises(subvol.InvalidInput, match="there are 2 for 1 files"):
        write_usd(tmp_path / "a.usda", tmp_path / "a.vdb", codes=[1, 2])
    with pytest.raises(subvol.InvalidInput, match="there are 2 for 2 files"):
        write_usd(tmp_path / "a.usda", [tmp_path / "a.vdb"] * 2, codes=[2, 1])
    with pytest.raises(subvol.FileError):
        write_usd(tmp_path / "a.usda", tmp_path / "b.vdb")
    assert not (tmp_path / "a.usda").exists()


def test_from_the_command_line(tmp_path, ball):
    subvol.write_mesh(ball, tmp_path / "ball.vtu")

    def run(*arguments):
        return subprocess.run([sys.executable, "-m", "subvol.usd", *map(str, arguments)], capture_output=True, text=True)

    done = run(tmp_path / "ball.vtu", "-o", tmp_path / "ball.usda", "--resolution", 12, "--field", "density")
    assert done.returncode == 0 and "1 .vdb file" in done.stdout, done.stderr
    assert "@./ball.vdb@" in (tmp_path / "ball.usda").read_text() and (tmp_path / "ball.vdb").exists()
    assert run(tmp_path / "none.vtu", "-o", tmp_path / "b.usda").returncode == 2
    done = run(tmp_path / "ball.vtu", "-o", tmp_path / "c.usd", "--resolution", 12)
    assert done.returncode == 2 and "unknown extension (.usda)\n" in done.stderr
    assert run(tmp_path / "ball.vtu", "-o", tmp_path / "c.usda", "--resolution", 12, "--tf", "none").returncode == 2
    assert not list(tmp_path.glob("c*"))
    assert "not a range" in run(tmp_path / "ball.vtu", "-o", tmp_path / "b.usda", "--steps", "4-9").stderr
