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
from foreign_texts import floats, fluent, gambit, line, lines, ls_dyna, nastran, tecplot, tecplot_zones, ucd, CELLS, POINTS, T

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
    meshio = pytest.importorskip("meshio", reason="Debian's python3-meshio is not installed")
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
    pytest.importorskip("meshio", reason="Debian's python3-meshio is not installed")
    (tmp_path / name).write_text({".bdf": nastran, ".tec": tecplot, ".avs": ucd}[os.path.splitext(name)[1]]())
    mesh, said = read_quietly(tmp_path / name)
    assert "read by meshio" in said and "not read" in said
    check_cube(mesh)
    assert name == "a.bdf" or "T" in mesh.fields


def test_vtk_reads_where_meshio_is_missing(tmp_path, monkeypatch):
    pytest.importorskip("vtkmodules", reason="Debian's python3-vtk9 is not installed")
    without_meshio(tmp_path, monkeypatch)
    for name, text in (("a.tec", tecplot()), ("a.avs", ucd())):
        (tmp_path / name).write_text(text)
        mesh, said = read_quietly(tmp_path / name)
        assert "read by VTK" in said and "single precision" in said
        check_cube(mesh)
        assert "T" in mesh.fields and "q" in mesh.cell_fields


def test_vtk_reads_all_zones_of_tecplot(tmp_path):
    pytest.importorskip("vtkmodules", reason="Debian's python3-vtk9 is not installed")
    (tmp_path / "a.dat").write_text(tecplot_zones())
    mesh, said = read_quietly(tmp_path / "a.dat")
    assert mesh.report()["cells"] == 16 and mesh.report()["volume"] == pytest.approx(16)
    assert '2 blocks are numbered in the field "block": 0 "z0", 1 "z1"' in said
    assert mesh.fields["T"] == pytest.approx(mesh.points @ [1, 2, 3], abs=1e-6)
    assert np.array_equal(mesh.cell_fields["block"].ravel() == 1, mesh.points[mesh.cells].mean(axis=1)[:, 0] > 2)


def test_vtk_reads_gambit_and_fluent(tmp_path):
    pytest.importorskip("vtkmodules", reason="Debian's python3-vtk9 is not installed")
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
    pytest.importorskip("vtkmodules", reason="Debian's python3-vtk9 is not installed")
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
    pytest.importorskip("vtkmodules", reason="Debian's python3-vtk9 is not installed")
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


def refused(path, match, **options):
    with pytest.raises(subvol.InvalidInput, match=match):
        read_quietly(path, **options)


def fe_zone(shift=0., head="", rows=None):
    """A zone of bricks, moved along x."""
    rows = [*zip(*((x + shift, y, z) for x, y, z in POINTS)), T] if rows is None else rows
    return f"ZONE NODES=27, ELEMENTS=8, DATAPACKING=BLOCK, ZONETYPE=FEBRICK{head}\n" + lines(rows) + lines(CELLS)


VARIABLES = 'VARIABLES = "X" "Y" "Z" "T"\n'


def test_tecplot_that_vtk_misreads_is_refused(tmp_path, monkeypatch):
    pytest.importorskip("vtkmodules", reason="Debian's python3-vtk9 is not installed")
    without_meshio(tmp_path, monkeypatch)
    path = tmp_path / "a.dat"
    path.write_text(VARIABLES + fe_zone() + fe_zone(2, ', T="27*5.5 VARSHARELIST" # 3*4'))
    mesh, _ = read_quietly(path)
    assert mesh.report()["volume"] == pytest.approx(16)
    far = "# padding\n" * 150_000  # more than a MiB before the second zone
    path.write_text(VARIABLES + fe_zone() + far + fe_zone(0, ", VARSHARELIST=([1-3]=1)", [T]))
    refused(path, "zone 2 has VARSHARELIST")
    path.write_text(VARIABLES + fe_zone() + fe_zone(2, ",\nconnectivitysharezone = 1").replace(lines(CELLS), "", 0))
    refused(path, "zone 2 has CONNECTIVITYSHAREZONE")
    path.write_text(VARIABLES + fe_zone().replace(line(T), "27*5.5\n"))
    refused(path, r'line 6 has the repeat count "27\*5.5"')
    path.write_text(tecplot().replace("([5]=CELLCENTERED)", "([1-4]=NODAL,\n [5]=CELLCENTERED)"))
    refused(path, "zone 1 lists NODAL and CELLCENTERED")


def test_steps_of_tecplot_do_not_lie_on_each_other(tmp_path):
    pytest.importorskip("vtkmodules", reason="Debian's python3-vtk9 is not installed")
    path = tmp_path / "a.dat"
    path.write_text(VARIABLES + "".join(fe_zone(0, f", STRANDID=1, SOLUTIONTIME={time}") for time in (0, 1.5)))
    refused(path, "SOLUTIONTIME 0.0, 1.5")
    path.write_text(VARIABLES + fe_zone() + fe_zone())
    refused(path, "have the same points and cells")
    path.write_text(VARIABLES + "".join(fe_zone(2 * k, f", STRANDID={k + 1}, SOLUTIONTIME=1.5") for k in (0, 1)))
    mesh, _ = read_quietly(path)
    assert mesh.report()["volume"] == pytest.approx(16)


def test_truncated_tecplot_behind_a_zone_without_volume(tmp_path):
    pytest.importorskip("vtkmodules", reason="Debian's python3-vtk9 is not installed")
    flat = 'ZONE T="flat", I=9, J=9, K=1, F=POINT\n' + lines((x, y, 0, 7) for y in range(9) for x in range(9))
    whole = VARIABLES + flat + fe_zone()
    (tmp_path / "a.dat").write_text(whole)
    mesh, said = read_quietly(tmp_path / "a.dat")
    assert mesh.report()["volume"] == pytest.approx(8) and "1 block without volume left out" in said
    (tmp_path / "a.dat").write_text(whole[:-len(lines(CELLS[4:]))])
    refused(tmp_path / "a.dat", "ends too early")
    (tmp_path / "a.dat").write_text(whole[:-len(" 27\n")])
    refused(tmp_path / "a.dat", "ends too early: it has 495 numbers, and its points, cells and values are 496")


