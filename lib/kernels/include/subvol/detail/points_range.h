// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/rbf_volume.h"

namespace subvol::detail {

/// Kernels as bytes, to be sent to another process of this program on a computer of the same kind: 48 bytes a kernel, 20 more
/// for each channel, and 24 more for its Hessians. Exact.
///
/// with_boundary: the boundary too
[[nodiscard]] std::string bytes_of_kernels(const RbfVolume& volume, bool with_boundary);

/// throws: Error(InvalidInput) if they are not what `bytes_of_kernels` returned
[[nodiscard]] RbfVolume kernels_from_bytes(std::string_view bytes);

/// The kernels from `begin` to before `end`, in their order. A share of a volume: the first one, which begins at 0, has the
/// boundary of the whole, because its triangles share points; the others have none. The bounds are those of the whole.
[[nodiscard]] RbfVolume kernels_between(const RbfVolume& volume, std::size_t begin, std::size_t end);

/// The kernels with these numbers, in that order; no boundary. The bounds are those of the whole.
[[nodiscard]] RbfVolume chosen_kernels(const RbfVolume& volume, std::span<const std::size_t> numbers);

/// Leaves only the kernels at these places, in that order; the boundary and the bounds stay. Gives the memory of the others
/// back.
///
/// places: ascending, less than volume.size()
void keep_kernels(RbfVolume& volume, const std::vector<std::size_t>& places);

/// Appends the kernels of another share, and takes its boundary if there was none.
///
/// throws: Error(InvalidInput) if the channels or the kernel differ
void append_kernels(RbfVolume& volume, const RbfVolume& next);

}  // namespace subvol::detail
