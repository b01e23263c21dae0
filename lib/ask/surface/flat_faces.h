// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hull_levels.h"
#include "subvol/detail/boundary_rings.h"

namespace subvol::detail {

/// A flag for each boundary face of a mesh: whether the limit is a part of a plane there, with straight sides where these are
/// creases, and the fields are linear. That is so where all points about the face, two rings wide, lie in a plane with fields
/// that are linear there, and the creases on its sides go straight on for two edges.
///
/// surface:    boundary faces without cells
/// places:     of its points; kinds and fields, too
/// bend_world: how far the limit may bend; less than a sixteenth of it is none
[[nodiscard]] std::vector<std::uint8_t> flat_faces(const Topology& surface, std::span<const PointKind> kinds,
                                                   std::span<const Vec3> places, const HullFields& fields, double bend_world);

}  // namespace subvol::detail
