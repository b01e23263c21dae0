// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "subvol/fit_kernel.h"

namespace subvol::cli {

/// terms: of a sum of Gaussians, if the name determines them
struct NamedShape {
    std::string name;
    KernelShape shape;
    std::optional<int> terms{};
};

/// The names of all shapes.
[[nodiscard]] std::vector<std::string> shape_names();

[[nodiscard]] std::optional<NamedShape> shape_named(const std::string& name);

/// options.terms is used if the shape's name does not determine it.
[[nodiscard]] KernelFit fit_shape(const BasisFunction& basis, const NamedShape& named, FitOptions options = {});

}  // namespace subvol::cli
