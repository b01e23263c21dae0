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
    using LaneArray = std::array<T, kLanes>;

    // The ray. axis: the coordinates of a point that become x, y and depth.
    alignas(64) std::array<LaneArray<std::int64_t>, 3> axis{};
    std::array<LaneArray<double>, 3> origin{};
    LaneArray<double> slope_x{}, slope_y{}, per_depth{}, speed{};
    // The face that it has crossed last: corners, areas of the edges k → k + 1, and ids.
    std::array<LaneArray<double>, 3> x{}, y{}, t{}, value{}, side{};
    std::array<LaneArray<std::int64_t>, 3> id{};
    // The tetrahedron behind that face, and its corner that is not on the face. At the end of a walk: the last tetrahedron.
    LaneArray<std::int64_t> tet{}, apex{};
    LaneArray<std::int64_t> walking{};         // all bits or none
    LaneArray<double> here_t{}, here_value{};  // the crossing
    LaneArray<double> lit_t{};                 // up to here the ray is integrated
    LaneArray<double> reached{};               // the largest depth that was integrated in this walk
    // The stretch that the last step crossed, of length 0 if it is not to be integrated; the corner that it dropped.
    LaneArray<double> front{}, back{}, length{};
    LaneArray<std::int64_t> dropped{};
};

/// Bit masks of the lanes whose walk ends with a step: at a boundary face, or because vectors cannot decide on which side of an
/// edge the ray passes.
struct TetPacketEnds {
    std::uint32_t boundary = 0, undecided = 0;
};

/// Moves every walking ray across one tetrahedron, with the same bits as `walk` and RayWalker.
TetPacketEnds step(const TetMesh& mesh, TetPacket& packet);

}  // namespace subvol::detail
