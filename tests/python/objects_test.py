# SPDX-License-Identifier: Apache-2.0
"""Lists of our objects, objects that are used by several threads or during a call, and properties that are made anew."""
import html.parser
import copy
import pickle
import subprocess
import sys
import textwrap

import numpy as np
import pytest
import subvol
from conftest import grid_of
from subvol import _core, _grids, _notebook


def run(program):
    """What a program prints; a crash of it is a failure of the test, not its end."""
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(program)], capture_output=True, text=True, timeout=1800)
    assert done.returncode == 0, (done.returncode, done.stdout[-500:], done.stderr[-2000:])
    return done.stdout


@pytest.mark.parametrize("wrong", [None, 3, "grid", subvol.Camera((1, 0, 0), (0, 0, 0))])
def test_lists_of_objects_refuse_others(wrong, tmp_path, cube, ball_points):
    name, kind, knots = tmp_path / "a.vdb", type(wrong).__name__, subvol.TransferFunction("viridis").knots(0, 1)
    grid = subvol.rasterize(cube, voxel_size=.5)[0]
    with pytest.raises(TypeError, match=rf"grids\[0\]: a Grid is needed, not {kind}"):
        subvol.write_vdb([wrong], name)
    with pytest.raises(TypeError, match=rf"grids\[1\]: a Grid is needed, not {kind}"):
        subvol.write_vdb([grid, wrong], name)
    with pytest.raises(TypeError, match=rf"steps\[1\]: an RbfVolume is needed, not {kind}"):
        _core.write_usd_splats(bytes(tmp_path / "a.usda"), [ball_points, wrong], [0.0, 1.0], knots)
    with pytest.raises(TypeError, match=rf"steps\[1\]: a HexMesh is needed, not {kind}"):
        list(subvol.approximate_series(cube, [cube, wrong]))
    with pytest.raises(TypeError, match=rf"steps\[1\]: a HexMesh is needed, not {kind}"):
        subvol.write_series([cube, wrong], tmp_path / "a.svw")
    assert list(tmp_path.iterdir()) == []


def test_one_object_is_not_a_list_of_them(tmp_path, ball_points):
    knots = subvol.TransferFunction("viridis").knots(0, 1)
    with pytest.raises(TypeError, match="steps: a list is needed, not RbfVolume"):
        _core.write_usd_splats(bytes(tmp_path / "a.usda"), ball_points, [0.0], knots)
    with pytest.raises(TypeError, match="grids: a list is needed, not NoneType"):
        _grids.write(bytes(tmp_path / "a.vdb"), None, False)


def test_what_is_drawn_is_whole(cube):
    shells, _ = _core.translucent_parts(cube, cube, ["half:.5,.5,.5,1,0,0=.5"])
    for wrong in ({}, {"colors": cube}, {"parts": shells}, {"source": cube}, {"mesh": cube, "points": subvol.sample(cube)},
                  {"points": subvol.sample(cube), "channels": [1]}, {"mesh": cube, "colors": subvol.HexMesh(cube.points, cube.cells)}):
        with pytest.raises(subvol.InvalidInput):
            _core.DrawnBody(**wrong)


def test_boxes_of_usd_are_as_many_as_files(tmp_path):
    knots = subvol.TransferFunction("viridis").knots(0, 1)
    with pytest.raises(subvol.InvalidInput, match="boxes"):
        _core.write_usd(bytes(tmp_path / "a.usda"), ["density"], [b"a.vdb", b"b.vdb"], [0.0, 1.0], [((0, 0, 0), (1, 1, 1))], knots, 1.0)


def test_a_grid_is_written_while_it_is_read():
    assert run("""
        import numpy as np, subvol, tempfile, threading, warnings
        warnings.simplefilter("ignore")
        folder = tempfile.mkdtemp()
        grid = subvol.rasterize(subvol.model("ball", 4), resolution=40)[0]
        places = np.random.default_rng(1).uniform(-.5, .5, (200, 3))
        values, report = grid.values(places)[0], dict(grid.report)
        expected = subvol.sample_grid(grid).centers.tobytes()
        during = []
        def write(stage, part):
            subvol.write_vdb([grid], folder + "/a.vdb")
            during.append(np.array_equal(grid.values(places)[0], values, equal_nan=True))
        assert subvol.sample_grid(grid, progress=write).centers.tobytes() == expected and all(during)
        stop = threading.Event()
        def writing():
            while not stop.is_set():
                subvol.write_vdb([grid], folder + "/b.vdb")
        writer = threading.Thread(target=writing)
        writer.start()
        for _ in range(5):
            assert subvol.sample_grid(grid).centers.tobytes() == expected
        stop.set()
        writer.join()
        assert dict(grid.report) == report
        again = subvol.read_vdb(folder + "/b.vdb")[0]
        assert np.array_equal(again.values(places)[0], values, equal_nan=True)
        print("alive")
        """) == "alive\n"


