// SPDX-License-Identifier: Apache-2.0
#include "splat_gaussians.h"

#include <tbb/parallel_for.h>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "subvol/detail/principal_axes.h"
#include "subvol/kernel.h"
#include "subvol/srgb.h"

namespace subvol::detail {

namespace {

constexpr double kLeastOpacity = 1.0 / 255;  // the least that a viewer can show; the logit of 0 is infinite

/// σ of the Gaussian with the height and the integral of the kernel, in units of the support radius.
double gaussian_width(const Kernel& kernel) {
    constexpr int kSteps = 32;  // midpoints along each axis of an octant of the support
    const double radius = support_radius(kernel), step = radius / kSteps;
    double sum = 0;
    for (int k = 0; k < kSteps; ++k) {
        for (int j = 0; j < kSteps; ++j) {
            for (int i = 0; i < kSteps; ++i) sum += kernel_value(kernel, step * Vec3(i + .5, j + .5, k + .5));
        }
    }
    const double volume = 8 * sum * step * step * step / kernel_value(kernel, Vec3(0.0));
    const double sigma = std::cbrt(volume) / std::sqrt(2 * std::numbers::pi);
    return std::isfinite(sigma) && sigma > 0 ? sigma / radius : 1.0 / 3;
}

}  // namespace

std::vector<SplatGaussian> splat_gaussians(const RbfVolume& volume, const TransferFunction& function, const Mat3& turn) {
    const std::vector<float>& values = volume.channels.front().values;
    const double width = gaussian_width(volume.kernel);
    std::vector<SplatGaussian> gaussians(volume.size());
    tbb::parallel_for(std::size_t{0}, gaussians.size(), [&](std::size_t i) {
        const PrincipalAxes axes = principal_axes(volume.frames[i]);
        const Vec3 color = color_at(function, values[i]);
        SplatGaussian& gaussian = gaussians[i];
        for (std::size_t k = 0; k < 3; ++k) {
            const auto n = static_cast<int>(k);
            gaussian.half_axes[k] = width * axes.half_axes[n];
            gaussian.harmonic[k] = (srgb_from_linear(color[n]) - .5) / kConstantHarmonic;
        }
        gaussian.rotation = quaternion(turn * axes.directions);
        gaussian.opacity = std::max(alpha_at(function, values[i]), kLeastOpacity);
    });
    return gaussians;
}

std::vector<SplatGaussian> viewer_gaussians(const RbfVolume& volume, const Mat3& turn) {
    const std::vector<float>& values = volume.channels.front().values;
    if (values.empty()) return {};
    const auto [min, max] = std::ranges::minmax(values);
    return splat_gaussians(volume, transfer_function_preset("viridis", min, max), turn);
}

}  // namespace subvol::detail
