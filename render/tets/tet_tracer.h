// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "boundary_scene.h"
#include "pixel_tiles.h"
#include "tet_walk.h"

namespace subvol::detail {

/// The boundary faces that a ray crosses. Each walk begins at one and ends at another. Keeps its memory from ray to ray.
class RayEnds {
public:
    RayEnds(const TetMesh& mesh, const BoundaryScene& scene) : mesh_(&mesh), scene_(&scene) {}

    /// Finds those of a ray, and marks none as walked.
    void find(const RayPlane& plane, const Ray& ray);
    [[nodiscard]] bool empty() const { return ends_.empty(); }

    /// The first one along the ray at which no walk has begun or ended; kNone if there is none.
    [[nodiscard]] TetFace first_unwalked() const;

    /// Marks both ends of a walk.
    void mark_walked(const RayPlane& plane, TetFace start, TetFace end);

private:
    struct WalkEnd {
        TetFace face;
        double t;
        bool walked;
    };
    void add(const RayPlane& plane, TetFace face);
    void add_near(const RayPlane& plane, TetFace face);

    const TetMesh* mesh_;
    const BoundaryScene* scene_;
    std::vector<TetFace> hits_;
    std::vector<WalkEnd> ends_;
};

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
