// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "subvol/vec.h"

namespace subvol::detail {

/// How to mix the colours of two knots, as in VTK.
///
/// Diverging: in a polar form of Lab, through white between two saturated colours of different hue
/// Step:      the second colour on the whole interval
enum class ColorSpace { Rgb, Hsv, Lab, Diverging, Step };

/// A space by its name in ParaView. "Lab/CIEDE2000", a path of equal colour differences, is read as Lab.
[[nodiscard]] std::optional<ColorSpace> color_space_named(std::string_view name);

/// The colour between two colours, all sRGB in [0,1].
///
/// s:      0: a, 1: b
/// source: K. Moreland, "Diverging Color Maps for Scientific Visualization", ISVC 2009, for Lab and Diverging; hue takes the
///         shorter way round
[[nodiscard]] Vec3 mix_colors(ColorSpace space, const Vec3& a, const Vec3& b, double s);

}  // namespace subvol::detail
