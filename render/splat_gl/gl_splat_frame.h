// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "splat_scene.h"

namespace subvol::detail {

/// The data of a frame for the shaders; the same as in shaders/splat_frame.glsl.
struct alignas(32) GlSplatFrame {
    std::array<double, 4> right{}, up{}, forward{};
    std::array<double, 4> cells{};
    std::array<float, 4> unit{}, key{}, material{};
    std::int32_t width = 0, height = 0, tiles_x = 0, tiles_y = 0;
    std::int32_t sheets = 0, batches = 0, first_batch = 0, end_batch = 0;
    std::uint32_t kernels = 0, most_entries = 0;
    std::int32_t perspective = 0, all_visible = 0;
    float first_depth = 0, sheet_distance = 0, middle_depth = 0, near_depth = 0;
    float pixel = 0, value_offset = 0, color_offset = 0, half_weight = 0;
    float least_gradient = 0, kernel_cells = 0;
    float unlit_ambient = 0, unused = 0;
    std::array<std::array<float, 4>, 3> to_light{};
    std::array<std::int32_t, 4> light_nodes{};

    [[nodiscard]] std::uint32_t tiles() const {
        return static_cast<std::uint32_t>(tiles_x) * static_cast<std::uint32_t>(tiles_y);
    }
    [[nodiscard]] std::uint32_t bins() const { return tiles() * static_cast<std::uint32_t>(end_batch - first_batch); }
};

/// Fills all but the number of kernels and the pass.
[[nodiscard]] GlSplatFrame gl_splat_frame(const SplatScene& scene, const View& view, const Classification& classification,
                                          const SheetStack& sheets, int tile_px, int batch);

}  // namespace subvol::detail
