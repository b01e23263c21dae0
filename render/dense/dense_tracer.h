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

/// Dense grids, which sides of theirs meet, and boxes of their open sides in Embree, as user geometry.
class DenseScene {
public:
    /// A triangle on a side of a grid.
    struct Door {
        std::uint32_t grid;
        TetFace face;
    };
    /// A part of an open side of a grid.
    struct OpenPart {
        std::uint32_t grid;
        DenseGrid::SidePart part;
    };
    /// Cells without a grid: there is nothing of them to be seen, or their grids are made when a ray comes to them.
    enum class Absent : std::uint8_t { Nothing, NotYet };

    /// Keeps references to both.
    ///
    /// throws: Error(MissingCapability) if Embree cannot be started or has not enough memory
    DenseScene(const std::vector<DenseGrid>& grids, const CellSides& sides, Absent absent = Absent::Nothing);
    ~DenseScene();
    DenseScene(DenseScene&&) = delete;

    /// Appends the numbers of the parts of open sides whose boxes the whole line of a ray may meet, in no particular order.
    void find_met(const Ray& ray, std::vector<std::uint32_t>& parts) const;
    [[nodiscard]] const OpenPart& part(std::uint32_t number) const { return parts_[number]; }
    /// The same triangle on the side of the grid behind it; nothing on an open side.
    [[nodiscard]] std::optional<Door> behind(const Door& door) const;
    /// The cell behind a triangle whose grid is not made yet, or kNone.
    [[nodiscard]] Index awaited_behind(const Door& door) const;
    [[nodiscard]] const std::vector<DenseGrid>& grids() const { return grids_; }
    /// At least the number of triangles on all sides: no walk passes through more of them.
    [[nodiscard]] std::size_t most_doors() const { return most_doors_; }

private:
    struct Embree;
    void link_grids();
    [[nodiscard]] bool is_open(std::uint32_t grid, std::size_t side) const;
    void find_parts();

    std::unique_ptr<Embree> embree_;
    const std::vector<DenseGrid>& grids_;
    const CellSides& sides_;
    Absent absent_;
    std::vector<std::array<std::uint32_t, 6>> next_;  // the grid behind each side
    std::vector<OpenPart> parts_;
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
    /// The cell without a grid that the last ray came to, or kNone: then its light is complete.
    [[nodiscard]] Index awaited() const { return awaited_; }
    [[nodiscard]] const TraceCounts& counts() const { return counts_; }
    void set_counts(const TraceCounts& counts) { counts_ = counts; }

private:
    /// A triangle on an open side that the ray crosses. Each walk from grid to grid begins at one and ends at another.
    struct BoundaryCrossing {
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
    Index awaited_ = kNone;
    std::vector<std::uint32_t> met_;
    std::vector<TetFace> faces_;
    std::vector<BoundaryCrossing> ends_;
};

}  // namespace subvol::detail
