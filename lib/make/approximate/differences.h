// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/hex_mesh.h"
#include "subvol/stencil_table.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// The weights of the squares of differences.
struct DifferenceWeights {
    double first = 0, second = 0;
};

/// Rows of differences between the values at a mesh's points, times the roots of their weights: first ones along edges, second
/// ones along lines of the mesh.
///
///     a────p──────b    second: 2 (b' x_a + a' x_b − x_p), with a' and b' the parts of the line on either side: 0 for what is
///                      linear along it
///
/// At an interior point where lines end, as at irregular edges, a second difference is that of the point and the mean of the
/// neighbours on these lines, weighted by their nearness. At the boundary lines end without one.
[[nodiscard]] CsrMatrix differences(const HexMesh& mesh, const Topology& topology, const DifferenceWeights& weights);

}  // namespace subvol::detail
