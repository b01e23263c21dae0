#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A complete study with pictures made elsewhere: ours and VTK's of the same meshes, by the same cameras, against the same reference.

    vtk_comparison.py OUT [--subvol COMMAND] [--vtk COMMAND] [--size WxH]

1. The meshes are written, each as it is and refined twice, since VTK interpolates linearly between points.
2. `subvol render --json` prints the camera of each view.
3. vtk_study.py draws the meshes by VTK with that camera: projected tetrahedra, and Bunyk's ray caster.
4. `subvol study` compares all of them with the limit; OUT/report.html is the result.

--vtk: runs Python with VTK (default: xvfb-run -a /usr/bin/python3). It sees OUT and this folder under their names.
"""
import argparse
import json
import shlex
import subprocess
from pathlib import Path

HERE = Path(__file__).resolve().parent
MODELS = {"twist": 6, "ball": 8}  # with cells a side; densities from -1 to 1
VIEWS = ["iso", "-y"]
LEVELS = [0, 2]
UNIT = .05
MAP = [{"Name": "map", "ColorSpace": "RGB", "RGBPoints": [-1, .1, .2, .7, 0, .9, .9, .8, 1, .8, .1, .1],
        "Points": [-1, 0, .5, 0, 0, .1, .5, 0, 1, .6, .5, 0]}]

LABELS = {"tets": "VTK projected tetrahedra", "rays": "VTK rays"}


def theirs(kind, level):
    return {"method": "file", "label": f"{LABELS[kind]}, {8 ** level} a cell", "file": f"theirs/{kind}{level}/{{input}}_{{view}}.pfm"}


def study(size):
    return {
        "name": "vtk",
        "title": "Kernels and tetrahedra, ours and VTK's, against the limit",
        "about": "All pictures have the same camera, colours and opacities. VTK blends 8 bits a channel, and draws the control cells, or the cells "
                 "of the mesh refined twice (64 a cell), as tetrahedra.",
        "inputs": [{"model": model, "resolution": cells} for model, cells in MODELS.items()],
        "cameras": [{"name": view, "camera": view, "visible": True} for view in VIEWS],
        "transfer_functions": [{"name": "map", "colors": "map.json", "opacity_unit": UNIT}],
        "size": size,
        "methods": [
            {"method": "splat", "label": "splats, {per_edge} a cell's edge", "per_edge": [1, 2], "sheets": 400},
            {"method": "tets", "label": "our tetrahedra, level {levels}", "levels": LEVELS},
        ] + [theirs(kind, level) for kind in LABELS for level in LEVELS],
        "reference": {"tolerance": 1e-3, "max_levels": 5},
        "metrics": ["rmse", "psnr", "ssim", "flip", "max"],
        "pictures": {"view": "iso"},
        "tables": [{"rows": ["input", "label"], "columns": ["psnr", "ssim", "flip", "max"], "average": ["view"],
                    "caption": "Means over the views."}],
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--subvol", default="subvol")
    parser.add_argument("--vtk", default="xvfb-run -a /usr/bin/python3")
    parser.add_argument("--size", default="320x240")
    asked = parser.parse_args()
    out = asked.out.resolve()
    size = [int(side) for side in asked.size.split("x")]

    def subvol(*words):
        return subprocess.run([asked.subvol, *map(str, words)], check=True, stdout=subprocess.PIPE, text=True, cwd=out).stdout

    out.mkdir(parents=True, exist_ok=True)
    (out / "map.json").write_text(json.dumps(MAP))
    (out / "study.json").write_text(json.dumps(study(size), indent=2))
    for model, cells in MODELS.items():
        subvol("model", model, "--resolution", cells, "-o", f"{model}0.vtu")
        subvol("subdivide", f"{model}0.vtu", "-o", f"{model}2.vtu", "--levels", "2")
        for view in VIEWS:
            camera = f"{model}_{view}.json"
            (out / camera).write_text(subvol("render", f"{model}0.vtu", "-o", f"{model}_{view}.png", "--look", "volume", "--tf", "map.json",
                                             "--opacity-unit", UNIT, "--view", view, "--size", asked.size, "--json"))
            for kind in LABELS:
                for level in LEVELS:
                    picture = out / "theirs" / f"{kind}{level}" / f"{model}_{view}.pfm"
                    picture.parent.mkdir(parents=True, exist_ok=True)
                    subprocess.run([*shlex.split(asked.vtk), HERE / "vtk_study.py", out / f"{model}{level}.vtu", "density", out / camera, asked.size,
                                    out / "map.json", str(UNIT), picture, *(["--rays"] if kind == "rays" else [])], check=True)
    subvol("study", "study.json", "-o", ".")
    print(out / "report.html")


if __name__ == "__main__":
    main()
