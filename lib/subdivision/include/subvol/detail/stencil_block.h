// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unordered_map>

#include "subvol/detail/stencil_row.h"

namespace subvol::detail {

/// The most rows of a block; patterns are numbered with 16 bits.
inline constexpr std::size_t kBlockRows = 4096;

/// Writes rows into a block one after the other. Rows with the same weights share a pattern.
class StencilBlockWriter {
public:
    /// Clears the block but keeps its memory.
    void start(std::size_t first_row);
    void push(const StencilRuns& row);
    [[nodiscard]] const StencilTable::Block& block() const { return block_; }

private:
    [[nodiscard]] bool is_pattern(std::size_t pattern, std::span<const StencilTable::Run> runs) const;
    std::size_t find_pattern(std::span<const StencilTable::Run> runs);

    StencilTable::Block block_;
    std::size_t last_ = 0;
    std::unordered_multimap<std::size_t, std::size_t> by_hash_;
};

/// Applies a block's rows to data of the coarser points; row i goes to out + i × channels.
void apply_block(const StencilTable::Block& block, const double* in, std::size_t channels, double* out);
void apply_block(const StencilTable::Block& block, const float* in, std::size_t channels, float* out);

}  // namespace subvol::detail
