// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "subvol/index.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// The ids of points along a Morton curve through their box, equal keys by id: neighbours in it share what caches hold.
[[nodiscard]] std::vector<Index> space_order(std::span<const Vec3> points);

}  // namespace subvol::detail
