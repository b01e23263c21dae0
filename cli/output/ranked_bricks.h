// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "picture_shares.h"
#include "ranks.h"
#include "subvol/brick_points.h"
#include "subvol/render_brick_tets.h"
#include "subvol/render_bricks.h"

namespace subvol::cli {

/// `write_points_of_bricks` by all ranks: each samples a range of the bricks, one after the other, and sends the kernels of
/// each to rank 0, which writes. Elsewhere nothing is returned.
BrickPointsReport write_points_ranked(const std::filesystem::path& path, const Bricks& bricks, const SampleOptions& options,
                                      const BrickFields& fields, Ranks& ranks);

/// `render_bricks` by all ranks: each samples a range of the bricks, one after the other, and sends every rank the kernels that
/// may touch its rows. The rows of this rank are drawn.
[[nodiscard]] SplatResult render_bricks_ranked(const Bricks& bricks, const BrickFields& fields, Surface boundary,
                                               const View& view, const Optics& optics, BrickSplatOptions options, Ranks& ranks,
                                               ShippedKernels& shipped);

/// `measure_tets` of all bricks: of ranks that draw one picture together, each measures a range of them.
[[nodiscard]] BrickTets measure_tets(const Bricks& bricks, const BrickTetsOptions& options, const OwnRows& rows);

}  // namespace subvol::cli
