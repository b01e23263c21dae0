// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "subvol/camera.h"
#include "subvol/topology.h"
#include "tet_mesh.h"

namespace subvol::detail {

/// The boundary of a mesh in Embree. Embree works in single precision, so the faces that it finds are candidates only; callers
/// decide in double precision.
class BoundaryScene {
public:
    /// box:    of the points that cells use
    /// throws: Error(MissingCapability) if Embree cannot be started or has not enough memory
    BoundaryScene(const TetMesh& mesh, const Box& box);
    ~BoundaryScene();
    BoundaryScene(BoundaryScene&&) = delete;

    /// Appends the boundary faces that the whole line of a ray may cross, behind its origin too, in no particular order.
    void find_crossed(const Ray& ray, std::vector<TetFace>& faces) const;

    /// The boundary faces at a point.
    [[nodiscard]] std::span<const TetFace> faces_at(Index point) const { return faces_at_points_[point]; }

private:
    struct Embree;
    std::unique_ptr<Embree> embree_;
    std::span<const TetFace> boundary_;
    IndexRows faces_at_points_;
    Vec3 center_;
    double scale_;  // to a ball of radius 1
};

}  // namespace subvol::detail
