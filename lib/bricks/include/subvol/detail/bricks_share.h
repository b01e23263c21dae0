// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "subvol/bricks.h"
#include "subvol/detail/mesh_share.h"

namespace subvol::detail {

/// The figures of some bricks, from `begin` to before `end`, for `join_shares`.
///
/// throws: as `read_brick`; Error(Cancelled)
[[nodiscard]] MeshShare inspect_share(const Bricks& bricks, std::size_t begin, std::size_t end, std::size_t inverted_at_most,
                                      Progress* progress);

}  // namespace subvol::detail
