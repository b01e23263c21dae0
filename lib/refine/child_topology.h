// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/topology.h"

namespace subvol::detail {

/// The topology of the child in the numbering of `refine`, derived from its parent's without sorting: exactly what
/// `build_topology` makes of the child mesh.
///
/// cost: parallel, O(n)
[[nodiscard]] Topology child_topology(const Topology& parent);

}  // namespace subvol::detail
