// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace subvol::detail {

/// The most threads that a user may ask for: far more than a machine has, and few enough that a slip is noticed.
inline constexpr int kMostThreads = 4096;

}  // namespace subvol::detail
