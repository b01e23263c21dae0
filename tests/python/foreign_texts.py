# SPDX-License-Identifier: Apache-2.0
"""Files of other programs: a cube of 2 x 2 x 2 cells with side 2, where T = x + 2 y + 3 z at points, and q is the number of the cell."""
import struct

POINTS = [(x, y, z) for z in (0., 1., 2.) for y in (0., 1., 2.) for x in (0., 1., 2.)]
CELLS = [[first + d for d in (1, 2, 5, 4, 10, 11, 14, 13)] for first in (0, 1, 3, 4, 9, 10, 12, 13)]  # of points from 1
T = [x + 2 * y + 3 * z for x, y, z in POINTS]


def line(values):
    return " ".join(f"{value:g}" for value in values) + "\n"


def lines(rows):
    return "".join(map(line, rows))


def numbered(rows):
    return "".join(f"{k + 1} {line(row)}" for k, row in enumerate(rows))


def nastran():
    corners = [[f"{corner:8d}" for corner in cell] for cell in CELLS]
    cells = "".join(f"CHEXA   {k + 1:8d}{1:8d}{''.join(cell[:6])}+\n+       {''.join(cell[6:])}\n" for k, cell in enumerate(corners))
    return "CEND\nBEGIN BULK\n" + "".join(f"GRID,{k + 1},,{x:g},{y:g},{z:g}\n" for k, (x, y, z) in enumerate(POINTS)) + cells + "ENDDATA\n"


def tecplot():
    """One zone of bricks, with q at cells."""
    head = 'VARIABLES = "X" "Y" "Z" "T" "q"\nZONE T="cube", NODES=27, ELEMENTS=8, DATAPACKING=BLOCK, ZONETYPE=FEBRICK, VARLOCATION=([5]=CELLCENTERED)\n'
    return head + lines([*zip(*POINTS), T, range(8)]) + lines(CELLS)


def tecplot_zones():
    """Two ordered zones side by side, of which VTK alone reads both."""
    zones = [f'ZONE T="z{k}", I=3, J=3, K=3, F=POINT\n' + lines((x + 2 * k, y, z, t + 2 * k) for (x, y, z), t in zip(POINTS, T)) for k in (0, 1)]
    return 'VARIABLES = "X" "Y" "Z" "T"\n' + "".join(zones)


def ucd():
    cells = "".join(f"{k + 1} {1 + k % 2} hex {line(cell)}" for k, cell in enumerate(CELLS))
    return "27 8 1 1 0\n" + numbered(POINTS) + cells + "1 1\nT, K\n" + numbered([t] for t in T) + "1 1\nq, W\n" + numbered([k] for k in range(8))


def gambit():
    """A brick's corners are counted in rows."""
    points = "".join(f"{k + 1:10d}{x:20.11e}{y:20.11e}{z:20.11e}\n" for k, (x, y, z) in enumerate(POINTS))
    rows = [[cell[k] for k in (0, 1, 3, 2, 4, 5, 7, 6)] for cell in CELLS]
    cells = "".join(f"{k + 1:8d}  4  8 {''.join(f'{p:8d}' for p in cell[:7])}\n               {cell[7]:8d}\n" for k, cell in enumerate(rows))
    group = "GROUP:          1 ELEMENTS:          8 MATERIAL:          2 NFLAGS:          1\n                           fluid\n       0\n"
    return ("        CONTROL INFO 2.4.6\n** GAMBIT NEUTRAL FILE\ncube\nPROGRAM:                Gambit     VERSION:  2.4.6\nJan 2020\n     NUMNP     NELEM     NGRPS    NBSETS     NDFCD     NDFVL\n"
            f"{27:10d}{8:10d}{1:10d}{0:10d}{3:10d}{3:10d}\nENDOFSECTION\n   NODAL COORDINATES 2.4.6\n{points}ENDOFSECTION\n      ELEMENTS/CELLS 2.4.6\n{cells}ENDOFSECTION\n"
            f"       ELEMENT GROUP 2.4.6\n{group}{''.join(f'{k + 1:8d}' for k in range(8))}\nENDOFSECTION\n")


def fluent():
    """A case, as text, and its data: temperatures 300 + the number of the cell."""
    faces = {}
    for number, cell in enumerate(CELLS):
        for side in ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)):
            corners = [cell[k] for k in reversed(side)]
            faces.setdefault(tuple(sorted(corners)), []).append((corners, number + 1))
    inner, outer = ([face for face in faces.values() if len(face) == count] for count in (2, 1))

    def words(face):
        return " ".join(f"{corner:x}" for corner in face[0][0])

    case = ['(0 "a cube")\n(2 3)\n', f"(10 (0 1 {27:x} 1 3))\n(10 (1 1 {27:x} 1 3)(\n{lines(POINTS)}))\n", "(12 (0 1 8 0))\n(12 (2 1 8 1 4))\n", f"(13 (0 1 {len(faces):x} 0))\n",
            f"(13 (3 1 {len(inner):x} 2 4)(\n", *(f"{words(face)} {face[0][1]:x} {face[1][1]:x}\n" for face in inner), "))\n",
            f"(13 (4 {len(inner) + 1:x} {len(faces):x} 3 4)(\n", *(f"{words(face)} {face[0][1]:x} 0\n" for face in outer), "))\n", "(45 (2 fluid fluid-1)())\n(45 (4 wall wall-4)())\n"]
    data = f'(0 "a cube")\n(4 (60 0 0 1 2 4 4 4 8 8 4))\n(33 (8 {len(faces)} 27))\n(300 (3 2 1 0 0 1 8)(\n' + "".join(f"{300 + k}\n" for k in range(8)) + "))\n"
    return "".join(case), data


def floats(rows):
    return b"".join(struct.pack(f"<{len(row)}f", *row) for row in rows)


def ls_dyna():
    """d3plot and d3plot01: at steps 0 and 1, times 0 and 0.5, the points are (1 + step) times what they were, and the first stress is q."""
    head = [0] * 64
    head[11], head[14], head[15], head[16], head[17] = 1, struct.unpack("<i", struct.pack("<f", 960))[0], 4, 27, 6
    head[18], head[20], head[21], head[23], head[24], head[27], head[30], head[33], head[36] = 13, 1, 1, 8, 1, 7, 6, 33, 3
    end = floats([[-999999]])
    root = struct.pack("<64i", *head) + floats(POINTS) + b"".join(struct.pack("<9i", *cell, 1) for cell in CELLS)
    root += end + struct.pack("<3i", 90001, 1, 1) + b"body".ljust(72) + struct.pack("<i", 90000) + b"a cube".ljust(72)
    states = b""
    for step in range(2):
        scaled = [floats([factor * x for x in point] for point in POINTS) for factor in (1 + step, 10 * step)]
        states += floats([[step / 2], [0] * 13]) + b"".join(scaled) + floats([k, 0, 0, 0, 0, 0, step] for k in range(8))
    return [file + bytes(-len(file) % 2048) for file in (root, states + end)]
