#pragma once

#include <memory>

#include "stencil_row.h"
#include "subvol/refine.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// The rules of a scheme over one topology: each writes the terms of one new point. Old points do not move.
///
/// Thread-safe: the rules only read.
class SchemeRules {
public:
    virtual ~SchemeRules() = default;
    virtual void edge_point(Index edge, StencilBuilder& row) const = 0;
    virtual void face_point(Index face, StencilBuilder& row) const = 0;
    virtual void cell_point(Index cell, StencilBuilder& row) const = 0;
};

/// Both keep a reference to the topology.
std::unique_ptr<SchemeRules> make_linear_rules(const Topology& topology);
std::unique_ptr<SchemeRules> make_mcq_rules(const Topology& topology, double tension);

}  // namespace subvol::detail
