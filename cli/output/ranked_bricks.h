// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "picture_shares.h"
#include "ranks.h"
#include "subvol/brick_points.h"
#include "subvol/render_brick_tets.h"
#include "subvol/render_bricks.h"

namespace subvol::cli {

/// `write_points_of_bricks` by all ranks: each samples a range of the pieces, one after the other, and sends the kernels of
/// each to rank 0, which writes. Elsewhere nothing is returned.
BrickPointsReport write_points_ranked(const std::filesystem::path& path, const MeshSource& source, const SampleOptions& options,
                                      Ranks& ranks);

/// `render_bricks` by all ranks: each samples a range of the pieces, one after the other, and sends every rank the kernels that
/// may touch its rows. The rows of this rank are drawn.
[[nodiscard]] SplatResult render_bricks_ranked(const MeshSource& source, Surface boundary, const View& view,
                                               const Optics& optics, BrickSplatOptions options, Ranks& ranks,
                                               ShippedKernels& shipped);

/// `measure_tets` of all pieces: of ranks that draw one picture together, each measures a range of them.
[[nodiscard]] BrickTets measure_tets(const MeshSource& source, const BrickTetsOptions& options, const OwnRows& rows);

}  // namespace subvol::cli
