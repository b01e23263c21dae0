# SPDX-License-Identifier: Apache-2.0
"""Sculpts a block with numpy: a few control points are moved, the volume follows. `05_sculpt.py [PIXELS]`"""
import sys

import numpy as np
import subvol

size = int(sys.argv[1]) if len(sys.argv) > 1 else 384
n = 6
u, v, w = np.meshgrid(*[np.linspace(-1, 1, n + 1)] * 3, indexing="ij")
points = np.stack([u, v, w], axis=-1).reshape(-1, 3)
number = np.arange((n + 1) ** 3).reshape(n + 1, n + 1, n + 1)
a, b, c = (n + 1) ** 2, n + 1, 1  # steps along u, v, w
cells = number[:-1, :-1, :-1].reshape(-1, 1) + [0, a, a + b, b, c, a + c, a + b + c, b + c]

# A vase: narrow at its ends, twisted about its axis. Wherever numpy can compute it, points can go.
height = points[:, 2]
radius = 0.7 + 0.25 * np.cos(2.5 * height + 0.4)
angle = 0.6 * height
x, y = points[:, 0] * radius, points[:, 1] * radius
vase = np.column_stack([x * np.cos(angle) - y * np.sin(angle), x * np.sin(angle) + y * np.cos(angle), 1.4 * height])
clay = np.sin(6 * height) * 0.5 + np.hypot(x, y)

mesh = subvol.HexMesh(vase, cells, {"clay": clay})
limit = subvol.subdivide(mesh, 2, "cc", on_limit=True)
print(f"the limit encloses {limit.report()['volume'] / mesh.report()['volume']:.3f} of the control mesh's volume")
edges = subvol.render(mesh, size=(size, size), levels=0, tf="turbo", look="solid")
smooth = subvol.render(mesh, size=(size, size), scheme="cc", tf="turbo", look="solid")
subvol.write_image(np.concatenate([np.asarray(edges), np.asarray(smooth)], axis=1), "vase.png", background=(0.77, 0.79, 0.81))
subvol.write_mesh(limit, "vase.vtu")
