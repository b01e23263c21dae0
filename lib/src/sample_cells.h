#pragma once

#include "subvol/sample.h"

namespace subvol::detail {

/// Kernels at any counts of intervals, entity by entity. Values and derivatives are those of quartics through the cells of the
/// twice refined mesh, whose points lie on the limit; a point has the mean over the cells about it.
///
/// intervals: of each edge of the topology, which is that of `control`
[[nodiscard]] SampleResult sample_in_cells(const HexMesh& control, const HexMesh& twice_refined, const Topology& topology,
                                           std::vector<int> intervals, const SampleOptions& options);

}  // namespace subvol::detail
