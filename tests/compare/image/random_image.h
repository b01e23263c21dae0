// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>

#include "subvol/image.h"

namespace subvol {

/// Opaque, with random colours in [0, largest].
inline Image random_image(int width, int height, unsigned seed, double largest = 1) {
    std::mt19937 random(seed);
    Image image(width, height);
    for (std::size_t i = 0; i < image.rgba.size(); ++i) {
        image.rgba[i] = i % 4 == 3 ? 1.0f : static_cast<float>(largest * static_cast<double>(random()) / 4294967295.0);
    }
    return image;
}

/// One colour everywhere, alpha 1.
inline Image plain_image(int width, int height, float red, float green, float blue) {
    Image image(width, height);
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        image.rgba[i] = red;
        image.rgba[i + 1] = green;
        image.rgba[i + 2] = blue;
        image.rgba[i + 3] = 1;
    }
    return image;
}

}  // namespace subvol
