// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "subvol/camera.h"
#include "subvol/optics.h"
#include "subvol/rbf_volume.h"
#include "subvol/splat_options.h"

namespace subvol {

// A picture of kernels that are in several processes. Each process owns a band of the picture, whole rows of tiles, and gets
// the kernels that touch it, in their global order, and the whole boundary. With the sheets of the whole picture, `Splatter`
// then draws the same bits there as one process with all kernels; what it draws beyond the band is to be cut off.

/// The rows of pixels that are drawn together: bands begin at multiples of this.
inline constexpr int kBandRows = 32;

/// For each kernel the distance in depth from its middle to where it ends. The one in place `place_of_finest_reach` of all
/// kernels' reaches, ascending, decides the number of sheets.
///
/// volume: some of the kernels, and the whole boundary
[[nodiscard]] std::vector<float> kernel_reaches(const RbfVolume& volume, const View& view, const SplatOptions& options);
[[nodiscard]] std::size_t place_of_finest_reach(std::size_t kernels);

/// The number of sheets of the picture: SplatOptions::sheets if that is not 0.
[[nodiscard]] int sheets_of_picture(const RbfVolume& volume, const View& view, const SplatOptions& options, float finest_reach);

/// The bands that a kernel touches, as numbers of kBandRows rows from the top; none if `last` is before `first`.
struct KernelBands {
    int first = 0, last = -1;
};

/// volume:  some of the kernels, and the whole boundary
/// options: with the sheets of the whole picture
/// throws:  Error(InvalidInput) as `Splatter`
[[nodiscard]] std::vector<KernelBands> bands_of_kernels(const RbfVolume& volume, const View& view, const Optics& optics,
                                                        const SplatOptions& options);

}  // namespace subvol
