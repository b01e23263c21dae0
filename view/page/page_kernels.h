// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "page_arrays.h"
#include "subvol/rbf_volume.h"

namespace subvol::detail {

/// The numbers of kernels in a page. Places: middle, and the frame's symmetric root by its trace's logarithm and its six
/// entries in parts of the trace. Values of a channel: value, the changes over the half axes (root · gradient), moment. So
/// every number of a kernel changes its field alike, however large or flat the kernel is.
inline constexpr std::size_t kPlaceNumbers = 10, kValueNumbers = 5;

/// `kPlaceNumbers` for each kernel
[[nodiscard]] std::vector<double> place_numbers(const RbfVolume& volume);
/// `kValueNumbers` for each kernel
[[nodiscard]] std::vector<double> value_numbers(const RbfVolume& volume, const RbfChannel& channel);

/// The kernels that a page has after rounding, with one channel.
[[nodiscard]] RbfVolume kernels_of_numbers(std::span<const double> places, std::span<const double> values,
                                           const Kernel& kernel);

/// Merges neighbours until only `count` kernels are left. n kernels of one size in a row become one that is n times as long,
/// and fields of the second degree stay as they are.
[[nodiscard]] RbfVolume merged_kernels(const RbfVolume& volume, std::size_t count);

}  // namespace subvol::detail
