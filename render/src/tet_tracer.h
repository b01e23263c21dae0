#pragma once

#include <vector>

#include "boundary_scene.h"
#include "integrate_walk.h"
#include "subvol/compositor.h"

namespace subvol {

struct TraceCounts {
    std::size_t rays = 0;
    std::size_t segments = 0;
    std::size_t lost_rays = 0;
};

/// Integrates rays through a mesh of tetrahedra. Keeps scratch memory: one for each thread or tile.
class TetTracer {
public:
    TetTracer(const TetMesh& mesh, const BoundaryScene& scene, const Optics& optics)
        : mesh_(mesh), scene_(scene), compositor_(optics, kOpaque) {}

    /// The part of the ray in front of its origin.
    [[nodiscard]] Segment trace(const Ray& ray);
    [[nodiscard]] const TraceCounts& counts() const { return counts_; }

private:
    /// A boundary face that the ray crosses: the walks pair them up.
    struct End {
        TetFace face;
        double t;
        bool walked;
    };

    void find_ends(const RayPlane& plane, const Ray& ray);
    void add_end(const RayPlane& plane, TetFace face);
    void add_ends_near(const RayPlane& plane, TetFace face);
    [[nodiscard]] End* first_unwalked();
    void mark_walked(const RayPlane& plane, TetFace start, TetFace end);

    const TetMesh& mesh_;
    const BoundaryScene& scene_;
    Compositor compositor_;
    TraceCounts counts_;
    std::vector<TetFace> hits_;
    std::vector<End> ends_;
};

}  // namespace subvol
