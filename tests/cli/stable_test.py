#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What docs/stability.md promises: declarations, options, JSON keys and files of earlier versions. `--write` records them anew."""

import json
import os
import re
import sys
import tempfile
import unittest
from pathlib import Path

from command import subvol

TOP = Path(__file__).resolve().parents[2]
KEPT = Path(__file__).resolve().parent / "stable"
# Of each format of series, which are newer than 0.2; `--write-series` makes the last one, once.
STEPS = [KEPT / "series-1.svw", KEPT / "series-2.svw"]
COMPONENTS = ("lib", "io", "vdb", "render", "compare", "view")

# A command for each kind of figures; in one folder, one after the other.
COMMANDS = [
    "model twist --resolution 3 -o twist.vtu", "info twist.vtu", "subdivide twist.vtu -o fine.vtu",
    "points twist.vtu -o twist.svk", "info twist.svk", "points fine.vtu -o fine.svw --wavelet-tolerance 1e-3",
    "points twist.vtu -o steps.svw --max-error 1e-3",
    "vdb twist.vtu -o twist.vdb --resolution 16", "info twist.vdb", "render twist.vtu -o a.exr --size 16x16 --backend cpu",
    "render twist.vtu -o c.exr --size 16x16 --backend cpu --tolerance-image 1e-2",
    "render twist.vtu -o b.exr --size 16x16 --method tets", "compare a.exr b.exr", "compare twist.vtu twist.vdb",
    "probe twist.vtu --at 0,0,0 --stats", "probe twist.vtu --line 0,0,-1,0,0,1", "slice twist.vtu -o s.png --plane 0,0,0,0,0,1",
    "surface twist.vtu -o s.stl --boundary", "surface twist.vtu -o i.stl --iso 0", "check twist.vtu", "page twist.vtu -o t.html",
    "split twist.vtu -o twist.bricks --bricks 2", "info twist.bricks", "vdb twist.vtu -o part1.vdb --resolution 16 --part 1/2",
    "vdb twist.vtu -o part2.vdb --resolution 16 --part 2/2", "join part1.vdb part2.vdb -o joined.vdb", "model --list",
    "fit --kernels",
]


def statements(text):
    """The declarations in C++ code without comments, each with the types around it: 'Box::min Vec3'. Bodies and private parts are left out."""
    around, statement, skipped, hidden = [], "", 0, []
    for word in re.findall(r"::|[\w~]+|[{};:]|[^\w\s{};:]+", text):
        if skipped:  # inside a body
            skipped += {"{": 1, "}": -1}.get(word, 0)
        elif word == "{" and re.match(r"(inline )?(namespace|struct|class|enum|union)\b", statement.strip()):
            around.append(statement.strip().removeprefix("namespace "))
            hidden.append(statement.strip().startswith("class "))
            if not statement.strip().startswith("namespace") and not any(hidden[:-1]) and "detail" not in around:
                yield "::".join(around)
            statement = ""
        elif word == "{":
            skipped = 1
            statement += " {}"
        elif word == "}":
            if around and around[-1].startswith("enum") and statement.strip():
                yield "::".join([*around, statement.strip()])
            if around:
                around.pop()
                hidden.pop()
            statement = ""
        elif word == ":" and statement.strip() in ("public", "private", "protected"):
            hidden[-1] = statement.strip() == "private"
            statement = ""
        elif word in (";", ",") and (word == ";" or (around and around[-1].startswith("enum"))) or \
                statement.endswith(" {}") and re.match(r"[\[\w~]", word) and "=" not in statement:
            if re.search(r"\w", statement) and not any(hidden) and "detail" not in around:
                yield "::".join([*around, re.sub(r"^([^(]*?) = .*", r"\1", statement.strip())])  # defaults may change
            statement = "" if word in ";," else word
        else:
            statement += f" {word}"
    assert not around, around


def declarations():
    """Each declaration of the public headers: 'refine.h: subvol::HexMesh refine ( … )'."""
    for header in sorted(path for part in COMPONENTS for path in (TOP / part).glob("*/include/subvol/*.h")):
        text = re.sub(r"//[^\n]*|^#.*?(?<!\\)$|/\*.*?\*/", " ", header.read_text(), flags=re.S | re.M)
        text = re.sub(r'"(\\.|[^"\\])*"', '""', text)
        for statement in statements(text):
            yield f"{header.name}: {statement}"


def options():
    """Each verb with each of its options."""
    verbs = re.findall(r"^  ([a-z]+) ", subvol("--help").out.split("Verbs:")[1].split("Options:")[0], re.M)
    for verb in verbs:
        for option in re.findall(r"^  (?:-\w, )?(--[a-z][a-z0-9-]*)", subvol(verb, "--help-all").out, re.M):
            yield f"{verb} {option}"


