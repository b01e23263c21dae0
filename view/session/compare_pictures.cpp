// SPDX-License-Identifier: Apache-2.0
#include "compare_pictures.h"

#include <algorithm>
#include <cmath>

namespace subvol::detail {

Image side_by_side(const Image& left, const Image& right, double slider, const Vec3& line) {
    Image both = left;
    const int border = static_cast<int>(std::lround(slider * left.width));
    for (int y = 0; y < left.height; ++y) {
        for (int x = border; x < left.width; ++x) std::ranges::copy(right.pixel(x, y), both.pixel(x, y).begin());
        if (border <= 0 || border >= left.width) continue;
        const auto pixel = both.pixel(border, y);
        for (std::size_t c = 0; c < 3; ++c) pixel[c] = static_cast<float>(line[static_cast<int>(c)]);
        pixel[3] = 1;
    }
    return both;
}

Image difference_of(const Image& left, const Image& right, const Vec3& background) {
    constexpr float kGain = 8;
    Image difference(left.width, left.height);
    for (int y = 0; y < left.height; ++y) {
        for (int x = 0; x < left.width; ++x) {
            const auto a = left.pixel(x, y), b = right.pixel(x, y);
            float most = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                const auto behind = static_cast<float>(background[static_cast<int>(c)]);
                most = std::max(most, std::abs(a[c] - b[c] - (a[3] - b[3]) * behind));
            }
            const auto pixel = difference.pixel(x, y);
            for (std::size_t c = 0; c < 3; ++c) pixel[c] = std::min(1.0F, kGain * most);
            pixel[3] = 1;
        }
    }
    return difference;
}

}  // namespace subvol::detail
