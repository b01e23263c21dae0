// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "subvol/image.h"

namespace subvol::test {

/// Over all four channels; huge if the sizes differ.
inline double largest_difference(const Image& a, const Image& b) {
    double largest = a.rgba.size() == b.rgba.size() ? 0 : 1e30;
    for (std::size_t i = 0; i < std::min(a.rgba.size(), b.rgba.size()); ++i) {
        const double difference = std::abs(double{a.rgba[i]} - double{b.rgba[i]});
        if (!(difference <= largest)) largest = difference;  // NaN counts
    }
    return largest;
}

/// Over all four channels of images of one size.
inline double rmse(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) sum += std::pow(double{a.rgba[i]} - double{b.rgba[i]}, 2);
    return std::sqrt(sum / static_cast<double>(a.rgba.size()));
}

}  // namespace subvol::test
