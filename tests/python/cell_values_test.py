# SPDX-License-Identifier: Apache-2.0
"""Fields at cells: read, measured, pickled, given to meshio, against numpy."""

import pickle

import numpy as np
import pytest

import subvol


@pytest.fixture
def box(tmp_path):
    """A box of 3 x 2 x 2 unit cells with numbers by chance, as `.vtu` with cell data in text."""
    shape = (3, 2, 2)
    grid = np.stack(np.meshgrid(*(np.arange(n + 1.) for n in shape), indexing="ij"), -1).reshape(-1, 3)
    number = np.arange(len(grid)).reshape([n + 1 for n in shape])
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = np.array([[number[x + i, y + j, z + k] for i, j, k in corners]
                      for x in range(3) for y in range(2) for z in range(2)])
    values = np.random.default_rng(3).uniform(-1, 4, len(cells))

    def array(name, kind, numbers):
        return f'<DataArray type="{kind}" Name="{name}" format="ascii">{" ".join(map(repr, numbers.ravel().tolist()))}</DataArray>'

    points = f'<DataArray type="Float64" NumberOfComponents="3" format="ascii">{" ".join(map(str, grid.ravel()))}</DataArray>'
    path = tmp_path / "box.vtu"
    path.write_text(
        f'<VTKFile type="UnstructuredGrid" version="1.0"><UnstructuredGrid><Piece NumberOfPoints="{len(grid)}" NumberOfCells="{len(cells)}">'
        f'<Points>{points}</Points><Cells>{array("connectivity", "Int64", cells)}{array("offsets", "Int64", 8 * np.arange(1, len(cells) + 1))}'
        f'{array("types", "UInt8", np.full(len(cells), 12))}</Cells><CellData>{array("heat", "Float64", values)}'
        f'{array("layer", "Int32", np.arange(len(cells)) // 4)}</CellData></Piece></UnstructuredGrid></VTKFile>')
    return path, values


@pytest.mark.filterwarnings("ignore::subvol.SubvolWarning")
def test_cells_are_measured_as_they_are(box):
    path, values = box
    mesh = subvol.read_mesh(path, cell_values="constant")
    assert np.array_equal(mesh.cell_fields["heat"], values)
    heat = subvol.measure(mesh)["fields"]["heat"]
    assert heat["mean"] == pytest.approx(values.mean(), abs=1e-12)
    assert (heat["min"], heat["max"]) == (values.min(), values.max())
    fine = subvol.subdivide(mesh, 1)
    assert np.array_equal(fine.cell_fields["heat"], np.repeat(values, 8))  # the children of a cell follow each other
    assert np.array_equal(mesh.with_fields(dict(mesh.fields)).cell_fields["heat"], values)


@pytest.mark.filterwarnings("ignore::subvol.SubvolWarning")
def test_they_stay_in_files_and_pickles(box, tmp_path):
    path, values = box
    mesh = subvol.read_mesh(path)
    subvol.write_mesh(mesh, tmp_path / "again.vtu")
    for again in (subvol.read_mesh(tmp_path / "again.vtu"), pickle.loads(pickle.dumps(mesh))):
        assert np.array_equal(again.cell_fields["heat"], values)
        assert np.array_equal(again.cell_fields["layer"], np.arange(12) // 4)
        assert np.array_equal(again.fields["heat"], mesh.fields["heat"])
    pytest.importorskip("meshio")
    given = subvol.to_meshio(mesh)
    assert np.array_equal(given.cell_data["heat"][0], values)
    assert "heat" not in given.point_data
