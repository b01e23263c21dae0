// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "cell_sides.h"
#include "dense_grid.h"
#include "pixel_tiles.h"
#include "subvol/camera.h"
#include "tet_walk.h"

namespace subvol::detail {

/// Dense grids, which sides of theirs meet, and the boxes of those with an open side in Embree, as user geometry.
class DenseScene {
public:
    /// A triangle on a side of a grid.
    struct Door {
        std::uint32_t grid;
        TetFace face;
    };

    /// Keeps references to both.
    ///
    /// throws: Error(MissingCapability) if Embree cannot be started or has not enough memory
    DenseScene(const std::vector<DenseGrid>& grids, const CellSides& sides);
    ~DenseScene();
    DenseScene(DenseScene&&) = delete;

    /// Appends the numbers of the grids with an open side whose boxes the whole line of a ray may meet, in no particular order.
    void find_met(const Ray& ray, std::vector<std::uint32_t>& grids) const;
    /// The sides of a grid behind which there is no other grid, one bit for each.
    [[nodiscard]] unsigned open_sides(std::uint32_t grid) const;
    /// The same triangle on the side of the grid behind it; nothing on an open side.
    [[nodiscard]] std::optional<Door> behind(const Door& door) const;
    [[nodiscard]] const std::vector<DenseGrid>& grids() const { return grids_; }
    /// At least the number of triangles on all sides: no walk passes through more of them.
    [[nodiscard]] std::size_t most_doors() const { return most_doors_; }

private:
    struct Embree;
    void link_grids();

    std::unique_ptr<Embree> embree_;
    const std::vector<DenseGrid>& grids_;
    const CellSides& sides_;
    std::vector<std::array<std::uint32_t, 6>> next_;  // the grid behind each side
    std::size_t most_doors_ = 0;
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
    /// A triangle on an open side that the ray crosses. Each walk from grid to grid begins at one and ends at another.
    struct End {
        double t;
        Index cell;
        DenseScene::Door door;
        bool walked;
    };
    void find_ends(const RayPlane& plane, const Ray& ray);
    [[nodiscard]] bool mark_walked(const DenseScene::Door& door);
    [[nodiscard]] WalkOutcome walk_from(DenseScene::Door door, RayWalker& walker);

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
