// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "color_space.h"
#include "subvol/transfer_function.h"

namespace subvol::detail {

// ParaView's curves are not linear between their knots. Here they are resampled to knots with straight lines between them, as
// TransferFunction needs: bisection adds knots until every line is within 1/512 of the curve.

/// Colours that are mixed in a space, as knots in linear light. The error is below 1/512 both in linear light and in sRGB.
///
/// knots: sRGB in [0,1]; at least one, values not descending
[[nodiscard]] std::vector<TransferFunction::ColorKnot> straight_pieces(std::span<const TransferFunction::ColorKnot> knots,
                                                                       ColorSpace space);

/// A knot of vtkPiecewiseFunction. Midpoint and sharpness, both in [0,1], shape the curve to the next knot.
///
/// midpoint:  where the curve is halfway, as a part of the interval
/// sharpness: how sudden the change is: below .01 a straight line, above .99 a jump
struct SharpKnot {
    double value;
    double alpha;
    double midpoint;
    double sharpness;
};

/// The opacity curve through the knots, to 1/512.
///
/// knots:  at least one, values not descending; alphas in [0,1]
/// source: VTK's documentation and behaviour of vtkPiecewiseFunction::AddPoint
[[nodiscard]] std::vector<TransferFunction::OpacityKnot> straight_pieces(std::span<const SharpKnot> knots);

}  // namespace subvol::detail
