# SPDX-License-Identifier: Apache-2.0
"""Converts a mesh of another program, by meshio or by VTK, into a .vtu file that OpenSubVol reads. A program of its own, for a child process.

    python3 _foreign_file.py SOURCE TARGET.vtu [--format NAME] [--step K | --time T] [--limit SECONDS]
    python3 _foreign_file.py SOURCE --times

        SOURCE -- its name --> row of FORMATS --> routes, one after another, each in a process of its own --> TARGET
                                                    |                                     |
                                                    `- fails, crashes or hangs: the next  `--> one JSON object on standard output

VTK's readers trust the file: of 60 damaged files 7 ended them by a signal and 4 kept them busy for ever. So each route is forked, has a time
limit that the system keeps, and what it prints is held back. `subvol.read_mesh` and `python3 -m subvol.convert` run this file; the command has
its text in itself and gives it to `python3 -c`. It needs nothing but the standard library, and of the packages what a route imports.

The object of a success: "figures", "by", "program", "warnings", "times", "step". The object of a failure: "message", "allowed", "missing" (Debian's
packages). Ends with 0, with 2 if the file cannot be read, with 3 if packages are missing, or with 4 if the target cannot be written.
"""
from __future__ import annotations

import os
import sys

if __name__ == "__main__":  # neither the folder of this file, which has modules named as packages, nor the current one is a place for packages
    _OWN = {"", os.path.dirname(os.path.abspath(__file__)) if "__file__" in globals() else ""}
    sys.path[:] = [place for place in sys.path if place not in _OWN]

import argparse
import contextlib
import hashlib
import importlib
import io
import json
import re
import resource
import signal
import tempfile
from collections.abc import Callable
from typing import Any, Optional

# The formats: the one list of them, which the library reads out of this text, too.
#   endings: of files' names in lower case; one without a point is a whole name
#   program: whose files they are
#   meshio:  its name of the format, "": by the ending; without it meshio does not read them
#   vtk:     module and class of VTK's reader
#   steps:   whether VTK's reader finds several
#   rounds:  whether VTK's reader rounds the file's numbers to single precision
FORMATS: list[dict[str, Any]] = json.loads("""[
  {"endings": [".med"], "program": "Salome", "meshio": "", "packages": ["python3-h5py"]},
  {"endings": [".bdf", ".nas", ".fem"], "program": "Nastran", "meshio": ""},
  {"endings": [".su2"], "program": "SU2", "meshio": ""},
  {"endings": [".f3grid"], "program": "FLAC3D", "meshio": ""},
  {"endings": [".avs", ".ucd"], "program": "AVS UCD", "meshio": "avsucd", "vtk": ["vtkIOGeometry", "vtkAVSucdReader"], "rounds": true},
  {"endings": [".dato", ".post"], "program": "Permas", "meshio": ""},
  {"endings": [".dat", ".tec", ".plt"], "program": "Tecplot", "meshio": "tecplot", "vtk": ["vtkIOGeometry", "vtkTecplotReader"], "rounds": true},
  {"endings": [".ele", ".node"], "program": "TetGen", "meshio": ""},
  {"endings": [".ugrid"], "program": "UGRID", "meshio": ""},
  {"endings": [".vol"], "program": "Netgen", "meshio": ""},
  {"endings": [".mdpa"], "program": "Kratos", "meshio": ""},
  {"endings": [".xml"], "program": "Dolfin", "meshio": ""},
  {"endings": [".h5m"], "program": "MOAB", "meshio": "", "packages": ["python3-h5py"]},
  {"endings": [".hmf"], "program": "HMF", "meshio": "", "packages": ["python3-h5py"]},
  {"endings": ["d3plot", ".d3plot"], "program": "LS-DYNA", "vtk": ["vtkIOLSDyna", "vtkLSDynaReader"], "steps": true},
  {"endings": [".cas"], "program": "Fluent", "vtk": ["vtkIOGeometry", "vtkFLUENTReader"], "rounds": true},
  {"endings": [".neu"], "program": "Gambit", "vtk": ["vtkIOGeometry", "vtkGAMBITReader"]},
  {"endings": [".res"], "program": "MFIX", "vtk": ["vtkIOGeometry", "vtkMFIXReader"], "steps": true, "rounds": true}
]""")
LIMIT_S = 600
BASE_LIMIT_S = 60  # of the clock on the wall: the machine may be busy
BYTES_A_SECOND = 50_000  # meshio reads a million
_VOLUMES = ("tetra", "hexahedron", "wedge", "pyramid", "polyhedron")
_SOME = 5


