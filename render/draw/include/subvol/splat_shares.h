// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "subvol/camera.h"
#include "subvol/detail/reach_counts.h"
#include "subvol/optics.h"
#include "subvol/pixel_rows.h"
#include "subvol/rbf_volume.h"
#include "subvol/share.h"
#include "subvol/splat_options.h"

namespace subvol {

// A picture of kernels that are in several processes. Each process draws the rows of its share of the picture, whole rows of
// tiles, and gets the kernels that touch them, in their global order, and the whole boundary. With the sheets of the whole
// picture, `Splatter` then draws the same bits there as one process with all kernels; what it draws beyond these rows is to be
// cut off.

/// The rows of pixels that are drawn together: shares begin at multiples of this.
inline constexpr int kRowsOfTile = 32;

/// The rows of a picture that a share of it has.
[[nodiscard]] PixelRows rows_of(const Share& share, int height);

/// The number of sheets of the picture: SplatOptions::sheets if that is not 0, else as many as the kernels of all processes
/// need; to be given to them as SplatOptions::needed_sheets.
///
/// volume: some of the kernels, and the whole boundary
/// sum:    adds counts up over all processes; empty: the volume has all kernels
[[nodiscard]] int sheets_of_picture(const RbfVolume& volume, const View& view, const SplatOptions& options,
                                    const detail::SumCounts& sum = {});

/// The rows of tiles that each kernel touches; none if `end` is not behind `first`.
///
/// volume:  some of the kernels, and the whole boundary
/// options: with the sheets of the whole picture, chosen or needed
/// throws:  Error(InvalidInput) as `Splatter`
[[nodiscard]] std::vector<PixelRows> rows_of_kernels(const RbfVolume& volume, const View& view, const Optics& optics,
                                                     const SplatOptions& options);

/// The numbers of the kernels that touch some rows, ascending.
///
/// kernels: the rows of each, as `rows_of_kernels` or `BrickPicture::rows_of` finds them
[[nodiscard]] std::vector<std::size_t> touching(std::span<const PixelRows> kernels, const PixelRows& rows);

}  // namespace subvol
