// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "boundary_rings.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/topology.h"

namespace subvol {

namespace {

Vec3 quad_normal(const HexMesh& mesh, const std::array<Index, 4>& q) {
    return glm::cross(mesh.points[q[2]] - mesh.points[q[0]], mesh.points[q[3]] - mesh.points[q[1]]);
}

}  // namespace

void tag_creases(HexMesh& mesh, double angle_deg) {
    if (!(angle_deg > 0 && angle_deg < 180)) {
        throw Error(ErrorCode::InvalidInput, "the crease angle is " + detail::number_text(angle_deg), {},
                    "between 0 and 180 degrees");
    }
    const Topology topology = build_topology(mesh);
    const double limit = std::cos(angle_deg * std::numbers::pi / 180);
    for (std::size_t e = 0; e < topology.edges.size(); ++e) {
        const auto edge = static_cast<Index>(e);
        if (!topology.edge_on_boundary[e] || topology.edge_is_crease[e]) continue;
        const auto [f0, f1] = detail::boundary_faces_of(topology, edge);
        const auto [a, b] = topology.edges[e];
        // One quad is oriented so that its edge goes from a to b, the other from b to a: on a plane their normals are then
        // equal.
        const auto normal = [&](Index face, Index from, Index to) {
            const auto& q = topology.faces[face];
            const std::size_t k = detail::slot_of(q, from);
            const Vec3 n = quad_normal(mesh, q);
            return q[(k + 1) % 4] == to ? n : -n;
        };
        const Vec3 n0 = normal(f0, a, b), n1 = normal(f1, b, a);
        if (glm::dot(n0, n1) < limit * glm::length(n0) * glm::length(n1)) mesh.creases.push_back({a, b});
    }
}

}  // namespace subvol
