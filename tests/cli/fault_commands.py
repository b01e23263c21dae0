# SPDX-License-Identifier: Apache-2.0
"""The commands that the faults are tried on, one or more of every verb: their files without a fault, and when a file is complete."""

import json
import os
import subprocess
import tempfile
import time
from pathlib import Path

from command import COMMAND, HANGS_AFTER

STUDY = {
    "name": "small",
    "inputs": [{"model": "ball", "resolution": 3}],
    "cameras": ["iso"],
    "size": 48,
    "methods": [{"method": "splat", "per_edge": [1, 2]}, {"method": "tets", "levels": [0, 1]},
                {"method": "field", "seed": [1, 2], "places": 1000}],
    "metrics": ["rmse"],
    "reference": {"tolerance": 0.05, "max_levels": 1},
    "pictures": True,
}

# Replaces the program that makes videos: keeps the bytes of the pictures.
FFMPEG = """#!/bin/sh
for last; do :; done
exec cat > "${last#file:}"
"""

# The same input gives the same bytes.
SAME_BYTES = {".vtu", ".vtkhdf", ".mesh", ".ply", ".vtp", ".svk", ".svw", ".svshare", ".usda", ".glb", ".npz", ".nvdb", ".png", ".exr",
              ".svg", ".mp4"}

# The surface of a cube, as `mesh` reads it.
CUBE = """v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
f 4 3 2 1
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
"""


class Command:
    """good: its files and their bytes. labels: the first words of what it prints. seconds: how long it takes. All of them after
    `run_undisturbed`."""

    def __init__(self, name, words, quick=False, slow=False, opengl=False, children=False, environment=None):
        self.name, self.words, self.quick, self.slow = name, words.split(), quick, slow
        self.opengl, self.children = opengl, children
        self.environment = environment or {}
        self.good, self.labels, self.seconds = {}, [], 0.0

    def run_undisturbed(self):
        with tempfile.TemporaryDirectory() as name:
            start = time.monotonic()
            done = subprocess.run([COMMAND, *self.words], cwd=name, capture_output=True, text=True, timeout=HANGS_AFTER,
                                  env={**os.environ, **self.environment})
            self.seconds = time.monotonic() - start
            if done.returncode != 0:
                raise SystemExit(f"{self.name}: {done.stderr}")
            files = [path for path in Path(name).rglob("*") if path.is_file()]
            self.good = {str(path.relative_to(name)): path.read_bytes() for path in files}
            self.labels = [line.split(" ")[0] for line in done.stdout.splitlines()]

    def is_whole(self, name, path, content):
        suffix = path.suffix
        if suffix in SAME_BYTES and content == self.good[name]:
            return True
        if suffix == ".vtkhdf":  # HDF5's library stores a block as it is where it cannot compress it
            return self.has_same_values(name, path)
        if suffix in SAME_BYTES:
            return False
        if suffix == ".json":
            return is_json(content)
        if suffix == ".vdb":  # each file has its own random identifier
            return subprocess.run([COMMAND, "info", path], capture_output=True).returncode == 0
        if suffix == ".html":
            return content.rstrip().endswith(b"</html>")
        return content.endswith(b"\n")  # tables as text

    def has_same_values(self, name, path):
        with tempfile.TemporaryDirectory() as other:
            good = Path(other) / Path(name).name
            good.write_bytes(self.good[name])
            done = subprocess.run([COMMAND, "compare", path, good, "--json"], capture_output=True, text=True)
            return done.returncode == 0 and json.loads(done.stdout)["linf"] == 0


def is_json(content):
    try:
        json.loads(content)
        return True
    except ValueError:
        return False


def prepare(inputs):
    (inputs / "study.json").write_text(json.dumps(STUDY))
    (inputs / "actions.json").write_text('[{"orbit": [20, 5]}, {"wait": true}]')
    (inputs / "cube.obj").write_text(CUBE)
    (inputs / "ffmpeg").write_text(FFMPEG)
    (inputs / "ffmpeg").chmod(0o755)
    for words in ("render model:ball:3 -o a.png --size 256 --backend cpu", "render model:ball:4 -o b.png --size 256 --backend cpu",
                  "points model:ball:4 -o a.ply", "points model:ball:2 -o small.ply", "vdb model:ball:3 -o a.vdb --resolution 40",
                  "model ball --resolution 4 -o a.vtu",
                  "subdivide model:ball:3 -o fine.vtu --levels 1",
                  "split model:ball:4 -o b.bricks --bricks 3", "surface model:ball:8 -o 1.svshare --part 1/2",
                  "surface model:ball:8 -o 2.svshare --part 2/2"):
        subprocess.run([COMMAND, *words.split()], cwd=inputs, check=True, capture_output=True)


