// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/camera.h"
#include "subvol/image.h"
#include "subvol/splat_options.h"
#include "subvol/surface.h"

namespace subvol {

/// Lights the picture of a body that is opaque from its boundary on, drawn by a renderer that knows no light: as the splatter
/// does with `SplatOptions::shading`.
///
/// boundary: closed, outward, as of RbfVolume
/// samples:  as those of the picture
void light_boundary(Image& image, const Surface& boundary, const View& view, const Shading& shading, int samples = 1);

}  // namespace subvol
