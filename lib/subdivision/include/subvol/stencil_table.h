// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol {

/// A sparse matrix in compressed rows: row r has columns[offsets[r] .. offsets[r+1]), ascending, with their weights.
struct CsrMatrix {
    std::vector<std::size_t> offsets{0};
    std::vector<Index> columns;
    std::vector<double> weights;
};

/// The stencils of a refinement: every point of the finer level as a weighted sum of points of the coarser level.
///
/// A row is stored as runs of points that have the same weight. Rows with the same weights share them, so a regular row costs
/// little more than its point ids. Rows come in blocks of a few thousand, in the order of the finer points.
class StencilTable {
public:
    struct Run {
        double weight = 0;
        std::uint32_t count = 0;
        bool operator==(const Run&) const = default;
    };

    /// Consecutive rows. Pattern k is runs[pattern_offsets[k] .. pattern_offsets[k+1]); row i has the pattern row_patterns[i]
    /// and uses as many entries of `points` as its runs count, after those of the rows before it.
    struct Block {
        std::size_t first_row = 0;
        std::vector<Index> points;
        std::vector<std::uint16_t> row_patterns;
        std::vector<std::uint32_t> pattern_offsets{0};
        std::vector<Run> runs;
    };

    StencilTable() = default;

    /// kept: how many leading points stay as they are; the blocks hold the rows after them
    StencilTable(std::size_t columns, std::size_t kept, std::vector<Block> blocks);

    [[nodiscard]] std::size_t rows() const { return rows_; }
    [[nodiscard]] std::size_t columns() const { return columns_; }
    [[nodiscard]] std::size_t kept() const { return kept_; }
    [[nodiscard]] std::size_t terms() const;
    [[nodiscard]] std::size_t bytes() const;
    [[nodiscard]] const std::vector<Block>& blocks() const { return blocks_; }

    /// Applies the stencils to data of the coarser points: any number of channels, point-major. Sums are in double precision.
    ///
    /// in:     columns() × channels values
    /// out:    rows() × channels values, all written
    /// throws: Error(InvalidInput) if a size is wrong
    /// cost:   parallel; bitwise the same for any number of threads
    void apply(std::span<const double> in, std::size_t channels, std::span<double> out) const;
    void apply(std::span<const float> in, std::size_t channels, std::span<float> out) const;

    /// The composition: `first`, then this table. Its rows are over the points that `first` starts from.
    [[nodiscard]] StencilTable after(const StencilTable& first) const;

    [[nodiscard]] CsrMatrix csr() const;

private:
    std::size_t rows_ = 0, columns_ = 0, kept_ = 0;
    std::vector<Block> blocks_;
};

}  // namespace subvol
