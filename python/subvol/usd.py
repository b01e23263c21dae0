# SPDX-License-Identifier: Apache-2.0
"""Writes a mesh as OpenUSD text: a volume of UsdVol whose fields are those of .vdb files, which are written beside it.

    python3 -m subvol.usd part.vtu -o part.usda [--field NAME] [--resolution N] [--steps all|A-B] [--tf NAME]

With steps there is a .vdb file for each, and the time codes are the numbers of the steps. The colour map is written as attributes of the
volume, subvol:colors and others: OpenUSD has no shader of its own for volumes. Ends with 2 if the file cannot be read or written.
"""
from __future__ import annotations

import argparse
import os
import re
import sys
import tempfile
import warnings
from collections.abc import Sequence
from typing import Any, Optional, Union

from ._arguments import Path, path_bytes
from ._colors import TransferFunction
from ._errors import Error, FileError, InvalidInput, SubvolWarning
from ._mesh import Series, open_series, read_mesh
from ._vdb import Grid, read_vdb, write_vdb


def _name(text: str) -> str:
    """As a prim may be called."""
    name = re.sub(r"\W", "_", text, flags=re.ASCII) or "_"
    return f"_{name}" if name[0].isdigit() else name


def _row(numbers: Sequence[float]) -> str:
    return "(" + ", ".join(f"{number:.9g}" for number in numbers) + ")"


def _list(rows: Sequence[str]) -> str:
    return "[" + ", ".join(rows) + "]"


def write_usd(path: Path, files: Union[Path, list[Path], tuple[Path, ...]], *, codes: Optional[Sequence[float]] = None,
              tf: Union[None, str, TransferFunction] = None, opacity_unit: Optional[float] = None) -> None:
    """Writes `.usda`: a Volume with a field for each grid of floats. The `.vdb` files are named relative to it.

    files:        one, or one for each time code, with the same grids
    codes:        the time code of each file; None: 0, 1, …
    tf:           the colour map that is written as attributes: a name, or a TransferFunction; None: viridis over the first grid's values
    opacity_unit: the distance that its opacities are for; None: 1/100 of the diagonal, as in pictures

    Raises InvalidInput for another extension, no grids, or codes that are not one for each file and ascending; FileError.
    """
    target = _target(path)
    names = [os.fsdecode(path_bytes(file)) for file in (files if isinstance(files, (list, tuple)) else [files])]
    times = [float(code) for code in (range(len(names)) if codes is None else codes)]
    if not names or len(times) != len(names) or any(b <= a for a, b in zip(times, times[1:])):
        raise InvalidInput(f"codes: there are {len(times)} for {len(names)} files", "codes", "one for each file, ascending")
    function = tf if isinstance(tf, TransferFunction) else TransferFunction(tf or "viridis")
    grids: list[str] = []
    extents: list[str] = []
    colors: list[str] = []
    for name in names:  # one after the other: the grids of a long series need not fit into memory together
        contents = read_vdb(name)
        if not extents:
            grids, colors = [grid.name for grid in contents], _colors(contents[0], function, opacity_unit)
        elif [grid.name for grid in contents] != grids:
            raise InvalidInput(f"{name}: has other grids than {names[0]}", name, ", ".join(grids))
        extents.append(_list([_row(corner) for corner in contents[0].frame]))
    text = _stage(os.path.splitext(os.path.basename(target))[0], grids, extents, times, colors,
                  [os.path.relpath(name, os.path.dirname(target) or ".").replace(os.sep, "/") for name in names])
    try:
        with tempfile.TemporaryDirectory(dir=os.path.dirname(os.path.abspath(target))) as folder:
            made = os.path.join(folder, "stage")
            with open(made, "w", encoding="utf-8") as file:
                file.write(text)
            os.replace(made, target)
    except OSError as error:
        raise FileError(f"{target}: cannot be written: {error.strerror}", target) from None


def _target(path: Path) -> str:
    target = os.fsdecode(path_bytes(path))
    if not target.endswith(".usda"):
        raise InvalidInput(f"{path!s}: has an unknown extension", str(path), ".usda")
    return target


def _colors(grid: Grid, function: TransferFunction, opacity_unit: Optional[float]) -> list[str]:
    report = grid.report
    knots = function.knots(report["min"], report["max"])
    lower, upper = grid.frame
    unit = opacity_unit or sum((b - a) ** 2 for a, b in zip(lower, upper)) ** 0.5 / 100
    return [f"custom float[] subvol:colorValues = {_list([f'{row[0]:.9g}' for row in knots.color])}",
            f"custom color3f[] subvol:colors = {_list([_row(row[1:4]) for row in knots.color])}",
            f"custom float[] subvol:opacityValues = {_list([f'{row[0]:.9g}' for row in knots.opacity])}",
            f"custom float[] subvol:opacities = {_list([f'{row[1]:.9g}' for row in knots.opacity])}",
            f"custom float subvol:opacityUnit = {unit:.9g}"]


