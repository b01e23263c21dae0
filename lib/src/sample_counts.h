#pragma once

#include <array>
#include <vector>

#include "subvol/sample.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// How many sample intervals each edge has, and what follows for faces and cells.
class SampleCounts {
public:
    SampleCounts(const HexMesh& mesh, const Topology& topology, const SampleOptions& options);

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
