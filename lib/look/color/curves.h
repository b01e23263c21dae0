// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "subvol/transfer_function.h"
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

// ParaView's curves are not linear between their knots. Here they are resampled to knots with straight lines between them, as
// TransferFunction needs: bisection adds knots until every line is within 1/512 of the curve.

/// Colours that are mixed in a space, as knots in linear light. The error is below 1/512 both in linear light and in sRGB.
///
/// knots: sRGB in [0,1]; at least one, values not descending
[[nodiscard]] std::vector<TransferFunction::ColorKnot> straight_pieces(std::span<const TransferFunction::ColorKnot> knots,
                                                                       ColorSpace space);

/// A knot of vtkPiecewiseFunction. Midpoint and sharpness, both in [0,1], shape the curve to the next knot.
struct SharpKnot {
    double value;
    double alpha;
    double midpoint;   ///< where the curve is halfway, as a part of the interval
    double sharpness;  ///< how sudden the change is: below .01 a straight line, above .99 a jump
};

/// The opacity curve through the knots, to 1/512.
///
/// knots:  at least one, values not descending; alphas in [0,1]
/// source: VTK's documentation and behaviour of vtkPiecewiseFunction::AddPoint
[[nodiscard]] std::vector<TransferFunction::OpacityKnot> straight_pieces(std::span<const SharpKnot> knots);

}  // namespace subvol::detail
