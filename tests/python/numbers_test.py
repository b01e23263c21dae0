# SPDX-License-Identifier: Apache-2.0
"""Every argument that is a real number refuses what is none: nan, infinities, and -1 where nothing negative makes sense."""
import inspect
import warnings

import numpy as np
import pytest
import subvol

# Each function with what it needs besides the argument.
CALLS = {
    "evaluate_limit": lambda mesh, points, folder, **more: subvol.evaluate_limit(mesh, [0], [[.5, .5, .5]], **more),
    "points_error": lambda mesh, points, folder, **more: subvol.points_error(points, mesh, **more),
    "probe": lambda mesh, points, folder, **more: subvol.probe(mesh, at=[[0, 0, 0]], **more),
    "measure": lambda mesh, points, folder, **more: subvol.measure(mesh, **more),
    "slice": lambda mesh, points, folder, **more: subvol.slice(mesh, **{"point": (0, 0, 0), "normal": (0, 0, 1), "resolution": 8, **more}),
    "surface": lambda mesh, points, folder, **more: subvol.surface(mesh, **more),
    "read_mesh": lambda mesh, points, folder, **more: subvol.read_mesh(folder / "mesh.vtu", **more),
    "write_wavelets": lambda mesh, points, folder, **more: subvol.write_wavelets(subvol.subdivide(mesh), folder / "out.svw", **more),
    "write_series": lambda mesh, points, folder, **more: subvol.write_series(mesh, folder / "out.svw", **more),
    "subdivide": lambda mesh, points, folder, **more: subvol.subdivide(mesh, **more),
    "render": lambda mesh, points, folder, **more: subvol.render(mesh, **{"size": (8, 8), **more}),
    "sample": lambda mesh, points, folder, **more: subvol.sample(mesh, **more),
    "reduce": lambda mesh, points, folder, **more: subvol.reduce(mesh, **more),
    "fit": lambda mesh, points, folder, **more: subvol.fit(**{"level": 2, **more}),
    "rasterize": lambda mesh, points, folder, **more: subvol.rasterize(mesh, **{"resolution": 8, **more}),
    "write_vdb": lambda mesh, points, folder, **more: subvol.write_vdb(mesh, folder / "out.vdb", **{"resolution": 8, **more}),
}
SEVERAL = {"point": 3, "normal": 3, "clip_box": 6, "background": 3}  # how many numbers
ANY_SIGN = {"tension", "time", "iso", "point", "normal", "clip_box"}
NEEDS = {"image_tolerance": {"method": "dense"}, "seconds": {"method": "splat"}}


def real_arguments(function):
    return [name for name, parameter in inspect.signature(function).parameters.items()
            if "float" in str(parameter.annotation) and name not in ("what", "times")]


@pytest.mark.parametrize("name", CALLS)
@pytest.mark.parametrize("wrong", [float("nan"), float("inf"), float("-inf"), -1.0])
def test_what_is_no_number_is_refused(name, wrong, cube, tmp_path):
    mesh = subvol.model("ball", 2)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        points = subvol.sample(mesh)
        subvol.write_mesh(mesh, tmp_path / "mesh.vtu")
        for argument in real_arguments(getattr(subvol, name)):
            if wrong == -1 and argument in ANY_SIGN:
                continue
            value = wrong if argument not in SEVERAL else (wrong,) + (1.0,) * (SEVERAL[argument] - 1)
            with pytest.raises(subvol.InvalidInput) as caught:
                CALLS[name](mesh, points, tmp_path, **{argument: value, **NEEDS.get(argument, {})})
                pytest.fail(f"{name}({argument}={value}) is taken")
            assert "\n" not in str(caught.value), argument
    assert sorted(file.name for file in tmp_path.iterdir()) == ["mesh.vtu"]


def test_schemes_of_tetrahedra_look_at_their_numbers_too():
    mesh = subvol.model("ball", 2)
    for wrong in (float("nan"), float("inf")):
        with pytest.raises(subvol.InvalidInput):
            subvol.sample(mesh, scheme="tetoct", spacing=wrong)
        with pytest.raises(subvol.InvalidInput):
            subvol.probe(mesh, at=[[0, 0, 0]], scheme="tetoct", reach=wrong)


def test_cameras_colours_and_heat_maps():
    nan, inf = float("nan"), float("inf")
    for wrong in (nan, inf):
        with pytest.raises(subvol.InvalidInput):
            subvol.TransferFunction("viridis", range=(0, wrong))
        with pytest.raises(subvol.InvalidInput):
            subvol.TransferFunction("viridis").legend(low=wrong, high=1)
        with pytest.raises(subvol.InvalidInput):
            subvol.TransferFunction("viridis", opacity=[(0, 0), (1, wrong)])
    image = np.zeros((8, 8, 4), np.float32)
    for wrong in (nan, inf, -1):
        with pytest.raises(subvol.InvalidInput):
            subvol.compare_images(image, image).heatmap(wrong)


def test_voxels_are_checked_before_the_limit_is_looked_for():
    mesh = subvol.model("ball", 4)
    for size in (1e-9, 1e-300, 1e-6):
        with pytest.raises(subvol.InvalidInput):
            subvol.rasterize(mesh, voxel_size=size)
    with pytest.raises(subvol.InvalidInput):
        subvol.rasterize(mesh, resolution=1_000_000)
