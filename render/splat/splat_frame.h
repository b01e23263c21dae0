// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "boundary_intervals.h"
#include "boundary_light.h"
#include "eye_splats.h"
#include "finer_sheets.h"
#include "splat_scene.h"

namespace subvol::detail {

/// Half a pixel, less a little for rounding: what is between a and b, in pixels, has the centres of the pixels from that which
/// a + kPastCenter_px is in to that of b − kPastCenter_px, and of none if that is before the first.
inline constexpr float kPastCenter_px = 0.45f;

/// What a ray meets where it enters or leaves the volume.
struct IntervalEnd {
    /// The value, and that of the second channel, in cells; kUnknownValue where no kernel reaches.
    float x = kUnknownValue, color = 0;
    SurfaceLight light;  ///< a factor of the colour, and white that is added
};

/// The values of a tile's pixels on the sheets of a batch, which other transfer functions may use again. Blocks are vectors of
/// pixels of the machine that draws.
struct KeptValues {
    std::vector<std::uint8_t> sheets{};  // of each block, one bit for each sheet that is there; empty: nothing is
    std::vector<std::uint32_t> first{};  // of each block: its place in x
    std::vector<float> x{};              // in cells, of each pixel of a block on each of its sheets; NaN: unknown
};

/// The data of a frame for the CPU: kernels in eye space, and for each square tile the kernels that it meets, ascending.
struct SplatFrame {
    static constexpr int kTile_px = 32;

    const SplatScene* scene = nullptr;
    const View* view = nullptr;
    const Classification* classification = nullptr;
    SheetStack sheets;
    PixelIntervals intervals;                // no offsets: there is neither a boundary nor a clip
    std::vector<SurfaceLight> entry_lights;  // of each interval; empty without shading
    std::vector<IntervalEnd> ends;           // beside the depths of the intervals
    EyeToNodes to_light{};                   // of the scene's light volume
    float* optical_depths = nullptr;         // of each pixel on each sheet: these are wanted instead of a picture
    EyeSplats kernels;
    FinerSheets finer;
    mutable std::vector<KeptValues>
        kept;  // of tile t and batch b: t · batches + b, set while they are drawn; empty: none are kept
    std::vector<std::array<std::uint16_t, 2>> batches;  // of each kernel: the first and the last that it may touch
    int tiles_x = 0, tiles_y = 0;
    std::vector<std::size_t> tile_offsets;
    std::vector<std::uint32_t> tile_splats;

    /// Whether any ray of the tile that begins at a pixel may be inside the volume.
    [[nodiscard]] bool meets_intervals(int x0, int y0) const;
};

/// Fills the parts of a frame that depend on kernels alone: without the boundary and what rays meet there.
void prepare_kernels(SplatFrame& frame, const SplatScene& scene, const View& view, const Classification& classification,
                     int sheets, Progress* progress);

/// Fills a frame, and uses again the memory of one that was filled before.
void prepare_frame(SplatFrame& frame, const SplatScene& scene, const View& view, const Classification& classification,
                   int sheets, Progress* progress);

/// Sets a transfer function with the same range for a filled frame. Kernels, tiles and intervals stay as they are, and values
/// on sheets are kept from now on, where that does not take too much memory.
void set_transfer_function(SplatFrame& frame, const View& view, const Classification& classification, int sheets);

}  // namespace subvol::detail
