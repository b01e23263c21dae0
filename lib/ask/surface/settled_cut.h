// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "point_settler.h"
#include "subvol/detail/surface_share.h"
#include "subvol/limit_surface.h"
#include "subvol/share.h"

namespace subvol::detail {

/// The part of a tolerance that is left for mending slivers where triangles are as large as the tolerance allows.
inline constexpr double kOfMending = 0.2;

/// What has been cut out of cells at one level, its points moved to the limit.
struct SettledCut {
    int level = 0;
    double deviation_world = 0;  ///< deviation of the whole surface, as far as the cells that were looked at show it
    bool converged = false;
    ShareRange range{};  ///< range of the cells that the whole surface passes
    SurfaceSoup soup;
    SettledPoints settled;
};

/// Parts of one surface as one. Each has some of its cells; cells and points that several have are in the result once.
[[nodiscard]] SettledCut joined(std::vector<SettledCut> parts);

/// Adds a surface to others: with normals where sides meet, fewer slivers, and no points that no triangle uses.
///
/// improve: slivers are mended; slack_world: how far new edges may bend away from the limit
void add_cut(const SettledCut& cut, bool improve, double slack_world, LimitSurface& all);

/// What is known of a surface in some of its cells.
struct SurfaceShare {
    bool improve = true;     ///< as of `add_cut`
    double slack_world = 0;  ///< as of `add_cut`
    std::vector<SettledCut> cuts{};
};

[[nodiscard]] std::string bytes_of(const SurfaceShare& share);

/// A share of a surface that passes no cell.
[[nodiscard]] std::string empty_surface_share();

}  // namespace subvol::detail
