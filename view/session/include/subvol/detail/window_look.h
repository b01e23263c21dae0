// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace subvol::detail {

/// What the window looks like, without effect on pictures.
///
/// log_counts, log_opacity: logarithmic heights of the histogram and of the curve of opacities
/// play:       the steps of a series go on by themselves
/// section:    the part of the panel that is open
struct WindowLook {
    bool dark = true, help = false, log_counts = false, log_opacity = false, play = false;
    std::string section = "colours";
};

}  // namespace subvol::detail
