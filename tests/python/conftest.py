# SPDX-License-Identifier: Apache-2.0
import os
import subprocess

import numpy as np
import pytest
import subvol


def grid_of(n, size=1.0, field=None):
    """A cube of n^3 cells with side `size`, and the fields x (linear) and, if given, f(points)."""
    u, v, w = np.meshgrid(*[np.linspace(0, size, n + 1)] * 3, indexing="ij")
    points = np.stack([u, v, w], -1).reshape(-1, 3)
    number = np.arange((n + 1) ** 3).reshape(n + 1, n + 1, n + 1)
    lower = number[:-1, :-1, :-1].reshape(-1)
    a, b, c = (n + 1) ** 2, n + 1, 1
    cells = lower[:, None] + np.array([0, a, a + b, b, c, a + c, a + b + c, b + c])
    fields = {"x": points[:, 0].copy()}
    if field is not None:
        fields["f"] = field(points)
    return subvol.HexMesh(points, cells, fields)


@pytest.fixture
def cube():
    return grid_of(3)


@pytest.fixture(scope="session")
def ball():
    return subvol.model("ball", 3)


@pytest.fixture(scope="session")
def ball_points(ball):
    return subvol.sample(ball)


@pytest.fixture
def command():
    """Runs the command, whose file the environment names."""
    program = os.environ.get("SUBVOL_COMMAND")
    if not program:
        pytest.skip("SUBVOL_COMMAND does not name the command")

    def run(*arguments):
        done = subprocess.run([program, *map(str, arguments), "--quiet"], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run
