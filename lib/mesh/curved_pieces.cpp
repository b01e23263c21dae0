// SPDX-License-Identifier: Apache-2.0
#include "curved_pieces.h"

#include <algorithm>
#include <cmath>

namespace subvol::detail {

namespace {

// Volumes add up the error of the shape, and nothing adds up that of the fields. The limit is nearer to the fields than the
// straight lines whose error is measured.
constexpr double kFieldsPerShape = 400;

// No more hexahedra than this are made, or than this for each cell where that is more.
constexpr std::size_t kMostHexes = std::size_t{1} << 15, kMostPerCell = 4;

// A direction is never split more often than this.
constexpr double kMostPieces = 1e4;

}  // namespace

/// Three directions share the tolerance.
CurvedPieces choose_pieces(std::span<const std::array<Index, 8>> cells, const EdgeClasses& edges,
                           std::span<const CellBend> bends, double tolerance) {
    CurvedPieces result;
    std::vector<double> of_shape(edges.size()), of_fields(edges.size());
    result.class_of.resize(cells.size());
    for (std::size_t c = 0; c < cells.size(); ++c) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t e = result.class_of[c][axis] = edges.class_of(edges.edge(cells[c], 4 * axis));
            of_shape[e] = std::max(of_shape[e], 3. * bends[c].shape[axis] / tolerance);
            of_fields[e] = std::max(of_fields[e], 3. * bends[c].fields[axis] / (kFieldsPerShape * tolerance));
        }
    }
    result.of_class.resize(edges.size());
    result.most_hexes = std::max(kMostHexes, kMostPerCell * cells.size());
    const auto most = static_cast<double>(result.most_hexes);
    const auto fits = [&](double shape_part, double fields_part) {
        for (std::size_t e = 0; e < result.of_class.size(); ++e) {
            const double needed = std::max(of_shape[e] * shape_part, of_fields[e] * fields_part);
            result.of_class[e] = static_cast<std::size_t>(std::clamp(std::ceil(std::sqrt(needed) - 1e-6), 1., kMostPieces));
        }
        double count = 0;
        for (std::size_t c = 0; c < cells.size(); ++c) {
            const auto n = result.of_cell(c);
            count += static_cast<double>(n[0]) * static_cast<double>(n[1]) * static_cast<double>(n[2]);
        }
        return count <= most;
    };
    constexpr double kLess = .8;
    const bool shape_fits = fits(1, 0);
    result.limited = !shape_fits || !fits(1, 1);
    if (!result.limited) return result;
    double part = 1;
    if (shape_fits) {
        while (!fits(1, part)) part = part < 1e-12 ? 0 : part * kLess;
    } else {
        while (!fits(part, part)) part = part < 1e-12 ? 0 : part * kLess;
    }
    return result;
}

}  // namespace subvol::detail
