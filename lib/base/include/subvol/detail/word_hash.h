// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>

namespace subvol::detail {

/// 2⁶⁴ divided by the golden ratio: a product with it moves the low bits of a word into the high ones.
inline constexpr std::uint64_t kGoldenWord = 0x9e3779b97f4a7c15U;

/// The mixing function of splitmix64: each bit of the input changes about half of the bits of the output.
[[nodiscard]] constexpr std::uint64_t mixed(std::uint64_t x) {
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9U;
    x = (x ^ x >> 27) * 0x94d049bb133111ebU;
    return x ^ x >> 31;
}

/// A hash of the words before, and of one more.
[[nodiscard]] constexpr std::uint64_t hash_with(std::uint64_t hash, std::uint64_t word) {
    return (hash ^ word) * kGoldenWord;
}

/// A hash of a place by the bits of its three coordinates; -0 is as 0.
template <class Place>
[[nodiscard]] std::uint64_t hash_of_place(const Place& place) {
    std::uint64_t hash = 0;
    for (const double x : {place[0], place[1], place[2]})
        hash = hash_with(std::rotl(hash, 21), std::bit_cast<std::uint64_t>(x + 0.0));
    return hash ^ hash >> 32;
}

}  // namespace subvol::detail
