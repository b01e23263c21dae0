# SPDX-License-Identifier: Apache-2.0
"""Stubs against the module, and the types of the package and the examples."""
import os
import pathlib
import subprocess
import sys

import pytest

TOP = pathlib.Path(__file__).resolve().parents[2]


def run(*arguments, tmp_path):
    environment = {**os.environ, "MYPYPATH": os.environ["PYTHONPATH"].split(os.pathsep)[0]}
    return subprocess.run([sys.executable, "-m", *arguments], capture_output=True, text=True, cwd=tmp_path, env=environment)


def test_stubs_are_those_of_the_module(tmp_path):
    pytest.importorskip("mypy")
    allowed = str(pathlib.Path(__file__).with_name("stubtest_allowed.txt"))
    done = run("mypy.stubtest", "subvol._core", "subvol._grids", "--allowlist", allowed, "--ignore-unused-allowlist", tmp_path=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_package_is_strictly_typed(tmp_path):
    pytest.importorskip("mypy")
    done = run("mypy", "--strict", "-p", "subvol", tmp_path=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_examples_are_strictly_typed(tmp_path):
    pytest.importorskip("mypy")
    for example in sorted((TOP / "examples/python").glob("*.py")):
        # matplotlib has no types in Debian
        done = run("mypy", "--strict", "--ignore-missing-imports", str(example), tmp_path=tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr


def test_everything_public_has_a_docstring():
    import subvol

    for name in subvol.__all__:
        assert (getattr(subvol, name).__doc__ or "").strip(), name
