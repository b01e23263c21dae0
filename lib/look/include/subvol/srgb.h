// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "subvol/vec.h"

namespace subvol {

/// Converts a component in [0,1] from sRGB to linear light (IEC 61966-2-1).
inline double linear_from_srgb(double s) {
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

inline Vec3 linear_from_srgb(const Vec3& s) {
    return {linear_from_srgb(s.x), linear_from_srgb(s.y), linear_from_srgb(s.z)};
}

/// Converts a component in [0,1] from linear light to sRGB.
inline double srgb_from_linear(double l) {
    return l <= 0.0031308 ? l * 12.92 : 1.055 * std::pow(l, 1 / 2.4) - 0.055;
}

}  // namespace subvol
