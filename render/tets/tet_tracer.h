// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "integrate_walk.h"
#include "ray_ends.h"

namespace subvol::detail {

struct TraceCounts {
    std::size_t rays = 0;
    std::size_t segments = 0;
    std::size_t lost_rays = 0;
};

/// Integrates rays through a mesh of tetrahedra, one by one. Keeps scratch memory: one for each thread or tile.
class TetTracer {
public:
    TetTracer(const TetMesh& mesh, const BoundaryScene& scene, const Optics& optics)
        : mesh_(mesh), compositor_(optics, kOpaque), ends_(mesh, scene) {}

    /// The part of the ray in front of its origin.
    [[nodiscard]] Segment trace(const Ray& ray);
    [[nodiscard]] const TraceCounts& counts() const { return counts_; }

private:
    const TetMesh& mesh_;
    Compositor compositor_;
    TraceCounts counts_;
    RayEnds ends_;
};

}  // namespace subvol::detail
