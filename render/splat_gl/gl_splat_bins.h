// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gl_scan.h"
#include "gl_stages.h"
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
    float unlit_ambient = 0;
    std::int32_t finer = 0;
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

/// The places of a kernel's extras, in vectors of four, before and after the conversion to eye space.
struct GlExtras {
    std::uint32_t bend = 0, color = 0, color_bend = 0, axes = 0;
    std::uint32_t count = 0;

    explicit GlExtras(const SplatScene& scene);
};

/// Defines for the splatter's shaders: the scene's features and the places of extras.
[[nodiscard]] std::string gl_scene_defines(const SplatScene& scene);

/// The data of kernels that does not depend on the view, as shaders/splat_eye.comp reads it.
struct GlKernelData {
    static constexpr std::size_t kFloats = 16;  // of a kernel, without extras
    std::vector<float> kernels, extras;
};

/// ids: the kernels, ascending; none: all
[[nodiscard]] GlKernelData pack_kernels(const SplatScene& scene, std::optional<std::span<const std::uint32_t>> ids = {});

/// Converts kernels to eye space and lists them by bins (tile, batch) in ascending order, on the current context. The frame's
/// uniforms have to be bound.
class GlSplatBins {
public:
    GlSplatBins(const std::string& defines, std::uint32_t extras);

    /// The most bytes that a kernel takes in any buffer.
    [[nodiscard]] static std::size_t kernel_bytes(std::uint32_t extras);
    /// The bytes that it takes in all of them.
    [[nodiscard]] static std::size_t bytes_of_kernel(std::uint32_t extras);
    /// The bytes of an entry, with those that sorting takes.
    static constexpr std::size_t kEntry_bytes = 17;

    void upload(const GlKernelData& data);
    [[nodiscard]] std::uint32_t kernels() const { return kernels_; }

    /// Converts kernels to eye space, and counts the entries of each.
    void count(GlStages& stages);

    /// The number of entries of the last count; inexact beyond 2³² − 1. Waits for the device.
    [[nodiscard]] std::uint64_t entries() const;

    /// Lists the entries by bins, at most as many as the frame allows. The lists are those of the last call if neither kernels
    /// nor camera have changed since.
    ///
    /// returns: whether they have been made
    bool list(const GlSplatFrame& frame, GlStages& stages);

    /// Binds the buffers for the shader that draws.
    void bind();

private:
    std::uint32_t kernels_ = 0, extras_;
    GlProgram eye_, emit_;
    GlScan scan_;
    GlSort sort_;
    GlRanges find_;
    std::vector<double> listed_;  // what the lists were made for; empty: there are none
    GlBuffer kernel_buffer_, kernel_extras_, splats_, splat_extras_, ranges_, rects_, counts_, total_, keys_, ids_, offsets_;
};

}  // namespace subvol::detail
