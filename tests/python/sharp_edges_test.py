# SPDX-License-Identifier: Apache-2.0
"""Bodies with flat sides and sharp edges keep their shape by default: closed forms."""
import json

import numpy as np
import pytest
import subvol

EXACT = 1e-9  # of quantities of order 1: what sums of some thousand doubles lose, with much to spare


def grid(n, keep=lambda x: np.ones(len(x), bool)):
    """Points and cells of n^3 cells of a unit cube; those whose middle `keep` chooses."""
    places = np.stack(np.meshgrid(*[np.linspace(0, 1, n + 1)] * 3, indexing="ij"), -1).reshape(-1, 3)
    number = np.arange((n + 1) ** 3).reshape(n + 1, n + 1, n + 1)
    low = number[:-1, :-1, :-1].reshape(-1)
    a, b, c = (n + 1) ** 2, n + 1, 1
    cells = low[:, None] + np.array([0, a, a + b, b, c, a + c, a + b + c, b + c])
    return places, cells[keep(places[cells].mean(1))]


def linear(x):
    return 3 * x[:, 0] - 2 * x[:, 1] + x[:, 2]


def write_vtk(path, points, cells, kind):
    """Legacy VTK; kind: VTK's number of the type of all cells."""
    rows = "\n".join(" ".join(map(str, (len(cell), *cell))) for cell in cells)
    path.write_text("# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\n"
                    f"POINTS {len(points)} double\n" + "\n".join(" ".join(map(repr, map(float, p))) for p in points) +
                    f"\nCELLS {len(cells)} {sum(len(cell) + 1 for cell in cells)}\n{rows}\nCELL_TYPES {len(cells)}\n" + f"{kind}\n" * len(cells) +
                    f"POINT_DATA {len(points)}\nSCALARS f double 1\nLOOKUP_TABLE default\n" + "\n".join(map(repr, map(float, linear(points)))) + "\n")
    return path


# A cube in six tetrahedra, two prisms, six pyramids about its middle, by the corners of VTK's hexahedron.
TETS = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]]
PRISMS = [[0, 1, 2, 4, 5, 6], [0, 2, 3, 4, 6, 7]]
PYRAMIDS = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]


def box_of(kind, n):
    points, cells = grid(n)
    if kind == "pyramids":
        middles = points[cells].mean(1)
        made = [[*cell[side], len(points) + c] for c, cell in enumerate(cells) for side in PYRAMIDS]
        return np.concatenate([points, middles]), made, 14
    parts, number = {"tetrahedra": (TETS, 10), "prisms": (PRISMS, 13)}[kind]
    return points, [list(cell[part]) for cell in cells for part in parts], number


def check(found, volume, integral, least, greatest):
    assert found["volume"] == pytest.approx(volume, abs=EXACT)
    field = found["fields"]["f"]
    assert field["integral"] == pytest.approx(integral, abs=EXACT)
    assert (field["min"], field["max"]) == pytest.approx((least, greatest), abs=EXACT)


@pytest.mark.parametrize("n", [2, 4])
def test_fichera_has_its_volume_and_range(n):
    points, cells = grid(n, lambda x: ~(x > .5).all(1))
    mesh = subvol.HexMesh(points, cells, {"f": linear(points)})
    assert len(mesh.creases) >= 3
    # A cube of 1/8 about (.75, .75, .75) is missing; the greatest value is at (1, 0, 1).
    check(subvol.measure(mesh), 7 / 8, 1 - 2 * .75 / 8, -2, 4)
    clay = subvol.HexMesh(points, cells, {"f": linear(points)}, crease_angle="none")
    assert len(clay.creases) == 0 and abs(subvol.measure(clay)["volume"] - 7 / 8) > .001
    assert clay.creases.tobytes() == subvol.HexMesh(points, cells, creases=np.zeros((0, 2), int)).creases.tobytes()


