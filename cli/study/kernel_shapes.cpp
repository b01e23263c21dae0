// SPDX-License-Identifier: Apache-2.0
#include "kernel_shapes.h"

#include <algorithm>

namespace subvol::cli {
namespace {

const std::vector<NamedShape> kShapes{{"gaussian", KernelShape::Gaussian},
                                      {"scaled_gaussian", KernelShape::ScaledGaussian},
                                      {"bc", KernelShape::BcSpline},
                                      {"cardinal", KernelShape::CardinalSpline},
                                      {"wendland_c2", KernelShape::WendlandC2},
                                      {"wendland_c4", KernelShape::WendlandC4},
                                      {"two_gaussians", KernelShape::GaussianSum, 2},
                                      {"three_gaussians", KernelShape::GaussianSum, 3},
                                      {"gaussians", KernelShape::GaussianSum},
                                      {"separable_gaussian", KernelShape::SeparableGaussian},
                                      {"separable_table", KernelShape::SeparableTable}};

}  // namespace

std::vector<std::string> shape_names() {
    std::vector<std::string> names;
    for (const NamedShape& named : kShapes) names.push_back(named.name);
    return names;
}

std::optional<NamedShape> shape_named(const std::string& name) {
    const auto found = std::ranges::find(kShapes, name, &NamedShape::name);
    return found != kShapes.end() ? std::optional(*found) : std::nullopt;
}

KernelFit fit_shape(const BasisFunction& basis, const NamedShape& named, FitOptions options) {
    options.terms = named.terms.value_or(options.terms);
    return fit_kernel(basis, named.shape, options);
}

}  // namespace subvol::cli
