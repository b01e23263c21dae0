// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "tet_walk.h"

namespace subvol::detail {

/// Rays that walk through a mesh side by side, each at a place of its own: a lane is a ray. Numbers as in CrossedFace, RayPlane
/// and LitDepth.
struct TetPacket {
    static constexpr std::size_t kLanes = 16;
    template <class T>
    using Row = std::array<T, kLanes>;

    // The ray. Axes tell which coordinates of a point are seen as x, y and depth.
    alignas(64) std::array<Row<std::int64_t>, 3> axis{};
    std::array<Row<double>, 3> origin{};
    Row<double> slope_x{}, slope_y{}, per_depth{}, speed{};
    // The face that it has crossed: its corners, edges k → k + 1, and ids.
    std::array<Row<double>, 3> x{}, y{}, t{}, value{}, side{};
    std::array<Row<std::int64_t>, 3> id{};
    // The tetrahedron behind, and its corner that is not on the face; at its end the one in which the ray ended.
    Row<std::int64_t> tet{}, apex{};
    Row<std::int64_t> walking{};         // all bits or none
    Row<double> here_t{}, here_value{};  // the crossing
    Row<double> lit_t{};                 // what is integrated already
    Row<double> reached{};               // the largest depth that counted
    // What the last step crossed: a stretch, of no length if it does not count; the corner that it left behind.
    Row<double> front{}, back{}, length{};
    Row<std::int64_t> dropped{};
};

/// Lanes, bit by bit, that a step has brought to an end: at a boundary face, or where vectors cannot decide on which side of an
/// edge the ray is.
struct TetPacketEnds {
    std::uint32_t boundary = 0, undecided = 0;
};

/// Takes every ray that walks across one tetrahedron: to the last bit what `walk` and RayWalker do.
TetPacketEnds step(const TetMesh& mesh, TetPacket& packet);

}  // namespace subvol::detail