@pytest.mark.parametrize("kind", ["tetrahedra", "prisms", "pyramids"])
@pytest.mark.parametrize("scheme", ["mcq", "cc", "tetoct"])
def test_boxes_of_other_cells_have_their_volume_and_range(kind, scheme, tmp_path):
    points, cells, number = box_of(kind, 2)
    mesh = subvol.read_mesh(write_vtk(tmp_path / "box.vtk", points, cells, number))
    if scheme == "tetoct":
        fine = subvol.subdivide(mesh, 2, scheme, on_limit=True)
        check(subvol.measure(fine, scheme="linear"), 1, 1, -2, 4)
    elif scheme == "mcq":
        check(subvol.measure(mesh, scheme=scheme), 1, 1, -2, 4)
    else:  # which rounds nothing of a box, but averages values of irregular edges
        assert subvol.measure(mesh, scheme=scheme)["volume"] == pytest.approx(1, abs=EXACT)


def test_a_cube_beside_eight_has_the_volume_of_two(tmp_path):
    coarse, one = grid(1)
    fine, eight = grid(2)
    points = np.concatenate([coarse, fine + [1, 0, 0]])
    path = write_vtk(tmp_path / "hanging.vtk", points, [*one, *(eight + len(coarse))], 12)
    found = subvol.measure(subvol.read_mesh(path, weld=0))
    field = found["fields"]["f"]
    assert found["volume"] == pytest.approx(2, abs=EXACT) and (field["min"], field["max"]) == pytest.approx((-2, 7), abs=EXACT)
    assert field["integral"] == pytest.approx(2 * (3 * 1 - 1 + .5), abs=2e-4 * 9)  # the tolerance of a mean, in parts of the range, times the volume


def test_an_angle_keeps_all_edges_that_bend_by_more():
    sides = 8
    angles = 2 * np.pi * np.arange(sides) / sides
    rings = [np.stack([r * np.cos(angles), r * np.sin(angles), 0 * angles + z], -1) for z in (0, 1, 2) for r in (1, 2)]
    number = np.arange(6 * sides).reshape(3, 2, sides)
    here, there = np.arange(sides), (np.arange(sides) + 1) % sides
    cells = [[number[z + up, r, k] for up in (0, 1) for r, k in ((0, a), (1, a), (1, b), (0, b))] for z in (0, 1) for a, b in zip(here, there)]
    points = np.concatenate(rings)
    assert len(subvol.HexMesh(points, cells).creases) == 0  # a curve in eight steps
    assert len(subvol.HexMesh(points, cells, crease_angle=44).creases) == 4 * sides == len(subvol.HexMesh(points, cells).with_creases(44).creases)
    octagon = subvol.measure(subvol.HexMesh(points, cells, crease_angle=44))["volume"]
    assert octagon == pytest.approx(2 * 3 * 2 * np.sqrt(2), abs=EXACT)  # an octagon of radius r has the area 2 √2 r²
    assert subvol.measure(subvol.HexMesh(points, cells))["volume"] == pytest.approx(6 * np.pi, rel=.01)
    for angle in (-1, 181, "round"):
        with pytest.raises(subvol.InvalidInput):
            subvol.HexMesh(points, cells, crease_angle=angle)


def test_files_of_ours_and_models_keep_what_they_are(tmp_path):
    points, cells = grid(2, lambda x: ~(x > .5).all(1))
    for angle in ("none", "auto"):
        mesh = subvol.HexMesh(points, cells, crease_angle=angle)
        subvol.write_mesh(mesh, tmp_path / "kept.vtu")
        assert subvol.read_mesh(tmp_path / "kept.vtu").creases.tobytes() == mesh.creases.tobytes()
    assert len(subvol.read_mesh(tmp_path / "kept.vtu", crease_angle="none").creases) == 3  # its own
    pawn = subvol.model("pawn", 6)
    subvol.write_mesh(pawn, tmp_path / "pawn.vtu")
    assert len(pawn.creases) == 0 == len(subvol.read_mesh(tmp_path / "pawn.vtu").creases)


def test_the_command_has_the_same_numbers(command, tmp_path):
    points, cells = grid(2, lambda x: ~(x > .5).all(1))
    path = write_vtk(tmp_path / "fichera.vtk", points, cells, 12)
    for given, angle in (([], "auto"), (["--crease-angle", "none"], "none"), (["--crease-angle", "80"], 80)):
        said = json.loads(command("probe", path, "--stats", "--json", *given))
        assert said["stats"]["whole"]["volume"] == subvol.measure(subvol.read_mesh(path, crease_angle=angle))["volume"]
        assert said.get("sharp_edges") == (None if angle == "none" else 3)
