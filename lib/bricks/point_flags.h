// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "subvol/index.h"

namespace subvol::detail {

/// A flag for each point, and how many are set before one.
class PointFlags {
public:
    void resize(std::size_t points);
    void set(Index p) { words_[p / 64] |= std::uint64_t{1} << p % 64; }
    [[nodiscard]] bool operator[](Index p) const { return (words_[p / 64] >> p % 64 & 1) != 0; }

    /// After the last one was set, for `count_before`. Returns how many there are.
    std::uint64_t count();
    [[nodiscard]] std::uint64_t count_before(Index p) const;

private:
    std::vector<std::uint64_t> words_;
    std::vector<std::uint64_t> before_;  // of each word
};

/// The different corners of some cells, ascending, and the place of each among them. What is kNone is left out.
class CornersOfCells {
public:
    /// corners: of one cell after the other
    explicit CornersOfCells(std::span<const Index> corners);
    template <std::size_t N>
    explicit CornersOfCells(const std::vector<std::array<Index, N>>& cells)
        : CornersOfCells(std::span(cells.empty() ? nullptr : cells.front().data(), N * cells.size())) {}
    [[nodiscard]] const std::vector<Index>& points() const { return points_; }
    [[nodiscard]] Index place(Index p) const;

private:
    Index first_ = 0;
    std::vector<std::uint64_t> words_;
    std::vector<Index> before_;
    std::vector<Index> points_;
};

}  // namespace subvol::detail
