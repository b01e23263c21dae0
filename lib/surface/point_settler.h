// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "soup_cutter.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/limit.h"

namespace subvol::detail {

/// Where a point is.
struct SettledPoints {
    std::vector<LimitQuery> places;
    std::vector<Vec3> positions, normals;
};

/// Moves the points of a soup along their edges to the limit, and measures how far its triangles are from it.
class PointSettler {
public:
    /// mesh:  its first attribute is the field, if the cuts have isovalues. The topology is kept by reference
    /// whole: the extent of the mesh that it is a part of
    PointSettler(const HexMesh& mesh, const Topology& topology, const LimitExtent& whole, const SchemeOptions& scheme,
                 Progress* progress)
        : topology_(topology), limit_(mesh, {.scheme = scheme}, whole), progress_(progress) {}

    [[nodiscard]] SettledPoints settle(const SurfaceSoup& soup, const Cut& cut, int level) const;

    /// How far most triangles are from the limit: all but one edge in a thousand, as normals are arbitrary where gradients
    /// vanish.
    [[nodiscard]] double deviation(const SurfaceSoup& soup, const SettledPoints& settled, int level) const;

private:
    struct Moving;
    void move(const SurfaceSoup& soup, const Cut& cut, int level, std::vector<Moving>& moving, SettledPoints& settled) const;
    void add_hull_bends(const SurfaceSoup& soup, const SettledPoints& settled, int level, const std::vector<std::size_t>& hull,
                        std::vector<double>& bends) const;
    [[nodiscard]] bool on_hull(Index cell, const Vec3& uvw) const;

    const Topology& topology_;
    LimitEvaluator limit_;
    Progress* progress_;
};

}  // namespace subvol::detail
