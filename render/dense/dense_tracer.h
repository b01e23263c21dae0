// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "dense_scene.h"
#include "pixel_tiles.h"
#include "ray_walker.h"

namespace subvol::detail {

/// Integrates rays through dense grids. Keeps scratch memory, so each thread or tile needs its own.
class DenseTracer {
public:
    /// Keeps references to all of them.
    DenseTracer(const DenseScene& scene, const Optics& optics, const RayClip& clip)
        : scene_(scene), optics_(optics), clip_(clip), cut_{{}, clip.slices_alone()}, compositor_(optics, kRayCutoff) {}

    /// The light along the ray, from its origin on.
    [[nodiscard]] Segment trace(const Ray& ray);
    [[nodiscard]] const TraceCounts& counts() const { return counts_; }

private:
    /// A boundary face of a grid that the ray crosses. Each walk begins at one and ends at another.
    struct End {
        double t;
        Index cell;
        std::uint32_t grid;
        TetFace face;
        bool walked;
    };
    void find_ends(const RayPlane& plane, const Ray& ray);
    [[nodiscard]] bool mark_walked(std::uint32_t grid, TetFace face);

    const DenseScene& scene_;
    const Optics& optics_;
    const RayClip& clip_;
    WalkCut cut_;
    Compositor compositor_;
    TraceCounts counts_;
    std::vector<std::uint32_t> met_;
    std::vector<TetFace> faces_;
    std::vector<End> ends_;
};

}  // namespace subvol::detail
