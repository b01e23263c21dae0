// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "subvol/detail/boundary_rings.h"
#include "subvol/detail/ring_sums.h"
#include "subvol/detail/stencil_row.h"
#include "subvol/scheme.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// The rules of a scheme over one topology: each writes the terms of one point of the next level.
///
/// Thread-safe, apart from use_ring_sums: the rules only read.
class SchemeRules {
public:
    virtual ~SchemeRules() = default;

    /// Whether old points stay where they are. `vertex_point` is called only if they do not.
    [[nodiscard]] virtual bool interpolates() const { return true; }
    virtual void vertex_point(Index point, StencilBuilder& row) const { row.add(point, 1); }
    virtual void edge_point(Index edge, StencilBuilder& row) const = 0;
    virtual void face_point(Index face, StencilBuilder& row) const = 0;
    virtual void cell_point(Index cell, StencilBuilder& row) const = 0;

    /// From now on rows have columns of sums over long rings, if the scheme has any. The result is part of the rules.
    virtual const RingSums* use_ring_sums() { return nullptr; }
};

/// All keep a reference to the topology. kinds: of its points
std::unique_ptr<SchemeRules> make_linear_rules(const Topology& topology);
std::unique_ptr<SchemeRules> make_mcq_rules(const Topology& topology, double tension, std::vector<PointKind> kinds);
std::unique_ptr<SchemeRules> make_catmull_clark_rules(const Topology& topology, std::vector<PointKind> kinds);
std::unique_ptr<SchemeRules> make_bsxw_rules(const Topology& topology, std::vector<PointKind> kinds);

/// The rules of the scheme that the options choose.
///
/// throws: Error(InvalidInput) if the tension is not finite
[[nodiscard]] std::unique_ptr<SchemeRules> make_rules(const Topology& topology, const SchemeOptions& scheme);

/// The same where the points are of other kinds than `classify_points` finds, as those of shells and beams are.
[[nodiscard]] std::unique_ptr<SchemeRules> make_rules(const Topology& topology, const SchemeOptions& scheme,
                                                      std::vector<PointKind> kinds);

}  // namespace subvol::detail
