// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "boundary_intervals.h"
#include "eye_splats.h"
#include "splat_scene.h"

namespace subvol::detail {

/// Everything about a frame for the CPU: kernels in eye space, listed by the square tiles that they meet, by ascending number.
struct SplatFrame {
    static constexpr int kTile_px = 32;

    const SplatScene* scene = nullptr;
    const View* view = nullptr;
    const Classification* classification = nullptr;
    SheetStack sheets;
    PixelIntervals intervals;  // empty offsets: there is no boundary
    EyeSplats kernels;
    int tiles_x = 0, tiles_y = 0;
    std::vector<std::size_t> tile_offsets;
    std::vector<std::uint32_t> tile_splats;
};

/// Fills a frame; one that was filled before keeps its memory.
void prepare_frame(SplatFrame& frame, const SplatScene& scene, const View& view, const Classification& classification,
                   int sheets, Progress* progress);

}  // namespace subvol::detail
