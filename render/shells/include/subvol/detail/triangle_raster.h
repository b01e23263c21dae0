// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "subvol/camera.h"
#include "subvol/clip.h"
#include "subvol/raster.h"
#include "subvol/surface.h"

namespace subvol::detail {

/// The first triangle that each ray through a pixel's centre meets, and its depth.
struct TriangleRaster {
    static constexpr float kFar = std::numeric_limits<float>::infinity();
    static constexpr std::uint32_t kNothing = 0xffffffff;

    /// clip: what it removes is not met
    /// cost: parallel over bands of rows; the same for any number of threads
    TriangleRaster(const Surface& surface, const View& view, const Clip& clip);

    std::vector<Vec3> eye;  // the points of the surface in eye space
    Raster<float> depth;    // kFar where there is no triangle
    Raster<std::uint32_t> triangle;
};

}  // namespace subvol::detail
