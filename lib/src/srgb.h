#pragma once

#include <cmath>

#include "subvol/vec.h"

namespace subvol {

/// IEC 61966-2-1: a component in [0,1] of sRGB to linear light.
inline double linear_from_srgb(double s) {
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

inline Vec3 linear_from_srgb(const Vec3& s) {
    return {linear_from_srgb(s.x), linear_from_srgb(s.y), linear_from_srgb(s.z)};
}

}  // namespace subvol