def test_four_threads_use_every_object():
    """Each class with work of its own: what four threads get is what one gets, or the sentence that it is busy."""
    assert run("""
        import numpy as np, subvol, threading, warnings
        from subvol import _core
        warnings.simplefilter("ignore")
        mesh = subvol.model("ball", 3)
        places = np.random.default_rng(1).uniform(-.5, .5, (300, 3))
        grid, volume = subvol.rasterize(mesh, resolution=24)[0], subvol.sample(mesh)
        field, points = subvol.as_field(mesh, "density"), subvol.as_field(volume)
        table, image = subvol.Refinement(mesh, 2), subvol.render(volume, size=(24, 24), backend="cpu")
        fitter = _core.Approximator(mesh)
        fit = lambda: fitter.fit(mesh.points, mesh.fields, None)[0].fields["density"]
        calls = {"Field": lambda: field.values(places)[0], "points": lambda: points.values(places)[0],
                 "Grid": lambda: grid.values(places)[0], "sample": lambda: subvol.sample_grid(grid).frames,
                 "Refinement": lambda: table.apply(mesh.points), "matrix": lambda: table.matrix()[0],
                 "Image": lambda: np.frombuffer(image.png(), np.uint8), "fit": fit, "mesh": lambda: mesh.boundary()[0],
                 "voxels": lambda: np.asarray(subvol.render(grid, method="grid", size=(16, 16))),
                 "kernels": lambda: np.asarray(subvol.render(volume, size=(24, 24), backend="cpu"))}
        for name, call in calls.items():
            expected, got, busy = call().tobytes(), [], []
            def work():
                for _ in range(4):
                    try:
                        got.append(call().tobytes() == expected)
                    except subvol.InvalidInput as error:
                        assert name == "fit" and "already" in str(error), error
                        busy.append(1)
            threads = [threading.Thread(target=work) for _ in range(4)]
            for thread in threads: thread.start()
            for thread in threads: thread.join()
            assert got and all(got) and len(got) + len(busy) == 16, (name, len(got), len(busy))
        print("alive")
        """) == "alive\n"


def test_a_fit_within_its_own_progress_is_refused(cube):
    fitter = _core.Approximator(cube)
    said = []

    def again(stage, part):
        try:
            fitter.fit(cube.points, cube.fields, None)
        except subvol.InvalidInput as error:
            said.append(str(error))

    made = fitter.fit(cube.points, cube.fields, again)[0]
    assert all("already" in text for text in said)
    np.testing.assert_allclose(made.fields["x"], cube.points[:, 0], atol=1e-6)  # a linear field; the solver's tolerance
    np.testing.assert_allclose(fitter.fit(cube.points, cube.fields, None)[0].fields["x"], cube.points[:, 0], atol=1e-6)


def test_sets_are_given_others_while_they_are_used(tmp_path):
    """The parts of a mesh hang on the object: another thread may take them away during a call."""
    mesh = with_sets(tmp_path)

    def forget(stage, part):
        if hasattr(mesh, "_sets"):
            del mesh._sets

    fine = subvol.subdivide(mesh, 1, progress=forget)
    assert len(mesh.sets) == 0 and len(fine.cells) == 8 * len(mesh.cells)


def with_sets(folder):
    """A mesh with a set of one cell, as a file has it."""
    points = grid_of(2).points
    cells = grid_of(2).cells
    lines = " ".join(str(x) for x in points.ravel())
    corners = " ".join(str(c) for c in cells.ravel())
    path = folder / "sets.vtu"
    ends, types = " ".join(str(8 * (i + 1)) for i in range(len(cells))), " ".join(["12"] * len(cells))
    in_set = " ".join("1" if i == 1 else "0" for i in range(len(cells)))
    path.write_text(f'''<VTKFile type="UnstructuredGrid" version="1.0"><UnstructuredGrid><Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells)}">
        <CellData><DataArray type="UInt8" Name="set:core">{in_set}</DataArray></CellData>
        <Points><DataArray type="Float64" NumberOfComponents="3">{lines}</DataArray></Points>
        <Cells><DataArray type="Int32" Name="connectivity">{corners}</DataArray><DataArray type="Int32" Name="offsets">{ends}</DataArray>
        <DataArray type="UInt8" Name="types">{types}</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>''')
    mesh = subvol.read_mesh(path)
    assert list(mesh.sets) == ["core"] and mesh.sets["core"].tolist() == [1]
    return mesh