class Unreadable(Exception):
    """Why a route does not read the file."""


class Unwritable(Exception):
    """Why the target cannot be written."""


def row_of(path: str) -> Optional[dict[str, Any]]:
    """The row of FORMATS with the ending of a file's name; None: there is none."""
    name = os.path.basename(path).lower()
    return next((row for row in FORMATS if os.path.splitext(name)[1] in row["endings"] or name in row["endings"]), None)


def listed(names: list[str]) -> str:
    return ", ".join(f'"{name}"' for name in names[:_SOME]) + (", …" if len(names) > _SOME else "")


def counted(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"


def add_counts(counts: dict[str, int], more: dict[str, int]) -> None:
    for kind, number in more.items():
        counts[kind] = counts.get(kind, 0) + number


def figures(points: int, counts: dict[str, int], fields: list[str]) -> str:
    """"8 points, 1 hexahedron; fields T, U": what was converted."""
    cells = ", ".join(f"{count:,} {kind}" for kind, count in counts.items()) or "no cells"
    return f"{points:,} points, {cells}" + (f"; fields {', '.join(fields)}" if fields else "")


def refuse_without_volume(points: int, counts: dict[str, int]) -> None:
    if not any(kind.startswith(_VOLUMES) for kind in counts):
        raise Unreadable(f"there are no cells with a volume: {figures(points, counts, [])}")


# meshio ---------------------------------------------------------------------------------------------------------------------------------------------


def _numbers(values: Any) -> bool:
    np = importlib.import_module("numpy")
    return np.asarray(values).dtype.kind in "iufb" and np.asarray(values).ndim in (1, 2)


def without_others(mesh: Any) -> list[str]:
    """Leaves the points in three dimensions and arrays of numbers. Returns a warning for each kind of thing that is left out."""
    np = importlib.import_module("numpy")
    if mesh.points.shape[1] < 3:
        mesh.points = np.column_stack([mesh.points, np.zeros((len(mesh.points), 3 - mesh.points.shape[1]))])
    arrays = [name for name, values in mesh.point_data.items() if not _numbers(values)]
    for name in arrays:
        del mesh.point_data[name]
    for name, blocks in list(mesh.cell_data.items()):
        same = all(block is not None and _numbers(block) for block in blocks) and len({np.shape(block)[1:] for block in blocks}) == 1
        if not same:
            arrays.append(name)
            del mesh.cell_data[name]
    sets = [*mesh.point_sets, *mesh.cell_sets]
    families = [name for tags in ("point_tags", "cell_tags") for names in (getattr(mesh, tags, None) or {}).values() for name in names]
    mesh.point_sets, mesh.cell_sets, mesh.field_data = {}, {}, {}
    kinds = (("array", arrays), ("set", sets), ("group", families))
    return [f"{counted(len(names), what)} left out ({listed(list(map(str, names)))})" for what, names in kinds if names]


def zones_of_tecplot(path: str) -> int:
    """The number of zones: meshio reads one. Refuses Tecplot's binary files."""
    with open(path, "rb") as file:
        if file.read(5) == b"#!TDV":
            raise Unreadable("it is Tecplot's binary format, which neither VTK nor meshio reads; export the data as ASCII")
        file.seek(0)
        return sum(1 for line in file if re.match(rb"\s*zone\b", line, re.IGNORECASE))


def bare_line(line: bytes) -> bytes:
    """A line of Tecplot in upper case without its strings and comments."""
    if b'"' in line:
        line = re.sub(rb'"[^"]*"', b'""', line)
    return line.partition(b"#")[0].strip().upper()


def is_data_of_tecplot(line: bytes) -> bool:
    """Whether a line has numbers, not words of a header."""
    return re.match(rb"\s*(?:[-+.]*\d|[-+]?(?:nan|inf))[^=\"(\[)]*$", line, re.IGNORECASE) is not None


def refuse_headers_of_tecplot(path: str, vtk: bool) -> None:
    """Refuses zones of several times, and on VTK's route what VTK takes for something else, wherever it is in the file."""
    times: set[bytes] = set()
    header = b""
    zone = 0

    def refuse_header() -> None:
        if not zone:
            return
        if vtk:
            for word in (b"VARSHARELIST", b"CONNECTIVITYSHAREZONE"):
                if re.search(rb"\b" + word + rb"\b", header):
                    raise Unreadable(f"zone {zone} has {word.decode()}, and VTK does not share data between zones; write each zone with its own data")
            places = re.search(rb"\bVARLOCATION\s*=\s*\(([^)]*)\)?", header)
            if places and b"NODAL" in places[1] and b"CELLCENTERED" in places[1]:
                raise Unreadable(f"zone {zone} lists NODAL and CELLCENTERED in VARLOCATION, which VTK does not read; list those that are CELLCENTERED alone")
        if time := re.search(rb"\bSOLUTIONTIME\s*=\s*([-+.0-9ED]+)", header):
            strand = re.search(rb"\bSTRANDID\s*=\s*([-+]?\d+)", header)
            if strand is None or int(strand[1]) != 0:  # 0: at all times
                with contextlib.suppress(ValueError):
                    times.add(str(float(time[1].replace(b"D", b"E"))).encode())
        if len(times) > 1:
            raise Unreadable(f"its zones are of several times (up to zone {zone}: SOLUTIONTIME {', '.join(sorted(map(bytes.decode, times)))}), which would lie on each other; "
                             "write a file of one time")

    with open(path, "rb") as file:
        for number, line in enumerate(file, 1):
            if vtk and b"*" in line and (word := re.search(rb"(?<![^\s,])\d+\*[-+.\dNI]\S*", bare_line(line))):
                raise Unreadable(f'line {number} has the repeat count "{word[0].decode("ascii", "replace")}", which VTK does not read; write each number')
            if is_data_of_tecplot(line):
                continue
            bare = bare_line(line)
            if re.match(rb"ZONE\b", bare):
                refuse_header()
                header = b""
                zone += 1
            header += bare + b" "
            if len(header) > 1 << 20:
                raise Unreadable(f"the header of zone {zone} does not end")
    refuse_header()


def by_meshio(row: dict[str, Any], source: str, target: str, wanted: argparse.Namespace) -> dict[str, Any]:
    meshio = importlib.import_module("meshio")
    zones = 1
    if row["program"] == "Tecplot" and wanted.format in (None, "tecplot"):
        zones = zones_of_tecplot(source)
        refuse_headers_of_tecplot(source, False)
    warnings: list[str] = []
    chosen_step(wanted, [], warnings)
    version = getattr(meshio, "__version__", "")
    with contextlib.redirect_stdout(io.StringIO()) as said:  # it prints what is wrong, and may end Python
        try:
            mesh = meshio.read(source, file_format=wanted.format or row.get("meshio") or None)
        except ImportError:
            raise
        except (Exception, SystemExit) as error:
            text = str(error) if isinstance(error, Exception) else ""
            raise Unreadable(text or " ".join(said.getvalue().split()) or type(error).__name__) from error
        counts: dict[str, int] = {}
        for block in mesh.cells:
            if len(block.data):
                add_counts(counts, {block.type: len(block.data)})
        refuse_without_volume(len(mesh.points), counts)
        warnings += without_others(mesh)
        if zones > 1:
            warnings.append(f"meshio reads the first of {zones} zones; VTK (Debian: python3-vtk9) reads all")
        try:
            meshio.write(target, mesh, file_format="vtu")
        except OSError as error:
            raise Unwritable(error.strerror or str(error)) from error
        except (Exception, SystemExit) as error:
            raise Unreadable(f"the cells that it finds are wrong: {error}") from error
    fields = list(map(str, [*mesh.point_data, *mesh.cell_data]))
    return {"figures": figures(len(mesh.points), counts, fields), "by": f"meshio {version}".strip(), "left": "sets and steps are", "warnings": warnings}


# VTK ------------------------------------------------------------------------------------------------------------------------------------------------


def vtk_module(name: str) -> Any:
    return importlib.import_module("vtkmodules." + name)


def leaves_of(data: Any) -> list[tuple[str, Any]]:
    """The grids of an output, each with the name of its block."""
    if data is None:
        return []
    if not data.IsA("vtkCompositeDataSet"):
        return [("", data)]
    name_key = vtk_module("vtkCommonDataModel").vtkCompositeDataSet.NAME()
    found = []
    each = data.NewIterator()
    each.InitTraversal()
    while not each.IsDoneWithTraversal():
        about = data.GetMetaData(each) if data.HasMetaData(each) else None
        found.append((about.Get(name_key) or "" if about is not None else "", each.GetCurrentDataObject()))
        each.GoToNextItem()
    return found


def counts_of(grid: Any) -> dict[str, int]:
    """How many cells of each kind a grid has, which is not empty: {"hexahedron": 8}. Those of a structured grid are as its first one."""
    np = importlib.import_module("numpy")
    names = {"Voxel": "hexahedron", "TriQuadraticHexahedron": "hexahedron27", "QuadraticHexahedron": "hexahedron20", "QuadraticTetra": "tetra10",
             "QuadraticWedge": "wedge15", "QuadraticPyramid": "pyramid13", "ConvexPointSet": "polyhedron"}
    kinds, numbers = [grid.GetCellType(0)], [grid.GetNumberOfCells()]
    if grid.IsA("vtkUnstructuredGrid"):
        kinds, numbers = np.unique(vtk_module("util.numpy_support").vtk_to_numpy(grid.GetCellTypesArray()), return_counts=True)
    counts: dict[str, int] = {}
    for kind, number in zip(kinds, numbers):
        name = vtk_module("vtkCommonDataModel").vtkCellTypes.GetClassNameFromTypeId(int(kind)).removeprefix("vtk")
        add_counts(counts, {names.get(name, name.lower()): int(number)})
    return counts


def with_volume(leaves: list[tuple[str, Any]], warnings: list[str]) -> tuple[list[tuple[str, Any]], dict[str, int]]:
    """The blocks with cells that have a volume, and how many cells they have. Warns of the others; refuses an output of these alone."""
    blocks = [(name, grid) for name, grid in leaves if grid is not None and grid.IsA("vtkDataSet") and grid.GetNumberOfCells()]
    counts: dict[str, int] = {}
    left: dict[str, int] = {}
    volumes, names = [], []
    for name, grid in blocks:
        here = counts_of(grid)
        if any(kind.startswith(_VOLUMES) for kind in here):
            volumes.append((name, grid))
            add_counts(counts, here)
        else:
            names.append(name)
            add_counts(left, here)
    if not volumes:
        refuse_without_volume(sum(grid.GetNumberOfPoints() for _, grid in blocks), left)
    if left:
        cells = ", ".join(f"{number:,} {kind}" for kind, number in left.items())
        warnings.append(f"{counted(len(names), 'block')} without volume left out ({listed([name or 'without name' for name in names])}): {cells}")
    return volumes, counts


def joined(volumes: list[tuple[str, Any]], warnings: list[str]) -> Any:
    """One grid of all blocks, which share no points, with the arrays that all have alike. Of several, a field has their numbers."""
    theirs = {key for _, grid in volumes for key in arrays_of(grid)}
    field = "block"
    while any(name == field for _, name in theirs):
        field += "_"
    if len(volumes) > 1:
        names = ", ".join(f'{number} "{name}"' for number, (name, _) in enumerate(volumes[:_SOME])) + (", …" if len(volumes) > _SOME else "")
        warnings.append(f'{len(volumes)} blocks are numbered in the field "{field}": {names}')
    append = vtk_module("vtkFiltersCore").vtkAppendFilter()
    append.MergePointsOff()
    for number, (_, grid) in enumerate(volumes):
        single = grid.NewInstance()
        single.ShallowCopy(grid)
        for where, name in [key for key in arrays_of(grid) if not all(alike(grid, other, key) for _, other in volumes)]:
            getattr(single, "Get" + where)().RemoveArray(name)
        if len(volumes) > 1:
            numbers = vtk_module("vtkCommonCore").vtkIntArray()
            numbers.SetName(field)
            numbers.SetNumberOfTuples(grid.GetNumberOfCells())
            numbers.Fill(number)
            single.GetCellData().AddArray(numbers)
        append.AddInputData(single)
    append.Update()
    whole = append.GetOutput()
    left = sorted({name for _, name in theirs - set(arrays_of(whole))})
    if left:
        warnings.append(f"{counted(len(left), 'array')} that not all blocks have alike left out ({listed(left)})")
    return whole


def alike(grid: Any, other: Any, key: tuple[str, str]) -> bool:
    """Whether two blocks have an array with the same number of components."""
    here, there = arrays_of(grid)[key], arrays_of(other).get(key)
    return there is not None and here.GetNumberOfComponents() == there.GetNumberOfComponents()


def refuse_copies(blocks: list[tuple[str, Any]]) -> None:
    """Refuses blocks with the same points and cells: steps, which would lie on each other."""
    seen: dict[bytes, str] = {}
    for number, (name, grid) in enumerate(blocks):
        told = f'{number} "{name}"'
        parts = [grid.GetPoints().GetData()]
        if grid.IsA("vtkUnstructuredGrid"):
            parts += [grid.GetCells().GetConnectivityArray(), grid.GetCellTypesArray()]
        marks = hashlib.sha256()
        for part in parts:
            marks.update(vtk_module("util.numpy_support").vtk_to_numpy(part).tobytes())
        if (first := seen.setdefault(marks.digest(), told)) is not told:
            raise Unreadable(f"blocks {first} and {told} have the same points and cells, as steps have, and would lie on each other; write a file of one step")


def arrays_of(grid: Any) -> dict[tuple[str, str], Any]:
    found = {}
    for where in ("PointData", "CellData"):
        data = getattr(grid, "Get" + where)()
        for number in range(data.GetNumberOfArrays()):
            array = data.GetAbstractArray(number)
            if array.GetName():
                found[where, array.GetName()] = array
    return found


def checked(grid: Any) -> None:
    """Refuses cells of points that there are not, and points or cells without a number: a reader that came to the end of the file too early."""
    np = importlib.import_module("numpy")
    numpy_support = vtk_module("util.numpy_support")
    if grid.GetNumberOfPoints() == 0:
        raise Unreadable("there are no points")
    points = numpy_support.vtk_to_numpy(grid.GetPoints().GetData())
    if not np.isfinite(points).all():
        raise Unreadable("there are points that are not finite")
    corners = numpy_support.vtk_to_numpy(grid.GetCells().GetConnectivityArray()) if grid.IsA("vtkUnstructuredGrid") else np.zeros(0, int)
    if len(corners) and not (0 <= corners.min() and corners.max() < len(points)):
        raise Unreadable(f"there are cells of points 0 to {max(abs(int(corners.min())), int(corners.max()))}, but only {len(points):,} points")
    for (where, name), array in arrays_of(grid).items():
        if array.GetNumberOfTuples() != (grid.GetNumberOfPoints() if where == "PointData" else grid.GetNumberOfCells()):
            raise Unreadable(f'array "{name}" has {array.GetNumberOfTuples():,} values, which is not one for each')


def in_order_of_vtk(grid: Any) -> None:
    """Gambit counts the corners of a brick as rows, 0 1 / 2 3; VTK 9 takes them as a ring. The order with the larger volume is the right one."""
    np = importlib.import_module("numpy")
    numpy_support = vtk_module("util.numpy_support")
    kinds = numpy_support.vtk_to_numpy(grid.GetCellTypesArray())
    starts = numpy_support.vtk_to_numpy(grid.GetCells().GetOffsetsArray())[:-1][kinds == 12]
    if not len(starts):
        return
    points = numpy_support.vtk_to_numpy(grid.GetPoints().GetData())
    corners = numpy_support.vtk_to_numpy(grid.GetCells().GetConnectivityArray())  # VTK's own memory
    rings = corners[starts[:, None] + np.arange(8)]
    turned = rings[:, [0, 1, 3, 2, 4, 5, 7, 6]]

    def volume(cells: Any) -> float:
        at = points[cells]
        middle = at.mean(1)
        sides = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
        total = np.zeros(len(cells))
        for side in sides:
            centre = at[:, side].mean(1)
            for a, b in zip(side, side[1:] + side[:1]):
                total += np.einsum("ij,ij->i", np.cross(at[:, a] - middle, at[:, b] - middle), centre - middle) / 6
        return float(np.abs(total).sum())

    if volume(turned) > volume(rings):
        corners[starts[:, None] + np.arange(8)] = turned


def numbers_in(path: str, tecplot: bool) -> int:
    """The words of a text that are numbers; of Tecplot those that are not in headers or comments."""
    with open(path, "rb") as file:
        lines = (line.partition(b"#")[0] for line in file if is_data_of_tecplot(line)) if tecplot else file
        return sum(len(re.findall(rb"(?<![^\s,])(?:[-+.0-9][-+.0-9ed]*|[-+]?(?:nan|inf|infinity))(?![^\s,])", line.lower())) for line in lines)


def refuse_short_text(row: dict[str, Any], source: str, grids: list[Any]) -> None:
    """Refuses a text with fewer words than what was read of it has numbers: VTK goes on with what happens to be in memory."""
    if row["program"] not in ("Tecplot", "AVS UCD", "Gambit"):
        return
    needed = 0
    for grid in grids:
        needed += 3 * grid.GetNumberOfPoints() + (grid.GetCells().GetConnectivityArray().GetNumberOfValues() if grid.IsA("vtkUnstructuredGrid") else 0)
        needed += sum(a.GetNumberOfTuples() * a.GetNumberOfComponents() for a in arrays_of(grid).values() if row["program"] != "Gambit")
        if row["program"] == "AVS UCD":  # numbers of points and cells before what they have
            needed += grid.GetNumberOfPoints() * (1 + (grid.GetPointData().GetNumberOfArrays() > 0)) + grid.GetNumberOfCells() * (1 + (grid.GetCellData().GetNumberOfArrays() > 1))
    have = numbers_in(source, row["program"] == "Tecplot")
    if have < needed:
        raise Unreadable(f"the file ends too early: it has {have:,} numbers, and its points, cells and values are {needed:,}")
    if row["program"] == "Gambit":
        with open(source, "rb") as file:
            text = file.read()
        if text.count(b"ENDOFSECTION") < len(re.findall(rb"^ *(?:CONTROL INFO|NODAL COORD|ELEMENTS/CELLS|ELEMENT GROUP|BOUNDARY COND)", text, re.MULTILINE)):
            raise Unreadable("the file ends too early: a section has no ENDOFSECTION")


def refuse_open_end(path: str) -> None:
    """Refuses a case of Fluent that does not end with the end of a section."""
    with open(path, "rb") as file:
        file.seek(max(os.path.getsize(path) - 4096, 0))
        if not file.read().rstrip().endswith(b")"):
            raise Unreadable("the file ends too early: its last section has no end")


def refuse_other_file(row: dict[str, Any], source: str) -> None:
    """Refuses a file that does not begin as MFIX's do: its reader reserves as much memory as it finds in it."""
    if row["program"] == "MFIX":
        with open(source, "rb") as file:
            if file.read(6) != b"RES = ":
                raise Unreadable('it does not begin with "RES = ", as the files .res of MFIX do')


def refuse_unsure_step(times: list[float], step: int, warnings: list[str]) -> None:
    """VTK finds a step by its time: the first one that is not before it."""
    found = next((k for k, time in enumerate(times) if time >= times[step]), None)
    if found != step:
        others = f"step {found}, of time {times[found]:g}, is found before it" if found is not None else "it is no number"
        raise Unreadable(f"step {step} has the time {times[step]:g}, by which VTK does not find it: {others}; choose another step (--step)")
    if (same := times.count(times[step])) > 1:
        warnings.append(f"{same} steps have the time {times[step]:g}; the first of them, step {step}, is read")


def chosen_step(wanted: argparse.Namespace, times: list[float], warnings: list[str]) -> int:
    """The step that is wanted, of those with these times, or of a file with one step."""
    if wanted.time is not None and len(times) < 2:
        warnings.append("the file has one step, so there is no time to choose")
    elif wanted.time is not None and not min(times) <= float(wanted.time) <= max(times):
        warnings.append(f"time {wanted.time:g} is beyond the steps of the file, whose times are {min(times):g} to {max(times):g}")
    if wanted.time is not None and times:
        return min(range(len(times)), key=lambda k: abs(times[k] - float(wanted.time)))
    if wanted.step is None:
        return max(len(times) - 1, 0)
    if not 0 <= wanted.step < max(len(times), 1):
        raise Unreadable(f"there is no step {wanted.step}: " + (f"steps are 0 to {len(times) - 1}" if len(times) > 1 else "it has one step, number 0"))
    return int(wanted.step)


def by_vtk(row: dict[str, Any], source: str, target: str, wanted: argparse.Namespace) -> dict[str, Any]:
    numpy_support = vtk_module("util.numpy_support")  # needs numpy
    core, pipeline = vtk_module("vtkCommonCore"), vtk_module("vtkCommonExecutionModel")
    if row["program"] == "Tecplot":
        zones_of_tecplot(source)
        refuse_headers_of_tecplot(source, True)
    refuse_other_file(row, source)
    if row["program"] == "Fluent":
        refuse_open_end(source)
    module, name = row["vtk"]
    reader = getattr(vtk_module(module), name)()
    reader.SetFileName(source)
    errors: list[str] = []

    def keep(_reader: Any, _event: str, text: str) -> None:
        errors.append(text)

    keep.CallDataType = "string0"  # type: ignore[attr-defined]
    reader.AddObserver("ErrorEvent", keep)
    reader.GetExecutive().AddObserver("ErrorEvent", keep)
    warnings: list[str] = []

    def refuse_errors() -> None:
        if row["program"] == "Fluent" and errors and errors[0].find("Could not open data file") >= 0:  # the mesh is read all the same
            warnings.append("there is no file .dat of the same name, so there are no values")
            errors.clear()
        if errors:
            said = re.sub(r"^ERROR: In [^\n]*\n[^\n]*?\): ", "", errors[0].strip())
            raise Unreadable(" ".join(said.split()) or "an error without words")

    reader.UpdateInformation()
    refuse_errors()
    steps_key = pipeline.vtkStreamingDemandDrivenPipeline.TIME_STEPS()
    about = reader.GetOutputInformation(0)
    times = [about.Get(steps_key, k) for k in range(about.Length(steps_key))] if row.get("steps") and about.Has(steps_key) else []
    if wanted.times:
        return {"times": times}
    step = chosen_step(wanted, times, warnings)
    for which in ("Point", "Cell", "Solid", "ThickShell", "Shell", "Beam"):  # readers that offer a choice of arrays take all
        with contextlib.suppress(AttributeError, TypeError):  # there is no choice, or it has other words
            for number in range(getattr(reader, f"GetNumberOf{which}Arrays")()):
                getattr(reader, f"Set{which}ArrayStatus")(getattr(reader, f"Get{which}ArrayName")(number), 1)
    if times:
        refuse_unsure_step(times, step, warnings)
        reader.UpdateTimeStep(times[step])
    else:
        reader.Update()
    refuse_errors()
    leaves = leaves_of(reader.GetOutputDataObject(0))
    volumes, counts = with_volume(leaves, warnings)
    refuse_short_text(row, source, [grid for _, grid in leaves if grid is not None and grid.IsA("vtkPointSet")])
    for _, grid in volumes:
        checked(grid)
    refuse_copies(volumes)
    whole = joined(volumes, warnings)
    checked(whole)
    if row["program"] == "Gambit":
        in_order_of_vtk(whole)
    texts = []
    for (where, name), array in arrays_of(whole).items():
        if not isinstance(array, core.vtkDataArray):
            getattr(whole, "Get" + where)().RemoveArray(name)
            texts.append(name)
    if texts:
        warnings.append(f"{counted(len(texts), 'array')} left out ({listed(texts)})")
    if row.get("rounds") and numpy_support.vtk_to_numpy(whole.GetPoints().GetData()).dtype.itemsize < 8:
        warnings.append("VTK rounds the file's numbers to single precision")
    fields = [name for _, name in arrays_of(whole)]
    writer = vtk_module("vtkIOXML").vtkXMLUnstructuredGridWriter()
    writer.SetFileName(target)
    writer.SetInputData(whole)
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetCompressorTypeToNone()
    if not writer.Write() or writer.GetErrorCode():
        raise Unwritable("VTK cannot write what it read: " + (vtk_module("vtkCommonMisc").vtkErrorCode.GetStringFromErrorCode(writer.GetErrorCode()) or "no reason").lower())
    version = core.vtkVersion.GetVTKVersion()
    return {"figures": figures(whole.GetNumberOfPoints(), counts, fields), "by": f"VTK {version}", "left": "sets are" if row.get("steps") else "sets and steps are",
            "warnings": warnings, "times": times, "step": step}


# routes ---------------------------------------------------------------------------------------------------------------------------------------------


def in_child(route: Callable[..., dict[str, Any]], limit_s: int, *arguments: Any) -> dict[str, Any]:
    """Runs a route in a process of its own, which the system ends after the time limit. Returns its result, {"reason": …}, {"unwritten": …} or {"missing": a package}."""
    with tempfile.TemporaryFile() as result, tempfile.TemporaryFile() as printed:
        child = os.fork()
        if child == 0:
            try:
                with contextlib.suppress(Exception):  # the child ends with its parent, in Linux
                    import ctypes
                    ctypes.CDLL(None).prctl(1, signal.SIGKILL)
                resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
                with open(os.devnull, "rb") as nothing:
                    os.dup2(nothing.fileno(), 0)
                signal.signal(signal.SIGALRM, signal.SIG_DFL)
                signal.alarm(limit_s)
                for stream in (1, 2):
                    os.dup2(printed.fileno(), stream)
                try:
                    found = route(*arguments)
                except ImportError as error:
                    found = {"missing": (error.name or str(error)).partition(".")[0]}
                except Unreadable as error:
                    found = {"reason": str(error)}
                except Unwritable as error:
                    found = {"unwritten": str(error)}
                except MemoryError:
                    found = {"reason": "memory is too short"}
                except BaseException as error:
                    found = {"reason": f"{type(error).__name__}: {error}"}
                result.write(json.dumps(found).encode("utf-8", "backslashreplace"))
                result.flush()
            finally:
                os._exit(0)
        _, status = os.waitpid(child, 0)
        if os.WIFSIGNALED(status):
            number = os.WTERMSIG(status)
            return {"signal": number, "reason": f"did not end within {counted(limit_s, 'second')}" if number == signal.SIGALRM else f"ended by signal {number}"}
        result.seek(0)
        text = result.read()
        if text:
            found = json.loads(text)
            return found if isinstance(found, dict) else {"reason": "ended without a result"}
        printed.seek(0)
        return {"reason": "ended without a result: " + " ".join(printed.read(400).decode("utf-8", "replace").split())}


def routes_of(row: dict[str, Any], source: str, wanted: argparse.Namespace) -> list[tuple[str, Callable[..., dict[str, Any]]]]:
    """What reads a file, in order: meshio, which keeps all digits, before VTK, but for Tecplot's files of several zones, of which meshio reads one."""
    if wanted.format is not None:
        return [("meshio", by_meshio)]
    routes = [route for route in (("meshio", by_meshio), ("VTK", by_vtk)) if route[0].lower() in row]
    if row["program"] == "Tecplot":
        with contextlib.suppress(Unreadable):
            if zones_of_tecplot(source) > 1:
                routes.reverse()
    return routes


def package_of(module: str) -> str:
    """Debian's package with a module."""
    return {"vtkmodules": "python3-vtk9"}.get(module, "python3-" + module)


def convert(source: str, target: str, wanted: argparse.Namespace) -> tuple[int, dict[str, Any]]:
    """Returns the exit code and the object to print."""
    row = row_of(source) or ({"program": wanted.format, "meshio": wanted.format} if wanted.format else None)
    if row is None:
        endings = ", ".join(ending for row in FORMATS for ending in row["endings"])
        return 2, {"message": "neither meshio nor VTK is known to read such files", "allowed": endings, "missing": []}
    reasons, missing, unread = [], [], False
    # A file by itself of some bytes does not take minutes; a reader that does not find its end does.
    limit_s = wanted.limit if row.get("vtk") and "meshio" not in row else min(wanted.limit, BASE_LIMIT_S + os.path.getsize(source) // BYTES_A_SECOND)
    routes = routes_of(row, source, wanted)
    for name, route in routes:
        found = in_child(route, limit_s, row, source, target, wanted)
        if "missing" in found:
            module = {"vtkmodules": "VTK"}.get(found["missing"], found["missing"])
            reasons.append(f"{module} is not installed")
            missing.append(package_of(found["missing"]))
        elif "unwritten" in found:
            folder = tempfile.gettempdir() if target.startswith("/dev/fd/") else os.path.dirname(target)
            return 4, {"message": f"the mesh that {name} read cannot be written in {folder}: {found['unwritten']}", "allowed": "room for it; TMPDIR names another folder", "missing": []}
        elif "reason" in found:
            unread = True
            reasons.append(f"{name} {found['reason']} while it read the file" if "signal" in found else f"{name} cannot read it: {found['reason']}")
            if name == "VTK" and len(routes) > 1 and routes[0][0] == "VTK":  # meshio would read the first zone of several
                break
        else:
            found["warnings"] = [*found.get("warnings", []), *reasons] if unread else found.get("warnings", [])
            found["program"] = row["program"]
            found.setdefault("times", [])
            found.setdefault("step", 0)
            return 0, found
    allowed = f"Debian has it as {' and '.join(missing)}" if missing else f"a file of {row['program']}, as the name says"
    if not unread:
        reasons[0] = f"is a file of {row['program']}, and {reasons[0]}"
    return 2 if unread else 3, {"message": "; ".join(reasons), "allowed": allowed, "missing": missing}


def main() -> int:
    parser = argparse.ArgumentParser(prog="_foreign_file.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source")
    parser.add_argument("target", nargs="?", default="")
    parser.add_argument("--format", help="meshio's name of the format")
    parser.add_argument("--step", type=int, help="from 0; default: the last one")
    parser.add_argument("--time", type=float, help="the step nearest to it")
    parser.add_argument("--times", action="store_true", help="print the times of the steps, and convert nothing")
    parser.add_argument("--limit", type=int, default=LIMIT_S, help="seconds")
    wanted = parser.parse_args()
    source = os.path.abspath(wanted.source)
    if not os.path.isfile(source):
        code, found = 2, {"message": "cannot be read: there is no such file", "allowed": "", "missing": []}
    elif wanted.times:
        code, found = convert(source, "", wanted)
    elif wanted.target.startswith("/dev/fd/"):  # a file without a name, which its owner reads
        code, found = convert(source, wanted.target, wanted)
    else:
        target = os.path.abspath(wanted.target)
        with tempfile.TemporaryDirectory(dir=os.path.dirname(target)) as folder:
            made = os.path.join(folder, "mesh.vtu")
            code, found = convert(source, made, wanted)
            if code == 0:
                os.replace(made, target)
    sys.stdout.buffer.write(json.dumps(found, ensure_ascii=False).encode("utf-8", "replace") + b"\n")
    return code


if __name__ == "__main__":
    sys.exit(main())
