// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report.h"
#include "subvol/fit_kernel.h"

namespace subvol::cli {

struct NamedShape {
    std::string name;
    KernelShape shape;
    std::optional<int> terms{};  ///< the number of terms of a sum of Gaussians, if the name determines it
};

/// The names of all shapes.
[[nodiscard]] std::vector<std::string> shape_names();

[[nodiscard]] std::optional<NamedShape> shape_named(const std::string& name);

/// options.terms is used if the shape's name does not determine it.
[[nodiscard]] KernelFit fit_shape(const BasisFunction& basis, const NamedShape& named, FitOptions options = {});

/// mse, rmse, mae, max
[[nodiscard]] Json to_json(const FitErrors& errors);

/// A kernel's parameters, without long tables.
[[nodiscard]] Json parameters_of(const Kernel& kernel);

struct FitTable {
    Json rows = Json::array();       ///< for JSON
    std::vector<std::string> lines;  ///< for people
};

/// Table 1 of [mnmq2007]: the paper's kernels with its printed errors, with ours summed in float (as the paper did) and in
/// double precision, and the kernels fitted by us.
///
/// basis: of MCQ at level 5
[[nodiscard]] FitTable table1(const BasisFunction& basis);

/// Every kind of kernel, fitted to the basis function.
[[nodiscard]] FitTable kernels_table(const BasisFunction& basis);

}  // namespace subvol::cli
