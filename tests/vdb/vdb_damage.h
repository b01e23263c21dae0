// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <limits>
#include <random>
#include <string>

namespace subvol::test {

/// SUBVOL_MUTATIONS sets how many damaged files a test makes of each good one.
inline int run_count() {
    constexpr int kUsual = 400;
    const char* const given = std::getenv("SUBVOL_MUTATIONS");
    return given ? std::max(std::atoi(given), 1) : kUsual;
}

/// A .vdb file with bytes or lengths changed, taken out or cut off.
inline std::string mutated(std::string bytes, std::mt19937& random) {
    const auto place = [&] { return random() % (bytes.size() - 8); };
    const auto ways = random() % 8;
    if (ways == 0) return bytes.substr(0, place());
    if (ways == 1) return bytes.erase(place(), 1 + random() % 16);
    if (ways < 4) {  // a length of 32 or 64 bits
        const std::int64_t odd[] = {-1, -2048, -60000, 0, 1, 2048, 0x7FFFFFFF, std::numeric_limits<std::int64_t>::min()};
        std::memcpy(&bytes[place()], &odd[random() % std::size(odd)], ways == 2 ? 4 : 8);
        return bytes;
    }
    // Nearly all numbers that count lie in the first and last parts, between them the masks of large nodes.
    for (auto flips = 1 + random() % 3; flips > 0; --flips) {
        const std::size_t at = random() % 2 == 0 ? random() % std::min<std::size_t>(bytes.size(), 1200) : place();
        bytes[at] = static_cast<char>(random() >> 8);
    }
    return bytes;
}

}  // namespace subvol::test
