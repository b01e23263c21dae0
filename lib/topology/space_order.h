// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "subvol/index.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// The ids of points in the order of a Morton curve through their box, equal keys by id. Points that are near each other in
/// this order are near each other in space, so that their data share cache lines.
[[nodiscard]] std::vector<Index> space_order(std::span<const Vec3> points);

}  // namespace subvol::detail
