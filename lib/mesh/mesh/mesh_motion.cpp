// SPDX-License-Identifier: Apache-2.0
#include "subvol/mesh_motion.h"

#include "subvol/detail/place_function.h"
#include "subvol/error.h"

namespace subvol {

bool same_cells(const HexMesh& a, const HexMesh& b) {
    return moved_cells(a, b) && a.creases == b.creases && a.sharp_faces == b.sharp_faces;
}

bool moved_cells(const HexMesh& a, const HexMesh& b) {
    return a.points.size() == b.points.size() && a.cells == b.cells;
}

HexMesh mesh_between(HexMesh a, const HexMesh& b, double t) {
    const auto refuse = [](const char* what) {
        throw Error(ErrorCode::InvalidInput, std::string("two meshes have other ") + what + ", so that none lies between them");
    };
    if (!moved_cells(a, b)) refuse("cells");
    if (a.attributes.size() != b.attributes.size()) refuse("fields");
    for (std::size_t i = 0; i < a.points.size(); ++i) a.points[i] = (1 - t) * a.points[i] + t * b.points[i];
    for (std::size_t f = 0; f < a.attributes.size(); ++f) {
        Attribute& from = a.attributes[f];
        const Attribute& to = b.attributes[f];
        if (from.name != to.name || from.channels != to.channels || from.arguments.size() != to.arguments.size() ||
            from.cells.size() != to.cells.size())
            refuse("fields");
        const auto mix = [t](auto& mixed, const auto& other) {
            for (std::size_t i = 0; i < mixed.size(); ++i) mixed[i] = (1 - t) * mixed[i] + t * other[i];
        };
        mix(from.values, to.values);
        mix(from.arguments, to.arguments);
        detail::evaluate_at_points(from);
        mix(from.cells, to.cells);
        from.constant = from.constant && to.constant;
        if (from.walls.points == to.walls.points) {
            mix(from.walls.gradients, to.walls.gradients);
        } else {
            from.walls = {};
        }
    }
    return a;
}

Attribute velocity_between(const HexMesh& before, const HexMesh& after, double time, const std::string& name) {
    if (!moved_cells(before, after)) {
        throw Error(ErrorCode::InvalidInput, "a velocity needs two meshes with the same cells; these differ");
    }
    if (!(time > 0)) throw Error(ErrorCode::InvalidInput, "the time between two meshes is not positive");
    Attribute velocity{name, 3, {}};
    velocity.values.reserve(3 * before.points.size());
    for (std::size_t i = 0; i < before.points.size(); ++i) {
        const Vec3 v = (after.points[i] - before.points[i]) / time;
        velocity.values.insert(velocity.values.end(), {v.x, v.y, v.z});
    }
    return velocity;
}

}  // namespace subvol
