// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "subvol/camera.h"
#include "subvol/clip.h"
#include "subvol/image.h"
#include "subvol/optics.h"
#include "subvol/pixel_rows.h"
#include "subvol/progress.h"
#include "subvol/splat_options.h"
#include "subvol/surface.h"

namespace subvol {

/// Lights the picture of a body that is opaque from its boundary on, drawn by a renderer without light: as the splatter does
/// with `SplatOptions::shading`.
///
/// boundary: closed, outward, as of RbfVolume
/// samples:  as those of the picture
/// clip:     as that of the picture; cuts are lit by the normals of their planes, slices are not lit
void light_boundary(Image& image, const Surface& boundary, const View& view, const Shading& shading, int samples = 1,
                    const Clip& clip = {});

/// Colours and lights the picture of a body that is opaque from its boundary on by the values on the boundary. Kernels are as
/// wide as cells: where two bodies touch, or a field is steep, their sums are not the values on the surface. Pixels that no ray
/// to the boundary meets stay as they are, and so do cuts and slices.
///
/// image:    its opacities stay
/// boundary: closed, outward; values: one for each of its points, linear on triangles
/// samples, clip: as those of the picture
/// throws:   Error(InvalidInput) if there is not one value for each point
void color_boundary(Image& image, const Surface& boundary, std::span<const double> values, const View& view,
                    const Optics& optics, const Shading& shading, int samples = 1, const Clip& clip = {});

/// How an opaque body is cut open.
struct BoundaryCut {
    Clip clip{};  ///< without slices
    /// The value at a place on a face of the cut; none where there is none. For several threads at once.
    std::function<std::optional<double>(const Vec3&)> value_at{};
};

/// The picture of a body that is opaque from its boundary on, without its inside.
struct BoundaryPicture {
    Image image;                  ///< colours times opacity; the opacity is the part of a pixel's rays that meet the body
    std::vector<float> depth;     ///< of each pixel the mean eye depth of its hits; infinity where there is none
    std::size_t rays_inside = 0;  ///< rays that begin inside, or at a cut where there is no value: they see nothing
};

/// Draws such a body by the values on its boundary, as `color_boundary` colours it, and on the faces of a cut alone.
///
/// boundary, values, samples: as of `color_boundary`
/// rows:   of the picture that are drawn; the others stay transparent
/// throws: Error(InvalidInput) as `color_boundary`
[[nodiscard]] BoundaryPicture draw_boundary(const Surface& boundary, std::span<const double> values, const View& view,
                                            const Optics& optics, const Shading& shading, int samples = 1,
                                            const PixelRows& rows = {}, Progress* progress = nullptr,
                                            const BoundaryCut& cut = {});

}  // namespace subvol
