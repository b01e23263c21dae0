// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>
#include <vector>

#include "subvol/detail/spill_file.h"
#include "subvol/index.h"
#include "subvol/vec.h"

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
    std::vector<std::uint64_t> before_;  // how many are set before each word
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

/// Things that have whole numbers of their own, in the order of these: two bits for each number between the least and the
/// largest, or, where these are far apart, 8 bytes for each different number.
class RanksOfNumbers {
public:
    void add(std::span<const double> numbers);
    /// After the last number. Returns whether all of them were different.
    bool finish();

    [[nodiscard]] std::size_t size() const { return size_; }
    /// number: one of those that were added
    [[nodiscard]] Index rank(double number) const;

private:
    [[nodiscard]] bool make_room(std::span<const double> numbers);
    void give_up_flags();
    void compact();

    // Flags of the numbers from 64 * first_word_ on, unless they are listed.
    std::vector<std::uint64_t> words_;
    std::vector<Index> before_;
    std::int64_t first_word_ = 0;
    bool listed_ = false;
    std::vector<double> numbers_;
    std::size_t added_ = 0, compacted_ = 0, size_ = 0;
    bool different_ = true;
};

/// Points in the order in which they come, those of different pieces at exactly the same place joined: 16 bytes for each that
/// is joined with another; the places wait in a file.
class RanksOfPlaces {
public:
    explicit RanksOfPlaces(const std::filesystem::path& folder);

    void add_piece(std::span<const Vec3> points);
    void finish();

    /// The ranks of the next piece's points, for one piece after the other; a flag for each: it is the first at its place.
    void take_piece(std::size_t points, std::vector<Index>& ranks, std::vector<std::uint8_t>& is_first);

private:
    struct Record {
        Vec3 place;
        std::uint64_t number;  // of the point among those of all pieces
    };
    static constexpr std::size_t kBuckets = 256;

    void find_joined(std::vector<Record> records);

    SpillBuckets<Record> records_;
    std::vector<std::uint64_t> ends_;                              // of the pieces
    std::vector<std::pair<std::uint64_t, std::uint64_t>> joined_;  // a point, and the first at its place
    std::uint64_t taken_ = 0;
    std::size_t next_joined_ = 0;
};

}  // namespace subvol::detail
