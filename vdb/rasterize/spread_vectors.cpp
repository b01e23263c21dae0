// SPDX-License-Identifier: Apache-2.0
#include <openvdb/tools/Morphology.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tree/LeafManager.h>
#include "openvdb_grids.h"

#include <array>

#include "subvol/error.h"
#include "subvol/spread_vectors.h"
#include "vdb_data.h"

namespace subvol {

using namespace detail;

namespace {

using Tree = openvdb::Vec3STree;
using openvdb::Coord;

constexpr int kMostLayers = 1000;

/// The steps to the 26 neighbours of a voxel.
std::array<Coord, 26> neighbours() {
    std::array<Coord, 26> all;
    std::size_t count = 0;
    for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
            for (int z = -1; z <= 1; ++z) {
                if (x != 0 || y != 0 || z != 0) all[count++] = Coord(x, y, z);
            }
        }
    }
    return all;
}

/// Adds one layer of voxels. Only new voxels are written and only old ones are read, so the order does not matter.
void add_layer(Tree& tree) {
    const openvdb::MaskTree before(tree, false, true, openvdb::TopologyCopy());
    openvdb::tools::dilateActiveValues(tree, 1, openvdb::tools::NN_FACE_EDGE_VERTEX, openvdb::tools::IGNORE_TILES);
    static const std::array<Coord, 26> kAround = neighbours();
    openvdb::tree::LeafManager<Tree> leaves(tree);
    leaves.foreach ([&](Tree::LeafNodeType& leaf, std::size_t) {
        auto fresh = leaf.valueMask();
        if (const auto* was = before.probeConstLeaf(leaf.origin())) fresh -= was->valueMask();
        if (fresh.isOff()) return;
        const openvdb::tree::ValueAccessor<const openvdb::MaskTree> old(before);
        const openvdb::tree::ValueAccessor<const Tree> values(tree);
        for (auto at = fresh.beginOn(); at; ++at) {
            const Coord voxel = leaf.offsetToGlobalCoord(at.pos());
            openvdb::Vec3d sum(0.0);
            int count = 0;
            for (const Coord& step : kAround) {
                if (!old.isValueOn(voxel + step)) continue;
                sum += openvdb::Vec3d(values.getValue(voxel + step));
                ++count;
            }
            leaf.setValueOnly(at.pos(), openvdb::Vec3s(sum / count));
        }
    });
}

}  // namespace

VdbGrid spread_vectors(const VdbGrid& grid, int layers) {
    const auto source = openvdb::gridPtrCast<openvdb::Vec3SGrid>(VdbData::of(grid).grid);
    if (!source) throw Error(ErrorCode::InvalidInput, "the voxels of '" + grid.report().name + "' are not vectors of floats");
    if (layers < 0 || layers > kMostLayers) {
        throw Error(ErrorCode::InvalidInput, std::to_string(layers) + " layers of voxels cannot be added", "spread_vectors",
                    "0 to 1000");
    }
    const openvdb::Vec3SGrid::Ptr spread = source->deepCopy();
    spread->tree().voxelizeActiveTiles();
    for (int layer = 0; layer < layers; ++layer) add_layer(spread->tree());
    openvdb::tools::prune(spread->tree());
    return make_vdb_grid(spread);
}

}  // namespace subvol
