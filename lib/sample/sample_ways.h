// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "point_lines.h"
#include "subvol/sample.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// One kernel at every point of a mesh whose points lie on the limit.
///
/// Steps and gradients come from fourth-order differences along the lines through a point, one-sided where a line ends;
/// across_points: whether the limit is smooth across the points of a line; if not, every cell has derivatives of its own
[[nodiscard]] SampleResult sample_at_points(HexMesh on_limit, const PointLines& lines, bool across_points,
                                            const SampleOptions& options);

/// Kernels at any counts of intervals, entity by entity. Values and derivatives are those of quartics through the cells of the
/// twice refined mesh, whose points lie on the limit; a point has the mean over the cells about it.
///
/// intervals: of each edge of the topology, which is that of `control`
[[nodiscard]] SampleResult sample_in_cells(const HexMesh& control, const HexMesh& twice_refined, const Topology& topology,
                                           std::vector<int> intervals, const SampleOptions& options);

/// Samples with as many intervals as it takes until the field's first channel errs by less than options.tolerance at every
/// point of the twice refined mesh, or has 64 intervals on every edge where it does not.
[[nodiscard]] SampleResult sample_to_tolerance(const HexMesh& control, const HexMesh& twice_refined, const Topology& topology,
                                               const SampleOptions& options);

}  // namespace subvol::detail
