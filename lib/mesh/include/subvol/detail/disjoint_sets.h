// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "subvol/index.h"

namespace subvol::detail {

/// Numbers from 0 in sets that are joined. Each set is known by its least number, whatever the order of joins.
class DisjointSets {
public:
    explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), Index{0}); }

    /// The least number of a set.
    [[nodiscard]] Index least(Index number) {
        while (parent_[number] != number) number = parent_[number] = parent_[parent_[number]];  // keeps the trees flat
        return number;
    }
    void join(Index a, Index b) {
        a = least(a);
        b = least(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<Index> parent_;
};

}  // namespace subvol::detail
