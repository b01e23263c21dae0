// SPDX-License-Identifier: Apache-2.0
#include "corner_split.h"

#include <algorithm>

namespace subvol::detail {

namespace {

using AwayFaces = std::array<std::array<std::array<int, 4>, 3>, 8>;

AwayFaces make_away_faces() {
    AwayFaces away;
    for (int corner = 0; corner < 8; ++corner) {
        std::size_t count = 0;
        for (const auto& face : kCellFaces) {
            if (std::ranges::find(face, corner) == face.end()) away[static_cast<std::size_t>(corner)][count++] = face;
        }
    }
    return away;
}

CornerSplit make_split(std::size_t apex, std::size_t diagonals) {
    CornerSplit split;
    for (std::size_t t = 0; t < 8; ++t) {
        const std::size_t f = std::min(t, std::size_t{5}) / 2, half = std::min(t, std::size_t{5}) % 2;
        auto quad = faces_away_from(apex)[f];
        std::rotate(quad.begin(), quad.begin() + static_cast<int>(diagonals >> f & 1), quad.end());
        // As in `split_cell`: the quad is counter-clockwise from outside and the apex lies behind it.
        split.corners[0][t] = quad[0];
        split.corners[1][t] = half == 0 ? quad[2] : quad[3];
        split.corners[2][t] = half == 0 ? quad[1] : quad[2];
        split.corners[3][t] = static_cast<std::int64_t>(apex);
    }
    return split;
}

std::array<CornerSplit, 64> make_splits() {
    std::array<CornerSplit, 64> splits;
    for (std::size_t i = 0; i < splits.size(); ++i) splits[i] = make_split(i / 8, i % 8);
    return splits;
}

}  // namespace

const std::array<std::array<int, 4>, 3>& faces_away_from(std::size_t corner) {
    static const AwayFaces kAway = make_away_faces();
    return kAway[corner];
}

const CornerSplit& corner_split(std::size_t apex, std::size_t diagonals) {
    static const std::array<CornerSplit, 64> kSplits = make_splits();
    return kSplits[8 * apex + diagonals];
}

}  // namespace subvol::detail
