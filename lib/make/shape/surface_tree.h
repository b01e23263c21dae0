// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "subvol/detail/median_tree.h"
#include "subvol/surface.h"

namespace subvol::detail {

/// Whether two boxes have a place in common.
[[nodiscard]] inline bool meet(const Box& a, const Box& b) {
    return glm::all(glm::lessThanEqual(a.lower, b.upper)) && glm::all(glm::lessThanEqual(b.lower, a.upper));
}

/// The place of a surface that is nearest to a point.
struct SurfacePlace {
    Index triangle = kNone;
    Vec3 weights{0.0};  ///< weights of the triangle's corners
    Vec3 point{0.0};
    Vec3 toward{0.0};  ///< the unit vector from the place to the point, or the triangle's normal where the point lies on it
    double distance = 0;
};

/// The triangles of a surface in a tree of boxes.
class SurfaceTree {
public:
    /// surface: referred to; of at least one triangle
    explicit SurfaceTree(const Surface& surface);

    [[nodiscard]] SurfacePlace nearest(const Vec3& x) const;

    /// How often the surface winds about x: 1 inside a closed one whose normals point outwards, 0 outside. Near holes it is
    /// between, and far triangles count by their area alone, so that it is exact to about .01.
    ///
    /// source: [barill2018]
    [[nodiscard]] double winding(const Vec3& x) const;

    [[nodiscard]] Vec3 normal(Index triangle) const;

    /// Whether a segment passes through a triangle: its ends lie on both sides, farther from it than `touching`.
    [[nodiscard]] bool pierced_by(const Vec3& a, const Vec3& b, double touching) const;

    /// The part of the way from a to b at which it meets the first triangle; nothing if it meets none.
    [[nodiscard]] std::optional<double> way_to(const Vec3& a, const Vec3& b) const;

    [[nodiscard]] const Box& box() const { return tree_->box(0); }

    /// The triangles that may meet a box.
    [[nodiscard]] std::vector<Index> triangles_near(const Box& box) const;

private:
    /// Triangles as one: their area vectors' sum at the centre of their areas; all lie within `radius` of it.
    struct Cluster {
        Vec3 area{0.0}, center{0.0};
        double radius = 0;
    };

    [[nodiscard]] std::array<Vec3, 3> corners(Index triangle) const;
    void make_clusters();

    const Surface& surface_;
    std::optional<MedianTree<Box>> tree_;
    std::vector<Cluster> clusters_;  // of the nodes
};

}  // namespace subvol::detail
