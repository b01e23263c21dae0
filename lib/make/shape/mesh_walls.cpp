// SPDX-License-Identifier: Apache-2.0
#include "mesh_walls.h"

namespace subvol::detail {

void sharpen_walls(HexMesh& mesh, std::span<const Index> materials) {
    mesh.sharp_faces.clear();
    if (materials.empty()) return;
    const Topology topology = build_topology(mesh);
    for (Index f = 0; f < topology.faces.size(); ++f) {
        if (!topology.face_on_hull(f) && wall_of(topology, materials, f) != kNone)
            mesh.sharp_faces.push_back(topology.faces[f]);
    }
}

}  // namespace subvol::detail
