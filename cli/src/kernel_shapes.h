#pragma once

#include <optional>
#include <string>
#include <vector>

#include "subvol/fit_kernel.h"

namespace subvol::cli {

/// The names of what can be fitted.
[[nodiscard]] std::vector<std::string> shape_names();

/// Two names are of sums of Gaussians: `gaussians`, and `two_gaussians`, which has two terms.
[[nodiscard]] std::optional<KernelShape> shape_named(const std::string& name);

}  // namespace subvol::cli
