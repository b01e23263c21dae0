// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "cell_block.h"
#include "point_lines.h"
#include "subvol/sample.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// The number of sample intervals of each edge, by per_edge, spacing or footprint.
///
/// throws: Error(InvalidInput) if an edge would get more than 1024
[[nodiscard]] std::vector<int> edge_intervals(const HexMesh& mesh, const Topology& topology, const SampleOptions& options);

/// The intervals of edges, and those of faces and cells that follow from them.
class SampleCounts {
public:
    SampleCounts(const Topology& topology, std::vector<int> edges) : topology_(topology), edges_(std::move(edges)) {}

    [[nodiscard]] int edge(std::size_t e) const { return edges_[e]; }
    /// Along edges 0 and 2 of the face, and along 1 and 3.
    [[nodiscard]] std::array<int, 2> face(std::size_t f) const;
    [[nodiscard]] std::array<int, 3> cell(std::size_t c) const;

    /// The intervals along an axis of a cell at one of its points: the most of any edge parallel to the axis that bounds the
    /// entity on which the point lies.
    ///
    /// uvw: exactly 0 or 1 where the point lies on a side of the cell
    [[nodiscard]] int near(std::size_t c, std::size_t axis, const std::array<double, 3>& uvw) const;

private:
    const Topology& topology_;
    std::vector<int> edges_;
};

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
