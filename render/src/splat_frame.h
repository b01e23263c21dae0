#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "boundary_intervals.h"
#include "subvol/camera.h"
#include "subvol/optics.h"
#include "subvol/rbf_volume.h"
#include "subvol/render.h"

namespace subvol::detail {

/// A kernel in eye space, ready to be cut by a plane of constant depth z: with z_s = z − depth, its section has the centre
/// center + shear·z_s, and e = z_s²·inv_szz + Δᵀ·conic·Δ for an offset Δ from that centre; it stands for
/// value + value_slope·z_s + bend_zz·z_s² + (gradient + z_s·bend_z)·Δ + Δᵀ·bend·Δ. Laid out as the shader has it.
struct EyeSplat {
    float center_x, center_y, depth, inv_szz;
    float shear_x, shear_y, conic_xx, conic_xy;
    float conic_yy, value, gradient_x, gradient_y;
    float value_slope, bend_zz, extent_x, extent_y;
    float bend_zx, bend_zy, bend_xx, bend_xy;
    float bend_yy, unused[3];
};
static_assert(sizeof(EyeSplat) == 96);

/// Everything about a frame that does not depend on who draws it. Kernels are binned by (tile, batch of sheets), by ascending
/// id: bin = tile · batches + batch.
struct SplatFrame {
    static constexpr int kBatch = 8;  // sheets a batch

    int tile_px = 16;
    int tiles_x = 0, tiles_y = 0;
    int sheets = 0, batches = 0;
    float first_depth = 0, sheet_distance = 0;  // depth of sheet k = first_depth + k · sheet_distance
    std::vector<EyeSplat> splats;
    std::vector<std::uint32_t> bin_offsets;
    std::vector<std::uint32_t> bin_splats;
    PixelIntervals intervals;

    [[nodiscard]] std::size_t bin(int tile, int batch) const {
        return static_cast<std::size_t>(tile) * static_cast<std::size_t>(batches) + static_cast<std::size_t>(batch);
    }
    [[nodiscard]] float depth(int sheet) const { return first_depth + static_cast<float>(sheet) * sheet_distance; }
};

/// Values become fractions of the table's range: 0 at its minimum, 1 at its maximum.
///
/// throws: Error(InvalidInput) if the volume has no boundary or no such channel, or its size, its values or the table are
/// beyond
///         what 32-bit floats hold
[[nodiscard]] SplatFrame prepare_splats(const RbfVolume& volume, const View& view, const PreintegratedTable& table,
                                        const SplatOptions& options, int tile_px);

/// The table over [0,1], for the values of a frame: beside a large value a small range would drown in the rounding of floats.
[[nodiscard]] PreintegratedTable over_unit_range(PreintegratedTable table);

/// The section of a kernel by a sheet, in slopes; empty (half < 0) where the sheet misses it.
struct Section {
    float x, y, half_x, half_y;
};

[[nodiscard]] inline Section section(const EyeSplat& s, float depth, bool perspective) {
    const float zs = depth - s.depth;
    const float left = 1.0f - zs * zs * s.inv_szz;
    if (left <= 0) return {0, 0, -1, -1};
    const float scale = perspective ? 1.0f / depth : 1.0f, root = std::sqrt(left);
    return {(s.center_x + s.shear_x * zs) * scale, (s.center_y + s.shear_y * zs) * scale, s.extent_x * root * scale,
            s.extent_y * root * scale};
}

}  // namespace subvol::detail
