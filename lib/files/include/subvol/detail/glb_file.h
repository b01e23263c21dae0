// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace subvol::detail {

/// More bytes than fit into a `.glb` file with what describes them.
inline constexpr std::size_t kMostGlbBytes = 0xF0000000U;

/// What comes before the bytes of a `.glb` file: its head, the chunk of JSON, and the head of the chunk of bytes.
///
/// json:  describes one buffer of so many bytes
/// bytes: a multiple of 4, at most `kMostGlbBytes`
[[nodiscard]] std::string glb_head(std::string json, std::size_t bytes);

}  // namespace subvol::detail
