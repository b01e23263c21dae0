// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "subvol/sample.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// How many sample intervals each edge gets by per_edge, spacing or footprint.
///
/// throws: Error(InvalidInput) if an edge would get more than 1024
[[nodiscard]] std::vector<int> edge_intervals(const HexMesh& mesh, const Topology& topology, const SampleOptions& options);

/// The intervals of edges and what follows for faces and cells.
class SampleCounts {
public:
    SampleCounts(const Topology& topology, std::vector<int> edges) : topology_(topology), edges_(std::move(edges)) {}

    [[nodiscard]] int edge(std::size_t e) const { return edges_[e]; }
    /// Along the face's edges 0 and 2, and 1 and 3.
    [[nodiscard]] std::array<int, 2> face(std::size_t f) const;
    [[nodiscard]] std::array<int, 3> cell(std::size_t c) const;

    /// Intervals along an axis of a cell near a point of it: the largest of the edges parallel to the axis that bound the
    /// entity on which the point lies. uvw: 0, 1 where the point lies on the cell's side, else between
    [[nodiscard]] int near(std::size_t c, std::size_t axis, const std::array<double, 3>& uvw) const;

private:
    const Topology& topology_;
    std::vector<int> edges_;
};

}  // namespace subvol::detail
