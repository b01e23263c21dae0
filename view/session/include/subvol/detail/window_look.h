// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace subvol::detail {

/// What the window looks like, without effect on pictures.
struct WindowLook {
    bool dark = true, help = false;
    bool log_counts = true;           ///< logarithmic heights of the histogram
    bool log_opacity = false;         ///< logarithmic heights of the curve of opacities
    bool panel = true;                ///< the panel at the right is there
    bool play = false;                ///< the steps of a series go on by themselves
    std::string section = "colours";  ///< the part of the panel that is open
    std::string tool = "turn";  ///< what dragging with the left button does: turn the camera, or work on the control points
    double brush_px = 40;       ///< the radius of brush and paint in pixels
};

}  // namespace subvol::detail
