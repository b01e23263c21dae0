# SPDX-License-Identifier: Apache-2.0
"""Looks at a mesh: what is in it, how good its cells are, and how it looks. `01_look_at_a_mesh.py [PIXELS] [FILE]`"""
import sys

import numpy as np
import subvol

size = int(sys.argv[1]) if len(sys.argv) > 1 else 512
mesh = subvol.read_mesh(sys.argv[2]) if len(sys.argv) > 2 else subvol.model("nozzle")
print(mesh)

report = mesh.report()
print(f"volume {report['volume']:.4g}, worst scaled Jacobian {report['min_scaled_jacobian']:.3f}")
print(f"edges by the number of cells around them: {report['interior_edge_valence']}")
for name, values in mesh.fields.items():
    print(f"{name}: {values.min():.3g} to {values.max():.3g}")

# A mesh is drawn as a lit solid. With a transfer function one sees into it.
solid = subvol.render(mesh, size=(size, size), tf="coolwarm", look="solid")
inside = subvol.render(mesh, size=(size, size), tf=subvol.TransferFunction("coolwarm", opacity="0%:.3,35%:0,65%:0,100%:.3"), per_edge=2)
solid.write("solid.png")
inside.write("inside.png")
print(f"{np.count_nonzero(np.asarray(inside)[..., 3])} pixels show something, {inside.report['points']} kernels were drawn")
