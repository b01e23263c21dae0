// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/image.h"
#include "subvol/splat_options.h"

namespace subvol::detail {

// How far a picture of kernels is from that of very many sheets is measured by drawing it again with more of them. The error
// falls with the square of their distance where sheets resolve the kernels, so that what four times as many leave of it is a
// sixteenth; where the field jumps between two sheets it is more, and the measured error less than the real one.

/// Options that draw a picture with four times as many sheets everywhere, also where it has finer ones than its stack.
///
/// options: of the picture, without a number of sheets
/// sheets:  those of its stack
[[nodiscard]] SplatOptions with_more_sheets(SplatOptions options, int sheets);

/// Differences of red, green and blue over all pixels.
struct SheetError {
    double rms = 0, largest = 0;
};

/// The images have the same size.
[[nodiscard]] SheetError difference(const Image& image, const Image& exact);

}  // namespace subvol::detail
