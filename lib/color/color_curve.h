// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "color_space.h"
#include "subvol/transfer_function.h"

namespace subvol::detail {

/// Colours mixed in a space, as knots in linear light with straight pieces between them: right to 1/512 both of linear light
/// and of sRGB.
///
/// knots: sRGB in [0,1]; values not descending, at least one
[[nodiscard]] std::vector<TransferFunction::ColorKnot> straight_pieces(std::span<const TransferFunction::ColorKnot> knots,
                                                                       ColorSpace space);

}  // namespace subvol::detail
