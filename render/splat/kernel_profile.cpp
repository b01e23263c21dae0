// SPDX-License-Identifier: Apache-2.0
#include "kernel_profile.h"

#include <cmath>

#include "subvol/error.h"

namespace subvol::detail {

namespace {

// Linear between: the error is an eighth of the squared step times the curvature over the unit range, which is some hundreds
// for the narrowest kernels.
constexpr std::size_t kSteps = 4096;

template <class Value>
std::vector<float> sampled(const Value& value) {
    std::vector<float> table(kSteps + 1);
    for (std::size_t i = 0; i < kSteps; ++i) table[i] = static_cast<float>(value(static_cast<double>(i) / kSteps));
    return table;
}

}  // namespace

std::pair<KernelForm, std::vector<float>> kernel_profile(const Kernel& kernel) {
    if (std::holds_alternative<CompactKernel>(kernel)) return {KernelForm::Compact, {}};
    const double radius = support_radius(kernel);
    if (is_radial(kernel)) {
        return {KernelForm::Radial, sampled([&](double e) { return radial_value(kernel, radius * std::sqrt(e)); })};
    }
    if (std::holds_alternative<TableKernel>(kernel)) {
        throw Error(ErrorCode::InvalidInput, "kernels tabulated in three dimensions cannot be splatted", {},
                    "radial or separable kernels");
    }
    // A product of one function over the axes: at the origin it is that function's third power.
    const double root = std::cbrt(kernel_value(kernel, Vec3(0.0)));
    return {KernelForm::Separable,
            sampled([&](double t) { return kernel_value(kernel, Vec3(radius * t, 0, 0)) / (root * root); })};
}

}  // namespace subvol::detail
