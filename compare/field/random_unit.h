// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>

namespace subvol::detail {

/// A number in [0, 1). std::uniform_real_distribution differs between libraries; this does not.
inline double random_unit(std::mt19937_64& random) {
    return static_cast<double>(random() >> 11) * 0x1p-53;
}

}  // namespace subvol::detail
