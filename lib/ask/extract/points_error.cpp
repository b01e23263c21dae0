// SPDX-License-Identifier: Apache-2.0
#include "subvol/points_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "subvol/probe.h"
#include "subvol/rbf_field.h"

namespace subvol {

namespace {

constexpr std::size_t kKernelsAtOnce = 1 << 17;  // kernels whose places are compared at once
constexpr std::size_t kPlaces = 9;               // of a kernel

/// L of S/R² = L Lᵀ: its columns are a sample interval long, as those of the kernel's Jacobian are.
Mat3 intervals(const Symmetric3& frame, double support) {
    const Mat3 s = matrix(frame) / (support * support);
    Mat3 l(0.0);
    for (int j = 0; j < 3; ++j) {
        for (int i = j; i < 3; ++i) {
            double rest = s[j][i];
            for (int k = 0; k < j; ++k) rest -= l[k][i] * l[k][j];
            l[j][i] = i == j ? std::sqrt(std::max(rest, 0.0)) : l[j][j] > 0 ? rest / l[j][j] : 0;
        }
    }
    return l;
}

void add_places(const Vec3& center, const Mat3& along, std::vector<Vec3>& places) {
    places.push_back(center);
    for (unsigned corner = 0; corner < 8; ++corner) {
        const Vec3 side((corner & 1) != 0 ? 0.5 : -0.5, (corner & 2) != 0 ? 0.5 : -0.5, (corner & 4) != 0 ? 0.5 : -0.5);
        places.push_back(center + along * side);
    }
}

}  // namespace

PointsError points_error(const RbfVolume& points, const HexMesh& mesh, std::string_view field,
                         const PointsErrorOptions& options) {
    const RbfField kernels(points, {.channel = options.channel});
    const LimitProbe probe(with_scalar_field(mesh, field), {.limit = {.scheme = options.scheme, .progress = options.progress}});
    PointsError error;
    error.of_points.assign(points.size(), 0);
    double squares = 0;
    std::vector<Vec3> places;
    for (std::size_t first = 0; first < points.size(); first += kKernelsAtOnce) {
        report_progress(options.progress, "error", first, points.size());
        const std::size_t end = std::min(first + kKernelsAtOnce, points.size());
        places.clear();
        for (std::size_t p = first; p < end; ++p) {
            add_places(points.centers[p], intervals(points.frames[p], support_radius(points.kernel)), places);
        }
        const ProbeResult limit = probe.at(places);
        const std::vector<double> sums = kernels.evaluate(places);
        for (std::size_t i = 0; i < places.size(); ++i) {
            if (!limit.inside(i)) continue;
            ++error.places;
            if (std::isnan(sums[i])) {
                ++error.gaps;
                continue;
            }
            const double off = std::abs(sums[i] - limit.fields[0].values[i]);
            double& of_point = error.of_points[first + i / kPlaces];
            of_point = std::max(of_point, off);
            error.max = std::max(error.max, off);
            squares += off * off;
        }
    }
    const std::size_t compared = error.places - error.gaps;
    error.rms = compared > 0 ? std::sqrt(squares / static_cast<double>(compared)) : 0;
    return error;
}

RbfChannel error_channel(const PointsError& error, std::string_view name) {
    const std::size_t count = error.of_points.size();
    RbfChannel channel{.name = std::string(name) + "_error"};
    channel.values.assign(error.of_points.begin(), error.of_points.end());
    channel.gradients.assign(count, {0, 0, 0});
    channel.moments.assign(count, 0);
    return channel;
}

}  // namespace subvol
