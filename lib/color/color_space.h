// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "subvol/vec.h"

namespace subvol::detail {

/// How colours between two knots are mixed, as VTK does it.
///
/// Diverging: in a polar form of Lab, through white between two saturated colours of different hue
/// Step:      the second colour all the way
enum class ColorSpace { Rgb, Hsv, Lab, Diverging, Step };

/// A space by the name that ParaView gives it; "Lab/CIEDE2000", which follows a path of equal differences, is taken as Lab.
[[nodiscard]] std::optional<ColorSpace> color_space_named(std::string_view name);

/// The colour between two colours, all sRGB in [0,1].
///
/// s:      0: a, 1: b
/// source: K. Moreland, "Diverging Color Maps for Scientific Visualization", ISVC 2009, for Lab and Diverging; hue takes the
///         shorter way round
[[nodiscard]] Vec3 mix_colors(ColorSpace space, const Vec3& a, const Vec3& b, double s);

}  // namespace subvol::detail
