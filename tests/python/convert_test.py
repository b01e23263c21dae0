# SPDX-License-Identifier: Apache-2.0
"""Meshes in formats that meshio or VTK reads: by `read_mesh`, and by `python3 -m subvol.convert`. A small meshio of our own stands in where the real one is missing."""
import importlib.util
import json
import os
import re
import subprocess
import sys
import textwrap
import warnings

import numpy as np
import pytest
import subvol
from foreign_texts import fluent, gambit, ls_dyna, nastran, tecplot, tecplot_zones, ucd

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


def test_the_command_and_the_package_have_the_same_endings(tmp_path):
    """A file with each of these endings is read by meshio or VTK, which refuse it, or are said to be missing."""
    program = os.environ.get("SUBVOL_COMMAND")
    if not program:
        pytest.skip("SUBVOL_COMMAND does not name the command")
    from subvol import _foreign
    for ending in _foreign.EXTENSIONS:
        (tmp_path / f"a{ending}" if ending.startswith(".") else tmp_path / ending).write_text("x")
        name = f"a{ending}" if ending.startswith(".") else ending
        done = subprocess.run([program, "info", name], capture_output=True, text=True, cwd=tmp_path)
        assert done.returncode in (2, 3) and name in done.stderr and re.search("meshio|VTK|h5py", done.stderr), done.stderr


def broken(folder, text):
    """meshio, which ends or hangs."""
    (folder / "packages" / "meshio" / "__init__.py").write_text(text)


def test_a_reader_that_crashes_is_a_sentence(stand_in):
    (stand_in / "a.med").write_text("good")
    broken(stand_in, "import os, signal\ndef read(path, file_format=None): os.kill(os.getpid(), signal.SIGSEGV)\n")
    with pytest.raises(subvol.InvalidInput, match="a.med: meshio ended by signal 11 while it read the file"):
        subvol.read_mesh(stand_in / "a.med")
    done = run(stand_in, "a.med", "a.vtu")
    assert done.returncode == 2 and "meshio ended by signal 11" in done.stderr
    assert sorted(p.name for p in stand_in.iterdir()) == ["a.med", "packages"]