def paths(value, at=""):
    """Keys of JSON with the kind of what is behind them: 'cells.proved number'. What lists hold is looked at once."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from paths(inner, f"{at}.{key}" if at else key)
    elif isinstance(value, list):
        for inner in value[:1]:
            yield from paths(inner, f"{at}[]")
    else:
        kind = {bool: "yes or no", str: "text", type(None): "nothing"}.get(type(value), "number")
        yield f"{at} {kind}"


def keys():
    with tempfile.TemporaryDirectory() as folder:
        for command in COMMANDS:
            done = subvol(*command.split(), "--json", folder=folder)
            if done.code != 0:
                raise AssertionError(f"subvol {command}: {done.err}")
            for path in paths(json.loads(done.out)):
                yield f"{command.split()[0]}: {path}"


def write_steps(path):
    """A series of three steps in a file that later versions read: the refined twisted block as the set "core", with x + y z + t."""
    with tempfile.TemporaryDirectory() as folder:
        sets = []
        for step, time in enumerate((0, .5, 2)):
            mesh = f"twist{step}.vtu"
            done = subvol("subdivide", "model:twist:3", "--density", f"x+y*z+{time}", "-o", mesh, folder=folder)
            assert done.code == 0, done.err
            Path(folder, f"step{step}.vtm").write_text(
                '<VTKFile type="vtkMultiBlockDataSet"><vtkMultiBlockDataSet>'
                f'<DataSet index="0" name="core" file="{mesh}"/></vtkMultiBlockDataSet></VTKFile>')
            sets.append(f'<DataSet timestep="{time}" file="step{step}.vtm"/>')
        Path(folder, "steps.pvd").write_text(f'<VTKFile type="Collection"><Collection>{"".join(sets)}</Collection></VTKFile>')
        done = subvol("points", "steps.pvd", "-o", path, "--step", "all", "--max-error", "1e-4", "--key-steps", "2", folder=folder)
        assert done.code == 0, done.err


LISTS = {"headers.txt": declarations, "options.txt": options, "json.txt": keys}


class Stable(unittest.TestCase):
    def check(self, name):
        kept = (KEPT / name).read_text().splitlines()
        self.assertGreater(len(kept), 100)
        now = set(LISTS[name]())
        self.assertEqual([line for line in kept if line not in now], [], f"gone or changed: see docs/stability.md ({name})")

    def test_declarations(self):
        self.check("headers.txt")

    def test_options(self):
        self.check("options.txt")

    def test_json_keys(self):
        self.check("json.txt")


class FilesOfEarlierVersions(unittest.TestCase):
    """Each is the twisted block of 3×3×3 cells, or its refinement, with the field x+y*z, as the version of its folder wrote it."""

    def info(self, version, name):
        done = subvol("info", KEPT / version / name, "--json")
        self.assertEqual(done.code, 0, done.err)
        return done.json()

    def test_kernels(self):
        for version in sorted(path.name for path in KEPT.iterdir() if path.is_dir()):
            for name in ("block.svk", "block.ply", "block.vtp"):
                with self.subTest(version=version, name=name):
                    figures = self.info(version, name)
                    self.assertEqual(figures["points"], 64)
                    channel = figures["channels"][0]
                    self.assertEqual(channel["name"], "density")
                    self.assertAlmostEqual(channel["min"], -1.77735, 4)
                    self.assertAlmostEqual(channel["max"], 0.849337, 4)

    def test_meshes(self):
        for version in sorted(path.name for path in KEPT.iterdir() if path.is_dir()):
            with self.subTest(version=version):
                self.assertEqual(self.info(version, "block.svw")["cells"], 64)
                self.assertEqual(self.info(version, "block.bricks")["cells"], 27)
                for name in ("block.svw", "block.bricks"):
                    done = subvol("probe", KEPT / version / name, "--at", ".1,.2,.3", "--json")
                    self.assertEqual(done.code, 0, done.err)
                    self.assertAlmostEqual(done.json()["values"][0]["value"], .1 + .2 * .3, delta=.03)

    def test_series(self):
        for kept in STEPS:
            with self.subTest(kept=kept.name), tempfile.TemporaryDirectory() as folder:
                done = subvol("info", kept, "--json")
                self.assertEqual(done.code, 0, done.err)
                self.assertEqual(done.json()["cells"], 216)
                self.assertEqual([(found["name"], found["cells"]) for found in done.json()["sets"]], [("core", 216)])
                for step, time in enumerate((0, .5, 2)):
                    done = subvol("probe", kept, "--step", step, "--at", ".1,.2,.3", "--json")
                    self.assertEqual(done.code, 0, done.err)
                    # The limit interpolates x + y z to .03 in so few cells; the file is nearer than that to its own first step.
                    self.assertAlmostEqual(done.json()["values"][0]["value"], .1 + .2 * .3 + time, delta=.03)
                # The present version writes what that one did, within the error of both.
                write_steps(Path(folder) / "now.svw")
                for step in range(3):
                    values = []
                    for path in (kept, Path(folder) / "now.svw"):
                        done = subvol("info", path, "--step", step, "--json")
                        self.assertEqual(done.code, 0, done.err)
                        field = done.json()["fields"][0]
                        values.append((field["min"], field["max"]))
                    self.assertLess(max(abs(a - b) for a, b in zip(*values)), 2e-4 * 5)

    def test_states_of_the_window(self):
        for version in sorted(path.name for path in KEPT.iterdir() if path.is_dir()):
            with self.subTest(version=version), tempfile.TemporaryDirectory() as folder:
                done = subvol("view", KEPT / version / "block.svk", "--state", KEPT / version / "state.json", "--screenshot", "a.png",
                              "--json", "--size", "64x64", folder=folder)
                self.assertEqual(done.code, 0, done.err)
                state = done.json()["state"]
                self.assertEqual(state["look"], "volume")


if __name__ == "__main__":
    if "--write-series" in sys.argv:
        write_steps(STEPS[-1])
    elif "--write" in sys.argv:
        KEPT.mkdir(exist_ok=True)
        for name, lines in LISTS.items():
            (KEPT / name).write_text("".join(f"{line}\n" for line in sorted(set(lines()))))
    else:
        unittest.main()
