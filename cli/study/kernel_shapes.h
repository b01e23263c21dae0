// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "subvol/fit_kernel.h"

namespace subvol::cli {

/// terms: of a sum of Gaussians whose name says how many
struct NamedShape {
    std::string name;
    KernelShape shape;
    std::optional<int> terms{};
};

/// The names of what can be fitted.
[[nodiscard]] std::vector<std::string> shape_names();

[[nodiscard]] std::optional<NamedShape> shape_named(const std::string& name);

/// options.terms: where the name does not say
[[nodiscard]] KernelFit fit_shape(const BasisFunction& basis, const NamedShape& named, FitOptions options = {});

}  // namespace subvol::cli
