# SPDX-License-Identifier: Apache-2.0
"""A named view is one camera for a mesh and its points."""
import os
from pathlib import Path

import numpy as np
import pytest
import subvol

MESHES = [("ball", 6), ("pawn", 16), ("twist", 6), ("nozzle", 12), "vtkdata_can.vtu", "sibl_bunny_conforming.mesh"]


def mesh_named(name):
    if isinstance(name, tuple):
        return subvol.model(*name)
    folder = os.environ.get("SUBVOL_DATA")
    if not folder:
        pytest.skip("SUBVOL_DATA does not name the meshes")
    mesh = subvol.read_mesh(Path(folder) / name)
    return subvol.HexMesh(mesh.points, mesh.cells, {"x": mesh.points[:, 0].copy()})


def psnr(a, b):
    error = np.mean((a.astype(np.float64) - b) ** 2)
    return np.inf if error == 0 else -10 * np.log10(error)


@pytest.mark.parametrize("name", MESHES, ids=str)
@pytest.mark.parametrize("view", ["iso", "-y"])
def test_a_mesh_and_its_points_are_seen_by_the_same_camera(name, view):
    mesh = mesh_named(name)
    points = subvol.sample(mesh)
    pictures = {look: [np.asarray(subvol.render(body, view=view, look=look, size=(160, 120))) for body in (mesh, points)]
                for look in ("volume", "solid")}
    assert psnr(*pictures["volume"]) >= 60
    # A solid's mesh is painted with the values of its limit, points with theirs; what they cover is the same to the bit.
    a, b = pictures["solid"]
    assert np.array_equal(a[..., 3], b[..., 3]) and 0 < a[..., 3].mean() < 1
    assert psnr(a, b) > 35
