// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>

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

}  // namespace

MixedMesh join_split_cells(const HexMesh& split) {
    HexMesh joined;
    const auto others = Joiner(split).join(joined.cells);
    if (!others) return make_mixed_mesh(split, {});
    if (!split.creases.empty() || !split.sharp_faces.empty()) {
        throw Error(ErrorCode::InvalidInput, "sharp edges and faces of split cells are not kept by the schemes of tetrahedra",
                    {}, "read the mesh without --sharp");
    }
    joined.points = split.points;
    joined.attributes = split.attributes;
    return make_mixed_mesh(joined, *others);
}

}  // namespace subvol
