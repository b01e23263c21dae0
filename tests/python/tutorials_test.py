# SPDX-License-Identifier: Apache-2.0
"""The scripts of examples/python, and the 25 lines that the interface was designed from."""
import importlib.util
import json
import os
import pathlib
import re
import subprocess
import sys
import types

import numpy as np
import pytest
import subvol

TOP = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = sorted((TOP / "examples/python").glob("[0-9]*.py"))
LINES = '''
import numpy as np, subvol
mesh = subvol.read_mesh("part.vtk")                          # InvalidInput says file and line
same = subvol.HexMesh(mesh.points, mesh.cells, fields={"T": mesh.fields["T"]})   # (n,3) float64, (m,8) ints
fine = subvol.subdivide(mesh, levels=2, scheme="mcq")
values, inside = subvol.evaluate(mesh, "T", at=np.zeros((1, 3)))
points = subvol.sample(mesh, field="T", per_edge=2)
tf = subvol.TransferFunction("viridis", range=(300, 900), opacity=[(300, 0), (900, .5)])
image = subvol.render(points, view="iso", size=(512, 512), tf=tf); rgba = np.asarray(image)   # (512,512,4) float32, no copy
subvol.write_vdb(mesh, "part.vdb", resolution=400, fields=["T"])
table = subvol.Refinement(mesh, levels=1)                    # topology once
for t, step in subvol.open_series("run.pvd"): fine = table.apply(step)
print(subvol.compare(image, subvol.render(mesh, method="tets", view="iso", tf=tf)).psnr)
'''


def write_legacy(mesh, path):
    cells = np.insert(mesh.cells, 0, 8, axis=1)
    with open(path, "w") as file:
        file.write(f"# vtk DataFile Version 3.0\npart\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {len(mesh.points)} double\n")
        np.savetxt(file, mesh.points, "%.17g")
        file.write(f"CELLS {len(cells)} {cells.size}\n")
        np.savetxt(file, cells, "%d")
        file.write(f"CELL_TYPES {len(cells)}\n" + "12\n" * len(cells))
        file.write(f"POINT_DATA {len(mesh.points)}\nSCALARS T double 1\nLOOKUP_TABLE default\n")
        np.savetxt(file, mesh.fields["T"], "%.17g")


def test_the_lines(tmp_path, monkeypatch, capsys):
    ball = subvol.model("ball", 4)
    mesh = subvol.HexMesh(ball.points, ball.cells, {"T": 600 + 300 * ball.fields["density"]})
    monkeypatch.chdir(tmp_path)
    write_legacy(mesh, "part.vtk")
    subvol.write_mesh(mesh, "run_0.vtu")
    (tmp_path / "run.pvd").write_text('<VTKFile type="Collection"><Collection><DataSet timestep="2.5" file="run_0.vtu"/>'
                                      "</Collection></VTKFile>")
    found = {}
    exec(LINES, found)
    assert np.array_equal(found["same"].cells, found["mesh"].cells)
    assert found["inside"][0] and 300 < found["values"][0] < 900
    assert found["rgba"].shape == (512, 512, 4) and found["rgba"].dtype == np.float32
    assert np.shares_memory(found["rgba"], np.asarray(found["image"]))
    assert len(found["fine"].cells) == 8 * len(mesh.cells)
    assert (tmp_path / "part.vdb").stat().st_size > 1_000_000
    assert float(capsys.readouterr().out) > 35  # level 1 against the limit


@pytest.mark.parametrize("script", EXAMPLES, ids=lambda path: path.stem)
def test_the_tutorials_run(tmp_path, script):
    if "matplotlib" in script.read_text():
        if importlib.util.find_spec("matplotlib") is None:
            pytest.skip("matplotlib is not installed")
    done = subprocess.run([sys.executable, str(script), "96"], cwd=tmp_path, capture_output=True, text=True,
                          env={**os.environ, "MPLBACKEND": "Agg"})
    assert done.returncode == 0, done.stderr
    assert list(tmp_path.iterdir()), "it writes a file"


def test_the_notebooks_are_those_of_the_scripts():
    assert len(EXAMPLES) == len(list((TOP / "examples/python").glob("*.ipynb"))) == 5
    subprocess.run([sys.executable, TOP / "scripts/notebooks", "--check"], check=True)


@pytest.mark.parametrize("script", EXAMPLES, ids=lambda path: path.stem)
def test_the_notebooks_run(tmp_path, monkeypatch, script):
    cells = [cell for cell in json.loads(script.with_suffix(".ipynb").read_text())["cells"] if cell["cell_type"] == "code"]
    if "".join(cells[0]["source"]) in script.read_text() and len(cells) == 1:
        return  # the script itself, which has been run
    shown = []
    monkeypatch.setitem(sys.modules, "IPython", types.SimpleNamespace(get_ipython=lambda: None))
    monkeypatch.setitem(sys.modules, "IPython.display", types.SimpleNamespace(
        display=lambda *pictures: shown.extend(picture._repr_png_() for picture in pictures),
        Image=lambda name: shown.append(pathlib.Path(name).read_bytes())))
    monkeypatch.chdir(tmp_path)
    variables = {}
    for cell in cells:
        exec(re.sub(r"^size = \d+", "size = 96", "".join(cell["source"]), flags=re.M), variables)
    assert list(tmp_path.glob("*.png"))
    assert shown and all(picture.startswith(b"\x89PNG") for picture in shown)
