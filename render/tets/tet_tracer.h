// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pixel_tiles.h"
#include "ray_ends.h"
#include "ray_walker.h"

namespace subvol::detail {

/// Integrates rays through a mesh of tetrahedra, one by one. Keeps scratch memory, so each thread or tile needs its own.
class TetTracer {
public:
    /// Keeps references to all of them.
    TetTracer(const TetMesh& mesh, const BoundaryScene& scene, const Optics& optics, const RayClip& clip)
        : mesh_(mesh),
          optics_(optics),
          clip_(clip),
          cut_{{}, clip.slices_alone()},
          compositor_(optics, kRayCutoff),
          ends_(mesh, scene) {}

    /// The light along the ray, from its origin on.
    [[nodiscard]] Segment trace(const Ray& ray);
    [[nodiscard]] const TraceCounts& counts() const { return counts_; }

private:
    const TetMesh& mesh_;
    const Optics& optics_;
    const RayClip& clip_;
    WalkCut cut_;
    Compositor compositor_;
    TraceCounts counts_;
    RayEnds ends_;
};

}  // namespace subvol::detail