def commands(inputs):
    """inputs: the folder that `prepare` fills."""
    draw = "render model:ball:4 --size 160"
    return [
        Command("model .vtu", "model twist --resolution 24 -o a.vtu"),
        Command("model .mesh", "model twist --resolution 16 -o a.mesh"),
        Command("model .vtkhdf", "model twist --resolution 12 -o a.vtkhdf", quick=True),
        Command("mesh", f"mesh {inputs}/cube.obj -o a.vtu --cells 2 --rounds 1"),
        Command("mesh .vtkhdf", f"mesh {inputs}/cube.obj -o a.vtkhdf --cells 2 --rounds 1"),
        Command("approximate", f"approximate {inputs}/a.vtu --onto model:ball:3 -o a.vtu"),
        Command("check --mend", "check model:ball:3 --mend -o a.vtkhdf"),
        Command("info", "info model:ball:8"),
        Command("subdivide", "subdivide model:ball:4 -o a.vtu --levels 1"),
        Command("subdivide .vtkhdf", "subdivide model:ball:4 -o a.vtkhdf --levels 1 --clamp"),
        Command("fit", "fit --kernel gaussian --level 3"),
        Command("points .ply", "points model:ball:8 -o a.ply"),
        Command("points .vtp", "points model:ball:8 -o a.vtp"),
        Command("points .vdb", "points model:ball:8 -o a.vdb", quick=True),
        Command("points .svk", "points model:ball:8 -o a.svk"),
        Command("compress", "compress model:ball:8 -o a.svw --max-error 1e-3", quick=True),
        Command("compress, wavelets", f"compress {inputs}/fine.vtu -o a.svw --wavelet-tolerance 1e-3"),
        Command("usd", "usd model:ball:4 -o a.usda --resolution 24"),
        Command("usd of points", f"usd {inputs}/a.ply -o a.usda"),
        Command("vdb", "vdb model:ball:4 -o a.vdb --resolution 80"),
        Command("vdb --memory", "vdb model:ball:4 -o a.vdb --resolution 80 --memory 1M"),
        Command("surface", "surface model:ball:6 -o a.ply --iso 0.3 --cap"),
        Command("surface --part", "surface model:ball:6 -o a.svshare --iso 0.3 --cap --part 1/2"),
        Command("join surfaces", f"join {inputs}/1.svshare {inputs}/2.svshare -o a.ply"),
        Command("points of bricks", f"points {inputs}/b.bricks -o a.ply"),
        Command("vdb of bricks", f"vdb {inputs}/b.bricks -o a.vdb --resolution 80 --memory 2M"),
        Command("render bricks", f"render {inputs}/b.bricks --size 160 -o a.png --backend cpu"),
        Command("render bricks, tets", f"render {inputs}/b.bricks --size 160 -o a.png --method tets --memory 10M"),
        Command("slice", "slice model:ball:6 -o a.png --plane 0,0,0,0,0,1"),
        Command("slice .csv", "slice model:ball:6 -o a.csv --plane 0,0,0,0,0,1 --resolution 200"),
        Command("probe", "probe model:ball:6 -o a.csv --line -1,0,0,1,0,0 --count 5000"),
        Command("render cpu", f"{draw} -o a.png --backend cpu", quick=True),
        Command("render auto, legend", f"{draw} -o a.exr --legend a.svg"),
        Command("render gl", f"{draw} -o a.png --backend gl", opengl=True),
        Command("render sheets", f"{draw} -o a.png --method sheets", opengl=True),
        Command("render pt", f"{draw} -o a.png --method pt", opengl=True),
        Command("render tets", f"{draw} -o a.exr --method tets"),
        Command("render dense", f"{draw} -o a.png --method dense"),
        Command("render grid", f"render {inputs}/a.vdb --size 160 -o a.png --method grid"),
        Command("render turntable", f"{draw} -o a.png --turntable 3 --backend cpu"),
        Command("render video", f"{draw} -o a.mp4 --turntable 3 --backend cpu", children=True,
                environment={"PATH": f"{inputs}:{os.environ['PATH']}"}),
        Command("compare --heatmap", f"compare {inputs}/a.png {inputs}/b.png --heatmap a.png"),
        Command("compare fields", f"compare {inputs}/a.ply {inputs}/a.vtu"),
        Command("page", "page model:ball:4 -o a.html --size 160"),
        Command("view", f"view model:ball:4 --script {inputs}/actions.json --screenshot a.png --size 160 --backend cpu"),
        Command("study", f"study {inputs}/study.json -o out --jobs 2", children=True),
        Command("demo", "demo -o out --size 48 --resolution 4"),
    ]


