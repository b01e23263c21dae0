// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace subvol::detail {

inline constexpr std::uint32_t kThreads = 256;  // of a work group
inline constexpr std::size_t kWord_bytes = 4;

/// The work groups in which each of `items` has a thread.
inline std::uint32_t groups_for(std::size_t items) {
    return static_cast<std::uint32_t>((items + kThreads - 1) / kThreads);
}

}  // namespace subvol::detail
