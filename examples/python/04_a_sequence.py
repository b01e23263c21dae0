# SPDX-License-Identifier: Apache-2.0
"""A mesh that moves, as a sequence of .vdb files: its cells are refined once. `04_a_sequence.py [PIXELS]`"""
import sys

import numpy as np
import subvol

size = int(sys.argv[1]) if len(sys.argv) > 1 else 256
rest = subvol.model("ball", 4)
table = subvol.Refinement(rest, levels=2)
density = table.apply(rest.fields["density"])
frames = []
for frame in range(6):
    # The points swing; whatever computes them (a solver, an animation) would do so here.
    t = frame / 6 * 2 * np.pi
    points = rest.points * [1 + 0.25 * np.sin(t), 1 - 0.2 * np.sin(t), 1]
    fine = subvol.HexMesh(table.apply(points), table.cells, {"density": density})
    (grid,) = subvol.write_vdb(fine, f"swing_{frame:04d}.vdb", resolution=64, levels=0, fields=["density"])
    print(f"swing_{frame:04d}.vdb: {grid['active_voxels']} voxels")
    frames.append(np.asarray(subvol.render(subvol.HexMesh(points, rest.cells, rest.fields), size=(size, size), tf="coolwarm", look="solid",
                                           camera=subvol.Camera((3, -3, 2.2), (0, 0, 0), fovy_deg=35))))
subvol.write_image(np.concatenate(frames, axis=1), "swing.png", background=(0.77, 0.79, 0.81))
