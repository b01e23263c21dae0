# SPDX-License-Identifier: Apache-2.0
"""Meshes in formats that meshio reads: by `read_mesh`, and by `python3 -m subvol.convert`. A small meshio of our own stands in where the real one is missing."""
import json
import os
import subprocess
import sys
import textwrap

import numpy as np
import pytest
import subvol

# What is used of meshio: a mesh of a cube and a prism beside it, with sets, an array of texts and one of Gauss points.
STAND_IN = '''
import sys
import numpy as np

class Block:
    def __init__(self, kind, data): self.type, self.data = kind, np.array(data)

class Mesh:
    def __init__(self):
        self.points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1], [2, 0, 0], [2, 0, 1]], float)
        self.cells = [Block("hexahedron", [range(8)]), Block("wedge", [[1, 8, 2, 5, 9, 6]])]
        self.point_data = {"T": np.arange(10.0), "names": np.array(list("abcdefghij"))}
        self.cell_data = {"m": [np.array([1]), np.array([2])], "gauss": [np.zeros((1, 8, 6)), np.zeros((1, 6, 6))]}
        self.point_sets, self.cell_sets = {"fixed": [0]}, {}

def read(path, file_format=None):
    if open(path).read() == "bad":
        print("Error: no such mesh")
        sys.exit(1)
    return Mesh()

def write(path, mesh, file_format=None):
    assert file_format == "vtu" and not mesh.point_sets and list(mesh.point_data) == ["T"] and list(mesh.cell_data) == ["m"]
    kinds = {"hexahedron": 12, "wedge": 13}
    array = lambda name, kind, values, more="": f'<DataArray type="{kind}" Name="{name}" format="ascii"{more}>' + " ".join(map(str, values)) + "</DataArray>"
    corners = [p for block in mesh.cells for cell in block.data for p in cell]
    ends = np.cumsum([len(cell) for block in mesh.cells for cell in block.data])
    open(path, "w").write('<VTKFile type="UnstructuredGrid" version="1.0"><UnstructuredGrid><Piece NumberOfPoints="10" NumberOfCells="2"><Points>'
        + array("Points", "Float64", mesh.points.ravel(), ' NumberOfComponents="3"') + "</Points><Cells>" + array("connectivity", "Int64", corners)
        + array("offsets", "Int64", ends) + array("types", "UInt8", [kinds[block.type] for block in mesh.cells]) + "</Cells><PointData>"
        + array("T", "Float64", mesh.point_data["T"]) + "</PointData></Piece></UnstructuredGrid></VTKFile>")
'''


@pytest.fixture
def stand_in(tmp_path, monkeypatch):
    (tmp_path / "packages" / "meshio").mkdir(parents=True)
    (tmp_path / "packages" / "meshio" / "__init__.py").write_text(textwrap.dedent(STAND_IN))
    monkeypatch.syspath_prepend(str(tmp_path / "packages"))
    sys.modules.pop("meshio", None)
    yield tmp_path
    sys.modules.pop("meshio", None)


def run(folder, *words):
    path = os.pathsep.join([str(folder / "packages"), *sys.path])
    return subprocess.run([sys.executable, "-m", "subvol.convert", *map(str, words)], cwd=folder, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": path})


def test_meshio_reads_what_the_library_does_not(stand_in):
    (stand_in / "a.med").write_text("good")
    with pytest.warns(subvol.SubvolWarning) as seen:
        mesh = subvol.read_mesh(stand_in / "a.med")
    assert mesh.report()["volume"] == pytest.approx(1.5) and "T" in mesh.fields
    said = " / ".join(str(w.message) for w in seen)
    assert "read by meshio (Salome)" in said and '2 arrays left out ("names", "gauss")' in said and '1 set left out ("fixed")' in said
    with pytest.raises(subvol.InvalidInput):
        subvol.read_mesh(stand_in / "a.med", other_cells="refuse")
    with pytest.raises(subvol.FileError):
        subvol.read_mesh(stand_in / "none.med")
    (stand_in / "b.med").write_text("bad")
    with pytest.raises(subvol.InvalidInput, match="b.med: meshio cannot read it: Error: no such mesh"):
        subvol.read_mesh(stand_in / "b.med")


def test_contents_that_the_library_knows_are_read_by_it(stand_in, cube):
    subvol.write_mesh(cube, stand_in / "a.vtu")
    (stand_in / "a.vtu").rename(stand_in / "a.dat")
    assert np.array_equal(subvol.read_mesh(stand_in / "a.dat").cells, cube.cells)


def test_convert_writes_a_vtu_that_the_command_reads(stand_in, command):
    (stand_in / "a.med").write_text("good")
    done = run(stand_in, "a.med", "a.vtu")
    assert done.returncode == 0, done.stderr
    assert done.stdout == "a.vtu: 10 points, 1 hexahedron, 1 wedge; fields T, m\n"
    assert "warning: 1 set left out" in done.stderr
    assert json.loads(command("info", stand_in / "a.vtu", "--json"))["volume"] == pytest.approx(1.5)
    assert sorted(p.name for p in stand_in.iterdir()) == ["a.med", "a.vtu", "packages"]
    (stand_in / "b.med").write_text("bad")
    for words, code, text in ((("b.med", "b.vtu"), 2, "meshio cannot read it"), (("a.med", "a.obj"), 2, "meshes are converted to .vtu"),
                              (("none.med", "a.vtu"), 2, "no such file")):
        done = run(stand_in, *words)
        assert done.returncode == code and text in done.stderr, done.stderr


def test_a_missing_package_is_named(stand_in):
    (stand_in / "a.med").write_text("good")
    (stand_in / "packages" / "meshio" / "__init__.py").write_text("raise ModuleNotFoundError('no meshio', name='meshio')")
    done = run(stand_in, "a.med", "a.vtu")
    assert done.returncode == 3 and "Debian has it as python3-meshio" in done.stderr
    with pytest.raises(subvol.MissingCapability):
        subvol.read_mesh(stand_in / "a.med")


@pytest.mark.parametrize("name", ["a.su2", "a.bdf", "a.f3grid", "a.avs"])
def test_the_real_meshio(name, tmp_path, cube):
    meshio = pytest.importorskip("meshio")
    kept = subvol.to_meshio(cube)
    kept.point_data = {}
    try:
        meshio.write(tmp_path / name, kept)
    except Exception as error:  # what meshio itself cannot write
        pytest.skip(f"meshio does not write {name}: {error}")
    with pytest.warns(subvol.SubvolWarning, match="read by meshio"):
        mesh = subvol.read_mesh(tmp_path / name)
    assert mesh.report()["cells"] == 27 and mesh.report()["volume"] == pytest.approx(1, rel=1e-6)


def test_the_command_names_the_same_endings(tmp_path):
    """Each ending that meshio reads gets the line that converts it."""
    program = os.environ.get("SUBVOL_COMMAND")
    if not program:
        pytest.skip("SUBVOL_COMMAND does not name the command")
    from subvol import _foreign
    for ending in _foreign.EXTENSIONS:
        (tmp_path / f"a{ending}").write_text("x")
        done = subprocess.run([program, "info", str(tmp_path / f"a{ending}")], capture_output=True, text=True)
        assert done.returncode == 2 and f"python3 -m subvol.convert a{ending} mesh.vtu" in done.stderr, done.stderr
