# SPDX-License-Identifier: Apache-2.0
"""What is raised and warned about."""
import os
import warnings

import numpy as np
import pytest
import subvol


def test_the_family_of_errors():
    assert issubclass(subvol.InvalidInput, subvol.Error) and issubclass(subvol.InvalidInput, ValueError)
    assert issubclass(subvol.FileError, subvol.Error) and issubclass(subvol.FileError, OSError)
    assert issubclass(subvol.MissingCapability, subvol.Error)
    assert issubclass(subvol.Cancelled, subvol.Error)
    assert issubclass(subvol.SubvolWarning, UserWarning)


def test_an_error_has_its_parts():
    with pytest.raises(subvol.InvalidInput) as caught:
        subvol.model("balloon")
    assert caught.value.code == "InvalidInput"
    assert "ball" in caught.value.allowed
    assert caught.value.allowed in str(caught.value)
    with pytest.raises(ValueError):
        subvol.model("balloon")


def test_a_malformed_file_names_its_line(tmp_path):
    file = tmp_path / "bad.mesh"
    file.write_text("MeshVersionFormatted 2\nDimension 3\nVertices\n1\n0 0 zero 0\n")
    with pytest.raises(subvol.InvalidInput) as caught:
        subvol.read_mesh(file)
    assert "bad.mesh" in caught.value.where and "5" in caught.value.where
    assert str(caught.value).startswith(caught.value.where)


def test_a_missing_file():
    with pytest.raises(subvol.FileError) as caught:
        subvol.read_mesh("/nowhere/part.vtk")
    assert caught.value.code == "FileError"
    assert "/nowhere/part.vtk" in str(caught.value)
    with pytest.raises(OSError):
        subvol.read_points("/nowhere/part.ply")
    with pytest.raises(subvol.Error):
        subvol.read_image("/nowhere/part.png")
    with pytest.raises(subvol.Error):
        subvol.read_vdb("/nowhere/part.vdb")


def test_names_of_files_may_be_any_bytes(tmp_path, cube):
    name = os.fsencode(tmp_path) + b"/\xff\xfe.vtu"
    subvol.write_mesh(cube, name)
    assert np.array_equal(subvol.read_mesh(name).cells, cube.cells)
    with pytest.raises(subvol.FileError) as caught:
        subvol.read_mesh(name + b".vtu")
    assert "xff" in str(caught.value) or "?" in str(caught.value) or "\ufffd" in str(caught.value)
    with pytest.raises(subvol.InvalidInput):
        subvol.read_mesh("a\0b.vtu")


def test_unknown_words_are_answered_with_the_known_ones(cube):
    for call, words in [(lambda: subvol.subdivide(cube, scheme="mqc"), "mcq"),
                        (lambda: subvol.sample(cube, correction="some"), "second"),
                        (lambda: subvol.sample(cube, values="some"), "cubic"),
                        (lambda: subvol.render(cube, method="splats"), "splat"),
                        (lambda: subvol.render(cube, look="glass"), "solid"),
                        (lambda: subvol.render(cube, method="tets", shadows=True), "splat"),
                        (lambda: subvol.render(cube, method="sheets", ambient_occlusion=.1), "splat"),
                        (lambda: subvol.render(cube, method="tets", lod=1), "splat"),
                        (lambda: subvol.render(cube, lod=float("nan")), "0 or more"),
                        (lambda: subvol.render(cube, backend="metal", method="splat"), "cpu"),
                        (lambda: subvol.render(cube, tf="virids"), "viridis"),
                        (lambda: subvol.fit("square"), "gaussian"),
                        (lambda: subvol.render(cube, view="sideways"), "iso")]:
        with pytest.raises(subvol.InvalidInput) as caught:
            call()
        assert words in str(caught.value)


def test_unknown_fields_are_answered_with_those_that_exist(cube):
    with pytest.raises(subvol.InvalidInput) as caught:
        subvol.sample(cube, field="T")
    assert "x" in str(caught.value)
    with pytest.raises(subvol.InvalidInput):
        subvol.evaluate(cube, "T", at=[[0, 0, 0]])
    with pytest.raises(subvol.InvalidInput):
        subvol.write_vdb(cube, "x.vdb", fields=["T"])
    with pytest.raises(subvol.InvalidInput):
        subvol.render(subvol.sample(cube), field="T")


def test_warnings_are_of_the_line_that_calls(cube):
    mesh = subvol.HexMesh(cube.points, cube.cells)
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        subvol.sample(mesh)
    assert [w.category for w in seen] == [subvol.SubvolWarning]
    assert "density" in str(seen[0].message)
    assert seen[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error", subvol.SubvolWarning)
        with pytest.raises(subvol.SubvolWarning):
            subvol.sample(mesh)


def test_a_field_that_is_named_is_not_warned_about(cube):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        subvol.sample(cube, field="x")


def test_values_at_cells_are_fitted_or_averaged(tmp_path):
    name = tmp_path / "row.vtk"
    points = "\n".join(f"{x} {y} {z}" for z in (0, 1) for y in (0, 1) for x in range(4))
    cells = "\n".join("8 " + " ".join(str(x + d) for d in (0, 1, 5, 4, 8, 9, 13, 12)) for x in range(3))
    name.write_text("# vtk DataFile Version 3.0\nrow\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 16 double\n" + points + "\nCELLS 3 27\n" +
                    cells + "\nCELL_TYPES 3\n12\n12\n12\nCELL_DATA 3\nSCALARS heat double 1\nLOOKUP_TABLE default\n0\n1\n2\n")
    with pytest.warns(subvol.SubvolWarning):
        mean, fitted = (subvol.read_mesh(name, cell_values=kind).fields["heat"] for kind in ("mean", "fit"))
    assert np.ptp(mean) == 2 and np.ptp(fitted) > 2.5  # a line through the means goes on to the ends
    with pytest.raises(subvol.InvalidInput, match="auto, fit, mean"):
        subvol.read_mesh(name, cell_values="best")


def test_a_long_name_is_cut_in_the_message():
    with pytest.raises(subvol.InvalidInput) as caught:
        subvol.model("x" * 5000)
    assert "xxx…" in str(caught.value) and len(str(caught.value)) < 500
    assert "pawn" in str(caught.value)