def test_steps_of_ls_dyna_with_one_time_are_refused(tmp_path):
    pytest.importorskip("vtkmodules", reason="Debian's python3-vtk9 is not installed")
    root, states = ls_dyna()
    (tmp_path / "d3plot").write_bytes(root)
    (tmp_path / "d3plot01").write_bytes(states.replace(floats([[.5]]), floats([[0]]), 1))
    refused(tmp_path / "d3plot", "step 1 has the time 0, by which VTK does not find it")
    mesh, said = read_quietly(tmp_path / "d3plot", time=0)
    check_cube(mesh)
    assert "2 steps have the time 0; the first of them, step 0, is read" in said


def test_steps_are_not_ignored(tmp_path):
    pytest.importorskip("meshio", reason="Debian's python3-meshio is not installed")
    (tmp_path / "a.bdf").write_text(nastran())
    done = run(tmp_path, "a.bdf", "a.vtu", "--step", 7)
    assert done.returncode == 2 and "there is no step 7: it has one step, number 0" in done.stderr
    done = run(tmp_path, "a.bdf", "a.vtu", "--time", 3)
    assert done.returncode == 0 and "the file has one step, so there is no time to choose" in done.stderr
    pytest.importorskip("vtkmodules", reason="Debian's python3-vtk9 is not installed")
    for name, data in zip(("d3plot", "d3plot01"), ls_dyna()):
        (tmp_path / name).write_bytes(data)
    assert "the file has 2 steps; the last one is read" in read_quietly(tmp_path / "d3plot")[1]
    assert "the last one" not in read_quietly(tmp_path / "d3plot", step=1)[1]
    assert "time 9 is beyond the steps of the file" in read_quietly(tmp_path / "d3plot", time=9)[1]


def test_files_that_are_not_of_mfix(tmp_path):
    pytest.importorskip("vtkmodules", reason="Debian's python3-vtk9 is not installed")
    (tmp_path / "a.res").write_bytes(b"\x7f" * 5000)
    refused(tmp_path / "a.res", 'a.res: .*does not begin with "RES = "')


def test_fluent_is_said_to_be_rounded(tmp_path):
    pytest.importorskip("vtkmodules", reason="Debian's python3-vtk9 is not installed")
    (tmp_path / "a.cas").write_text(fluent()[0])
    assert "single precision" in read_quietly(tmp_path / "a.cas")[1]


def test_blocks_are_joined_with_what_they_have_alike():
    pytest.importorskip("vtkmodules", reason="Debian's python3-vtk9 is not installed")
    from subvol import _foreign_file
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkStructuredGrid

    def grid(shift, widths):
        made = vtkStructuredGrid()
        made.SetDimensions(3, 3, 3)
        points = vtkPoints()
        points.SetData(numpy_to_vtk(np.array(POINTS) + [shift, 0, 0], deep=True))
        made.SetPoints(points)
        for name, width in widths.items():
            values = numpy_to_vtk(np.full((8, width), 5. + shift), deep=True)
            values.SetName(name)
            made.GetCellData().AddArray(values)
        return made

    said = []
    whole = _foreign_file.joined([("a", grid(0, {"block": 1, "u": 3, "m": 1})), ("b", grid(2, {"block": 1, "u": 1, "m": 1}))], said)
    data = whole.GetCellData()
    assert sorted(data.GetArrayName(k) for k in range(data.GetNumberOfArrays())) == ["block", "block_", "m"]
    assert list(vtk_to_numpy(data.GetArray("block"))) == [5] * 8 + [7] * 8 and list(vtk_to_numpy(data.GetArray("block_"))) == [0] * 8 + [1] * 8
    assert '1 array that not all blocks have alike left out ("u")' in said
    short = grid(0, {})
    short.GetCellData().AddArray(numpy_to_vtk(np.zeros(3), deep=True))
    short.GetCellData().GetAbstractArray(0).SetName("short")
    with pytest.raises(_foreign_file.Unreadable, match='array "short" has 3 values'):
        _foreign_file.checked(short)


@pytest.mark.parametrize("vtk", [False, True])
def test_a_full_disk_is_no_fault_of_the_file(vtk, tmp_path, monkeypatch):
    pytest.importorskip("vtkmodules" if vtk else "meshio", reason=f"Debian's python3-{'vtk9' if vtk else 'meshio'} is not installed")
    from subvol import _foreign_file
    if vtk:
        without_meshio(tmp_path, monkeypatch)
    (tmp_path / "a.avs").write_text(ucd())
    path = os.pathsep.join(place for place in sys.path if place)
    words = f"'{sys.executable}' '{_foreign_file.__file__}' a.avs /dev/fd/3 3> /dev/full"
    done = subprocess.run(["sh", "-c", words], cwd=tmp_path, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": path})
    assert done.returncode == 4 and "cannot be written" in json.loads(done.stdout)["message"], done.stdout + done.stderr


@pytest.mark.parametrize("name", ["a.med", "a.h5m", "a.hmf"])
def test_hdf5_files_of_other_programs_reach_meshio(name, stand_in):
    (stand_in / name).write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(200))
    broken(stand_in, "def read(path, file_format=None):\n    raise ValueError('it is ' + open(path, 'rb').read(4)[1:].decode())\n")
    refused(stand_in / name, f"{name}: meshio cannot read it: it is HDF")
