// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "subvol/boundary_values.h"
#include "subvol/camera.h"
#include "subvol/clip.h"
#include "subvol/image.h"
#include "subvol/optics.h"

namespace subvol::detail {

/// A picture and its depths, as of SplatResult.
struct Preview {
    Image image;
    std::vector<float> depth;
};

/// A quick picture of an opaque body: its boundary's triangles, each in one colour and flatly lit, one place for each pixel.
/// For while something moves; through a cut one looks into the hollow body.
[[nodiscard]] Preview surface_preview(const BoundaryValues& boundary, const View& view, const Optics& optics, const Clip& clip);

}  // namespace subvol::detail
