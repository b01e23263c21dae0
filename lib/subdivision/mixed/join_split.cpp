// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>
#include <string>

#include "subvol/detail/place_function.h"
#include "subvol/error.h"
#include "subvol/mixed_mesh.h"

namespace subvol {

namespace {

/// The inverse of `split_into_hexes`, which readers apply to meshes of tetrahedra and prisms. The children of a cell follow
/// each other and share its middle point, which is corner 6 of each of them: four for a tetrahedron, six for a prism, eight for
/// a hexahedron.
///
/// Finds the cell of a group of children by its corners: child k is at corner k, which is its own first corner; its corner 1 is
/// the middle of the edge to the first of the neighbours in the split's order.
class Joiner {
public:
    explicit Joiner(const HexMesh& split) : cells_(split.cells) {}

    /// Nothing if the hexahedra do not come from such a split.
    std::optional<MixedCells> join(std::vector<std::array<Index, 8>>& hexes) const {
        MixedCells others;
        for (std::size_t first = 0; first < cells_.size();) {
            std::size_t end = first + 1;
            while (end < cells_.size() && cells_[end][6] == cells_[first][6]) ++end;
            switch (end - first) {
                case 4:
                    others.tets.push_back(corners<4>(first));
                    break;
                case 6:
                    others.prisms.push_back(corners<6>(first));
                    break;
                case 8:
                    hexes.push_back(corners<8>(first));
                    break;
                default:
                    return std::nullopt;
            }
            if (!is_split(first, end)) return std::nullopt;
            first = end;
        }
        return others;
    }

private:
    template <std::size_t N>
    std::array<Index, N> corners(std::size_t first) const {
        std::array<Index, N> result;
        for (std::size_t k = 0; k < N; ++k) result[k] = cells_[first + k][0];
        return result;
    }

    /// Whether the corners of a cell come before all middles, as the split numbers them.
    bool is_split(std::size_t first, std::size_t end) const {
        // Hexahedra of any mesh may share their corner 6 by chance. The numbers of corners and middles tell them from a split.
        Index last_corner = 0, first_middle = kNone;
        for (std::size_t c = first; c < end; ++c) {
            last_corner = std::max(last_corner, cells_[c][0]);
            for (std::size_t k = 1; k < 8; ++k) first_middle = std::min(first_middle, cells_[c][k]);
        }
        return last_corner < first_middle;
    }

    const std::vector<std::array<Index, 8>>& cells_;
};

std::array<Index, 2> in_order(Index a, Index b) {
    return {std::min(a, b), std::max(a, b)};
}

/// The creases that are no edges of sharp faces.
std::vector<std::array<Index, 2>> creases_outside(const HexMesh& mesh) {
    std::vector<std::array<Index, 2>> inside, outside;
    for (const auto& face : mesh.sharp_faces) {
        for (std::size_t k = 0; k < 4; ++k) inside.push_back(in_order(face[k], face[(k + 1) % 4]));
    }
    std::sort(inside.begin(), inside.end());
    for (const auto& [a, b] : mesh.creases) {
        if (!std::binary_search(inside.begin(), inside.end(), in_order(a, b))) outside.push_back({a, b});
    }
    return outside;
}

/// The edges whose halves are creases. A half goes from a corner to a middle, which has the greater number.
std::vector<std::array<Index, 2>> joined_creases(std::vector<std::array<Index, 2>> halves) {
    for (auto& half : halves) half = {std::max(half[0], half[1]), std::min(half[0], half[1])};  // the middle first
    std::sort(halves.begin(), halves.end());
    halves.erase(std::unique(halves.begin(), halves.end()), halves.end());
    std::vector<std::array<Index, 2>> edges;
    for (std::size_t i = 0; i < halves.size(); i += 2) {
        if (i + 1 == halves.size() || halves[i][0] != halves[i + 1][0]) {
            throw Error(ErrorCode::InvalidInput, "a crease lies within a face of a cell that was split",
                        "points " + std::to_string(halves[i][1]) + " and " + std::to_string(halves[i][0]),
                        "creases along the edges of cells, or --scheme mcq");
        }
        edges.push_back({halves[i][1], halves[i + 1][1]});
    }
    return edges;
}

}  // namespace

MixedMesh join_split_cells(const HexMesh& split) {
    HexMesh joined;
    const auto others = Joiner(split).join(joined.cells);
    const auto creases = creases_outside(split);
    joined.points = split.points;
    joined.attributes = detail::without_functions(split.attributes);
    joined.creases = others ? joined_creases(creases) : creases;
    if (!others) joined.cells = split.cells;
    return make_mixed_mesh(joined, others.value_or(MixedCells{}));
}

}  // namespace subvol
