// SPDX-License-Identifier: Apache-2.0
#include "point_flags.h"

#include <algorithm>
#include <bit>

namespace subvol::detail {

void PointFlags::resize(std::size_t points) {
    words_.resize((points + 63) / 64);
}

std::uint64_t PointFlags::count() {
    std::uint64_t count = 0;
    before_.clear();
    for (const std::uint64_t word : words_) {
        before_.push_back(count);
        count += static_cast<std::uint64_t>(std::popcount(word));
    }
    return count;
}

std::uint64_t PointFlags::count_before(Index p) const {
    const std::uint64_t lower = (std::uint64_t{1} << p % 64) - 1;
    return before_[p / 64] + static_cast<std::uint64_t>(std::popcount(words_[p / 64] & lower));
}

CornersOfCells::CornersOfCells(std::span<const Index> corners) {
    if (corners.empty()) return;
    Index last = 0;
    first_ = kNone;
    for (const Index p : corners) {
        if (p == kNone) continue;
        first_ = std::min(first_, p);
        last = std::max(last, p);
    }
    words_.resize((last - first_) / 64 + 1);
    for (const Index p : corners) {
        if (p != kNone) words_[(p - first_) / 64] |= std::uint64_t{1} << (p - first_) % 64;
    }
    for (std::size_t w = 0; w < words_.size(); ++w) {
        before_.push_back(static_cast<Index>(points_.size()));
        for (std::uint64_t word = words_[w]; word != 0; word &= word - 1) {
            points_.push_back(static_cast<Index>(first_ + 64 * w + static_cast<std::size_t>(std::countr_zero(word))));
        }
    }
}

Index CornersOfCells::place(Index p) const {
    const Index at = p - first_;
    const std::uint64_t lower = (std::uint64_t{1} << at % 64) - 1;
    return before_[at / 64] + static_cast<Index>(std::popcount(words_[at / 64] & lower));
}

}  // namespace subvol::detail
