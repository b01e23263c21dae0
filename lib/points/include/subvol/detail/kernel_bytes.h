// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "subvol/rbf_volume.h"

namespace subvol::detail {

/// Kernels as bytes, to be sent to another process of this program on a computer of the same kind: 48 bytes a kernel, 20 more
/// for each channel, and 24 more for its Hessians. Exact.
///
/// with_boundary: the boundary too
[[nodiscard]] std::string bytes_of_kernels(const RbfVolume& volume, bool with_boundary);

/// throws: Error(InvalidInput) if they are not what `bytes_of_kernels` returned
[[nodiscard]] RbfVolume kernels_from_bytes(std::string_view bytes);

}  // namespace subvol::detail
