// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/transposed_table.h"

#include <string>

#include "subvol/detail/parallel_sums.h"
#include "subvol/error.h"

namespace subvol::detail {

std::vector<double> apply_transpose(const StencilTable& table, std::span<const double> fine, std::size_t channels) {
    if (fine.size() != table.rows() * channels) {
        throw Error(ErrorCode::InvalidInput, "the transpose of a table of " + std::to_string(table.rows()) + " rows over " +
                                                 std::to_string(fine.size()) + " values of " + std::to_string(channels) +
                                                 " channels");
    }
    const auto& blocks = table.blocks();
    const std::size_t size = table.columns() * channels;
    std::vector<double> sums = parallel_sums(size, blocks.size(), [&](std::size_t b, std::vector<double>& into) {
        const StencilTable::Block& block = blocks[b];
        const Index* point = block.points.data();
        for (std::size_t row = 0; row < block.row_patterns.size(); ++row) {
            const double* values = &fine[(block.first_row + row) * channels];
            const std::size_t pattern = block.row_patterns[row];
            for (std::size_t r = block.pattern_offsets[pattern]; r < block.pattern_offsets[pattern + 1]; ++r) {
                const StencilTable::Run& run = block.runs[r];
                for (std::uint32_t k = 0; k < run.count; ++k, ++point) {
                    for (std::size_t c = 0; c < channels; ++c) into[*point * channels + c] += run.weight * values[c];
                }
            }
        }
    });
    for (std::size_t k = 0; k < table.kept() * channels; ++k) sums[k] += fine[k];
    return sums;
}

}  // namespace subvol::detail
