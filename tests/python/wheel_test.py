# SPDX-License-Identifier: Apache-2.0
"""`python -m subvol` is the command, and the description of the wheel says what pyproject.toml does."""
import email
import importlib.machinery
import importlib.util
import os
import signal
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import subvol_command

TOP = Path(__file__).resolve().parents[2]


def run(*words, **options):
    return subprocess.run([sys.executable, "-m", "subvol", *words], capture_output=True, text=True, check=False, **options)


def test_the_module_is_the_command(tmp_path):
    command = os.environ["SUBVOL_COMMAND"]
    for words, code in ((["--version"], 0), (["render", "nothing.vtu", "-o", "x.png"], 2), (["frobnicate"], 2)):
        told = subprocess.run([command, *words], capture_output=True, text=True, check=False, cwd=tmp_path)
        done = run(*words, cwd=tmp_path)
        assert (done.returncode, done.stdout, done.stderr) == (told.returncode, told.stdout, told.stderr)
        assert done.returncode == code


def test_a_pipe_that_nobody_reads_ends_it_as_it_ends_the_command():
    codes = []
    for words in ([os.environ["SUBVOL_COMMAND"]], [sys.executable, "-m", "subvol"]):
        reader, writer = os.pipe()
        os.close(reader)
        done = subprocess.run([*words, "render", "--help-all"], stdout=writer, stderr=subprocess.PIPE, check=False)
        os.close(writer)
        codes.append((done.returncode, done.stderr))
    assert codes == [(-signal.SIGPIPE, b"")] * 2


def test_a_package_without_the_command_says_so(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(subvol_command, "HERE", str(tmp_path))
    with pytest.raises(SystemExit) as ended:
        subvol_command.main()
    assert ended.value.code == 3
    assert capsys.readouterr().err == "subvol: the command is not installed: Debian has it in the package subvol\n"


def test_the_description_of_the_wheel_is_that_of_the_project():
    loader = importlib.machinery.SourceFileLoader("wheel_script", str(TOP / "scripts/wheel"))
    script = importlib.util.module_from_spec(importlib.util.spec_from_loader("wheel_script", loader))
    sys.dont_write_bytecode = True
    loader.exec_module(script)
    project = tomllib.loads((TOP / "pyproject.toml").read_text())["project"]
    told = email.message_from_string(script.metadata(project, "Apache-2.0 AND MIT", ["LICENSE"]))
    assert (told["Name"], told["Version"], told["License-Expression"], told["License-File"]) == ("subvol", project["version"], "Apache-2.0 AND MIT", "LICENSE")
    assert told.get_all("Requires-Dist")[0] == "numpy>=1.20"
    assert 'meshio; extra == "all"' in told.get_all("Requires-Dist")
    assert told.get_payload().startswith((TOP / "README.md").read_text()[:80])
