// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh_parts.h"

namespace subvol::detail {

/// The grid lines through every point of a mesh. Entries 2i and 2i+1 of a point are the neighbours on both sides along one
/// line, or a neighbour and kNone where the line ends: at the boundary, at creases, at irregular edges.
///
/// offsets:    point p has the entries offsets[p] to offsets[p+1], an even number
/// neighbours: of each entry
/// cells:      of each entry: how many cells have the edge from the point to the neighbour
struct PointLines {
    FlatArray<std::size_t> offsets;
    FlatArray<Index> neighbours;
    FlatArray<std::uint8_t> cells;

    [[nodiscard]] std::size_t size() const { return offsets.size() - 1; }

    /// The point after `at` on the line that comes from its neighbour `from`.
    [[nodiscard]] Index after(Index at, Index from) const {
        for (std::size_t i = offsets[at]; i < offsets[at + 1]; ++i) {
            if (neighbours[i] == from) return neighbours[i ^ 1];
        }
        return kNone;
    }
};

/// The lines of the child of a mesh, in the numbering of `refine`, without the child's topology.
[[nodiscard]] PointLines lines_of_child(const Topology& parent);

/// The lines of a mesh, assembled from those of its parts.
class LinesOfParts {
public:
    void add(const MeshPart& part);

    /// points: of the mesh; every one of them must be the own point of a part
    [[nodiscard]] PointLines finish(std::size_t points);

private:
    struct Part {
        PointLines lines;
        std::vector<Index> points;
        std::vector<std::uint8_t> own;
    };
    std::vector<Part> parts_;
};

}  // namespace subvol::detail
