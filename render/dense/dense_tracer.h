// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "dense_grid.h"
#include "pixel_tiles.h"
#include "subvol/camera.h"
#include "tet_walk.h"

namespace subvol::detail {

/// The boxes of dense grids in Embree, as user geometry.
class DenseScene {
public:
    /// grids:  referred to, not copied
    ///
    /// throws: Error(MissingCapability) if Embree cannot be started or has not enough memory
    explicit DenseScene(const std::vector<DenseGrid>& grids);
    ~DenseScene();
    DenseScene(DenseScene&&) = delete;

    /// Appends the numbers of the grids whose boxes the whole line of a ray may meet, in no particular order.
    void find_met(const Ray& ray, std::vector<std::uint32_t>& grids) const;
    [[nodiscard]] const std::vector<DenseGrid>& grids() const { return grids_; }

private:
    struct Embree;
    std::unique_ptr<Embree> embree_;
    const std::vector<DenseGrid>& grids_;
    Vec3 center_{0.0};
    double scale_ = 1;  // to a ball of radius 1
};

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
