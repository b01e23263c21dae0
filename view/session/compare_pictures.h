// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/image.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// Left of `slider` (0 to 1 of the width) one picture, right of it the other, with a line between them.
///
/// right: of the same size
[[nodiscard]] Image side_by_side(const Image& left, const Image& right, double slider, const Vec3& line);

/// The largest difference of a pixel's colours, over a background, as grey: white is a difference of 1/8 or more.
[[nodiscard]] Image difference_of(const Image& left, const Image& right, const Vec3& background);

}  // namespace subvol::detail