def test_a_reader_that_hangs_is_ended(stand_in):
    (stand_in / "a.med").write_text("good")
    broken(stand_in, "def read(path, file_format=None):\n    while True: pass\n")
    program = os.path.join(os.path.dirname(subvol.__file__), "_foreign_file.py")
    path = os.pathsep.join([str(stand_in / "packages"), *sys.path])
    done = subprocess.run([sys.executable, program, "a.med", "a.vtu", "--limit", "1"], cwd=stand_in, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": path})
    assert done.returncode == 2 and "meshio did not end within 1 second while" in json.loads(done.stdout)["message"], done.stderr
    assert sorted(p.name for p in stand_in.iterdir()) == ["a.med", "packages"]


def without_meshio(folder, monkeypatch):
    (folder / "none" / "meshio").mkdir(parents=True)
    (folder / "none" / "meshio" / "__init__.py").write_text("raise ModuleNotFoundError('no meshio', name='meshio')")
    monkeypatch.syspath_prepend(str(folder / "none"))


def read_quietly(path, **options):
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        mesh = subvol.read_mesh(path, **options)
    return mesh, " / ".join(str(w.message) for w in seen)


def check_cube(mesh, side=2.0):
    assert mesh.report()["cells"] == 8 and mesh.report()["volume"] == pytest.approx(side**3, rel=1e-6)
    assert mesh.report()["inverted_cells"] == 0
    if "T" in mesh.fields:
        assert mesh.fields["T"] == pytest.approx(mesh.points @ [1, 2, 3], abs=1e-6)
    if "q" in mesh.cell_fields:  # a cell of number q is at x, y, z: its bits
        centres = mesh.points[mesh.cells].mean(axis=1)
        assert mesh.cell_fields["q"].ravel() == pytest.approx((centres // 1) @ [1, 2, 4])


@pytest.mark.parametrize("name", ["a.bdf", "a.tec", "a.avs"])
def test_files_with_known_volume_and_values_by_meshio(name, tmp_path):
    pytest.importorskip("meshio")
    (tmp_path / name).write_text({".bdf": nastran, ".tec": tecplot, ".avs": ucd}[os.path.splitext(name)[1]]())
    mesh, said = read_quietly(tmp_path / name)
    assert "read by meshio" in said and "not read" in said
    check_cube(mesh)
    assert name == "a.bdf" or "T" in mesh.fields


def test_vtk_reads_where_meshio_is_missing(tmp_path, monkeypatch):
    pytest.importorskip("vtkmodules")
    without_meshio(tmp_path, monkeypatch)
    for name, text in (("a.tec", tecplot()), ("a.avs", ucd())):
        (tmp_path / name).write_text(text)
        mesh, said = read_quietly(tmp_path / name)
        assert "read by VTK" in said and "single precision" in said
        check_cube(mesh)
        assert "T" in mesh.fields and "q" in mesh.cell_fields


def test_vtk_reads_all_zones_of_tecplot(tmp_path):
    pytest.importorskip("vtkmodules")
    (tmp_path / "a.dat").write_text(tecplot_zones())
    mesh, said = read_quietly(tmp_path / "a.dat")
    assert mesh.report()["cells"] == 16 and mesh.report()["volume"] == pytest.approx(16)
    assert '2 blocks are numbered in the field "block": 0 "z0", 1 "z1"' in said
    assert mesh.fields["T"] == pytest.approx(mesh.points @ [1, 2, 3], abs=1e-6)
    assert np.array_equal(mesh.cell_fields["block"].ravel() == 1, mesh.points[mesh.cells].mean(axis=1)[:, 0] > 2)


def test_vtk_reads_gambit_and_fluent(tmp_path):
    pytest.importorskip("vtkmodules")
    (tmp_path / "a.neu").write_text(gambit())
    mesh, said = read_quietly(tmp_path / "a.neu")
    assert "(Gambit)" in said
    check_cube(mesh)
    case, data = fluent()
    (tmp_path / "a.cas").write_text(case)
    mesh, said = read_quietly(tmp_path / "a.cas")
    assert "there is no file .dat of the same name" in said
    check_cube(mesh)
    (tmp_path / "a.dat").write_text(data)
    mesh, said = read_quietly(tmp_path / "a.cas")
    check_cube(mesh)
    centres = mesh.points[mesh.cells].mean(axis=1)
    assert mesh.cell_fields["TEMPERATURE"].ravel() == pytest.approx(300 + (centres // 1) @ [1, 2, 4])


def test_vtk_reads_steps_of_ls_dyna(tmp_path):
    pytest.importorskip("vtkmodules")
    for name, data in zip(("d3plot", "d3plot01"), ls_dyna()):
        (tmp_path / name).write_bytes(data)
    for options, step in (({}, 1), ({"step": 0}, 0), ({"step": 1}, 1), ({"time": .2}, 0)):
        mesh, said = read_quietly(tmp_path / "d3plot", **options)
        check_cube(mesh, 2 * (1 + step))
        assert mesh.fields["Velocity"] == pytest.approx(10 * step / (1 + step) * mesh.points, abs=1e-5)
        centres = mesh.points[mesh.cells].mean(axis=1) / (1 + step)
        assert mesh.cell_fields["Stress"][:, 0] == pytest.approx((centres // 1) @ [1, 2, 4])
        assert "(LS-DYNA)" in said
    with pytest.raises(subvol.InvalidInput, match="there is no step 2: steps are 0 to 1"):
        subvol.read_mesh(tmp_path / "d3plot", step=2)
    done = run(tmp_path, "d3plot", "a.vtu", "--step", 0)
    assert done.returncode == 0 and "8 hexahedron" in done.stdout and "step 0 of 0 to 1, time 0" in done.stdout, done.stderr


def test_truncated_files_end_with_a_sentence(tmp_path):
    pytest.importorskip("vtkmodules")
    files = {"a.neu": gambit().encode(), "a.cas": fluent()[0].encode(), "a.dat": tecplot_zones().encode(), "d3plot": ls_dyna()[0]}
    for name, data in files.items():
        for part in (.2, .45, .8):
            (tmp_path / name).write_bytes(data[:int(part * len(data.rstrip(bytes(1))))])
            with pytest.raises(subvol.InvalidInput, match=name) as error:
                read_quietly(tmp_path / name)
            assert "VTK" in str(error.value)
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(files)


def test_binary_files_of_tecplot_are_named(tmp_path):
    if not any(map(importlib.util.find_spec, ("meshio", "vtkmodules"))):
        pytest.skip("neither meshio nor VTK is installed")
    (tmp_path / "a.plt").write_bytes(b"#!TDV112" + bytes(100))
    with pytest.raises(subvol.InvalidInput, match="a.plt: .*binary"):
        subvol.read_mesh(tmp_path / "a.plt")
