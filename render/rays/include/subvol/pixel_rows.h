// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

namespace subvol {

/// Rows of pixels, from `first` to before `end`.
struct PixelRows {
    int first = 0, end = std::numeric_limits<int>::max() / 2;
};

}  // namespace subvol
