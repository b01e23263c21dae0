// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace subvol::detail {

/// The mixing function of splitmix64: each bit of the input changes about half of the bits of the output.
inline std::uint64_t mixed(std::uint64_t x) {
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ x >> 27) * 0x94d049bb133111ebULL;
    return x ^ x >> 31;
}

}  // namespace subvol::detail
