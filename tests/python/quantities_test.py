# SPDX-License-Identifier: Apache-2.0
"""Quantities computed from fields, displacement, and regions."""
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import subvol


@pytest.fixture(scope="module")
def bar() -> subvol.HexMesh:
    """4 x 4 x 4 unit cells with a stress, a displacement and a linear temperature."""
    grid = np.stack(np.meshgrid(*[np.arange(5.)] * 3, indexing="ij"), -1).transpose(2, 1, 0, 3).reshape(-1, 3)
    number = np.arange(125).reshape(5, 5, 5)
    corner = [(0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0), (1, 0, 0), (1, 0, 1), (1, 1, 1), (1, 1, 0)]
    cells = np.stack([number[k:k + 4, j:j + 4, i:i + 4].ravel() for k, j, i in corner], 1)
    rng = np.random.default_rng(3)
    stress = rng.normal(size=(125, 6))
    return subvol.HexMesh(grid, cells, {"S": stress, "D": np.stack([grid[:, 2], 0 * grid[:, 0], 0 * grid[:, 0]], 1), "T": grid @ [2, -1, .5]})


def test_invariants_are_those_of_the_matrices(bar: subvol.HexMesh) -> None:
    s = bar.fields["S"]
    matrices = s[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
    values = np.linalg.eigvalsh(matrices)[:, ::-1]
    for k in range(3):
        np.testing.assert_allclose(subvol.quantity(bar, f"principal{k + 1}(S)"), values[:, k], atol=1e-12)
    deviator = matrices - np.trace(matrices, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    np.testing.assert_allclose(subvol.quantity(bar, "mises(S)"), np.sqrt(1.5 * (deviator**2).sum((1, 2))), atol=1e-12)
    np.testing.assert_allclose(subvol.quantity(bar, "tresca(S)"), values[:, 0] - values[:, 2], atol=1e-12)
    np.testing.assert_allclose(subvol.quantity(bar, "det(S)"), np.linalg.det(matrices), atol=1e-12)
    np.testing.assert_allclose(subvol.quantity(bar, "norm(S)"), np.sqrt((matrices**2).sum((1, 2))), atol=1e-12)


def test_derivatives_and_components(bar: subvol.HexMesh) -> None:
    assert subvol.quantity(bar, "grad(T)").shape == (125, 3)
    np.testing.assert_allclose(subvol.quantity(bar, "grad(T)"), np.tile([2, -1, .5], (125, 1)), atol=1e-9)
    np.testing.assert_allclose(subvol.quantity(bar, "curl(D).y"), 1, atol=1e-9)
    assert (subvol.quantity(bar, "S.yz") == bar.fields["S"][:, 4]).all()
    with pytest.raises(subvol.InvalidInput, match="takes a tensor"):
        subvol.quantity(bar, "mises(D)")


def test_fields_of_calls_are_quantities(bar: subvol.HexMesh) -> None:
    image = np.asarray(subvol.render(bar, field="S.xx + 2 * T", size=(24, 24)))
    with_field = subvol.HexMesh(bar.points, bar.cells, {"m": subvol.quantity(bar, "S.xx + 2 * T")})
    np.testing.assert_array_equal(image, np.asarray(subvol.render(with_field, size=(24, 24))))


def test_what_is_not_linear_is_that_of_the_place(bar: subvol.HexMesh) -> None:
    place = [[.3, 1.7, 2.6]]
    stress = subvol.probe(bar, at=place).fields["S"][0]
    xx, yy, zz, xy, yz, xz = stress
    expected = np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * (xy**2 + yz**2 + xz**2))
    values, inside = subvol.evaluate(bar, "mises(S)", place)
    assert inside.all() and values[0] == pytest.approx(expected, rel=1e-6)


def scaled_jacobians(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """The least at the corners of each cell: the determinant of the unit vectors along its three edges there."""
    edges = {0: (1, 3, 4), 1: (2, 0, 5), 2: (3, 1, 6), 3: (0, 2, 7), 4: (7, 5, 0), 5: (4, 6, 1), 6: (5, 7, 2), 7: (6, 4, 3)}
    found = []
    for corner, ends in edges.items():
        sides = np.stack([points[cells[:, end]] - points[cells[:, corner]] for end in ends], axis=1)
        found.append(np.linalg.det(sides / np.linalg.norm(sides, axis=2, keepdims=True)))
    return np.min(found, axis=0)


def test_quality_of_cells_is_that_of_numpy(bar: subvol.HexMesh) -> None:
    rng = np.random.default_rng(2)
    mesh = subvol.HexMesh(bar.points + rng.normal(scale=.1, size=bar.points.shape), bar.cells)
    quality = scaled_jacobians(mesh.points, mesh.cells)
    assert mesh.report()["min_scaled_jacobian"] == pytest.approx(quality.min(), abs=1e-12)
    pairs = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    lengths = np.stack([np.linalg.norm(mesh.points[mesh.cells[:, a]] - mesh.points[mesh.cells[:, b]], axis=1) for a, b in pairs])
    aspect = lengths.max(axis=0) / lengths.min(axis=0)
    for name, values in (("quality", quality), ("aspect", aspect), ("1-quality", 1 - quality)):
        sums, counts = np.zeros(len(mesh.points)), np.zeros(len(mesh.points))  # at points the means over the cells there
        np.add.at(sums, mesh.cells.reshape(-1), np.repeat(values, 8))
        np.add.at(counts, mesh.cells.reshape(-1), 1)
        np.testing.assert_allclose(subvol.quantity(mesh, name), sums / counts, atol=1e-12, err_msg=name)
    middle = float(np.median(quality))
    assert len(subvol.only(mesh, f"where:quality<{middle!r}").cells) == (quality < middle).sum()


def test_warp_and_regions(bar: subvol.HexMesh) -> None:
    np.testing.assert_allclose(subvol.warp(bar, "D", 2).points[:, 0], bar.points[:, 0] + 2 * bar.points[:, 2])
    longest = np.abs(subvol.warp(bar, "D", None).points - bar.points).max()
    assert longest == pytest.approx(.1 * np.sqrt(48))
    assert len(subvol.only(bar, "box:0,0,0,2,4,4", "half:0,0,1,0,0,1").cells) == 24
    assert len(subvol.only(bar, "where:T>=2").cells) > 0
    with pytest.raises(subvol.InvalidInput, match="no cell"):
        subvol.only(bar, "sphere:9,9,9,1")
    part = subvol.measure(bar, only="box:.5,.5,.5,3.25,2,4")
    assert part["volume"] == pytest.approx(2.75 * 1.5 * 3.5, rel=1e-4)
    assert part["fields"]["T"]["mean"] == pytest.approx(2 * 1.875 - 1.25 + .5 * 2.25, abs=2e-3)


DECK = """*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
9, 0, 0, 2
10, 1, 0, 2
11, 1, 1, 2
12, 0, 1, 2
*ELEMENT, TYPE=C3D8, ELSET=low
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=C3D8, ELSET=high
2, 5, 6, 7, 8, 9, 10, 11, 12
*SURFACE, NAME=bottom
low, S1
*SURFACE, NAME=top
high, S2
"""


def test_patches_and_sets_follow_the_cells(tmp_path: Path) -> None:
    (tmp_path / "a.inp").write_text(DECK)
    mesh = subvol.read_mesh(tmp_path / "a.inp")
    assert {name: sides.tolist() for name, sides in mesh.patches.items()} == {"bottom": [[0, 4]], "top": [[1, 5]]}
    assert {name: cells.tolist() for name, cells in mesh.sets.items()} == {"low": [0], "high": [1]}
    upper = subvol.only(mesh, "set:high")
    assert len(upper.cells) == 1
    assert upper.patches["top"].tolist() == [[0, 5]] and len(upper.patches["bottom"]) == 0
    assert subvol.measure(mesh, only="set:high", scheme="linear")["volume"] == pytest.approx(1)
    found = subvol.measure(mesh, patch="top", scheme="linear")
    assert found["area"] == pytest.approx(1) and found["normal"] == pytest.approx((0, 0, 1))
    assert [p["name"] for p in subvol.measure(mesh, patch=["top", "bottom"])] == ["top", "bottom"]
    assert subvol.model("ball", 2).patches == {}
    with pytest.raises(subvol.InvalidInput, match="bottom, top"):
        subvol.measure(mesh, patch="side")
    with pytest.raises(subvol.InvalidInput, match="no set"):
        subvol.only(mesh, "set:middle")
    with pytest.raises(subvol.InvalidInput, match="1 component"):
        subvol.measure(subvol.HexMesh(mesh.points, mesh.cells, {"T": mesh.points[:, 0]}), patch=[], flux="T")
    with pytest.raises(subvol.InvalidInput, match="patch"):
        subvol.measure(mesh, flux="U")


def test_pictures_of_patches_are_those_of_the_command(tmp_path: Path, command: Callable[..., str]) -> None:
    (tmp_path / "a.inp").write_text(DECK)
    mesh = subvol.read_mesh(tmp_path / "a.inp")

    def shown(*words: str) -> subvol.Image:
        command("render", tmp_path / "a.inp", "-o", tmp_path / "a.exr", "--size", "48x40", *words)
        return subvol.read_image(tmp_path / "a.exr")

    top, both = shown("--patch", "top"), shown("--patch", "top", "--patch", "bottom", "--view", "+x", "--levels", "2")
    np.testing.assert_array_equal(subvol.render(mesh, patch="top", size=(48, 40)), top)
    np.testing.assert_array_equal(subvol.render(mesh, patch=["top", "bottom"], size=(48, 40), view="+x", levels=2), both)
    np.testing.assert_array_equal(subvol.render(mesh, patch="all", tf="grey", size=(48, 40)), shown("--patch", "all", "--tf", "grey"))
    for wrong, words in (({"patch": "side"}, "bottom, top"), ({"patch": "top", "sheets": 20}, "no volume"), ({"patch": "top", "shadows": True}, "no volume")):
        with pytest.raises(subvol.InvalidInput, match=words):
            subvol.render(mesh, size=(8, 8), **wrong)
    with pytest.raises(subvol.InvalidInput, match="no patches"):
        subvol.render(subvol.sample(subvol.model("ball", 2)), patch="top", size=(8, 8))
