// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "splat_scene.h"

namespace subvol::detail {

/// How the splatter sums a kernel, and its table if it needs one.
///
/// throws: Error(InvalidInput) for a table in three dimensions
[[nodiscard]] std::pair<KernelForm, std::vector<float>> kernel_profile(const Kernel& kernel);

}  // namespace subvol::detail
