#pragma once

#include "subvol/image.h"

namespace subvol {

/// throws: Error(InvalidInput) if the sizes differ; names both
void check_same_size(const Image& a, const Image& b);

/// The largest difference of the red, green and blue of a pixel; not a number if one of them is none.
[[nodiscard]] double pixel_difference(const Image& a, const Image& b, int x, int y);

}  // namespace subvol
