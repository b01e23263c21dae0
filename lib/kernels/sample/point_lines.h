// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/detail/mesh_parts.h"

namespace subvol::detail {

/// The grid lines through every point of a mesh. Entries 2i and 2i+1 of a point are the neighbours on both sides along one
/// line, or a neighbour and kNone where the line ends: at the boundary, at creases, at irregular edges.
struct PointLines {
    FlatArray<std::size_t> starts;  ///< the first entry of each point; the points may have their entries in any order
    FlatArray<Index> counts;        ///< how many entries each point has, an even number
    FlatArray<Index> neighbours;    ///< neighbour of each entry
    FlatArray<std::uint8_t> cells;  ///< for each entry, how many cells have the edge from the point to the neighbour

    [[nodiscard]] std::size_t size() const { return starts.size(); }
    [[nodiscard]] std::size_t end(std::size_t point) const { return starts[point] + counts[point]; }

    /// The point after `at` on the line that comes from its neighbour `from`.
    [[nodiscard]] Index after(Index at, Index from) const {
        for (std::size_t i = starts[at]; i < end(at); ++i) {
            if (neighbours[i] == from) return neighbours[i ^ 1];
        }
        return kNone;
    }
};

/// The lines of the child of a mesh, in the numbering of `refine`, without the child's topology.
[[nodiscard]] PointLines lines_of_child(const Topology& parent);

/// The lines of a mesh from its parts: those of each part follow those of the parts before, so they are in memory once.
class LinesOfParts {
public:
    /// points: of the mesh; every one of them must be the own point of a part
    explicit LinesOfParts(std::size_t points);

    void add(const MeshPart& part);

    [[nodiscard]] PointLines finish() { return std::move(all_); }

private:
    PointLines all_;
};

}  // namespace subvol::detail
