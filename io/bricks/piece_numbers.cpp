// SPDX-License-Identifier: Apache-2.0
#include "piece_numbers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

#include "subvol/detail/word_hash.h"

// Numbers of points and cells that are too many for a table of them in memory.
//
//      flags   0110 1001 0000 1111 …   one bit a number, 64 to a word
//      before  0    2    4    4   …    how many are set before each word
//
// The rank of a number among those that are set is before[word] + the bits below it in its word: 2 bits a number instead of 4
// or 8 bytes. Points without numbers are ranked by their places, which are sorted bucket by bucket from a file.

namespace subvol::detail {

namespace {

constexpr std::size_t kRoom = std::size_t{1} << 20;  // numbers before the first search for equal ones; words of flags
constexpr double kLargestWhole = 9007199254740992;   // 2⁵³

}  // namespace

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

void RanksOfNumbers::add(std::span<const double> numbers) {
    if (numbers.empty()) return;
    added_ += numbers.size();
    if (!listed_ && !make_room(numbers)) give_up_flags();
    if (listed_) {
        numbers_.insert(numbers_.end(), numbers.begin(), numbers.end());
        // Sorting whenever the list has doubled keeps it at about twice the different numbers, and the cost in all at O(n log
        // n).
        if (numbers_.size() > 2 * compacted_ + kRoom) compact();
        return;
    }
    for (const double number : numbers) {
        const std::int64_t n = static_cast<std::int64_t>(number) - 64 * first_word_;
        const std::uint64_t flag = std::uint64_t{1} << n % 64;
        std::uint64_t& word = words_[static_cast<std::size_t>(n / 64)];
        // A flag that is set already is a number that occurs twice.
        different_ = different_ && (word & flag) == 0;
        word |= flag;
    }
}

// Returns false if the flags would take more than 8 bytes for each number, and 8 MB.
bool RanksOfNumbers::make_room(std::span<const double> numbers) {
    const auto [least, largest] = std::ranges::minmax(numbers);
    if (!(least >= -kLargestWhole && largest <= kLargestWhole)) return false;
    // Rounded down, so that negative numbers belong to the word before.
    const auto word_of = [](double number) { return static_cast<std::int64_t>(std::floor(number / 64)); };
    std::int64_t begin = word_of(least), end = word_of(largest) + 1;
    // The flags grow at both ends, as pieces may come in any order of their numbers.
    if (!words_.empty()) {
        begin = std::min(begin, first_word_);
        end = std::max(end, first_word_ + static_cast<std::int64_t>(words_.size()));
    }
    if (static_cast<std::uint64_t>(end - begin) > added_ + kRoom) return false;
    const std::int64_t in_front = words_.empty() ? 0 : first_word_ - begin;
    words_.insert(words_.begin(), static_cast<std::size_t>(in_front), 0);
    words_.resize(static_cast<std::size_t>(end - begin));
    first_word_ = begin;
    return true;
}

void RanksOfNumbers::give_up_flags() {
    listed_ = true;
    for (std::size_t w = 0; w < words_.size(); ++w) {
        for (std::uint64_t word = words_[w]; word != 0; word &= word - 1) {
            const std::int64_t n = 64 * (first_word_ + static_cast<std::int64_t>(w)) + std::countr_zero(word);
            numbers_.push_back(static_cast<double>(n));
        }
    }
    compacted_ = numbers_.size();
    words_ = {};
}

void RanksOfNumbers::compact() {
    std::ranges::sort(numbers_);
    const auto end = std::unique(numbers_.begin(), numbers_.end());
    different_ = different_ && end == numbers_.end();
    numbers_.erase(end, numbers_.end());
    compacted_ = numbers_.size();
}

bool RanksOfNumbers::finish() {
    compact();
    numbers_.shrink_to_fit();
    size_ = numbers_.size();
    for (const std::uint64_t word : words_) {
        before_.push_back(static_cast<Index>(size_));
        size_ += static_cast<std::size_t>(std::popcount(word));
    }
    return different_;
}

Index RanksOfNumbers::rank(double number) const {
    if (listed_) return static_cast<Index>(std::ranges::lower_bound(numbers_, number) - numbers_.begin());
    const std::int64_t n = static_cast<std::int64_t>(number) - 64 * first_word_;
    const auto w = static_cast<std::size_t>(n / 64);
    const std::uint64_t lower = (std::uint64_t{1} << n % 64) - 1;
    return before_[w] + static_cast<Index>(std::popcount(words_[w] & lower));
}

RanksOfPlaces::RanksOfPlaces(const std::filesystem::path& folder) : records_(folder, kBuckets) {
}

void RanksOfPlaces::add_piece(std::span<const Vec3> points) {
    std::uint64_t number = ends_.empty() ? 0 : ends_.back();
    for (const Vec3& point : points) {
        // Equal places must have equal hashes, so both zeros are made one. Points whose places are not finite are joined with
        // nothing.
        const Vec3 place = point + 0.0;  // -0 is 0
        const bool finite = std::isfinite(place.x) && std::isfinite(place.y) && std::isfinite(place.z);
        if (finite) records_.add(hash_of_place(place) % kBuckets, {place, number});
        ++number;
    }
    ends_.push_back(number);
}

void RanksOfPlaces::finish() {
    for (std::size_t bucket = 0; bucket < kBuckets; ++bucket) find_joined(records_.take(bucket));
    std::ranges::sort(joined_);
}

void RanksOfPlaces::find_joined(std::vector<Record> records) {
    const auto key = [](const Record& r) { return std::tuple(r.place.x, r.place.y, r.place.z, r.number); };
    std::ranges::sort(records, [&](const Record& a, const Record& b) { return key(a) < key(b); });
    for (std::size_t begin = 0, end = 0; begin < records.size(); begin = end) {
        const std::uint64_t first = records[begin].number;
        // The records of a place are sorted by the number of the point, so the first one is the point that all others are
        // joined to.
        const std::uint64_t end_of_piece = *std::ranges::upper_bound(ends_, first);
        for (end = begin + 1; end < records.size() && records[end].place == records[begin].place; ++end) {
            // Points of one piece stay apart, as in a crack.
            if (records[end].number >= end_of_piece) joined_.emplace_back(records[end].number, first);
        }
    }
}

void RanksOfPlaces::take_piece(std::size_t points, std::vector<Index>& ranks, std::vector<std::uint8_t>& is_first) {
    ranks.clear();
    is_first.clear();
    // The rank of a point is its number less the joined points before it. next_joined_ is that count for the point at hand; for
    // an earlier point it is looked up.
    const auto joined_before = [&](std::uint64_t number) {
        const auto found = std::ranges::lower_bound(joined_, number, {}, [](const auto& pair) { return pair.first; });
        return static_cast<std::uint64_t>(found - joined_.begin());
    };
    for (const std::uint64_t end = taken_ + points; taken_ < end; ++taken_) {
        if (next_joined_ < joined_.size() && joined_[next_joined_].first == taken_) {
            const std::uint64_t first = joined_[next_joined_++].second;
            ranks.push_back(static_cast<Index>(first - joined_before(first)));
            is_first.push_back(0);
        } else {
            ranks.push_back(static_cast<Index>(taken_ - next_joined_));
            is_first.push_back(1);
        }
    }
}

}  // namespace subvol::detail
