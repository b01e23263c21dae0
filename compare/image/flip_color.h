// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "subvol/vec.h"

namespace subvol::detail {

/// Linear sRGB to XYZ, relative to the white of the screen: white is (1, 1, 1).
inline Vec3 xyz_over_white(const Vec3& rgb) {
    // Columns: the primaries of sRGB (IEC 61966-2-1) as fractions.
    static const Mat3 kToXyz{10135552. / 24577794, 2613072. / 12288897, 1425312. / 73733382,
                             8788810. / 24577794,  8788810. / 12288897, 8788810. / 73733382,
                             4435075. / 24577794,  887015. / 12288897,  70074185. / 73733382};
    static const Vec3 kWhite = kToXyz * Vec3(1.0);
    return kToXyz * rgb / kWhite;
}

inline Vec3 rgb_of_xyz_over_white(const Vec3& xyz) {
    static const Mat3 kInverse =
        glm::inverse(Mat3(xyz_over_white({1, 0, 0}), xyz_over_white({0, 1, 0}), xyz_over_white({0, 0, 1})));
    return kInverse * xyz;
}

/// The opponent space YCxCz: linear in light.
inline Vec3 ycxcz(const Vec3& rgb) {
    const Vec3 t = xyz_over_white(rgb);
    return {116 * t.y - 16, 500 * (t.x - t.y), 200 * (t.y - t.z)};
}

inline Vec3 rgb_of_ycxcz(const Vec3& c) {
    const double y = (c.x + 16) / 116;
    return rgb_of_xyz_over_white({y + c.y / 500, y, y - c.z / 200});
}

/// L*, a*, b* with a* and b* times L*/100, as dark colours are less colourful (the Hunt effect).
inline Vec3 hunt_lab(const Vec3& rgb) {
    constexpr double kDelta = 6. / 29;
    const auto f = [](double t) { return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4. / 29; };
    const Vec3 t = xyz_over_white(rgb);
    const double x = f(t.x), y = f(t.y), z = f(t.z), lightness = 116 * y - 16;
    return {lightness, .01 * lightness * 500 * (x - y), .01 * lightness * 200 * (y - z)};
}

/// HyAB: the sum of the difference in lightness and the distance in a*, b*.
inline double hyab(const Vec3& a, const Vec3& b) {
    return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

}  // namespace subvol::detail
