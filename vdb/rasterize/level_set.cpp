// SPDX-License-Identifier: Apache-2.0
#include "level_set.h"

#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tree/LeafManager.h>

#include "brick_grids.h"

namespace subvol::detail {

openvdb::FloatGrid::Ptr level_set(VoxelBricks band, const openvdb::MaskGrid& inside, double voxel_size,
                                  double half_width_voxels) {
    const std::vector<GridOfChannels> wanted{{"sdf", GridKind::Float, 0}};
    auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(make_grids(std::move(band), wanted).front());
    openvdb::tree::LeafManager<openvdb::FloatTree> leaves(grid->tree());
    leaves.foreach ([&](openvdb::FloatTree::LeafNodeType& leaf, std::size_t) {
        const openvdb::MaskGrid::ConstUnsafeAccessor mask(inside.constTree());
        for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) {
            const auto distance = static_cast<float>(voxel_size * static_cast<double>(*voxel));
            voxel.setValue(mask.isValueOn(voxel.getCoord()) ? -distance : distance);
        }
    });
    // Where one of two neighbours is inside and the other is not, both lie in the band. So every voxel outside the band has the
    // sign of the nearest band voxel along an axis.
    grid->tree().root().setBackground(static_cast<float>(voxel_size * half_width_voxels), /*updateChildNodes=*/false);
    openvdb::tools::signedFloodFill(grid->tree());
    openvdb::tools::pruneLevelSet(grid->tree());
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    return grid;
}

}  // namespace subvol::detail
