# SPDX-License-Identifier: Apache-2.0
"""A region of --only means the same in every command: each command's figure of each region against one that is made here."""

import itertools
import math
import unittest

from command import InFolder, subvol

# A bar of 2 x 2 x 6 unit cubes along z, whose limit is the bar, as its edges are sharp.
SIZE = (2, 2, 6)
POINTS = [(x, y, z) for z in range(7) for y in range(3) for x in range(3)]
NUMBER = {p: i for i, p in enumerate(POINTS)}
AROUND = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
LOWEST = [(x, y, z) for z in range(6) for y in range(2) for x in range(2)]
CELLS = [[NUMBER[x + i, y + j, z + k] for i, j, k in AROUND] for x, y, z in LOWEST]
PROBED = 1, len(CELLS) - 2  # one of each end


def inp(cells):
    """As Abaqus writes it: the upper half is a set, if it is there."""
    upper = [n + 1 for n in cells if LOWEST[n][2] >= 3]
    return ("*NODE\n" + "\n".join(f"{i + 1}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(POINTS)) +
            "\n*ELEMENT, TYPE=C3D8, ELSET=all\n" +
            "\n".join(f"{n + 1}, " + ", ".join(str(p + 1) for p in CELLS[n]) for n in cells) +
            ("\n*ELSET, ELSET=upper\n" + "\n".join(map(str, upper)) if upper else "") + "\n")


def centre(n):
    return tuple(a + .5 for a in LOWEST[n])


# Regions: the cells that they choose, by their centres or corners, and the volume that is cut out of the bar; none: whole cells.
REGIONS = [
    ("box:-1,-1,.2,3,.9,4.7", lambda n: .2 < centre(n)[2] < 4.7 and centre(n)[1] < .9, 2 * .9 * 4.5),
    ("sphere:1,1,3,.9", lambda n: math.dist(centre(n), (1, 1, 3)) < .9, 4 * math.pi / 3 * .9**3),
    ("half:0,0,3.1,0,0,1", lambda n: centre(n)[2] > 3.1, 4 * 2.9),
    ("where:z>3.5", lambda n: LOWEST[n][2] + 1 > 3.5, None),
    ("set:upper", lambda n: LOWEST[n][2] >= 3, None),
    ("block:low", lambda n: LOWEST[n][2] < 2, None),
    ("fold:proved", lambda n: True, None),
    ("fold:folded", lambda n: False, None),
    ("sphere:9,9,9,1", lambda n: False, 0),
    ("where:z>99", lambda n: False, None),
]


def hull_area(cells):
    """Of unit cubes: the sides that have no other cube beside them."""
    taken = {LOWEST[n] for n in cells}
    beside = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    return sum(tuple(map(sum, zip(cell, step))) not in taken for cell in taken for step in beside)


def corners(cells):
    return len({p for n in cells for p in CELLS[n]})


VOXEL = .35  # no voxel's centre lies on a side between two cubes


def voxels(cells):
    return sum(math.prod(sum(low <= VOXEL * k < low + 1 for k in range(99)) for low in LOWEST[n]) for n in cells)


# Commands, and the figure of each: by the command's JSON, and by cells, as a volume, an area or a number.
COMMANDS = {
    "info": (["info", "{}"], lambda found: found["volume"], len),
    "check": (["check", "{}"], lambda found: sum(found["cells"][k] for k in ("proved", "folded", "undecided")), len),
    "subdivide": (["subdivide", "{}", "--levels", "0", "-o", "s.vtu"], lambda found: found["points"], corners),
    "surface": (["surface", "{}", "--boundary", "-o", "s.ply"], lambda found: found["area"], hull_area),
    "slice": (["slice", "{}", "--plane", ".5,.5,3,1,0,0", "--resolution", "96", "-o", "s.csv"],
              lambda found: found["inside"] * found["step"]**2, lambda cells: sum(LOWEST[n][0] == 0 for n in cells)),
    "points": (["points", "{}", "-o", "s.ply"], lambda found: found["points"], corners),
    "compress": (["compress", "{}", "--max-error", "1e-3", "-o", "s.svw"], lambda found: found["points"], corners),
    "vdb": (["vdb", "{}", "--voxel-size", str(VOXEL), "-o", "s.vdb"], lambda found: found["active_voxels"], voxels),
    "split": (["split", "{}", "-o", "bricks{n}"], lambda found: found["cells"], len),
    # The field is x.
    "compare": (["compare", "{}", "{}", "--samples", "100"], lambda found: found["a"]["mass"], lambda cells: sum(centre(n)[0] for n in cells)),
    # Here only that there is something to draw, or nothing.
    "render": (["render", "{}", "--method", "tets", "--size", "8x8", "-o", "s.png"], lambda found: 0, lambda cells: 0),
    "page": (["page", "{}", "-o", "s.html"], lambda found: 0, lambda cells: 0),
    "usd": (["usd", "{}", "-o", "s.usda"], lambda found: 0, lambda cells: 0),
}


class Regions(InFolder):
    def setUp(self):
        super().setUp()
        self.runs = 0
        (self.folder / "a.inp").write_text(inp(range(len(CELLS))))
        for name, lower in ("low", 0), ("high", 1):
            cells = [n for n in range(len(CELLS)) if (LOWEST[n][2] < 2) == (lower == 0)]
            (self.folder / f"{name}.inp").write_text(inp(cells))
            self.run_ok("subdivide", f"{name}.inp", "--levels", "0", "-o", f"{name}.vtu")
        (self.folder / "a.vtm").write_text('<VTKFile type="vtkMultiBlockDataSet"><vtkMultiBlockDataSet>' + "".join(
            f'<DataSet index="{k}" name="{name}" file="{name}.vtu"/>' for k, name in enumerate(("low", "high"))) +
                                           "</vtkMultiBlockDataSet></VTKFile>")

    def run_region(self, arguments, region):
        mesh = "a.vtm" if region.startswith("block") else "a.inp"
        self.runs += 1  # a folder of bricks must be new
        return subvol(*(a.replace("{}", mesh).replace("{n}", str(self.runs)) for a in arguments), "--density", "x", "--only", region, "--json",
                      folder=self.folder)

    def test_every_region_in_every_command(self):
        for (region, chosen, _), (name, (arguments, figure, expected)) in itertools.product(REGIONS, COMMANDS.items()):
            cells = [n for n in range(len(CELLS)) if chosen(n)]
            with self.subTest(region=region, command=name):
                done = self.run_region(arguments, region)
                if not cells:
                    self.assertEqual(done.code, 2, done.err)
                    self.assertIn("no cell lies in the region", done.err)
                    continue
                self.assertEqual(done.code, 0, done.err)
                # A slice counts pixels at its edge as a whole; a mass is summed over a grid of floats.
                delta = .05 * len(cells) if name == "slice" else 1e-4 if name == "compare" else 1e-9
                self.assertAlmostEqual(figure(done.json()), expected(cells), delta=delta)

    def test_probe_cuts_space_and_takes_whole_cells(self):
        for region, chosen, cut in REGIONS:
            cells = [n for n in range(len(CELLS)) if chosen(n)]
            volume = len(cells) if cut is None else cut
            with self.subTest(region=region):
                done = self.run_region(["probe", "{}", "--stats"], region)
                if volume == 0:
                    self.assertEqual(done.code, 2, done.err)
                    self.assertIn("lies in the region", done.err)
                else:
                    whole = done.json()["stats"]["whole"]
                    self.assertAlmostEqual(whole["volume"], volume, delta=(whole["error"] + 1e-9) * volume)
                    low = min(LOWEST[n][0] for n in cells) if cut is None else {"b": 0, "s": .1, "h": 0}[region[0]]
                    self.assertAlmostEqual(whole["fields"][0]["min"], low, delta=whole["fields"][0]["extreme_error"] + 1e-9)
                for n in PROBED:
                    at = ",".join(map(str, centre(n)))
                    done = self.run_region(["probe", "{}", "--at", at], region)
                    if not cells and cut is None:
                        self.assertEqual(done.code, 2, done.err)
                    else:
                        self.assertEqual(done.json()["values"][0]["inside"], n in cells, at)
                done = self.run_region(["probe", "{}", "--patch", "set:upper"] if region != "block:low" else
                                       ["probe", "{}", "--patch", "all"], region)
                if cut is not None or not cells or region == "block:low":  # cells alone have patches; a .vtm has none
                    self.assertEqual(done.code, 2, done.out)
                else:
                    upper = [n for n in cells if LOWEST[n][2] >= 3]
                    self.assertAlmostEqual(done.json()["patches"][0]["area"], hull_area(upper), delta=1e-6)


if __name__ == "__main__":
    unittest.main()
