// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/image.h"

namespace subvol::detail {

/// throws: Error(InvalidInput) if the sizes differ or there are no pixels; the message names both sizes
void check_comparable(const Image& a, const Image& b);

/// throws: Error(InvalidInput) as `check_comparable`, or if pixels are not finite; the message says how many
void check_finite(const Image& a, const Image& b);

}  // namespace subvol::detail
