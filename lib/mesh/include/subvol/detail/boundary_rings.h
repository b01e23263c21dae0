// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "subvol/topology.h"

namespace subvol::detail {

/// How a point moves: with the cells around it, with the faces of the boundary, with its two crease edges, or not at all.
enum class PointKind : std::uint8_t { Interior, Smooth, Crease, Corner };

/// The kind of every point. On the boundary it is smooth without crease edges, on a crease with exactly two of them, else a
/// corner. A point where several fans of boundary faces touch is a corner too, unless all of them lie between the same two
/// crease edges: bodies touch along a curve there.
std::vector<PointKind> classify_points(const Topology& topology);

/// Whether several fans of boundary faces touch in a boundary point alone: its boundary edges all have two faces.
[[nodiscard]] bool is_touching_point(const Topology& topology, Index point);

/// A flag for each point: whether it is inside, with six edges of four cells each.
std::vector<std::uint8_t> regular_points(const Topology& topology);

/// The boundary face on the other side of a boundary edge that is not a crease.
Index other_boundary_face(const Topology& topology, Index edge, Index face);

/// The boundary faces of a boundary edge (two where it is manifold).
std::pair<Index, Index> boundary_faces_of(const Topology& topology, Index edge);

/// Writes the boundary edges at a smooth boundary point to `ring`, in cyclic order, starting at `start`.
void ring_of_spokes(const Topology& topology, Index point, Index start, std::vector<Index>& ring);

/// The position of an element that occurs once in a small array.
inline std::size_t slot_of(std::span<const Index> range, Index element) {
    return static_cast<std::size_t>(std::find(range.begin(), range.end(), element) - range.begin());
}

template <std::size_t N>
std::size_t slot_of(const std::array<Index, N>& range, Index element) {
    std::uint32_t slot = 0;  // without branches, which would be unpredictable
    for (std::uint32_t k = 1; k < N; ++k) slot |= range[k] == element ? k : 0;
    return slot;
}

inline Index other_end(const Topology& topology, Index edge, Index point) {
    const auto [a, b] = topology.edges[edge];
    return a == point ? b : a;
}

}  // namespace subvol::detail
