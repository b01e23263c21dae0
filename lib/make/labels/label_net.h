// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/label_grid.h"

namespace subvol::detail {

/// The walls between the materials of voxels. A point lies between eight voxels that are not of one material; a quad lies
/// between two neighbours of different ones, and has the four points around the face that they share. Coordinates are those of
/// voxels: their centres are at whole numbers.
struct LabelNet {
    struct Point {
        Vec3 middle{};                             ///< of the eight voxels
        std::array<std::uint32_t, 8> materials{};  ///< of them, x fastest
        /// The points at the other ends of edges, by the direction: −x, +x, −y, +y, −z, +z; kNone where there is no edge
        std::array<Index, 6> next{};
        std::uint8_t lines = 0;  ///< bit d: the edge to `next[d]` is sharp, or three or more materials meet at it
    };
    struct Quad {
        std::array<Index, 4> points;             ///< counter-clockwise seen from the material above
        std::array<std::uint32_t, 2> materials;  ///< below and above; 0 is outside
    };
    std::vector<Point> points;
    std::vector<Quad> quads;
};

/// material: of a label; 0 is outside
/// throws:   Error(InvalidInput) if there are too many points for an Index
[[nodiscard]] LabelNet label_net(const LabelGrid& grid, const std::function<std::uint32_t(std::int32_t)>& material);

/// Adds the sharp edges along the axes to the lines of a net, as far as they are longer and wider than a few voxels.
void mark_sharp_edges(LabelNet& net);

}  // namespace subvol::detail
