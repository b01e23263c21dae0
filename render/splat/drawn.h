// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "subvol/image.h"

namespace subvol::detail {

/// A picture and the mean depth of what is seen in each pixel, by opacity (eye depth; infinity where nothing is).
struct Drawn {
    Image image;
    std::vector<float> depth;
};

}  // namespace subvol::detail
