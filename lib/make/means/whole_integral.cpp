// SPDX-License-Identifier: Apache-2.0
// The last step of fit_means.cpp: u += f k with k = (u − L)(H − u) / (H − L), where f is chosen for the integral over all
// cells. While |f| ≤ 1 values stay between L and H, what they are kept between by the means around each point. The integral is
// that over the limit volume, where it fills the same space as the straight cells: has the same volume and the same centre.
// Where its boundary is rounder, the means say nothing of what is between, and a linear function would be changed: there it is
// the integral over the straight cells, by A (fit_means.cpp).
//
// Where a field has bounds, its limit is kept within them, which takes away what overshoots: its integral is that of the kept
// values, and no longer linear in f, so that rounds follow until it is met.
#include "whole_integral.h"

#include <algorithm>
#include <numeric>

#include "subvol/dense_cells.h"
#include "subvol/detail/all_cells.h"

namespace subvol::detail {

namespace {

/// Integrals over the limit volume of 1, x, y, z and each attribute of a mesh, by the 27 nodes of each cell.
///
/// bounds: what the limit of each attribute is kept within
std::vector<double> limit_integrals(const HexMesh& mesh, std::span<const std::array<double, 2>> bounds, Progress* progress) {
    const DenseCells dense(mesh, {.levels = 1, .progress = progress}, true, DenseBits::ToRounding);
    const std::vector<Index> cells = all_cells(mesh);
    const std::size_t width = 4 + mesh.attributes.size();
    constexpr std::size_t kAtOnce = 1 << 16;  // their sums are added in order, whichever is finished first
    std::vector<double> totals(width), sums;
    for (std::size_t first = 0; first < cells.size(); first += kAtOnce) {
        const std::size_t count = std::min(kAtOnce, cells.size() - first);
        sums.assign(count * width, 0);
        dense.for_each(std::span(cells).subspan(first, count), [&](const DenseCell& cell) {
            std::array<Vec3, kMeanNodes> x;
            std::ranges::copy(cell.points, x.begin());
            const auto weights = node_integrals(x);
            double* sum = &sums[(cell.cell - first) * width];
            for (std::size_t n = 0; n < kMeanNodes; ++n) {
                sum[0] += weights[n];
                for (int a = 0; a < 3; ++a) sum[1 + a] += weights[n] * x[n][a];
                for (std::size_t a = 4; a < width; ++a)
                    sum[a] += weights[n] * std::clamp(cell.values[a - 4][n], bounds[a - 4][0], bounds[a - 4][1]);
            }
        });
        for (std::size_t i = 0; i < sums.size(); ++i) totals[i % width] += sums[i];
    }
    return totals;
}

bool fills_the_same(const HexMesh& mesh, const StraightVolume& straight, std::span<const double> limit) {
    constexpr double kSame = 1e-7;
    const Box box = bounds(mesh);
    const Vec3 moment(limit[1], limit[2], limit[3]);
    const Vec3 shift = (moment - limit[0] * box.center()) - (straight.moment - straight.volume * box.center());
    return std::abs(limit[0] - straight.volume) <= kSame * straight.volume &&
           glm::length(shift) <= kSame * straight.volume * box.diagonal();
}

/// k of a channel.
std::vector<double> room_of(const FittedChannel& channel) {
    std::vector<double> room(channel.values.size());
    if (channel.is_constant()) return room;
    for (std::size_t p = 0; p < room.size(); ++p) {
        const double u = channel.values[p], from = channel.from[p], to = channel.to[p];
        if (to > from) room[p] = std::max(0., (u - from) * ((to - u) / (to - from)));
    }
    return room;
}

}  // namespace

std::array<double, 2> FittedChannel::bounds() const {
    constexpr double kNoBound = std::numeric_limits<double>::infinity();
    return {std::isfinite(least) ? multiplied_value(low, exponent) : -kNoBound,
            std::isfinite(most) ? multiplied_value(high, exponent) : kNoBound};
}

double FittedChannel::value(std::size_t point) const {
    const auto [lower, upper] = bounds();
    return std::clamp(multiplied_value(is_constant() ? low : low + values[point], exponent), lower, upper);
}

StraightVolume straight_volume(const HexMesh& mesh, const MeanStencils& stencils) {
    StraightVolume straight{.weights = std::vector<double>(mesh.points.size())};
    for (std::size_t w = 0; w < stencils.volumes.size(); ++w) {
        straight.volume += stencils.volumes[w];
        straight.moment += stencils.volumes[w] * stencils.centres[w];
    }
    std::vector<double> corners(mesh.points.size());
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        for (std::size_t k = 0; k < 8; ++k) corners[mesh.cells[c][k]] += stencils.corners[c][k];
    }
    straight.weights = corners;
    for (std::size_t p = 0; p < corners.size(); ++p) {
        for (const auto& [q, weight] : stencils.bends[p]) straight.weights[q] -= weight / 12 * corners[p];
    }
    return straight;
}

void correct_integrals(const HexMesh& mesh, const StraightVolume& straight, std::vector<FittedChannel>& channels,
                       Progress* progress) {
    constexpr int kRounds = 3;         // the second has work only where |f| would have been above 1, or a field has bounds
    constexpr double kBounded = 1e-5;  // of the volume times the range
    constexpr std::array kNoBounds{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    bool done = channels.empty();
    for (int round = 0; round < kRounds && !done; ++round) {
        HexMesh both{mesh.points, mesh.cells, {}, mesh.creases, mesh.sharp_faces};
        std::vector<std::array<double, 2>> kept;
        for (const FittedChannel& channel : channels) {
            both.attributes.push_back({"u", 1, channel.values});
            both.attributes.push_back({"k", 1, room_of(channel)});
            kept.push_back({channel.least, channel.most});
            kept.push_back(kNoBounds);
        }
        const std::vector<double> limit = limit_integrals(both, kept, progress);
        const bool same = fills_the_same(mesh, straight, limit);
        done = true;
        for (std::size_t i = 0; i < channels.size(); ++i) {
            FittedChannel& channel = channels[i];
            const std::vector<double>& k = both.attributes[2 * i + 1].values;
            double room = limit[5 + 2 * i], lacks = channel.integral - limit[4 + 2 * i];
            if (!same) {
                room = std::inner_product(k.begin(), k.end(), straight.weights.begin(), 0.);
                lacks = channel.lacks;
            }
            if (!(room > 0) || !std::isfinite(lacks)) continue;
            const double factor = std::clamp(lacks / room, -1., 1.);
            const bool bounded = std::isfinite(channel.least) || std::isfinite(channel.most);
            done = done && std::abs(factor) < 1 &&
                   (!same || !bounded || std::abs(lacks) <= kBounded * straight.volume * (channel.high - channel.low));
            channel.lacks = lacks - factor * room;
            for (std::size_t p = 0; p < k.size(); ++p) channel.values[p] += factor * k[p];
        }
    }
}

}  // namespace subvol::detail
