// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "boundary_triangles.h"
#include "voxel_bricks.h"

namespace subvol::detail {

/// What a closed surface holds, along the columns of voxel centres in z: crossings upwards and downwards are counted. Centres
/// on the surface go to the side that the rasterizer puts them on. Two triangles that share an edge, to the bit, leave no gap.
class SurfaceColumns {
public:
    explicit SurfaceColumns(std::span<const VoxelTriangle> triangles);

    /// How often the surface goes round a centre; 0: it is outside.
    [[nodiscard]] int winding(const VoxelCoord& voxel) const;

    /// Calls visit(lowest, upper z) for every run of centres whose winding is not 0; both ends are in it.
    void for_each_run(const std::function<void(const VoxelCoord&, int)>& visit) const;

private:
    /// step: 1 where the surface is entered upwards, else -1
    struct Crossing {
        int x, y;
        double z;
        int step;

        auto operator<=>(const Crossing&) const = default;
    };

    void add(const VoxelTriangle& triangle);

    std::vector<Crossing> crossings_;
};

}  // namespace subvol::detail
