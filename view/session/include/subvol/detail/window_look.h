// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace subvol::detail {

/// What the window looks like, without effect on pictures.
///
/// log_counts, log_opacity: logarithmic heights of the histogram and of the curve of opacities
/// play:       the steps of a series go on by themselves
/// panel:      the panel at the right is there
/// section:    the part of the panel that is open
/// tool:       what dragging with the left button does: turn the camera, or work on the control points
/// brush_px:   the radius of brush and paint in pixels
struct WindowLook {
    bool dark = true, help = false, log_counts = true, log_opacity = false, panel = true, play = false;
    std::string section = "colours", tool = "turn";
    double brush_px = 40;
};

}  // namespace subvol::detail
