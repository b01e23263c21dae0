// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "subvol/camera.h"
#include "subvol/image.h"
#include "subvol/optics.h"
#include "subvol/progress.h"
#include "subvol/voxels.h"

namespace subvol {

/// samples:   n × n rays a pixel on a regular grid, 1..16
/// tolerance: how far the value may be from the straight lines that are integrated, as part of the range of the knots, > 0
struct GridOptions {
    int samples = 1;
    double tolerance = 1e-4;
    Progress* progress = nullptr;
};

struct GridTraceReport {
    std::size_t rays = 0;    // that met an active voxel
    std::size_t cells = 0;   // between eight voxels, that were integrated
    std::size_t blocks = 0;  // passed at once
    double seconds_draw = 0;
};

struct GridResult {
    Image image;
    GridTraceReport report;
};

/// Rays through a grid, from cell to cell between eight voxels; blocks that are empty or of one value are passed at once. In a
/// cell the value along the ray is a cubic, cut where it enters another voxel if some are inactive, and integrated exactly
/// between as many places as the tolerance asks for.
///
/// throws: Error(InvalidInput) if an option is out of range or the grid's axes are not independent
/// cost:   of a ray, the cells that it crosses; pictures are bitwise the same for any number of threads
[[nodiscard]] GridResult render_grid(const Voxels& grid, const View& view, const Optics& optics,
                                     const GridOptions& options = {});

}  // namespace subvol
