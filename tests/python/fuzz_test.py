# SPDX-License-Identifier: Apache-2.0
"""Whatever is given to a call: an exception, or a result; never a crash. Each trial is a few values at random."""
import os
import pickle
import random
import subprocess
import sys
import warnings

import numpy as np
import pytest
import subvol
from conftest import grid_of

TRIALS = int(os.environ.get("SUBVOL_FUZZ_TRIALS", "150"))
EXPECTED = (subvol.Error, TypeError, ValueError, OverflowError, MemoryError)


def arrays(rng):
    """Something that may be taken for an array."""
    rows = rng.choice([0, 1, 2, 3, 7, 8, 26, 27, 28, 64])
    shape = rng.choice([(), (rows,), (rows, 1), (rows, 2), (rows, 3), (rows, 4), (rows, 6), (rows, 8), (3, rows), (rows, 3, 4), (0, 3), (0, 8)])
    kind = rng.choice(["f2", "f4", "f8", "g", ">f8", "i1", "i8", "u8", ">i2", "b1", "c16", "U3", "O", "M8[s]", "V4"])
    numbers = np.random.default_rng(rng.randrange(1 << 30))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            array = np.asarray(numbers.random(shape) * rng.choice([1, 10, 27, 1e300, -5])).astype(kind)
        except (TypeError, ValueError):
            array = np.zeros(shape, kind)
    if array.dtype.kind == "f" and array.size and rng.random() < .3:
        array.flat[rng.randrange(array.size)] = rng.choice([np.nan, np.inf, -np.inf])
    if array.ndim and rng.random() < .3:
        array = np.repeat(array, 2, 0)[::rng.choice([2, -2])]
    if array.ndim > 1 and rng.random() < .2:
        array = np.asfortranarray(array)
    array = np.array(array, copy=False)
    if rng.random() < .2:
        array.flags.writeable = False
    if rng.random() < .1:
        array = np.broadcast_to(array[:1] if array.ndim else array, array.shape)
    return array


def anything(rng):
    return rng.choice([lambda: arrays(rng), lambda: None, lambda: "text", lambda: rng.randrange(-3, 99), lambda: rng.choice([np.nan, -1.0, 1e308]),
                       lambda: [], lambda: {}, lambda: {"a": arrays(rng)}, lambda: object(), lambda: b"\0", lambda: [[1, 2], [3]],
                       lambda: (arrays(rng), arrays(rng)), lambda: "\udcff", lambda: 2 ** 70])()