def test_nothing_of_a_mesh_is_lost_on_the_way(tmp_path):
    mesh = with_sets(tmp_path)
    for other in (pickle.loads(pickle.dumps(mesh)), copy.copy(mesh), copy.deepcopy(mesh), mesh.with_creases(30), mesh.without_unused_points(),
                  mesh.with_fields({})):
        assert list(other.sets) == ["core"] and other.sets["core"].tolist() == [1]


def test_changes_that_would_be_lost_are_refused(tmp_path, cube, ball_points):
    grid, study = subvol.rasterize(cube, voxel_size=.5)[0], subvol.study("kernels")
    mesh = with_sets(tmp_path)
    for items, words in ((cube.fields, r"fields of a mesh.*with_fields"), (mesh.sets, "sets of a mesh"), (mesh.patches, "patches of a mesh"),
                         (ball_points.values, "channels of a volume"), (ball_points.moments, "channels"), (grid.report, "report of a grid"),
                         (study.cases[0].values, "values of a case")):
        before = dict(items)
        for change in (lambda: items.__setitem__("delta", 1), lambda: items.update(delta=1), lambda: items.pop("x", None), items.clear,
                       lambda: items.setdefault("delta", 1), lambda: items.__delitem__("x"), lambda: items.__ior__({"delta": 1}), items.popitem):
            with pytest.raises(TypeError, match=words):
                change()
        assert items.keys() == before.keys()
        for mine in ({**items}, dict(items), items | {}, copy.copy(items), copy.deepcopy(items), pickle.loads(pickle.dumps(items)), items.copy()):
            assert type(mine) is dict and mine.keys() == before.keys()
            mine["delta"] = 1
    with pytest.raises(TypeError):
        cube.fields["delta"] = np.zeros(len(cube.points))
    with pytest.raises((AttributeError, TypeError)):
        study.cases.append(None)
    knots = subvol.TransferFunction("viridis").knots(0, 1)
    field = subvol.as_field(cube, "x")
    for array in (cube.points, cube.cells, cube.bounds, cube.fields["x"], mesh.sets["core"], ball_points.bounds, ball_points.centers, field.bounds,
                  knots.color, knots.opacity, ball_points.boundary[0]):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0
    for thing, name in ((cube, "fields"), (cube, "points"), (ball_points, "values"), (grid, "report"), (study, "cases"), (field, "bounds")):
        with pytest.raises(AttributeError):
            setattr(thing, name, None)


def test_a_mesh_with_other_fields(cube):
    delta = np.arange(float(len(cube.points)))
    made = cube.with_fields({**cube.fields, "delta": delta})
    assert list(made.fields) == ["x", "delta"] and np.array_equal(made.fields["delta"], delta)
    assert np.array_equal(made.points, cube.points) and np.array_equal(made.cells, cube.cells) and list(cube.fields) == ["x"]
    with pytest.raises(subvol.InvalidInput, match="rows"):
        cube.with_fields({"delta": delta[1:]})


def test_names_are_text(cube, ball_points):
    for fields in ({3: cube.points[:, 0], "3": cube.points[:, 1]}, {None: cube.points[:, 0]}, {b"x": cube.points[:, 0]}):
        with pytest.raises(subvol.InvalidInput, match="not text"):
            subvol.HexMesh(cube.points, cube.cells, fields)
        with pytest.raises(subvol.InvalidInput, match="not text"):
            cube.with_fields(fields)
        with pytest.raises(subvol.InvalidInput, match="not text"):
            subvol.approximate(cube, cube.points, fields)
        with pytest.raises(subvol.InvalidInput, match="not text"):
            subvol.RbfVolume(ball_points.centers, ball_points.frames, fields)
    with pytest.raises(subvol.InvalidInput, match="no channel"):
        subvol.RbfVolume(ball_points.centers, ball_points.frames, dict(ball_points.values), gradients={"other": np.zeros((len(ball_points), 3))})


TETRAHEDRON = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]]), np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


