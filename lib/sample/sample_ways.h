// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "cell_block.h"
#include "point_lines.h"
#include "subvol/sample.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// One kernel at every point of a mesh whose points lie on the limit. Steps and gradients are fourth-order differences along
/// the lines through a point, one-sided where a line ends.
///
/// across_points: whether the limit is smooth across the points of a line; if not, each edge gives its own derivative
/// diagonal:      of the bounding box, if the points are part of a larger mesh
[[nodiscard]] SampleResult sample_at_points(HexMesh on_limit, const PointLines& lines, bool across_points,
                                            const SampleOptions& options, std::optional<double> diagonal = {});

/// Kernels at any number of intervals on each edge, entity by entity. Values and derivatives are those of quartics through the
/// blocks of the cells.
///
/// blocks, topology: of `control`
/// intervals:        of each edge of the topology
[[nodiscard]] SampleResult sample_in_cells(const HexMesh& control, const CellBlocks& blocks, const Topology& topology,
                                           std::vector<int> intervals, const SampleOptions& options);

/// Increases the intervals, in at most six rounds, until the error of the first channel is below options.tolerance at every
/// node of the blocks, or the edges where it is not have 64 intervals.
[[nodiscard]] SampleResult sample_to_tolerance(const HexMesh& control, const CellBlocks& blocks, const Topology& topology,
                                               const SampleOptions& options);

}  // namespace subvol::detail
