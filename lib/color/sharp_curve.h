// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "subvol/transfer_function.h"

namespace subvol::detail {

/// A knot of vtkPiecewiseFunction. Midpoint and sharpness, both in [0,1], shape the curve to the next knot: where it is halfway
/// (a part of the interval), and how sudden (below .01 straight, above .99 a jump).
struct SharpKnot {
    double value;
    double alpha;
    double midpoint;
    double sharpness;
};

/// The curve through the knots, as knots with straight pieces between them, right to 1/512.
///
/// knots:  values not descending, at least one; alphas in [0,1]
/// source: VTK's documentation and behaviour of vtkPiecewiseFunction::AddPoint
[[nodiscard]] std::vector<TransferFunction::OpacityKnot> straight_pieces(std::span<const SharpKnot> knots);

}  // namespace subvol::detail
