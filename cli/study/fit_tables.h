// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "report.h"
#include "subvol/fit_kernel.h"

namespace subvol::cli {

/// mse, rmse, mae, max
[[nodiscard]] Json to_json(const FitErrors& errors);

/// A kernel's parameters, without long tables.
[[nodiscard]] Json parameters_of(const Kernel& kernel);

/// Reports table 1 of [mnmq2007] under "rows": the paper's kernels with its printed errors, with ours summed in float (as the
/// paper did) and in double precision, and the kernels fitted by us.
///
/// basis: of MCQ at level 5
void report_table1(const BasisFunction& basis, Report& report);

/// Reports every kind of kernel, fitted to the basis function, under "kernels".
void report_kernels(const BasisFunction& basis, Report& report);

}  // namespace subvol::cli
