// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "tet_walk.h"

namespace subvol::detail {

/// Rays that walk through a mesh side by side, each in its own tetrahedron: a lane is a ray. The numbers are those of
/// CrossedFace, RayPlane and LitDepth.
struct TetPacket {
    static constexpr std::size_t kLanes = 16;
    template <class T>
    using Row = std::array<T, kLanes>;

    // The ray. axis: the coordinates of a point that become x, y and depth.
    alignas(64) std::array<Row<std::int64_t>, 3> axis{};
    std::array<Row<double>, 3> origin{};
    Row<double> slope_x{}, slope_y{}, per_depth{}, speed{};
    // The face that it has crossed last: corners, areas of the edges k → k + 1, and ids.
    std::array<Row<double>, 3> x{}, y{}, t{}, value{}, side{};
    std::array<Row<std::int64_t>, 3> id{};
    // The tetrahedron behind that face, and its corner that is not on the face. At the end of a walk: the last tetrahedron.
    Row<std::int64_t> tet{}, apex{};
    Row<std::int64_t> walking{};         // all bits or none
    Row<double> here_t{}, here_value{};  // the crossing
    Row<double> lit_t{};                 // up to here the ray is integrated
    Row<double> reached{};               // the largest depth that was integrated in this walk
    // The stretch that the last step crossed, of length 0 if it is not to be integrated; the corner that it dropped.
    Row<double> front{}, back{}, length{};
    Row<std::int64_t> dropped{};
};

/// Bit masks of the lanes whose walk ends with a step: at a boundary face, or because vectors cannot decide on which side of an
/// edge the ray passes.
struct TetPacketEnds {
    std::uint32_t boundary = 0, undecided = 0;
};

/// Moves every walking ray across one tetrahedron, with the same bits as `walk` and RayWalker.
TetPacketEnds step(const TetMesh& mesh, TetPacket& packet);

}  // namespace subvol::detail
