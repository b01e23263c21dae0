// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "subvol/split.h"

namespace subvol::detail {

/// The centres of cells, in memory or in files.
class CellCenters {
public:
    virtual ~CellCenters() = default;
    [[nodiscard]] virtual std::size_t count() const = 0;

    /// One coordinate of the centres of some cells, whose numbers ascend. Many threads may call it at once.
    virtual void read(int axis, std::span<const Index> cells, std::span<double> values) const = 0;
};

/// The brick of each cell, as `bricks_of_cells` of a mesh.
///
/// cost: memory: 16 bytes a cell
[[nodiscard]] std::vector<std::uint32_t> bricks_of_cells(const CellCenters& centers, const SplitOptions& options);

}  // namespace subvol::detail
