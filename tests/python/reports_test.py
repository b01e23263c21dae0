# SPDX-License-Identifier: Apache-2.0
"""The types of subvol.reports against what the calls return, and what a type checker says of a wrong key."""
import os
import subprocess
import sys
import typing

import numpy as np
import pytest
import subvol
from quantities_test import DECK
from subvol import reports


def check(value, kind, where):
    """Whether a value has a type, keys and all."""
    if typing.is_typeddict(kind):
        hints = typing.get_type_hints(kind, vars(reports))
        assert set(value) <= set(hints), f"{where}: {set(value) - set(hints)} are not in {kind.__name__}"
        assert kind.__required_keys__ <= set(value), f"{where}: lacks {kind.__required_keys__ - set(value)} of {kind.__name__}"
        for key, one in value.items():
            check(one, hints[key], f"{where}.{key}")
        return
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin is dict:
        for key, one in value.items():
            assert isinstance(key, arguments[0]), where
            check(one, arguments[1], f"{where}[{key!r}]")
    elif origin is list:
        assert isinstance(value, list), where
        for k, one in enumerate(value):
            check(one, arguments[0], f"{where}[{k}]")
    elif origin is tuple:
        assert isinstance(value, tuple) and len(value) == len(arguments), where
        for one, part in zip(value, arguments):
            check(one, part, where)
    elif origin is np.ndarray:
        assert isinstance(value, np.ndarray) and value.dtype == np.float64, where
    else:
        assert type(value) is kind, f"{where}: {type(value).__name__} is not {kind.__name__}"


@pytest.mark.filterwarnings("ignore::subvol.SubvolWarning")
def test_reports_have_the_types_that_they_say(tmp_path, ball):
    (tmp_path / "a.inp").write_text(DECK)
    deck = subvol.read_mesh(tmp_path / "a.inp")
    box = deck.with_fields({"T": deck.points[:, 2], "u": deck.points})
    check(subvol.measure(box), reports.VolumeMeasure, "measure")
    check(subvol.measure(box, only="half:.5,.5,.5,1,0,0"), reports.VolumeMeasure, "measure of a part")
    check(subvol.measure(box, patch="top"), reports.PatchMeasure, "measure of a patch")
    found = subvol.measure(box, patch=["top"], flux="u")
    check(found, list[reports.PatchMeasure], "measure of patches")
    assert found[0]["flux"] == pytest.approx(2) and set(subvol.measure(box)["parts"]) == {"low", "high"}  # u is the place, and the top at z = 2
    check(ball.report(), reports.MeshReport, "report")
    boundary = subvol.surface(ball, tolerance=.05)
    check(boundary.report, reports.SurfaceReport, "surface")
    check(subvol.write_vdb(ball, tmp_path / "a.vdb", resolution=8), list[reports.GridReport], "write_vdb")
    check(dict(subvol.read_vdb(tmp_path / "a.vdb")[0].report), reports.GridReport, "grid")
    fine = subvol.subdivide(ball)
    check(subvol.approximate(ball, fine)[1], reports.ApproximateReport, "approximate")
    for _, report in subvol.approximate_series(ball, [fine]):
        check(report, reports.ApproximateReport, "approximate_series")
    check(subvol.fit_shape(ball, boundary.points, boundary.triangles)[1], reports.ShapeReport, "fit_shape")
    check(subvol.control_mesh(boundary.points, boundary.triangles, cells=4)[1], reports.ControlMeshReport, "control_mesh")
    check(subvol.control_mesh(boundary.points, boundary.triangles[1:], cells=4)[1], reports.ControlMeshReport, "control_mesh of an open surface")
    check(subvol.control_mesh(np.ones((8, 8, 8), int), cells=4)[1], reports.ControlMeshReport, "control_mesh of labels")
    check(subvol.mend_folds(ball)[2], reports.MendReport, "mend_folds")
    folded = ball.points.copy()
    folded[ball.cells[0, 6]] += [2, 2, 2]
    check(subvol.mend_folds(subvol.HexMesh(folded, ball.cells, crease_angle="none"), tests=1)[2], reports.MendReport, "mend_folds of a folded mesh")
    check(subvol.mesh_difference(fine, ball)[1], reports.DifferenceReport, "mesh_difference")
    check(subvol.reduce(ball, rmse=.1)[1], reports.ReduceReport, "reduce")
    check(subvol.write_wavelets(fine, tmp_path / "a.svw"), reports.WaveletReport, "write_wavelets")
    check(subvol.write_series([ball, ball], tmp_path / "b.svw"), reports.SeriesReport, "write_series")


def test_a_wrong_key_is_a_type_error(tmp_path):
    pytest.importorskip("mypy")
    right = """
import subvol
from subvol.reports import PatchMeasure, VolumeMeasure

mesh = subvol.read_mesh("part.vtu")
found: VolumeMeasure = subvol.measure(mesh)
print(found["volume"] + found["fields"]["T"]["max"], found["fields"]["T"]["max_at"][2], found["fields"]["T"]["histogram"].sum())
inlet: PatchMeasure = subvol.measure(mesh, patch="inlet", flux="U")
print(inlet["flux"], [patch["area"] for patch in subvol.measure(mesh, patch=["inlet", "outlet"])])
print(mesh.report()["min_scaled_jacobian"], subvol.surface(mesh).report["watertight"])
grids = subvol.write_vdb(mesh, "part.vdb")
print(grids[0]["active_voxels"], subvol.approximate(mesh, mesh)[1]["fields"]["T"]["rms"])
"""
    environment = {**os.environ, "MYPYPATH": os.environ["PYTHONPATH"].split(os.pathsep)[0]}

    def said(text):
        (tmp_path / "program.py").write_text(text)
        done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "program.py"], capture_output=True, text=True, cwd=tmp_path, env=environment)
        return done.returncode, done.stdout

    code, text = said(right)
    assert code == 0, text
    wrong = {'found["volume"]': 'found["volum"]', '"max_at"': '"max_place"', 'inlet["flux"]': 'inlet["flow"]', 'patch["area"]': 'patch["size"]',
             '"min_scaled_jacobian"': '"worst"', '"watertight"': '"closed"', '"active_voxels"': '"voxels"', '["rms"]': '["rmse"]'}
    program = right
    for key, mistake in wrong.items():
        assert key in program
        program = program.replace(key, mistake)
    code, text = said(program)
    assert code == 1 and text.count("has no key") == len(wrong), text
