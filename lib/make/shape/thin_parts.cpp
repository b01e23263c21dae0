// SPDX-License-Identifier: Apache-2.0
#include "thin_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "subvol/detail/parallel_each.h"
#include "surface_tree.h"

namespace subvol::detail {
namespace {

/// A place of a surface that stands for a part of its area.
struct Sample {
    Vec3 place, normal;
    double area, thickness = std::numeric_limits<double>::infinity();
};

/// The middles of the n² parts of each triangle, where parts are as large as each other as far as they can be.
std::vector<Sample> samples_of(const Surface& surface) {
    constexpr double kSamples = 10'000;
    constexpr int kMost = 100;
    const auto doubled = [&](const std::array<Index, 3>& t) {
        return glm::cross(surface.points[t[1]] - surface.points[t[0]], surface.points[t[2]] - surface.points[t[0]]);
    };
    double total = 0;
    for (const auto& t : surface.triangles) total += glm::length(doubled(t)) / 2;
    // Of many small triangles only some are looked at.
    const std::size_t stride = 1 + surface.triangles.size() / static_cast<std::size_t>(kSamples);
    std::vector<Sample> samples;
    for (std::size_t k = 0; k < surface.triangles.size(); k += stride) {
        const auto& t = surface.triangles[k];
        const Vec3 normal = doubled(t);
        const double area = glm::length(normal) / 2;
        if (!(area > 0)) continue;
        const int n = std::clamp(static_cast<int>(std::ceil(std::sqrt(kSamples * area / total))), 1, kMost);
        const Vec3 &a = surface.points[t[0]], u = (surface.points[t[1]] - a) / (3.0 * n),
                   v = (surface.points[t[2]] - a) / (3.0 * n);
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n - i; ++j) {
                const auto add = [&](int x, int y) {
                    samples.push_back(
                        {a + static_cast<double>(x) * u + static_cast<double>(y) * v, normal / (2 * area), area / (n * n)});
                };
                add(3 * i + 1, 3 * j + 1);
                if (j < n - i - 1) add(3 * i + 2, 3 * j + 2);
            }
        }
    }
    return samples;
}

}  // namespace

ThinParts thin_parts(const SurfaceBodies& bodies, double far) {
    const SurfaceTree tree(bodies.surface());
    std::vector<Sample> samples = samples_of(bodies.surface());
    parallel_each(samples.size(), [&](std::size_t k) {
        Sample& sample = samples[k];
        constexpr double kBeside = 1e-3;  // of `far`
        constexpr float kEnclosed = 0.5F;
        const Vec3 step = kBeside * far * sample.normal;
        const bool below = bodies.likeness(sample.place - step) > kEnclosed,
                   above = bodies.likeness(sample.place + step) > kEnclosed;
        if (below == above) return;
        const Vec3 inwards = below ? -sample.normal : sample.normal;
        // From beside the sample's own triangle on, so that it is not met.
        if (const auto way = tree.way_to(sample.place + kBeside * far * inwards, sample.place + far * inwards))
            sample.thickness = kBeside * far + *way * (1 - kBeside) * far;
    });
    std::ranges::sort(samples, {}, &Sample::thickness);
    double total = 0, thin = 0;
    for (const Sample& sample : samples) {
        total += sample.area;
        if (sample.thickness < far) thin += sample.area;
    }
    ThinParts found;
    if (!(thin > 0)) return found;
    found.part = thin / total;
    constexpr double kThinner = 0.1;
    double sum = 0;
    for (const Sample& sample : samples) {
        sum += sample.area;
        if (sum < kThinner * thin) continue;
        found.thickness_world = sample.thickness;
        found.at = sample.place;
        break;
    }
    return found;
}

}  // namespace subvol::detail
