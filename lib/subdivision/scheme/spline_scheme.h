// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/detail/incident.h"
#include "subvol/detail/schemes.h"

namespace subvol::detail {

/// The common part of the schemes that generalise tricubic B-splines, (1,6,1)/8 and (1,1)/2 along each axis: everything but the
/// rules at irregular points and edges.
class SplineScheme : public SchemeRules {
public:
    /// Keeps a reference to the topology. kinds: of its points
    SplineScheme(const Topology& topology, std::vector<PointKind> kinds)
        : topology_(topology), regular_(regular_points(topology)), kinds_(std::move(kinds)) {}

    [[nodiscard]] bool interpolates() const final { return false; }
    void vertex_point(Index point, StencilBuilder& row) const final;
    void edge_point(Index edge, StencilBuilder& row) const final;
    void face_point(Index face, StencilBuilder& row) const final;
    void cell_point(Index cell, StencilBuilder& row) const final { add_mean(row, topology_.cells[cell], 1); }

protected:
    virtual void interior_vertex(Index point, StencilBuilder& row) const = 0;
    virtual void surface_vertex(Index point, StencilBuilder& row) const = 0;
    virtual void interior_edge(Index edge, StencilBuilder& row) const = 0;

    template <std::size_t N>
    static void add_mean(StencilBuilder& row, const std::array<Index, N>& points, double weight) {
        for (const Index p : points) row.add(p, weight / static_cast<double>(N));
    }

    [[nodiscard]] const Topology& topology() const { return topology_; }

private:
    void regular_vertex(Index point, StencilBuilder& row) const;
    void regular_edge(Index edge, StencilBuilder& row) const;

    const Topology& topology_;
    std::vector<std::uint8_t> regular_;
    std::vector<PointKind> kinds_;
};

}  // namespace subvol::detail
