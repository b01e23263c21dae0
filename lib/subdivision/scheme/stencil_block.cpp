// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/stencil_block.h"
#include "subvol/detail/word_hash.h"

#include <bit>

namespace subvol::detail {

namespace {

std::size_t hash_of(std::span<const StencilTable::Run> runs) {
    std::uint64_t hash = runs.size();
    for (const auto& run : runs) {
        hash = hash_with(hash, std::bit_cast<std::uint64_t>(run.weight));
        hash = (hash ^ run.count ^ hash >> 29) * 0xbf58476d1ce4e5b9u;
    }
    return hash;
}

/// C channels of every row, of data that has `stride` channels.
template <std::size_t C, class T>
void apply_channels(const StencilTable::Block& block, const T* in, std::size_t stride, T* out) {
    const Index* point = block.points.data();
    for (const std::uint16_t pattern : block.row_patterns) {
        std::array<double, C> value{};
        for (std::size_t r = block.pattern_offsets[pattern]; r < block.pattern_offsets[pattern + 1u]; ++r) {
            const auto [weight, count] = block.runs[r];
            std::array<double, C> sum{};
            for (std::uint32_t i = 0; i < count; ++i) {
                const T* from = in + *point++ * stride;
                for (std::size_t c = 0; c < C; ++c) sum[c] += static_cast<double>(from[c]);
            }
            for (std::size_t c = 0; c < C; ++c) value[c] += weight * sum[c];
        }
        for (std::size_t c = 0; c < C; ++c) out[c] = static_cast<T>(value[c]);
        out += stride;
    }
}

template <class T>
void apply_all(const StencilTable::Block& block, const T* in, std::size_t channels, T* out) {
    std::size_t done = 0;
    for (; done + 4 <= channels; done += 4) apply_channels<4>(block, in + done, channels, out + done);
    switch (channels - done) {
        case 3:
            return apply_channels<3>(block, in + done, channels, out + done);
        case 2:
            return apply_channels<2>(block, in + done, channels, out + done);
        case 1:
            return apply_channels<1>(block, in + done, channels, out + done);
        default:
            return;
    }
}

}  // namespace

void StencilBlockWriter::start(std::size_t first_row) {
    block_.first_row = first_row;
    block_.points.clear();
    block_.row_patterns.clear();
    block_.pattern_offsets.assign(1, 0);
    block_.runs.clear();
    by_hash_.clear();
    last_ = 0;
}

void StencilBlockWriter::push(const StencilRuns& row) {
    if (block_.pattern_offsets.size() == 1 || !is_pattern(last_, row.runs)) last_ = find_pattern(row.runs);
    block_.row_patterns.push_back(static_cast<std::uint16_t>(last_));
    block_.points.insert(block_.points.end(), row.points.begin(), row.points.end());
}

bool StencilBlockWriter::is_pattern(std::size_t pattern, std::span<const StencilTable::Run> runs) const {
    const auto begin = block_.runs.begin();
    return std::equal(runs.begin(), runs.end(), begin + block_.pattern_offsets[pattern],
                      begin + block_.pattern_offsets[pattern + 1]);
}

std::size_t StencilBlockWriter::find_pattern(std::span<const StencilTable::Run> runs) {
    const std::size_t hash = hash_of(runs);
    const auto [begin, end] = by_hash_.equal_range(hash);
    for (auto i = begin; i != end; ++i) {
        if (is_pattern(i->second, runs)) return i->second;
    }
    const std::size_t pattern = block_.pattern_offsets.size() - 1;
    by_hash_.emplace(hash, pattern);
    block_.runs.insert(block_.runs.end(), runs.begin(), runs.end());
    block_.pattern_offsets.push_back(static_cast<std::uint32_t>(block_.runs.size()));
    return pattern;
}

void apply_block(const StencilTable::Block& block, const double* in, std::size_t channels, double* out) {
    apply_all(block, in, channels, out);
}

void apply_block(const StencilTable::Block& block, const float* in, std::size_t channels, float* out) {
    apply_all(block, in, channels, out);
}

}  // namespace subvol::detail
