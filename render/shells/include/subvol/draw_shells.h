// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "subvol/camera.h"
#include "subvol/clip.h"
#include "subvol/image.h"
#include "subvol/optics.h"
#include "subvol/splat_options.h"
#include "subvol/surface.h"

namespace subvol {

/// Triangles with a value at each point, such as those of `shell_surface`.
struct ColoredSurface {
    Surface surface;
    std::vector<double> values;
    /// Opacity at each point, linear on triangles, 0 to 1: the part of the light from behind that it keeps off; empty: opaque.
    std::vector<float> opacities{};
};

struct ShellOptions {
    Shading shading{};
    int samples = 1;     ///< the samples of the picture: n × n places in each pixel
    Clip clip{};         ///< the clip of the picture, without its slices
    bool whole = false;  ///< the clip cuts the volume, but not the triangles
    /// Each ray of the volume has ended where it meets the triangles (`ended_at`), so that they lie in its depth.
    bool ended = false;
};

/// The eye depths at which rays through the middles of pixels meet triangles, rows from the top; infinity where they do not.
///
/// clip: what it takes away is not met
[[nodiscard]] std::vector<float> depths_of(const Surface& surface, const View& view, const Clip& clip = {});

/// Draws triangles, lit on either side, into the finished picture of a volume: before it or behind it. Opaque ones that lie
/// within the volume, or between parts of it, are drawn behind it, as far as that is transparent. That is exact where the
/// volume is opaque from its boundary on, and where its rays have ended at the triangles. Translucent ones are drawn one over
/// the other, in any number, before the volume; what lies behind its boundary is not seen.
///
/// depth:    of the picture as of `SplatResult`, which becomes that of opaque triangles where they are seen first; empty: none
/// boundary: of the volume, closed, outward; empty: there is no volume
/// throws:   Error(InvalidInput) if there is not one value and opacity for each point, or the sizes of picture and view differ
/// cost:     parallel; the same for any number of threads
void draw_shells(Image& image, std::span<float> depth, const ColoredSurface& shells, const Surface& boundary, const View& view,
                 const Optics& optics, const ShellOptions& options = {});

}  // namespace subvol
