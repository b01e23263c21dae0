// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <vector>

namespace subvol::detail {

/// Adds up counts, number by number, over all processes that look for a number together. Empty: this process is alone.
using SumCounts = std::function<void(std::vector<std::int64_t>&)>;

/// The number in a place, from 0, of floats in ascending order; none is negative, and there are more than `place`.
///
/// Floats that are not negative have the order of their bits, so the number is found digit by digit: how many numbers that
/// begin with the digits found so far have each value of the next one. Counts are all that processes must know of each other.
///
/// each_bits: calls its argument with the bits of each number of this process, and how often it occurs
template <class EachBits>
requires(!std::convertible_to<const EachBits&, std::span<const float>>)
    [[nodiscard]] float number_in_place(std::size_t place, const EachBits& each_bits, const SumCounts& sum = {}) {
    constexpr unsigned kBits = 11;
    std::uint32_t found = 0, known = 0;  // the digits that are found, and their mask
    auto left = static_cast<std::int64_t>(place);
    for (unsigned shift = 32; shift > 0;) {
        const unsigned digits = std::min(kBits, shift);
        shift -= digits;
        const std::uint32_t mask = (1U << digits) - 1;
        std::vector<std::int64_t> counts(std::size_t{mask} + 1);
        each_bits([&](std::uint32_t bits, std::uint32_t count) {
            if ((bits & known) == found) counts[bits >> shift & mask] += count;
        });
        if (sum) sum(counts);
        std::uint32_t digit = 0;
        while (digit < mask && left >= counts[digit]) left -= counts[digit++];
        found |= digit << shift;
        known |= mask << shift;
    }
    return std::bit_cast<float>(found);
}

[[nodiscard]] inline float number_in_place(std::size_t place, std::span<const float> numbers, const SumCounts& sum = {}) {
    const auto each_bits = [&](const auto& visit) {
        for (const float number : numbers) visit(std::bit_cast<std::uint32_t>(number), 1U);
    };
    return number_in_place(place, each_bits, sum);
}

/// Floats that are not negative, of which only the counts are kept: for more of them than should be in memory.
class FloatCounts {
public:
    void add(float number) {
        const auto bits = std::bit_cast<std::uint32_t>(number);
        auto& counts = counts_[bits >> 16];
        if (counts.empty()) counts.resize(std::size_t{1} << 16);
        ++counts[bits & 0xffff];
        ++size_;
    }

    [[nodiscard]] std::size_t size() const { return size_; }

    [[nodiscard]] float in_place(std::size_t place, const SumCounts& sum = {}) const {
        const auto each_bits = [&](const auto& visit) {
            for (const auto& [high, counts] : counts_) {
                for (std::uint32_t low = 0; low < counts.size(); ++low) {
                    if (counts[low] > 0) visit(high << 16 | low, counts[low]);
                }
            }
        };
        return number_in_place(place, each_bits, sum);
    }

private:
    std::map<std::uint32_t, std::vector<std::uint32_t>> counts_;  // of the lower 16 bits, by the upper 16
    std::size_t size_ = 0;
};

}  // namespace subvol::detail
