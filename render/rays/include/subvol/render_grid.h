// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "subvol/camera.h"
#include "subvol/clip.h"
#include "subvol/image.h"
#include "subvol/optics.h"
#include "subvol/progress.h"
#include "subvol/voxels.h"

namespace subvol {

struct GridOptions {
    int samples = 1;  ///< n × n rays for each pixel on a regular grid, 1..16
    Clip clip{};      ///< how the volume is cut open
    /// How far the value may be from the straight lines that are integrated, as a part of the range of the knots, > 0.
    double tolerance = 1e-4;
    Progress* progress = nullptr;
};

struct GridTraceReport {
    std::size_t rays = 0;    // that met an active voxel
    std::size_t cells = 0;   // between eight voxels, that were integrated
    std::size_t blocks = 0;  // that were crossed in one step
    double seconds_draw = 0;
};

struct GridResult {
    Image image;
    GridTraceReport report;
};

/// Rays through a grid, from cell to cell between eight voxels; blocks that are empty or constant are crossed in one step. In a
/// cell the value along the ray is a cubic. It is cut where the ray enters another voxel if some are inactive, and
/// integrated exactly as a polyline with as many pieces as the tolerance requires.
///
/// throws: Error(InvalidInput) if an option is out of range or the grid's axes are not independent
/// cost:   proportional to the cells that rays cross; pictures are bitwise the same for any number of threads
[[nodiscard]] GridResult render_grid(const Voxels& grid, const View& view, const Optics& optics,
                                     const GridOptions& options = {});

}  // namespace subvol
