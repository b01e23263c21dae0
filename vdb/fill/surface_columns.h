// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "boundary_triangles.h"
#include "voxel_bricks.h"

namespace subvol::detail {

/// The winding numbers of a closed surface about voxel centres, from its crossings with the columns of centres along z.
///
/// A centre on the surface belongs to the same side as in the rasterizer. Two triangles whose shared edge has the same bits
/// leave no gap.
class SurfaceColumns {
public:
    explicit SurfaceColumns(std::span<const VoxelTriangle> triangles);

    /// The winding number of the surface about a centre; 0 is outside.
    [[nodiscard]] int winding(const VoxelCoord& voxel) const;

    /// Calls visit(lowest, upper z) for every run of centres whose winding number is not 0; the run includes both ends.
    void for_each_run(const std::function<void(const VoxelCoord&, int)>& visit) const;

private:
    struct Crossing {
        int x, y;
        double z;
        int step;  ///< 1 where the column enters the surface upwards, else -1

        auto operator<=>(const Crossing&) const = default;
    };

    void add(const VoxelTriangle& triangle);

    std::vector<Crossing> crossings_;
};

}  // namespace subvol::detail
