// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "splat_scene.h"

namespace subvol::detail {

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

}  // namespace subvol::detail