@pytest.mark.parametrize("change", [lambda t: t + .7, lambda t: t + 0j, lambda t: t.astype("U"), lambda t: t.astype(object), lambda t: t > 0])
def test_triangles_are_integers(change, cube):
    points, triangles = TETRAHEDRON
    for call in (lambda t: subvol.control_mesh(points, t, cells=2), lambda t: subvol.fit_shape(cube, points, t)):
        with pytest.raises(subvol.InvalidInput, match="triangles.* type"):
            call(change(triangles))
        with pytest.raises(subvol.InvalidInput, match=r"triangles.*shape"):
            call(triangles[:, :2])
        with pytest.raises(subvol.InvalidInput, match=r"triangles.*number 9; there are 4 points"):
            call(np.where(triangles == 3, 9, triangles))


@pytest.mark.parametrize("kind", ["u8", ">u8", "u4", "i8", "i2"])
def test_numbers_of_points_are_named_as_they_were_given(kind, cube):
    largest = np.iinfo(kind).max
    cells = cube.cells.astype(kind)
    assert np.array_equal(subvol.HexMesh(cube.points, cells).cells, cube.cells)
    cells[1, 2] = largest
    with pytest.raises(subvol.InvalidInput, match=rf"row 1 has the number {largest}; there are {len(cube.points)} points"):
        subvol.HexMesh(cube.points, cells)


def test_numbers_of_cells_beyond_63_bits(cube):
    with pytest.raises(subvol.InvalidInput, match="2\\^63"):
        subvol.evaluate_limit(cube, np.array([2 ** 63], "u8"), [[.5, .5, .5]])


@pytest.mark.parametrize("type_of_vtk", [268, -244, 1 << 40])
def test_types_of_vtk_do_not_wrap(type_of_vtk):
    points = grid_of(1).points
    order = grid_of(1).cells[0].astype(int)
    mesh, _ = _core.from_vtk(points, [12], [8], order, [], [], [], [])
    assert len(mesh.cells) == 1
    with pytest.raises(subvol.InvalidInput, match=f"no type {type_of_vtk}"):
        _core.from_vtk(points, [type_of_vtk], [8], order, [], [], [], [])


def test_threads_have_the_limit_of_the_command(command):
    try:
        subvol.set_threads(4096)
    finally:
        subvol.set_threads(0)
    for wrong in (4097, 10 ** 9, -1):
        with pytest.raises(subvol.InvalidInput, match="0 to 4096"):
            subvol.set_threads(wrong)


def test_text_of_objects_obeys_no_terminal(cube):
    name = "\x1b[31mred\u202e\n"
    mesh = subvol.HexMesh(cube.points, cube.cells, {name: cube.points[:, 0]})
    assert list(mesh.fields) == [name]  # the name itself stays
    for thing in (mesh, subvol.sample(mesh), subvol.as_field(mesh)):
        assert repr(thing).isprintable() and "red" in repr(thing)


def test_evaluate_is_what_probe_says(ball):
    low, high = ball.bounds
    places = low + (high - low) * np.random.default_rng(3).random((400, 3))
    found, (values, inside) = subvol.probe(ball, at=places), subvol.evaluate(ball, "density", places)
    assert np.array_equal(inside, found.inside) and 100 < inside.sum() < 400
    assert np.array_equal(values, found.fields["density"], equal_nan=True)
    cube = grid_of(2, field=lambda x: x @ [1, 2, -3])
    places = np.random.default_rng(4).random((50, 3)) * .9 + .05
    np.testing.assert_allclose(subvol.evaluate(cube, "f", places)[0], places @ [1, 2, -3], atol=1e-5)  # linear; the limit's tolerance, twice


def test_evaluate_refines_nothing(ball):
    """Two places cost what `probe` costs: the stages of the work are the same."""
    stages, probed = [], []
    subvol.evaluate(ball, "density", [[0, 0, 0], [.1, 0, 0]], progress=lambda stage, part: stages.append(stage))
    subvol.probe(ball, at=[[0, 0, 0], [.1, 0, 0]], progress=lambda stage, part: probed.append(stage))
    assert not any(stage.startswith("refine") for stage in stages) or set(stages) <= set(probed)


