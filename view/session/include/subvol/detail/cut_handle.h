// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "subvol/vec.h"

namespace subvol::detail {

/// The handle of a plane in the picture: the point of the plane that is nearest to the middle of the body, and an arrow along
/// its normal.
///
/// slice: a slice, else a plane that clips; index: which of them
/// at, tip: in pixels
struct CutHandle {
    bool slice = false;
    std::size_t index = 0;
    Vec2 at{0.0}, tip{0.0};
};

}  // namespace subvol::detail
