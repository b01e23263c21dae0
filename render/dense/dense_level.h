// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cell_sides.h"
#include "subvol/camera.h"
#include "subvol/hex_mesh.h"
#include "subvol/optics.h"
#include "subvol/refine.h"

namespace subvol::detail {

/// A level of dense grids, and how far what it shows lies from the limit, in the mean over the picture (RMS): the boundary
/// and the lines where colours jump in pixels, colours and opacities elsewhere as parts of 1.
struct DenseLevel {
    int level = 0;
    double error_px = 0, error_color = 0;
    bool within = false;  ///< `error_px` is not more than a quarter, and `error_color` not more than 1/256
};

/// The lowest level up to `most` that lies within these tolerances. The same for any number of threads.
///
/// cost: one level of refinement, 40 bytes a cell
[[nodiscard]] DenseLevel find_dense_level(const HexMesh& mesh, const CellSides& sides, const RefineOptions& refine,
                                          const View& view, const Optics& optics, int most);

}  // namespace subvol::detail
