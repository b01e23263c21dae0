// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "subvol/limit_slice.h"

namespace subvol::detail {

/// throws: Error(InvalidInput) if the normal has no length, or an option is out of range
void check_plane(const Vec3& point, const Vec3& normal, const SliceOptions& options);

/// A slice without values: its places cover the part of a plane that is in a box.
///
/// throws: Error(InvalidInput) as `check_plane`, or if the plane misses the box
[[nodiscard]] LimitSlice empty_slice(const Box& box, const Vec3& point, const Vec3& normal, const SliceOptions& options);

/// All places of a slice, row by row.
[[nodiscard]] std::vector<Vec3> places_of(const LimitSlice& slice);

/// Puts the first field that was found at these places into the slice, and counts.
///
/// throws: Error(InvalidInput) if no place is in the volume
void take_found(LimitSlice& slice, ProbeResult found);

}  // namespace subvol::detail
