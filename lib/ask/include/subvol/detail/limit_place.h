// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "subvol/limit.h"
#include "subvol/topology.h"

namespace subvol::detail {

using LimitPlace = LimitQuery;

/// From cell to cell across faces, in parameters.
class CellSteps {
public:
    /// Both are kept by reference.
    CellSteps(const HexMesh& mesh, const Topology& topology) : mesh_(mesh), topology_(topology) {}

    /// Whether the face of a cell at u, v or w (axis 0, 1, 2) = 0 or 1 (side) is one of the hull.
    [[nodiscard]] bool on_hull(Index cell, std::size_t axis, bool side) const;

    /// Moves a place whose parameters are beyond a face into the cell on its other side. Beyond the hull and where it has gone
    /// too far, it ends at the face.
    void enter(LimitPlace& place) const;

private:
    void cross(LimitPlace& place, std::size_t axis, bool side) const;

    const HexMesh& mesh_;
    const Topology& topology_;
};

/// The parameters by which a place of the limit should move to come nearest to `offset` (world), with those that would leave
/// the volume held at its hull.
struct LimitStep {
    Vec3 by{0.0};
    Vec3 left{0.0};  ///< what remains of the offset, by the Jacobian
    bool held = false;
};
[[nodiscard]] LimitStep step_towards(const Vec3& offset, const Mat3& jacobian, const LimitPlace& from, const CellSteps& steps);

/// The gradient by position of a field with these derivatives by parameters; 0 where the Jacobian has no inverse.
[[nodiscard]] Vec3 world_gradient(const Mat3& jacobian, const Vec3& derivatives);

}  // namespace subvol::detail
