// SPDX-License-Identifier: Apache-2.0
#include "edge_classes.h"

#include <algorithm>
#include <numeric>

#include "subvol/cell.h"

namespace subvol::detail {

namespace {

std::array<Index, 2> key(const std::array<Index, 8>& cell, std::size_t e) {
    const Index a = cell[static_cast<std::size_t>(kCellEdges[e][0])], b = cell[static_cast<std::size_t>(kCellEdges[e][1])];
    return {std::min(a, b), std::max(a, b)};
}

}  // namespace

EdgeClasses::EdgeClasses(std::span<const std::array<Index, 8>> cells) {
    for (const auto& cell : cells) {
        for (std::size_t e = 0; e < 12; ++e) keys_.push_back(key(cell, e));
    }
    std::sort(keys_.begin(), keys_.end());
    keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
    parents_.resize(keys_.size());
    std::iota(parents_.begin(), parents_.end(), std::size_t{0});
    for (const auto& cell : cells) {
        for (std::size_t e = 0; e < 12; ++e) {
            if (e % 4 != 0) join(edge(cell, e - e % 4), edge(cell, e));
        }
    }
}

std::size_t EdgeClasses::edge(const std::array<Index, 8>& cell, std::size_t e) const {
    return static_cast<std::size_t>(std::lower_bound(keys_.begin(), keys_.end(), key(cell, e)) - keys_.begin());
}

std::size_t EdgeClasses::class_of(std::size_t edge) const {
    while (parents_[edge] != edge) edge = parents_[edge];
    return edge;
}

void EdgeClasses::join(std::size_t a, std::size_t b) {
    a = class_of(a);
    b = class_of(b);
    for (std::size_t* x : {&a, &b}) parents_[*x] = std::min(a, b);
}

}  // namespace subvol::detail
