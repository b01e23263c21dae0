// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "mesh_walls.h"
#include "subvol/surface.h"
#include "surface_tree.h"

namespace subvol::detail {

/// A chain of edges along which a surface is sharp.
struct SharpCurve {
    std::vector<Vec3> points;  ///< points in their order; for a closed chain the first one again at its end
    /// Corners of the `SharpEdges` where it begins and ends; the first is kNone for a closed chain
    std::array<Index, 2> corners{kNone, kNone};

    [[nodiscard]] bool closed() const { return corners[0] == kNone; }
    [[nodiscard]] double length() const;
    /// The place at a part of the length.
    [[nodiscard]] Vec3 at(double part) const;
};

struct SharpEdges {
    std::vector<Vec3> corners;  ///< where chains meet, end or turn sharply
    std::vector<SharpCurve> curves;
};

/// The edges of a surface where it is bent by more than an angle, also as seen from a part of a cell away. What is
/// noise is left out: chains that end freely within a few cells, small rings, and nets of chains shorter than a cell or two.
///
/// target: edges are taken where its surface is reached on one side of them at least
/// side:   of a cell
/// is_new: edges are left out where it is false at their ends and middle; none: all are taken
[[nodiscard]] SharpEdges sharp_edges(const WallTarget& target, double angle_deg, double side,
                                     const std::function<bool(const Vec3&)>& is_new = {});

/// The place of a curve that is nearest to a point, and the curve's direction there.
struct CurvePlace {
    Vec3 point, along;
    bool end;  ///< the place is one of the curve's ends
};

class CurveTree {
public:
    explicit CurveTree(const SharpCurve& curve);
    // The tree refers to the segments.
    CurveTree(const CurveTree&) = delete;
    CurveTree& operator=(const CurveTree&) = delete;

    [[nodiscard]] CurvePlace nearest(const Vec3& x) const;

private:
    Surface segments_;  // triangles with a corner twice
    bool closed_;
    std::optional<SurfaceTree> tree_;
};

}  // namespace subvol::detail
