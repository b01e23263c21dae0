// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "subvol/progress.h"
#include "subvol/scheme.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// A place in a boundary face: in steps of the finest grid, along its corners 0→1 and 0→3.
using FacePlace = std::array<std::uint16_t, 2>;

inline constexpr std::uint32_t kNoVertex = ~std::uint32_t{0};

/// A vertex of a leaf: its number, and where it lies in the face.
struct LeafVertex {
    std::uint32_t vertex;
    FacePlace at;
};

/// A part of a boundary face that is not refined further.
struct HullLeaf {
    Index face = 0;                  ///< a face of the topology
    int level = 0;                   ///< 0: the whole face
    std::vector<LeafVertex> ring{};  ///< its corners, and between them the vertices that finer neighbours have on its sides
    /// The vertices at the middles of its sides, where the side is not divided; kNoVertex if it has not been computed
    std::array<std::uint32_t, 4> middles{};
    std::array<std::uint32_t, 4> corners{};  ///< where they are in `ring`
    LeafVertex center{};                     ///< kNoVertex if it has not been computed
    double bend = 0;  ///< how far the limit's place is from the middles of its sides, or its centre from a diagonal
};

/// Values beside the places of points, each scaled so that where it bends counts as where the boundary does.
struct HullFields {
    std::span<const double> values{};  ///< `channels` numbers for each point
    std::size_t channels = 0;

    [[nodiscard]] std::span<const double> at(std::size_t point) const { return values.subspan(point * channels, channels); }
};

struct HullLevelOptions {
    double bend_world = 0;          ///< leaves bend by no more, unless one of the other limits ends the refinement
    HullFields fields{};            ///< of the points of the mesh
    int max_level = 6;              ///< 1 to 8
    std::size_t max_triangles = 0;  ///< about the most that leaves may have
    Progress* progress = nullptr;
};

/// The boundary of the limit as leaves.
struct HullLeaves {
    std::vector<Vec3> vertices;    ///< places on the limit
    std::vector<HullLeaf> leaves;  ///< by their cells, the sides of these, and levels
    int level = 0;                 ///< the finest
};

/// Refines the boundary of a mesh where its limit bends.
///
/// mesh:   the scheme must interpolate; the rules of the boundary use points of the boundary alone
/// chosen: a flag for each cell whose boundary faces are wanted; empty: all
/// cost:   a microsecond for each vertex of the finest faces
[[nodiscard]] HullLeaves refine_hull(const HexMesh& mesh, const Topology& topology, std::span<const std::uint8_t> chosen,
                                     const SchemeOptions& scheme, const HullLevelOptions& options);

/// Steps of the finest grid along a side of a face.
[[nodiscard]] constexpr std::uint16_t hull_steps(int max_level) {
    return static_cast<std::uint16_t>(2U << max_level);
}

}  // namespace subvol::detail