def attempt(call, *arguments, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return call(*arguments, **options)
        except EXPECTED as error:
            assert str(error) or isinstance(error, MemoryError), repr(error)
            return None


def test_meshes_of_anything():
    rng, good, made = random.Random(1), grid_of(2), 0
    for _ in range(TRIALS * 4):
        points = good.points if rng.random() < .5 else anything(rng)
        cells = good.cells if rng.random() < .5 else anything(rng)
        mesh = attempt(subvol.HexMesh, points, cells, rng.choice([None, {"a": anything(rng)}, anything(rng)]),
                       creases=rng.choice([None, anything(rng)]), sharp_faces=rng.choice([None, anything(rng)]))
        if mesh is not None:
            made += 1
            assert mesh.cells.max() < len(mesh.points)
            attempt(subvol.subdivide, mesh)
            attempt(mesh.report)
    assert made > 0 or TRIALS < 60  # few trials may hit no mesh


def test_volumes_of_anything():
    rng, volume = random.Random(2), subvol.sample(grid_of(2))
    good = {"centers": volume.centers, "frames": volume.frames, "values": volume.values, "gradients": volume.gradients,
            "moments": volume.moments, "kernel": volume.kernel, "boundary": volume.boundary}
    for _ in range(TRIALS * 2):
        changed = dict(good)
        for name in rng.sample(list(good), rng.randrange(1, 3)):
            changed[name] = rng.choice([anything(rng), {"x": anything(rng)}, arrays(rng)])
        made = attempt(subvol.RbfVolume, **changed)
        if made is not None:
            attempt(subvol.render, made, size=(8, 8), backend="cpu")
            attempt(subvol.evaluate, made, at=[[.5, .5, .5]])


def test_calls_with_anything(tmp_path):
    rng, mesh = random.Random(3), grid_of(2)
    volume, table, image, field = subvol.sample(mesh), subvol.Refinement(mesh), subvol.Image(np.zeros((4, 4, 4))), subvol.as_field(mesh, "x")
    calls = [lambda: subvol.subdivide(mesh, rng.choice([anything(rng), 1]), anything(rng)), lambda: subvol.subdivide(anything(rng)),
             lambda: subvol.subdivide(mesh, tension=anything(rng)), lambda: subvol.subdivide(mesh, crease_angle=anything(rng)),
             lambda: subvol.Refinement(anything(rng)), lambda: table.apply(anything(rng)), lambda: table.apply(arrays(rng), out=anything(rng)),
             lambda: table.apply(mesh.points, out=anything(rng)), lambda: subvol.evaluate(mesh, "x", at=anything(rng)),
             lambda: subvol.evaluate(anything(rng), at=anything(rng)), lambda: field.gradients(anything(rng)), lambda: field.values(arrays(rng)),
             lambda: subvol.evaluate_limit(mesh, anything(rng), anything(rng)), lambda: subvol.evaluate_limit(mesh, [0], arrays(rng)),
             lambda: subvol.sample(mesh, anything(rng)), lambda: subvol.sample(mesh, kernel=anything(rng)),
             lambda: subvol.sample(mesh, per_edge=rng.choice([anything(rng), -1, 65])), lambda: subvol.render(anything(rng)),
             lambda: subvol.render(volume, size=anything(rng)), lambda: subvol.render(volume, size=(8, 8), tf=anything(rng)),
             lambda: subvol.render(volume, size=(8, 8), camera=anything(rng)), lambda: subvol.render(mesh, size=(8, 8), method=anything(rng)),
             lambda: subvol.render(volume, size=(8, 8), sheets=anything(rng)), lambda: subvol.render(volume, size=(8, 8), samples=anything(rng)),
             lambda: subvol.TransferFunction(opacity=anything(rng)), lambda: subvol.TransferFunction(anything(rng), range=anything(rng)),
             lambda: subvol.TransferFunction.from_knots(anything(rng), anything(rng)), lambda: subvol.Camera(anything(rng), anything(rng)),
             lambda: subvol.Camera.parse(anything(rng), anything(rng)), lambda: subvol.Camera.parse("iso", arrays(rng)),
             lambda: subvol.Image(anything(rng)), lambda: subvol.compare(image, anything(rng)), lambda: subvol.compare(mesh, anything(rng)),
             lambda: image.png(anything(rng)), lambda: subvol.write_image(anything(rng), tmp_path / "a.png"),
             lambda: subvol.read_mesh(anything(rng)), lambda: subvol.read_points(anything(rng)), lambda: subvol.read_vdb(anything(rng)),
             lambda: subvol.read_image(anything(rng)), lambda: subvol.write_vdb(anything(rng), tmp_path / "a.vdb"),
             lambda: subvol.write_vdb(mesh, tmp_path / "a.vdb", resolution=rng.choice([anything(rng), 5]), fields=anything(rng)),
             lambda: subvol.write_points(volume, anything(rng)), lambda: subvol.study(anything(rng)), lambda: subvol.fit(anything(rng)),
             lambda: subvol.reduce(mesh, "x", rmse=anything(rng)), lambda: subvol.model(anything(rng)),
             lambda: type(mesh).__setstate__(type(mesh).__new__(type(mesh)), rng.choice([anything(rng), tuple(anything(rng) for _ in range(rng.choice([5, 9])))])),
             lambda: subvol.RbfVolume.__new__(subvol.RbfVolume).centers]
    here = os.getcwd()
    os.chdir(tmp_path)  # a text may name a file to be written
    try:
        for _ in range(TRIALS * 8):
            attempt(rng.choice(calls))
    finally:
        os.chdir(here)
    assert np.array_equal(mesh.points, grid_of(2).points)


def test_objects_without_a_constructor_are_refused():
    for kind in (subvol.HexMesh, subvol.RbfVolume, subvol.Image, subvol.Camera, subvol.Refinement):
        empty = kind.__new__(kind)
        for name in ("points", "fields", "centers", "width", "eye", "cells"):
            if hasattr(kind, name):
                with pytest.raises((TypeError, RuntimeError, ValueError)):
                    getattr(empty, name)


NEVER_MADE = """
import copy, inspect, pickle, sys
import numpy as np, subvol
from subvol import _core, _grids

OURS = {"IndexError", "StopIteration"}
for module in (_core, _grids):
    for name, kind in vars(module).items():
        if not isinstance(kind, type) or kind.__module__.split(".")[0] != "subvol":
            continue
        for made in (kind, type("Of" + name, (kind,), {})):
            empty = made.__new__(made)
            uses = [(use, lambda use=use: use(empty)) for use in (np.asarray, np.array, memoryview, bytes, repr, str, hash, bool, len, list, float,
                                                                  copy.copy, copy.deepcopy, pickle.dumps, vars)]
            uses += [(use, lambda use=use: use(empty, empty)) for use in (np.add, np.stack, lambda a, b: a == b, lambda a, b: a in b)]
            for at in dir(empty):
                if at in ("__init__", "__class__", "__init_subclass__", "__subclasshook__", "__setstate__"):
                    continue
                for arguments in ((), (None,), (empty,), ([0],), ("x",), (1, 2), (empty, empty)):
                    uses.append((at, lambda at=at, arguments=arguments: getattr(empty, at)(*arguments)))
            for function in list(vars(module).values()) + [subvol.render, subvol.subdivide, subvol.sample, subvol.write_mesh, subvol.compare]:
                if callable(function) and not isinstance(function, type):
                    uses += [(function, lambda f=function, n=n: f(*[empty] * n)) for n in (1, 2, 3)]
            for use, call in uses:
                try:
                    call()
                except Exception:
                    pass
            if hasattr(kind, "__array__"):
                for use in (np.asarray, memoryview):
                    try:
                        use(empty)
                    except BufferError:  # NumPy's and Python 3.13's word for the same
                        pass
                    except TypeError as error:
                        assert "initialised" in str(error) or "compatible" in str(error), error
                    else:
                        sys.exit(f"{name}: {use} took it")
print("alive")
"""


def test_objects_that_were_never_made_can_be_used_for_nothing():
    done = subprocess.run([sys.executable, "-c", NEVER_MADE], capture_output=True, text=True, timeout=1800)
    assert done.returncode == 0 and done.stdout.endswith("alive\n"), (done.returncode, done.stdout[-500:], done.stderr[-2000:])


@pytest.mark.parametrize("protocol", range(6))
def test_every_protocol_of_pickling(protocol, ball):
    image = subvol.Image(np.ones((2, 3, 4)))
    assert np.array_equal(pickle.loads(pickle.dumps(image, protocol)), np.asarray(image))
    assert np.array_equal(pickle.loads(pickle.dumps(ball, protocol)).points, ball.points)
    with pytest.raises(TypeError, match="pickle"):
        pickle.dumps(subvol.as_field(ball, "density"), protocol)


@pytest.mark.parametrize("exception", [KeyboardInterrupt, MemoryError, RecursionError, SystemExit, ZeroDivisionError])
def test_exceptions_of_given_objects_pass_on(exception, cube, ball_points):
    class Guest:
        def __array__(self, dtype=None, copy=None):
            raise exception("by the guest")

    class Row:
        """A sequence whose numbers raise it."""
        def __len__(self):
            return 3

        def __getitem__(self, index):
            raise exception("by the guest")

    class Unmeasured(Row):
        def __len__(self):
            raise exception("by the guest")

    grid = subvol.rasterize(cube, voxel_size=.5)[0]
    fill = np.zeros((2, 2, 3))
    for call in (lambda guest: subvol.HexMesh(guest, cube.cells), lambda guest: subvol.HexMesh(cube.points, guest),
                 lambda guest: subvol.HexMesh(cube.points, cube.cells, {"x": guest}),
                 lambda guest: subvol.HexMesh(cube.points, cube.cells, creases=guest),
                 lambda guest: subvol.RbfVolume(guest, ball_points.frames, dict(ball_points.values)),
                 lambda guest: subvol.RbfVolume(ball_points.centers, ball_points.frames, {"x": guest}),
                 lambda guest: subvol.Image(guest), lambda guest: subvol.compare(fill, guest), lambda guest: subvol.write_image(guest, "no.png"),
                 lambda guest: subvol.probe(cube, at=guest), lambda guest: subvol.as_field(cube, "x").values(guest), lambda guest: grid.values(guest),
                 lambda guest: subvol.evaluate_limit(cube, guest, [[.5, .5, .5]]), lambda guest: subvol.Camera(guest, [0, 0, 0]),
                 lambda guest: subvol.Refinement(cube, 1).apply(guest), lambda guest: subvol.render(cube, size=(8, 8), clip=guest)):
        with pytest.raises(exception, match="by the guest"):
            call(Guest())
    for guest in (Row(), [Row()], Unmeasured(), [Unmeasured()] * 3):
        with pytest.raises(exception, match="by the guest"):
            subvol.HexMesh(guest, cube.cells)
