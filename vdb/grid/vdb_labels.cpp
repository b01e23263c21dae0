// SPDX-License-Identifier: Apache-2.0
#include "subvol/grid_surface.h"

#include "openvdb_grids.h"

#include <cstdint>
#include <limits>
#include <string>

#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "vdb_data.h"

namespace subvol {

using namespace detail;

namespace {

template <class Integer>
std::int32_t label_from(Integer value, const openvdb::Coord& at, const std::string& where) {
    if (value < 0 || std::int64_t{value} > std::numeric_limits<std::int32_t>::max()) {
        throw Error(ErrorCode::InvalidInput,
                    "voxel (" + std::to_string(at[0]) + ", " + std::to_string(at[1]) + ", " + std::to_string(at[2]) +
                        ") has the label " + std::to_string(value),
                    where, "0 outside, and labels from 1 to 2147483647");
    }
    return static_cast<std::int32_t>(value);
}

/// The leaves of OpenVDB are the blocks of a LabelGrid, with the last axis fastest.
template <class Grid>
void add_blocks(const Grid& from, LabelGrid& to, const std::string& where) {
    constexpr std::int32_t kBlock = LabelGrid::kSide;
    static_assert(Grid::TreeType::LeafNodeType::DIM == kBlock);
    const auto block_at = [](const openvdb::Coord& c) { return LabelGrid::At{c[0] >> 3, c[1] >> 3, c[2] >> 3}; };
    for (auto leaf = from.constTree().cbeginLeaf(); leaf; ++leaf) {
        LabelGrid::Voxels voxels{};
        for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel) {
            const openvdb::Coord at = voxel.getCoord() - leaf->origin();
            voxels[static_cast<std::size_t>(at[0] + kBlock * (at[1] + kBlock * at[2]))] =
                label_from(*voxel, voxel.getCoord(), where);
        }
        to.set(block_at(leaf->origin()), voxels);
    }
    auto tile = from.constTree().cbeginValueOn();
    tile.setMaxDepth(decltype(tile)::LEAF_DEPTH - 1);
    for (; tile; ++tile) {
        const openvdb::CoordBBox box = tile.getBoundingBox();
        const std::int32_t label = label_from(*tile, box.min(), where);
        if (label == 0) continue;
        const LabelGrid::At first = block_at(box.min()), last = block_at(box.max());
        for (std::int32_t x = first[0]; x <= last[0]; ++x) {
            for (std::int32_t y = first[1]; y <= last[1]; ++y) {
                for (std::int32_t z = first[2]; z <= last[2]; ++z) to.set({x, y, z}, label);
            }
        }
    }
}

}  // namespace

LabelGrid labels_of_grid(const VdbGrid& grid) {
    const VdbData& data = VdbData::of(grid);
    const std::string where = "grid " + in_quotes(data.report().name);
    const auto [to_world, origin] = axes_of(*data.grid);
    LabelGrid labels(to_world, origin);
    if (const auto* integers = dynamic_cast<const openvdb::Int32Grid*>(data.grid.get())) {
        add_blocks(*integers, labels, where);
    } else if (const auto* wide = dynamic_cast<const openvdb::Int64Grid*>(data.grid.get())) {
        add_blocks(*wide, labels, where);
    } else {
        throw Error(ErrorCode::InvalidInput, "its voxels are of the kind " + data.report().kind, where, "integers");
    }
    return labels;
}

}  // namespace subvol
