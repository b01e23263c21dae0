# SPDX-License-Identifier: Apache-2.0
"""Values of the limit along a line, in the world and in a cell. `03_along_a_line.py` needs matplotlib."""
import matplotlib.pyplot as plt
import numpy as np
import subvol

mesh = subvol.model("twist", 6)
name = next(iter(mesh.fields))
low, high = mesh.bounds
s = np.linspace(0, 1, 400)[:, None]
line = low + s * (high - low)

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.5), layout="constrained")
length = float(np.linalg.norm(high - low))
for label, field in [("limit", subvol.as_field(mesh, name)), ("control mesh", subvol.as_field(mesh, name, levels=0))]:
    values, inside = field.values(line)
    left.plot(s[:, 0] * length, values, label=label)  # nan outside: the line is interrupted
    print(f"{label}: {inside.sum()} of {len(line)} places are inside")
left.set(xlabel="distance along the diagonal", ylabel=name)
left.legend()

# Within a cell there is no search, and derivatives come along.
u = np.linspace(0, 1, 200)
at = subvol.evaluate_limit(mesh, np.full(200, len(mesh.cells) // 2), np.column_stack([u, np.full(200, 0.5), np.full(200, 0.5)]))
right.plot(u, at.fields[name], label=name)
right.plot(u, np.linalg.norm(at.gradients(name), axis=1), label="|gradient|")
right.plot(u, np.linalg.det(at.jacobians), label="det J")
right.set(xlabel="u in one cell")
right.legend()
figure.savefig("line.png", dpi=120)
