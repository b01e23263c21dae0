// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "boundary_intervals.h"
#include "eye_splats.h"
#include "splat_scene.h"

namespace subvol::detail {

/// The data of a frame for the CPU: kernels in eye space, and for each square tile the kernels that it meets, ascending.
struct SplatFrame {
    static constexpr int kTile_px = 32;

    const SplatScene* scene = nullptr;
    const View* view = nullptr;
    const Classification* classification = nullptr;
    SheetStack sheets;
    PixelIntervals intervals;  // no offsets: there is no boundary
    EyeSplats kernels;
    int tiles_x = 0, tiles_y = 0;
    std::vector<std::size_t> tile_offsets;
    std::vector<std::uint32_t> tile_splats;
};

/// Fills a frame, and uses again the memory of one that was filled before.
void prepare_frame(SplatFrame& frame, const SplatScene& scene, const View& view, const Classification& classification,
                   int sheets, Progress* progress);

}  // namespace subvol::detail
