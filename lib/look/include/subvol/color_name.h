// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "subvol/vec.h"

namespace subvol {

/// A colour in linear light: three numbers in 0..1 such as "1,.5,0", "#rrggbb" (sRGB), or a name of CSS.
///
/// where:  is named in the error
/// throws: Error(InvalidInput)
[[nodiscard]] Vec3 parse_color(const std::string& text, const std::string& where);

}  // namespace subvol
