// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/cell_splits.h"

#include <algorithm>

#include "subvol/cell.h"

namespace subvol {

std::array<std::array<Index, 4>, 6> split_cell(const std::array<Index, 8>& cell) {
    const auto apex = *std::min_element(cell.begin(), cell.end());
    std::array<std::array<Index, 4>, 6> tets{};  // of a cell that repeats its apex some stay without corners
    std::size_t count = 0;
    for (const auto& face : kCellFaces) {
        std::array<Index, 4> quad;
        for (std::size_t k = 0; k < 4; ++k) quad[k] = cell[face[k]];
        if (std::find(quad.begin(), quad.end(), apex) != quad.end()) continue;
        std::rotate(quad.begin(), std::min_element(quad.begin(), quad.end()), quad.end());
        // The quad is counter-clockwise seen from outside and the apex lies behind it: the order (0,2,1) turns the base
        // inwards.
        tets[count++] = {quad[0], quad[2], quad[1], apex};
        tets[count++] = {quad[0], quad[3], quad[2], apex};
    }
    return tets;
}

namespace detail {

namespace {

// Turns left-handed cells. Each kind of cell is a hexahedron some of whose corners coincide, and its volume is that
// hexahedron's.
//
// as_hex: the cell's corners as those of a hexahedron
// turned: the order of the corners that makes a left-handed cell right-handed
template <std::size_t N>
void orient(std::span<const Vec3> points, std::vector<std::array<Index, N>>& cells, const std::array<std::size_t, 8>& as_hex,
            const std::array<std::size_t, N>& turned) {
    for (auto& cell : cells) {
        std::array<Vec3, 8> corners;
        for (std::size_t k = 0; k < 8; ++k) corners[k] = points[cell[as_hex[k]]];
        if (!(cell_volume(corners) < 0)) continue;
        const auto before = cell;
        for (std::size_t k = 0; k < N; ++k) cell[k] = before[turned[k]];
    }
}

// As split_cell: the triangles of the faces that are not at the corner with the smallest id are joined to it.
std::array<std::array<Index, 4>, 3> cut_prism(const std::array<Index, 6>& prism) {
    const Index apex = *std::min_element(prism.begin(), prism.end());
    std::array<std::array<Index, 4>, 3> tets;
    std::size_t count = 0;
    for (const auto& face : kPrismShape.faces) {
        std::array<Index, 4> quad;
        for (std::size_t k = 0; k < 4; ++k) quad[k] = prism[face[k]];
        if (std::find(quad.begin(), quad.end(), apex) != quad.end()) continue;
        const bool triangle = quad[2] == quad[3];
        if (!triangle) std::rotate(quad.begin(), std::min_element(quad.begin(), quad.end()), quad.end());
        tets[count++] = {quad[0], quad[2], quad[1], apex};
        if (!triangle) tets[count++] = {quad[0], quad[3], quad[2], apex};
    }
    return tets;
}

std::array<std::array<Index, 4>, 2> cut_pyramid(const std::array<Index, 5>& pyramid) {
    std::array<Index, 4> base;
    std::copy_n(pyramid.begin(), 4, base.begin());
    std::rotate(base.begin(), std::min_element(base.begin(), base.end()), base.end());
    return {{{base[0], base[1], base[2], pyramid[4]}, {base[0], base[2], base[3], pyramid[4]}}};
}

}  // namespace

void orient_mixed(std::span<const Vec3> points, std::vector<std::array<Index, 8>>& hexes, MixedCells& others) {
    orient<8>(points, hexes, {0, 1, 2, 3, 4, 5, 6, 7}, {4, 5, 6, 7, 0, 1, 2, 3});
    orient<4>(points, others.tets, {0, 1, 2, 2, 3, 3, 3, 3}, {0, 1, 3, 2});
    orient<6>(points, others.prisms, {0, 1, 2, 2, 3, 4, 5, 5}, {3, 4, 5, 0, 1, 2});
    orient<5>(points, others.pyramids, {0, 1, 2, 3, 4, 4, 4, 4}, {0, 3, 2, 1, 4});
}

CutCells cut_to_tets(const std::vector<std::array<Index, 8>>& hexes, const MixedCells& others) {
    CutCells cut;
    Index parent = 0;
    const auto add = [&](const auto& tets) {
        cut.tets.insert(cut.tets.end(), tets.begin(), tets.end());
        cut.parents.insert(cut.parents.end(), tets.size(), parent++);
    };
    for (const auto& hex : hexes) add(split_cell(hex));
    for (const auto& tet : others.tets) add(std::array<std::array<Index, 4>, 1>{tet});
    for (const auto& prism : others.prisms) add(cut_prism(prism));
    for (const auto& pyramid : others.pyramids) add(cut_pyramid(pyramid));
    return cut;
}

}  // namespace detail

}  // namespace subvol