def small_commands(inputs):
    """As little work as each verb can do, for thousands of runs. inputs: the folder that `prepare` fills."""
    draw = "render model:ball:2 --size 16"
    return [
        Command("model .vtu", "model ball --resolution 2 -o a.vtu", quick=True),
        Command("model .mesh", "model ball --resolution 2 -o a.mesh"),
        Command("model .vtkhdf", "model ball --resolution 2 -o a.vtkhdf"),
        Command("info", "info model:ball:2", quick=True),
        Command("info of a file", f"info {inputs}/a.vtu"),
        Command("mesh", f"mesh {inputs}/cube.obj -o a.vtu --cells 2 --rounds 1", slow=True),
        Command("approximate", f"approximate {inputs}/fine.vtu --onto model:ball:2 -o a.vtu", slow=True),
        Command("check --mend", "check model:ball:2 --mend -o a.vtu"),
        Command("subdivide", "subdivide model:ball:2 -o a.vtu --levels 1"),
        Command("fit", "fit --kernel gaussian --level 2"),
        Command("points .ply", "points model:ball:2 -o a.ply", quick=True),
        Command("points .vtp", "points model:ball:2 -o a.vtp"),
        Command("points .vdb", "points model:ball:2 -o a.vdb"),
        Command("points .svk", "points model:ball:2 -o a.svk"),
        Command("points .glb", "points model:ball:2 -o a.glb"),
        Command("points .npz", "points model:ball:2 -o a.npz"),
        Command("compress", "compress model:ball:2 -o a.svw --max-error 1e-3"),
        Command("compress, wavelets", f"compress {inputs}/fine.vtu -o a.svw --wavelet-tolerance 1e-3"),
        Command("usd", "usd model:ball:2 -o a.usda --resolution 8"),
        Command("vdb", "vdb model:ball:2 -o a.vdb --resolution 8", quick=True),
        Command("vdb --nano", "vdb model:ball:2 -o a.vdb --resolution 8 --nano"),
        Command("vdb of bricks", f"vdb {inputs}/b.bricks -o a.vdb --resolution 8 --memory 2M"),
        Command("surface", "surface model:ball:2 -o a.ply --iso 0.3 --cap"),
        Command("surface .glb", "surface model:ball:2 -o a.glb --boundary"),
        Command("surface --part", "surface model:ball:2 -o a.svshare --iso 0.3 --cap --part 1/2"),
        Command("join surfaces", f"join {inputs}/1.svshare {inputs}/2.svshare -o a.ply"),
        Command("split", "split model:ball:2 -o b.bricks --bricks 2"),
        Command("points of bricks", f"points {inputs}/b.bricks -o a.ply"),
        Command("slice", "slice model:ball:2 -o a.png --plane 0,0,0,0,0,1 --resolution 8"),
        Command("slice .csv", "slice model:ball:2 -o a.csv --plane 0,0,0,0,0,1 --resolution 8"),
        Command("probe", "probe model:ball:2 -o a.csv --line -1,0,0,1,0,0 --count 5", quick=True),
        Command("probe --stats", "probe model:ball:2 --stats"),
        Command("render cpu", f"{draw} -o a.png --backend cpu", quick=True),
        Command("render .exr", f"{draw} -o a.exr --backend cpu --legend a.svg"),
        Command("render volume", f"{draw} -o a.png --backend cpu --look volume"),
        Command("render tets", f"{draw} -o a.png --method tets"),
        Command("render dense", f"{draw} -o a.png --method dense"),
        Command("render grid", f"render {inputs}/a.vdb --size 16 -o a.png --method grid"),
        Command("render bricks", f"render {inputs}/b.bricks --size 16 -o a.png --backend cpu"),
        Command("render turntable", f"{draw} -o a.png --turntable 2 --backend cpu"),
        Command("render video", f"{draw} -o a.mp4 --turntable 2 --backend cpu", environment={"PATH": f"{inputs}:{os.environ['PATH']}"}),
        Command("compare --heatmap", f"compare {inputs}/a.png {inputs}/a.png --heatmap a.png"),
        Command("compare fields", f"compare {inputs}/small.ply model:ball:2", slow=True),
        Command("view", f"view model:ball:2 --script {inputs}/actions.json --screenshot a.png --size 16 --backend cpu"),
        Command("page", "page model:ball:2 -o a.html --size 32"),
        Command("study", f"study {inputs}/study.json -o out --jobs 2"),
        Command("demo", "demo -o out --size 16 --resolution 3", slow=True),
    ]
