#pragma once

#include <cmath>

namespace subvol {

/// IEC 61966-2-1: a component in [0,1] from sRGB to linear light and back.
inline double decode_srgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

inline double encode_srgb(double linear) {
    return linear <= 0.0031308 ? linear * 12.92 : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

}  // namespace subvol
