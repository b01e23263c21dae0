# SPDX-License-Identifier: Apache-2.0
"""A named view is one camera for a mesh, its points and its grid."""
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
    # A solid's mesh is painted with the values of its limit, points with theirs; by kernels what they cover is the same to the bit.
    a, b = pictures["solid"]
    assert psnr(a, b) > 35
    kernels = np.asarray(subvol.render(mesh, view=view, look="solid", size=(160, 120), image_tolerance=1e-3))
    assert np.array_equal(kernels[..., 3], b[..., 3]) and 0 < b[..., 3].mean() < 1
    # Without kernels the outline is rounder, and lies in the same place.
    assert abs(a[..., 3].mean() / b[..., 3].mean() - 1) < .02
    for axis in (0, 1):
        places = np.arange(a.shape[axis])
        centres = [np.average(places, weights=picture[..., 3].sum(1 - axis)) for picture in (a, b)]
        assert abs(centres[0] - centres[1]) < .2


@pytest.mark.parametrize("name", MESHES, ids=str)
def test_a_mesh_and_its_grid_are_seen_by_the_same_camera(name):
    mesh = mesh_named(name)
    grid = subvol.rasterize(mesh, resolution=16)[0]
    camera = subvol.render(mesh, view="iso", look="volume", size=(60, 40)).report["camera"]
    for method in ("grid", "splat"):
        assert subvol.render(grid, view="iso", method=method, size=(60, 40)).report["camera"] == camera
    low, high = grid.frame
    assert np.array_equal(np.array([low, high]), mesh.bounds)


def test_the_camera_of_a_picture_is_that_of_the_keyword():
    given = subvol.Camera((3, -4, 2), (0, 0, 0), (0, 0, 1), 35)
    camera = subvol.render(subvol.model("ball", 6), camera=given, size=(32, 32)).report["camera"]
    assert camera == {"eye": [3, -4, 2], "target": [0, 0, 0], "up": [0, 0, 1], "fovy_deg": 35}
