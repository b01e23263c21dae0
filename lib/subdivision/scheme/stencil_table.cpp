// SPDX-License-Identifier: Apache-2.0
#include "subvol/stencil_table.h"

#include <tbb/parallel_for.h>

#include <cassert>

#include "subvol/detail/row_access.h"
#include "subvol/detail/stencil_block.h"
#include "subvol/error.h"

namespace subvol {

using detail::kBlockRows;
using detail::RowAccess;

namespace {

template <class Body>
void each_block(const std::vector<StencilTable::Block>& blocks, const Body& body) {
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) { body(b); });
}

std::size_t term_count(const StencilTable::Block& block, std::uint16_t pattern) {
    std::size_t count = 0;
    for (std::size_t r = block.pattern_offsets[pattern]; r < block.pattern_offsets[pattern + 1u]; ++r) {
        count += block.runs[r].count;
    }
    return count;
}

template <class T>
void apply_table(const StencilTable& table, std::span<const T> in, std::size_t channels, std::span<T> out) {
    if (in.size() != table.columns() * channels || out.size() != table.rows() * channels) {
        throw Error(ErrorCode::InvalidInput,
                    std::to_string(in.size()) + " values in and " + std::to_string(out.size()) + " out for " +
                        std::to_string(channels) + " channels",
                    "stencil table",
                    std::to_string(table.columns() * channels) + " and " + std::to_string(table.rows() * channels));
    }
    const std::size_t kept = table.kept() * channels;
    tbb::parallel_for(std::size_t{0}, (kept + 65535) / 65536, [&](std::size_t i) {
        const std::size_t begin = i * 65536, end = std::min(kept, begin + 65536);
        std::copy(in.begin() + static_cast<std::ptrdiff_t>(begin), in.begin() + static_cast<std::ptrdiff_t>(end),
                  out.begin() + static_cast<std::ptrdiff_t>(begin));
    });
    each_block(table.blocks(), [&](std::size_t b) {
        const auto& block = table.blocks()[b];
        detail::apply_block(block, in.data(), channels, out.data() + block.first_row * channels);
    });
}

}  // namespace

detail::RowAccess::RowAccess(const StencilTable& table) : table_(table), starts_(table.blocks().size()) {
    each_block(table.blocks(), [&](std::size_t b) {
        const auto& block = table.blocks()[b];
        std::size_t start = 0;
        for (const std::uint16_t pattern : block.row_patterns) {
            starts_[b].push_back(start);
            start += term_count(block, pattern);
        }
    });
    for (const auto& block : table.blocks()) first_rows_.push_back(block.first_row);
}

StencilTable::StencilTable(std::size_t columns, std::size_t kept, std::vector<Block> blocks)
    : rows_(kept), columns_(columns), kept_(kept), blocks_(std::move(blocks)) {
    for (const Block& block : blocks_) {
        assert(block.first_row == rows_);
        rows_ += block.row_patterns.size();
    }
}

std::size_t StencilTable::terms() const {
    std::size_t count = kept_;
    for (const Block& block : blocks_) count += block.points.size();
    return count;
}

std::size_t StencilTable::bytes() const {
    std::size_t bytes = blocks_.capacity() * sizeof(Block);
    for (const Block& block : blocks_) {
        bytes += block.points.capacity() * sizeof(Index) + block.row_patterns.capacity() * sizeof(std::uint16_t) +
                 block.pattern_offsets.capacity() * sizeof(std::uint32_t) + block.runs.capacity() * sizeof(Run);
    }
    return bytes;
}

void StencilTable::apply(std::span<const double> in, std::size_t channels, std::span<double> out) const {
    apply_table(*this, in, channels, out);
}

void StencilTable::apply(std::span<const float> in, std::size_t channels, std::span<float> out) const {
    apply_table(*this, in, channels, out);
}

StencilTable StencilTable::after(const StencilTable& first) const {
    if (first.rows() != columns()) {
        throw Error(ErrorCode::InvalidInput, "a table over " + std::to_string(columns()) +
                                                 " points cannot follow one that makes " + std::to_string(first.rows()));
    }
    const RowAccess first_rows(first), own_rows(*this);
    // Points that both tables keep stay kept; all rows behind them are composed.
    const std::size_t kept = std::min(first.kept(), kept_);
    std::vector<Block> composed((rows_ - kept + kBlockRows - 1) / kBlockRows);
    each_block(composed, [&](std::size_t b) {
        detail::StencilBlockWriter writer;
        detail::StencilBuilder row;
        const std::size_t begin = kept + b * kBlockRows;
        writer.start(begin);
        for (std::size_t r = begin; r < std::min(rows_, begin + kBlockRows); ++r) {
            row.clear();
            own_rows.terms(r, [&](Index middle, double weight) {
                first_rows.terms(middle, [&](Index point, double w) { row.add(point, weight * w); });
            });
            writer.push(row.finish());
        }
        composed[b] = writer.block();
    });
    return {first.columns(), kept, std::move(composed)};
}

CsrMatrix StencilTable::csr() const {
    const RowAccess access(*this);
    CsrMatrix matrix;
    matrix.offsets.reserve(rows_ + 1);
    std::vector<std::pair<Index, double>> row;
    for (std::size_t r = 0; r < rows_; ++r) {
        row.clear();
        access.terms(r, [&](Index point, double weight) { row.emplace_back(point, weight); });
        std::sort(row.begin(), row.end());
        for (const auto& [point, weight] : row) {
            const bool again = matrix.columns.size() > matrix.offsets.back() && matrix.columns.back() == point;
            if (again) {
                matrix.weights.back() += weight;
            } else {
                matrix.columns.push_back(point);
                matrix.weights.push_back(weight);
            }
        }
        matrix.offsets.push_back(matrix.columns.size());
    }
    return matrix;
}

}  // namespace subvol
