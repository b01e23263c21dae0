// SPDX-License-Identifier: Apache-2.0
#include "flatness.h"

#include "subvol/cell.h"
#include "subvol/vec.h"

namespace subvol::detail {

double flatness_of(const CornerCoordinates& corners, double least, CornerCoordinates& slopes) {
    for (auto& axis : slopes) axis.fill(0);
    double sum = 0;
    for (std::size_t k = 0; k < 8; ++k) {
        std::array<Vec3, 3> edges;
        double lengths = 1;
        for (std::size_t e = 0; e < 3; ++e) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                edges[e][static_cast<int>(axis)] = corners[axis][kCornerNeighbors[k][e]] - corners[axis][k];
            }
            lengths *= glm::length(edges[e]);
        }
        if (!(lengths > 0)) continue;
        const double scaled = glm::dot(edges[0], glm::cross(edges[1], edges[2])) / lengths;
        if (scaled >= least) continue;
        const double below = 1 - scaled / least;
        sum += below * below;
        for (std::size_t e = 0; e < 3; ++e) {
            const Vec3& edge = edges[e];
            const Vec3 of_scaled =
                glm::cross(edges[(e + 1) % 3], edges[(e + 2) % 3]) / lengths - scaled / glm::dot(edge, edge) * edge;
            const Vec3 slope = -2 * below / least * of_scaled;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                slopes[axis][kCornerNeighbors[k][e]] += slope[static_cast<int>(axis)];
                slopes[axis][k] -= slope[static_cast<int>(axis)];
            }
        }
    }
    return sum;
}

}  // namespace subvol::detail
