// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/fit_kernel.h"

namespace subvol::detail {

// The fits by shape; `fit_kernel` has checked the options and fills in the errors.

[[nodiscard]] KernelFit fit_cubic(const BasisFunction& basis, KernelShape shape, const FitOptions& options);
[[nodiscard]] KernelFit fit_gaussian(const BasisFunction& basis);
[[nodiscard]] KernelFit fit_gaussian_sum(const BasisFunction& basis, int terms);
[[nodiscard]] KernelFit fit_scaled_gaussian(const BasisFunction& basis);
[[nodiscard]] KernelFit fit_wendland_c2(const BasisFunction& basis);
[[nodiscard]] KernelFit fit_wendland_c4(const BasisFunction& basis);
[[nodiscard]] KernelFit fit_separable_gaussian(const BasisFunction& basis);
[[nodiscard]] KernelFit fit_separable_table(const BasisFunction& basis);

}  // namespace subvol::detail
