// SPDX-License-Identifier: Apache-2.0
#include "model_solid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "model_parts.h"

namespace subvol::model {
namespace {

std::array<Index, 3> lattice(const Solid& solid, Index resolution) {
    std::array<Index, 3> cells;
    for (int axis = 0; axis < 3; ++axis) {
        const double share = solid.half[axis] / solid.half[solid.main];
        cells[static_cast<std::size_t>(axis)] = std::max<Index>(1, static_cast<Index>(std::lround(resolution * share)));
    }
    return cells;
}

}  // namespace

Vec3 parameter(const Solid& solid, const Vec3& x) {
    return undo(solid.deformation, x) / solid.half;
}

Vec3 position(const Solid& solid, const Vec3& parameter) {
    return apply(solid.deformation, solid.half * parameter);
}

double density(const Solid& solid, const Vec3& parameter) {
    return std::tanh(solid.distance(solid.half * parameter) / solid.transition);
}

std::optional<double> value(const Solid& solid, const Vec3& x) {
    const Vec3 p = parameter(solid, x);
    if (!in_block(p)) return std::nullopt;
    return density(solid, p);
}

HexMesh make_solid(const Solid& solid, Index resolution) {
    HexMesh mesh = parameter_block(lattice(solid, resolution));
    Attribute field{.name = "density", .channels = 1, .values = std::vector<double>(mesh.points.size())};
    tbb::parallel_for(std::size_t{0}, mesh.points.size(), [&](std::size_t p) {
        field.values[p] = density(solid, mesh.points[p]);
        mesh.points[p] = position(solid, mesh.points[p]);
    });
    mesh.attributes.push_back(std::move(field));
    return mesh;
}

}  // namespace subvol::model
