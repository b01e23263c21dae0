# SPDX-License-Identifier: Apache-2.0
"""Quantities computed from fields, displacement, and regions."""
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
    image = np.asarray(subvol.render(bar, field="mises(S)", size=(24, 24)))
    with_field = subvol.HexMesh(bar.points, bar.cells, {"m": subvol.quantity(bar, "mises(S)")})
    np.testing.assert_array_equal(image, np.asarray(subvol.render(with_field, size=(24, 24))))


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
