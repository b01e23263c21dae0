# SPDX-License-Identifier: Apache-2.0
"""What a notebook shows of a mesh: a small table without a picture."""
from __future__ import annotations

import html
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ._core import HexMesh

_MOST_FIELDS, _LONGEST_NAME = 20, 60


def _name(text: str) -> str:
    """A name of a file as text of a page."""
    shown = "".join(letter if letter.isprintable() else "\ufffd" for letter in text)
    return html.escape(shown if len(shown) <= _LONGEST_NAME else shown[:_LONGEST_NAME - 1] + "…")


def _field(name: str, place: str, values: Any) -> tuple[str, ...]:
    """Name, where it is, components, and the range of the values, or of the lengths of vectors."""
    components = 1 if values.ndim == 1 else values.shape[1]
    numbers = values if components == 1 else np.linalg.norm(values, axis=1)
    there = numbers[np.isfinite(numbers)]
    ends = (f"{there.min():.6g}", f"{there.max():.6g}") if there.size else ("–", "–")
    return _name(name), place, str(components), *ends


def mesh_html(mesh: HexMesh) -> str:
    """Counts, bounds, and the range of each field (of the lengths of vectors) at the points of a mesh, or at its cells."""
    counts = [f"{len(mesh.points):,} points", f"{len(mesh.cells):,} cells"]
    others = {"crease edges": len(mesh.creases), "patches": len(mesh.patches), "sets of cells": len(mesh.sets), "sets of nodes": len(mesh.node_sets)}
    counts += [f"{count:,} {what}" for what, count in others.items() if count]
    low, high = ([f"{x:.6g}" for x in corner] for corner in mesh.bounds)
    box = " × ".join(f"[{a}, {b}]" for a, b in zip(low, high)) if len(mesh.cells) else "none"
    fields = [(name, "points", values) for name, values in mesh.fields.items() if name not in mesh.cell_fields]
    fields += [(name, "cells", values) for name, values in mesh.cell_fields.items()]
    rows = [_field(*field) for field in fields[:_MOST_FIELDS]]
    head = "".join(f"<th>{title}</th>" for title in ("field", "at", "components", "min", "max"))
    lines = "".join("<tr>" + "".join(f"<td>{text}</td>" for text in row) + "</tr>" for row in rows)
    more = f"<div>and {len(fields) - _MOST_FIELDS:,} more fields</div>" if len(fields) > _MOST_FIELDS else ""
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{lines}</tbody></table>{more}" if rows else "<div>no fields</div>"
    return f"<div><b>subvol.HexMesh</b>: {', '.join(counts)}</div><div>bounds: {box}</div>{table}"
