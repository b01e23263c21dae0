// SPDX-License-Identifier: Apache-2.0
#include "page_kernels.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "subvol/detail/principal_axes.h"

namespace subvol::detail {

namespace {

/// S^(1/2), symmetric; a flat frame gets a little thickness, so that it has an inverse.
Mat3 symmetric_root(const Symmetric3& frame) {
    constexpr double kThinnest = 1e-4;
    const PrincipalAxes axes = principal_axes(frame);
    Mat3 root(0.0);
    for (int a = 0; a < 3; ++a) {
        const double half = std::max(axes.half_axes[a], kThinnest * axes.half_axes[0]);
        root += half * glm::outerProduct(axes.directions[a], axes.directions[a]);
    }
    return root;
}

}  // namespace

std::vector<double> place_numbers(const RbfVolume& volume) {
    std::vector<double> numbers(kPlaceNumbers * volume.size());
    tbb::parallel_for(std::size_t{0}, volume.size(), [&](std::size_t i) {
        const Vec3& x = volume.centers[i];
        const Mat3 r = symmetric_root(volume.frames[i]);
        const double trace = r[0][0] + r[1][1] + r[2][2];
        const double all[kPlaceNumbers]{x.x,
                                        x.y,
                                        x.z,
                                        std::log2(trace),
                                        r[0][0] / trace,
                                        r[1][0] / trace,
                                        r[2][0] / trace,
                                        r[1][1] / trace,
                                        r[2][1] / trace,
                                        r[2][2] / trace};
        std::copy(std::begin(all), std::end(all), numbers.begin() + static_cast<std::ptrdiff_t>(kPlaceNumbers * i));
    });
    return numbers;
}

std::vector<double> value_numbers(const RbfVolume& volume, const RbfChannel& channel) {
    std::vector<double> numbers(kValueNumbers * volume.size());
    tbb::parallel_for(std::size_t{0}, volume.size(), [&](std::size_t i) {
        const auto& g = channel.gradients[i];
        const Vec3 change = symmetric_root(volume.frames[i]) * Vec3(g[0], g[1], g[2]);
        double* to = numbers.data() + kValueNumbers * i;
        to[0] = static_cast<double>(channel.values[i]);
        for (int a = 0; a < 3; ++a) to[1 + a] = change[a];
        to[4] = static_cast<double>(channel.moments[i]);
    });
    return numbers;
}

RbfVolume kernels_of_numbers(std::span<const double> places, std::span<const double> values, const Kernel& kernel) {
    const std::size_t count = places.size() / kPlaceNumbers;
    RbfVolume volume{.centers = std::vector<Vec3>(count),
                     .frames = std::vector<Symmetric3>(count),
                     .channels = {{.name = "value",
                                   .values = std::vector<float>(count),
                                   .gradients = std::vector<std::array<float, 3>>(count),
                                   .moments = std::vector<float>(count)}},
                     .kernel = kernel,
                     .boundary = {},
                     .bounds = {}};
    RbfChannel& channel = volume.channels.front();
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        const double* p = places.data() + kPlaceNumbers * i;
        const double* v = values.data() + kValueNumbers * i;
        volume.centers[i] = {p[0], p[1], p[2]};
        const Mat3 root = std::exp2(p[3]) * Mat3(Vec3(p[4], p[5], p[6]), Vec3(p[5], p[7], p[8]), Vec3(p[6], p[8], p[9]));
        volume.frames[i] = symmetric3(root * root);
        const Vec3 gradient = glm::inverse(root) * Vec3(v[1], v[2], v[3]);
        channel.values[i] = static_cast<float>(v[0]);
        for (int a = 0; a < 3; ++a) channel.gradients[i][static_cast<std::size_t>(a)] = static_cast<float>(gradient[a]);
        channel.moments[i] = static_cast<float>(v[4]);
    });
    for (const Vec3& x : volume.centers) volume.bounds.add(x);
    return volume;
}

}  // namespace subvol::detail
