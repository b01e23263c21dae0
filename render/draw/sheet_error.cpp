// SPDX-License-Identifier: Apache-2.0
#include "sheet_error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace subvol::detail {

SplatOptions with_more_sheets(SplatOptions options, int sheets) {
    constexpr int kTimes = 4, kMostSheets = 65536;
    options.needed_sheets = std::min(kTimes * (sheets - 1) + 1, kMostSheets);
    options.image_tolerance /= kTimes * kTimes;  // which finer sheets follow
    return options;
}

SheetError difference(const Image& image, const Image& exact) {
    SheetError error;
    double squares = 0;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double off = std::abs(double{image.rgba[i + c]} - double{exact.rgba[i + c]});
            squares += off * off;
            error.largest = std::max(error.largest, off);
        }
    }
    if (!image.rgba.empty()) error.rms = std::sqrt(squares / (3.0 / 4 * static_cast<double>(image.rgba.size())));
    return error;
}

}  // namespace subvol::detail
