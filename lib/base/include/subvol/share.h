// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

namespace subvol {

/// One of several equal shares of a work: of cells, kernels, bricks, rows or layers of voxels. All shares together are the
/// whole.
struct Share {
    int number = 1;  ///< from 1 to `count`
    int count = 1;

    [[nodiscard]] bool whole() const { return count == 1; }

    /// The first of so many things that is the share's, and the first that is not: all shares together have each once.
    [[nodiscard]] std::pair<std::size_t, std::size_t> range(std::size_t things) const;

    /// The same of layers that weigh something, so that all shares weigh about the same. A layer belongs to the share in which
    /// its middle lies; a share may have none.
    ///
    /// weights: of the layers, not negative
    [[nodiscard]] std::pair<std::size_t, std::size_t> range_by_weight(std::span<const double> weights) const;

    /// "2/4"
    [[nodiscard]] std::string name() const;
};

/// What a share has of a work: the things from `begin` to before `end`, of so many.
struct ShareRange {
    std::uint64_t begin = 0, end = 0, count = 0;
};

/// throws: Error(InvalidInput) unless the number is from 1 to the count
void validate(const Share& share);

}  // namespace subvol
