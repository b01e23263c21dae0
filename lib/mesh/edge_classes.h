// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "subvol/index.h"

namespace subvol::detail {

/// Sets of edges that have to be split alike: opposite edges of a cell, through all cells that follow each other.
class EdgeClasses {
public:
    explicit EdgeClasses(std::span<const std::array<Index, 8>> cells);

    /// The number of edges.
    [[nodiscard]] std::size_t size() const { return keys_.size(); }
    /// The number of edge e of a cell, one of those given.
    [[nodiscard]] std::size_t edge(const std::array<Index, 8>& cell, std::size_t e) const;
    /// The first edge of the set that an edge belongs to.
    [[nodiscard]] std::size_t class_of(std::size_t edge) const;

private:
    void join(std::size_t a, std::size_t b);

    std::vector<std::array<Index, 2>> keys_;  // the points of each edge, sorted
    std::vector<std::size_t> parents_;
};

}  // namespace subvol::detail
