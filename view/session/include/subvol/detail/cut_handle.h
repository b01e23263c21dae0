// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "subvol/vec.h"

namespace subvol::detail {

/// The handle of a plane in the picture: the point of the plane that is nearest to the middle of the body, and an arrow along
/// its normal.
struct CutHandle {
    bool slice = false;      ///< whether it is a slice, else a plane that clips
    std::size_t index = 0;   ///< which of the slices or of the planes
    Vec2 at{0.0}, tip{0.0};  ///< in pixels
};

}  // namespace subvol::detail
