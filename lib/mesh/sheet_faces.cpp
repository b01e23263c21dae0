// SPDX-License-Identifier: Apache-2.0
#include "sheet_faces.h"

#include <algorithm>
#include <utility>

#include "subvol/cell.h"

namespace subvol::detail {

namespace {

template <std::size_t N, std::size_t Parts>
std::vector<std::uint8_t> are_parts(std::span<const std::array<Index, N>> items, std::span<const std::array<Index, 8>> hexes,
                                    std::size_t points, const std::array<std::array<int, N>, Parts>& parts) {
    using Item = std::pair<std::array<Index, N>, std::size_t>;
    std::vector<Item> sorted;
    std::vector<std::uint8_t> used(points, 0), found(items.size(), 0);
    for (std::size_t i = 0; i < items.size(); ++i) {
        sorted.emplace_back(items[i], i);
        std::sort(sorted.back().first.begin(), sorted.back().first.end());
        for (const Index p : items[i]) used[p] = 1;
    }
    if (items.empty()) return found;
    std::sort(sorted.begin(), sorted.end());
    for (const auto& hex : hexes) {
        for (const auto& part : parts) {
            std::array<Index, N> key;
            bool all = true;
            for (std::size_t k = 0; k < N; ++k) {
                key[k] = hex[static_cast<std::size_t>(part[k])];
                all = all && used[key[k]] != 0;
            }
            if (!all) continue;
            std::sort(key.begin(), key.end());
            auto at = std::lower_bound(sorted.begin(), sorted.end(), Item{key, 0});
            for (; at != sorted.end() && at->first == key; ++at) found[at->second] = 1;
        }
    }
    return found;
}

}  // namespace

std::vector<std::uint8_t> are_faces(std::span<const std::array<Index, 4>> quads, std::span<const std::array<Index, 8>> hexes,
                                    std::size_t points) {
    return are_parts(quads, hexes, points, kCellFaces);
}

std::vector<std::uint8_t> are_edges(std::span<const std::array<Index, 2>> lines, std::span<const std::array<Index, 8>> hexes,
                                    std::size_t points) {
    return are_parts(lines, hexes, points, kCellEdges);
}

}  // namespace subvol::detail
