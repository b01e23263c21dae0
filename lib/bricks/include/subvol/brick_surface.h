// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "subvol/bricks.h"
#include "subvol/detail/surface_share.h"
#include "subvol/limit_surface.h"

namespace subvol {

/// Isosurfaces and the boundary of a mesh in bricks: the same bits as those of `limit_surface` of the whole.
///
/// Each brick is looked at for cells that a surface may pass through; these are then gathered with their halos, and the surface
/// is cut from them alone.
///
/// The places of the result have the cells' numbers in the whole mesh; kNone if an Index cannot hold them.
///
/// fields: changes the attributes of each brick; none: they stay
/// throws: as `limit_surface` and `read_brick`; Error(InvalidInput) if the bricks have fewer than three layers of halo
/// cost:   memory: a brick with its topology; then some 2 kB for each cell that the surface passes, and 300 bytes a triangle
[[nodiscard]] LimitSurface limit_surface(const Bricks& bricks, std::string_view field, const SurfaceOptions& options,
                                         const BrickFields& fields = {});

namespace detail {

/// The same for one share of a surface. Every share looks at all bricks and gathers the same cells.
///
/// throws: also Error(InvalidInput) if an isosurface leads two cells farther than the first look finds
[[nodiscard]] std::string share_of_surface(const Bricks& bricks, std::string_view field, const SurfaceOptions& options,
                                           const Share& share, const BrickFields& fields = {});

}  // namespace detail

}  // namespace subvol