def test_a_field_is_the_limit(ball):
    """Values and gradients of the object are those of `probe`, many at once or one by one, as `compare` asks for them."""
    low, high = ball.bounds
    places = low + (high - low) * np.random.default_rng(5).random((500, 3))
    found, field = subvol.probe(ball, at=places), subvol.as_field(ball, "density")
    assert np.array_equal(field.values(places)[0], found.fields["density"], equal_nan=True)
    assert np.array_equal(field.gradients(places)[found.inside], found.gradients["density"][found.inside])
    assert np.isnan(field.gradients(places)[~found.inside]).all()
    other = grid_of(2, field=lambda x: x @ [1, 2, -3] + .25)
    difference = subvol.compare(subvol.as_field(other, "f"), subvol.as_field(grid_of(3, field=lambda x: x @ [1, 2, -3]), "f"), samples=300)
    assert difference.linf == pytest.approx(.25, abs=1e-5) and difference.l2 == pytest.approx(.25, abs=1e-5)  # the limit's tolerance, twice


def test_errors_of_large_values_are_numbers(cube):
    """The root of a mean of squares lies between the largest error and that over the root of the count."""
    rng = np.random.default_rng(6)
    places, values = rng.random((400, 3)), 1e300 * rng.random(400)
    _, report = subvol.approximate(cube, places, {"T": values})
    error = report["fields"]["T"]
    assert 0 < error["max"] / 20 <= error["rms"] <= error["max"] < 1e300


class _Cells(html.parser.HTMLParser):
    """The texts of the cells of tables, and whether each tag is closed in order."""

    def __init__(self, text):
        super().__init__()
        self.open, self.cells, self.texts = [], [], []
        self.feed(text)
        self.close()
        assert not self.open

    def handle_starttag(self, tag, attributes):
        assert not attributes and tag in ("div", "b", "table", "thead", "tbody", "tr", "th", "td"), tag
        self.open.append(tag)
        if tag == "td":
            self.cells.append("")

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.texts.append(data)
        if self.open[-1] == "td":
            self.cells[-1] += data


def test_a_notebook_shows_a_table_of_a_mesh():
    cube = grid_of(2)
    steps = np.arange(27.) - 5
    fields = {"T<script>alert('&')</script>": steps, "u": cube.points * [3, 0, 4], "e\u202e\n": np.zeros(27)}
    mesh = subvol.HexMesh(cube.points * 2, cube.cells, fields, creases=[[0, 1], [1, 2]])
    text = mesh._repr_html_()
    shown = _Cells(text)
    rows = [shown.cells[k:k + 5] for k in range(0, len(shown.cells), 5)]
    by_name = {row[0]: row[1:] for row in rows}
    assert by_name["T<script>alert('&')</script>"] == ["points", "1", "-5", "21"] and "<script" not in text
    assert by_name["u"] == ["points", "3", "0", "5"]  # the length of (3, 0, 4)
    assert _notebook._field("gap", "points", np.array([np.nan, 2, 5, np.inf])) == ("gap", "points", "1", "2", "5")  # as files may have
    assert _notebook._field("none", "cells", np.full(3, np.nan)) == ("none", "cells", "1", "–", "–")
    assert "e\ufffd\ufffd" in by_name
    every = "".join(shown.texts)
    assert "27 points, 8 cells, 2 crease edges" in every and "bounds: [0, 2] × [0, 2] × [0, 2]" in every
    many = subvol.HexMesh(cube.points, cube.cells, {f"field {k} " + "x" * 500: steps for k in range(300)})
    assert len(many._repr_html_()) < 5000 and "and 280 more fields" in many._repr_html_()
    assert "no fields" in subvol.HexMesh(cube.points, cube.cells)._repr_html_()


def test_assigning_to_a_mesh_says_how_to_have_another(cube):
    for change, message in ((lambda: cube.fields.update(T=1), r"mesh.with_fields\(\{...\}\) is a mesh with others"),
                            (lambda: setattr(cube, "fields", {}), r"mesh.with_fields\(\{...\}\) is a mesh with others"),
                            (lambda: setattr(cube, "points", cube.points), r"HexMesh\(points, cells, mesh.fields\) is a mesh with others"),
                            (lambda: setattr(cube, "cells", cube.cells), r"HexMesh\(points, cells, mesh.fields\) is a mesh with others")):
        with pytest.raises((TypeError, AttributeError), match=message):
            change()
    with pytest.raises(TypeError, match=r"cannot be changed; mesh.with_fields\(\{...\}\)"):
        cube.fields["T"] = np.zeros(len(cube.points))
    more = cube.with_fields({**cube.fields, "T": np.arange(float(len(cube.points)))})
    assert list(more.fields) == ["x", "T"] and list(cube.fields) == ["x"]
