// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "subvol/brick_points.h"
#include "subvol/splat.h"

namespace subvol {

/// memory_bytes: about the most that kernels take while a part of the picture is drawn; besides there are the boundary and a
///               brick
/// scratch:      a folder for kernels that wait for their part of the picture, some 90 bytes each; empty: the folder for
///               temporary files
struct BrickSplatOptions {
    SampleOptions sample{};
    SplatOptions splat{};
    std::uint64_t memory_bytes = std::uint64_t{1} << 30;
    std::filesystem::path scratch{};
};

/// Draws a mesh in bricks as kernels at its points: the picture has the bits of `render_splats` of the whole mesh. Each brick
/// is sampled once; its kernels wait in files, one for each part of the picture that they touch, and are drawn part by part in
/// the order of the whole mesh.
///
/// fields:   leaves one field of one channel in a brick
/// boundary: as `sample_bricks_boundary` makes it
/// throws:   as `sample_brick` and `render_splats`; Error(InvalidInput) for shadows, ambient occlusion, a colour channel and
/// other
///           methods than the CPU's; Error(Io) if `scratch` is full
[[nodiscard]] SplatResult render_bricks(const Bricks& bricks, const BrickFields& fields, Surface boundary, const View& view,
                                        const Optics& optics, const BrickSplatOptions& options = {});

}  // namespace subvol
