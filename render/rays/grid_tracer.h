// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "subvol/detail/ray_clip.h"
#include "subvol/optics.h"
#include "subvol/render_grid.h"

namespace subvol::detail {

/// Integrates rays through a grid. Keeps a cursor, so each thread or tile needs its own.
class GridTracer {
public:
    /// Keeps references to grid, optics and clip.
    GridTracer(const Voxels& grid, const Optics& optics, double tolerance, const RayClip& clip);

    /// The light along the ray, from its origin on.
    [[nodiscard]] Segment trace(const Ray& ray);
    [[nodiscard]] const GridTraceReport& counts() const { return counts_; }

private:
    /// A ray in index space.
    struct Line {
        Vec3 origin, direction, inverse;
        double speed;  // world length of a unit of t
    };
    struct Stretch {
        double begin, end;
    };
    /// Cells lower … upper, both included: cell i lies between voxels i and i + 1.
    struct Cells {
        Voxel lower, upper;
    };

    [[nodiscard]] Line to_index(const Ray& ray) const;
    [[nodiscard]] bool clip(const Line& line, Stretch& inside) const;
    [[nodiscard]] Voxel cell_at(const Line& line, double t, const Cells& within) const;
    [[nodiscard]] Cells covered(const Voxel& cell, const VoxelBlock& block) const;
    void add_cell(const Line& line, const Voxel& cell, Stretch stretch, Segment& light);
    [[nodiscard]] std::optional<double> value_at(const Line& line, const Voxel& cell, const VoxelBlock& block, double t);
    void add_voxel_part(const Line& line, const Voxel& cell, const VoxelCorners& corners, Stretch stretch, Segment& light);

    const Optics& optics_;
    const RayClip& clip_;
    RayCut cut_;
    double value_tolerance_;
    Mat3 to_index_;
    Mat3 to_world_;
    Vec3 origin_;
    Cells cells_;
    std::unique_ptr<VoxelCursor> cursor_;
    GridTraceReport counts_;
};

}  // namespace subvol::detail
