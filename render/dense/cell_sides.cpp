// SPDX-License-Identifier: Apache-2.0
#include "cell_sides.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>

#include "dense_grid.h"

namespace subvol::detail {

namespace {

/// A side by its control vertices, which are the same for the cell at the other side.
struct SideKey {
    std::array<Index, 4> vertices;  // ascending
    Index cell;
    std::uint8_t side;

    auto operator<=>(const SideKey&) const = default;
};

/// The control vertices of a cell's side: corner k lies at (k mod 2, k / 2) along the two axes after that of the side.
std::array<Index, 4> quad_of_side(const std::array<Index, 8>& cell, std::size_t number) {
    const CellSide side = cell_side(number);
    std::array<Index, 4> quad{};
    for (std::size_t k = 0; k < 8; ++k) {
        const auto at = [&](int axis) { return static_cast<std::size_t>(kCellCorners[k][static_cast<std::size_t>(axis % 3)]); };
        if (static_cast<int>(at(side.axis)) == side.end) quad[at(side.axis + 1) + 2 * at(side.axis + 2)] = cell[k];
    }
    return quad;
}

/// From the corners of one quad to those of the other; open if they come in another order around.
SideLink link_between(const std::array<Index, 4>& from, const std::array<Index, 4>& to, const SideKey& other) {
    std::array<std::size_t, 4> at{};  // where a corner of the one is in the other; bits 0 and 1: along the two axes
    for (std::size_t k = 0; k < 4; ++k) at[k] = static_cast<std::size_t>(std::ranges::find(to, from[k]) - to.begin());
    if ((at[0] ^ at[3]) != 3) return {};
    return {other.cell, other.side, (at[0] ^ at[1]) == 2, {(at[0] & 1) != 0, (at[0] & 2) != 0}};
}

}  // namespace

CellSides::CellSides(std::span<const std::array<Index, 8>> cells) : links_(cells.size()) {
    std::vector<SideKey> keys(6 * cells.size());
    tbb::parallel_for(std::size_t{0}, keys.size(), [&](std::size_t n) {
        const auto cell = static_cast<Index>(n / 6);
        keys[n] = {quad_of_side(cells[cell], n % 6), cell, static_cast<std::uint8_t>(n % 6)};
        std::ranges::sort(keys[n].vertices);
    });
    tbb::parallel_sort(keys.begin(), keys.end());
    for (std::size_t first = 0, end = 0; first < keys.size(); first = end) {
        while (end < keys.size() && keys[end].vertices == keys[first].vertices) ++end;
        const bool collapsed = std::ranges::adjacent_find(keys[first].vertices) != keys[first].vertices.end();
        if (end - first != 2 || collapsed) continue;
        const SideKey &a = keys[first], &b = keys[first + 1];
        const auto quad_a = quad_of_side(cells[a.cell], a.side), quad_b = quad_of_side(cells[b.cell], b.side);
        links_[a.cell][a.side] = link_between(quad_a, quad_b, b);
        links_[b.cell][b.side] = link_between(quad_b, quad_a, a);
    }
}

}  // namespace subvol::detail
