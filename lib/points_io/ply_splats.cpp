// SPDX-License-Identifier: Apache-2.0
#include "ply_splats.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "knot_values.h"
#include "subvol/detail/principal_axes.h"
#include "subvol/srgb.h"
#include "subvol/transfer_function.h"

namespace subvol::detail {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kConstantHarmonic = 0.28209479177387814;  // √(1/4π): a viewer's colour is .5 + this · f_dc
constexpr double kLeastOpacity = 1.0 / 255;                // the least that a viewer can show; the logit of 0 is infinite

}  // namespace

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
    const double sigma = std::cbrt(volume) / std::sqrt(2 * kPi);
    return std::isfinite(sigma) && sigma > 0 ? sigma / radius : 1.0 / 3;
}

Mat3 turn_to_viewers(UpAxis up) {
    // By columns: where x, y and z go.
    if (up == UpAxis::X) return {Vec3(0, -1, 0), Vec3(1, 0, 0), Vec3(0, 0, 1)};
    if (up == UpAxis::Y) return {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, -1)};
    return {Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(0, -1, 0)};
}

std::vector<PlySplat> ply_splats(const RbfVolume& volume, const Mat3& turn) {
    const std::vector<float>& values = volume.channels.front().values;
    std::vector<PlySplat> splats(volume.size());
    if (splats.empty()) return splats;
    const auto [min, max] = std::minmax_element(values.begin(), values.end());
    const TransferFunction function = transfer_function_preset("viridis", *min, *max);
    const double width = gaussian_width(volume.kernel);
    tbb::parallel_for(std::size_t{0}, splats.size(), [&](std::size_t i) {
        const PrincipalAxes axes = principal_axes(volume.frames[i]);
        const auto rotation = quaternion(turn * axes.directions);
        const Vec3 color = color_at(function, values[i]);
        const double alpha = std::max(alpha_at(function, values[i]), kLeastOpacity);
        PlySplat& splat = splats[i];
        for (int k = 0; k < 3; ++k) {
            const auto n = static_cast<std::size_t>(k);
            splat[n] = static_cast<float>(std::log(width * axes.half_axes[k]));
            splat[8 + n] = static_cast<float>((srgb_from_linear(color[k]) - .5) / kConstantHarmonic);
        }
        for (std::size_t k = 0; k < 4; ++k) splat[3 + k] = static_cast<float>(rotation[k]);
        splat[7] = static_cast<float>(std::log(alpha / (1 - alpha)));
    });
    return splats;
}

}  // namespace subvol::detail
