// SPDX-License-Identifier: Apache-2.0
#include "list_parts.h"

#include <numeric>
#include <string>

#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kMostPixels = std::size_t{1} << 20;  // of a part: what is kept for each pixel has to fit too

/// A row that is too much as a whole.
void split_row(std::span<const std::uint32_t> counts, int y, std::size_t most, std::vector<PixelRect>& parts) {
    int first = 0;
    std::size_t sum = 0;
    const int width = static_cast<int>(counts.size());
    for (int x = 0; x < width; ++x) {
        const std::size_t count = counts[static_cast<std::size_t>(x)];
        if (count > most) {
            throw Error(ErrorCode::InvalidInput, "a pixel has " + std::to_string(count) + " segments", {},
                        "memory for lists of more than " + std::to_string(most));
        }
        if (sum + count > most) {
            parts.push_back({first, y, x, y + 1});
            first = x;
            sum = 0;
        }
        sum += count;
    }
    parts.push_back({first, y, width, y + 1});
}

}  // namespace

std::vector<PixelRect> split_into_parts(std::span<const std::uint32_t> counts, int width, int height,
                                        std::size_t most_fragments) {
    std::vector<PixelRect> parts;
    const auto row_pixels = static_cast<std::size_t>(width);
    PixelRect part{0, 0, width, 0};
    std::size_t sum = 0;
    const auto end_part = [&](int next_row) {
        if (!part.empty()) parts.push_back(part);
        part = {0, next_row, width, next_row};
        sum = 0;
    };
    for (int y = 0; y < height; ++y) {
        const auto row = counts.subspan(static_cast<std::size_t>(y) * row_pixels, row_pixels);
        const std::size_t count = std::accumulate(row.begin(), row.end(), std::size_t{0});
        const auto pixels = static_cast<std::size_t>(y + 1 - part.y0) * row_pixels;
        if (sum + count > most_fragments || pixels > kMostPixels) end_part(y);
        if (count > most_fragments) {
            split_row(row, y, most_fragments, parts);
            part = {0, y + 1, width, y + 1};
            continue;
        }
        part.y1 = y + 1;
        sum += count;
    }
    end_part(height);
    return parts;
}

}  // namespace subvol::detail