def _asset(file: str) -> str:
    return f"@@@./{file}@@@" if "@" in file else f"@./{file}@"


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", r"\\").replace('"', r"\"").replace("\n", r"\n") + '"'


def _names(grids: Sequence[str]) -> list[str]:
    """Prims for the grids, each with another name."""
    names: list[str] = []
    for grid in grids:
        name, count = _name(grid), 1
        while (each := name if count == 1 else f"{name}_{count}") in names:
            count += 1
        names.append(each)
    return names


def _stage(title: str, grids: Sequence[str], extents: Sequence[str], times: Sequence[float], colors: Sequence[str],
           files: Sequence[str]) -> str:
    root, prims, moves = _name(title), _names(grids), len(files) > 1

    def value(declaration: str, values: Sequence[str]) -> str:
        if not moves:
            return f"{declaration} = {values[0]}"
        samples = "".join(f"                {time:g}: {each},\n" for time, each in zip(times, values))
        return f"{declaration}.timeSamples = {{\n{samples}            }}"

    lines = ["#usda 1.0", "(", f'    defaultPrim = "{root}"', '    doc = "Written by OpenSubVol"', "    metersPerUnit = 1", '    upAxis = "Z"']
    if moves:
        lines += [f"    startTimeCode = {times[0]:g}", f"    endTimeCode = {times[-1]:g}", "    timeCodesPerSecond = 24"]
    lines += [")", "", f'def Xform "{root}" (', '    kind = "component"', ")", "{", '    def Volume "volume"', "    {",
              f"        {value('float3[] extent', extents)}"]
    lines += [f"        rel field:{prim} = </{root}/volume/{prim}>" for prim in prims]
    lines += [f"        {line}" for line in colors]
    for grid, prim in zip(grids, prims):
        lines += ["", f'        def OpenVDBAsset "{prim}"', "        {",
                  '            token fieldDataType = "float"', f"            token fieldName = {_quoted(grid)}",
                  f"            {value('asset filePath', [_asset(file) for file in files])}", "        }"]
    return "\n".join([*lines, "    }", "}", ""])


def _steps(text: str, series: Series) -> range:
    if text == "all":
        return range(len(series))
    found = re.fullmatch(r"(\d+)(?:-(\d+))?", text)
    chosen = range(int(found[1]), int(found[2] or found[1]) + 1) if found else range(0)
    if not chosen or chosen[-1] >= len(series):
        raise InvalidInput(f"--steps: '{text}' is not a range of the steps", "--steps", f"all, or A-B up to {len(series) - 1}")
    return chosen


def _convert(given: argparse.Namespace) -> str:
    base = os.path.splitext(_target(given.output))[0]
    function = TransferFunction(given.tf or "viridis")  # a wrong name is found before anything is written
    options: dict[str, Any] = {"resolution": given.resolution, "fields": given.field or None}
    if given.steps is None:
        files, codes = [base + ".vdb"], [0]
        write_vdb(read_mesh(given.mesh), files[0], **options)
    else:
        series = open_series(given.mesh)
        codes = list(_steps(given.steps, series))
        files = [f"{base}_{step:04}.vdb" for step in codes]
        for step, file in zip(codes, files):
            write_vdb(series[step], file, **options)
    write_usd(given.output, tuple(files), codes=codes, tf=function)
    return f"{given.output}, and {len(files)} .vdb {'file' if len(files) == 1 else 'files'}"


def main() -> int:
    parser = argparse.ArgumentParser(prog="python3 -m subvol.usd", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mesh", metavar="MESH", help="a mesh, or a series with --steps")
    parser.add_argument("-o", "--output", metavar="NAME.usda", required=True, help="the file to write")
    parser.add_argument("--field", metavar="NAME", action="append", help="a field that is written (repeatable; default: the most sensible one)")
    parser.add_argument("--resolution", metavar="N", type=int, default=200, help="voxels along the longest side (default 200)")
    parser.add_argument("--steps", metavar="A-B", help="steps of a series, or all")
    parser.add_argument("--tf", metavar="NAME", help="the colour map (default viridis)")
    with warnings.catch_warnings():
        warnings.simplefilter("always", SubvolWarning)
        warnings.showwarning = lambda message, *_: print(f"subvol.usd: warning: {message}", file=sys.stderr)
        try:
            print(_convert(parser.parse_args()))
        except (Error, OSError) as error:
            print(f"subvol.usd: {error}", file=sys.stderr)
            return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
