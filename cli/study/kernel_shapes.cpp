// SPDX-License-Identifier: Apache-2.0
#include "kernel_shapes.h"

#include <algorithm>

namespace subvol::cli {
namespace {

const std::vector<NamedShape> kSums{{"two_gaussians", KernelShape::GaussianSum, 2},
                                    {"three_gaussians", KernelShape::GaussianSum, 3}};

}  // namespace

std::vector<std::string> shape_names() {
    std::vector<std::string> names = names_of<KernelShape>();
    auto place = std::ranges::find(names, name_of(KernelShape::GaussianSum));
    for (const NamedShape& sum : kSums) place = names.insert(place, sum.name) + 1;
    return names;
}

std::optional<NamedShape> shape_named(const std::string& name) {
    const auto sum = std::ranges::find(kSums, name, &NamedShape::name);
    if (sum != kSums.end()) return *sum;
    const auto shape = find_named<KernelShape>(name);
    return shape ? std::optional(NamedShape{name, *shape}) : std::nullopt;
}

KernelFit fit_shape(const BasisFunction& basis, const NamedShape& named, FitOptions options) {
    options.terms = named.terms.value_or(options.terms);
    return fit_kernel(basis, named.shape, options);
}

}  // namespace subvol::cli
