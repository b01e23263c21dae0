// SPDX-License-Identifier: Apache-2.0
#include "piece_numbers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

namespace subvol::detail {

namespace {

constexpr std::size_t kWaiting = 1024;               // records of a bucket
constexpr std::size_t kRoom = std::size_t{1} << 20;  // numbers before the first search for equal ones

std::uint64_t hash_of(const Vec3& x) {
    std::uint64_t hash = 0;
    for (int a = 0; a < 3; ++a) hash = (std::rotl(hash, 21) ^ std::bit_cast<std::uint64_t>(x[a])) * 0x9E3779B97F4A7C15u;
    return hash ^ hash >> 32;
}

}  // namespace

void RanksOfNumbers::add(std::span<const double> numbers) {
    numbers_.insert(numbers_.end(), numbers.begin(), numbers.end());
    if (numbers_.size() > 2 * compacted_ + kRoom) compact();
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
    return different_;
}

Index RanksOfNumbers::rank(double number) const {
    const double guess = number - numbers_.front();  // right if there are no gaps
    if (guess >= 0 && guess < static_cast<double>(numbers_.size()) && numbers_[static_cast<std::size_t>(guess)] == number) {
        return static_cast<Index>(guess);
    }
    return static_cast<Index>(std::ranges::lower_bound(numbers_, number) - numbers_.begin());
}

RanksOfPlaces::RanksOfPlaces(const std::filesystem::path& folder)
    : records_(folder, sizeof(Record)), waiting_(kBuckets), parts_(kBuckets) {
}

void RanksOfPlaces::add_piece(std::span<const Vec3> points) {
    std::uint64_t number = ends_.empty() ? 0 : ends_.back();
    for (const Vec3& point : points) {
        const Vec3 place = point + 0.0;  // -0 is 0
        const std::size_t bucket = hash_of(place) % kBuckets;
        const bool finite = std::isfinite(place.x) && std::isfinite(place.y) && std::isfinite(place.z);
        if (finite) waiting_[bucket].push_back({place, number});
        if (waiting_[bucket].size() == kWaiting) flush(bucket);
        ++number;
    }
    ends_.push_back(number);
}

void RanksOfPlaces::flush(std::size_t bucket) {
    if (waiting_[bucket].empty()) return;
    records_.write(written_, records_of(waiting_[bucket]));
    parts_[bucket].emplace_back(written_, waiting_[bucket].size());
    written_ += waiting_[bucket].size();
    waiting_[bucket].clear();
}

void RanksOfPlaces::finish() {
    for (std::size_t bucket = 0; bucket < kBuckets; ++bucket) {
        flush(bucket);
        std::vector<Record> records;
        for (const auto& [first, count] : parts_[bucket]) {
            const std::size_t before = records.size();
            records.resize(before + count);
            records_.read(first, records_of(records).subspan(before * sizeof(Record)));
        }
        find_joined(std::move(records));
    }
    waiting_.clear();
    parts_.clear();
    std::ranges::sort(joined_);
}

void RanksOfPlaces::find_joined(std::vector<Record> records) {
    const auto key = [](const Record& r) { return std::tuple(r.place.x, r.place.y, r.place.z, r.number); };
    std::ranges::sort(records, [&](const Record& a, const Record& b) { return key(a) < key(b); });
    for (std::size_t begin = 0, end = 0; begin < records.size(); begin = end) {
        const std::uint64_t first = records[begin].number;
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
