// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "splat_frame.h"
#include "subvol/progress.h"

namespace subvol::detail {

/// Finds the values where rays enter and leave the volume, which draw_splats_cpu needs. Nothing without a boundary.
void find_interval_ends(SplatFrame& frame);

/// Draws a frame on all threads of the CPU, tile by tile.
[[nodiscard]] Drawn draw_splats_cpu(const SplatFrame& frame, Progress* progress);

/// The optical depth that each ray has gone through up to each sheet: of pixel (x, y) on sheet z at (z · height + y) · width +
/// x.
[[nodiscard]] std::vector<float> optical_depths_cpu(SplatFrame& frame);

}  // namespace subvol::detail
