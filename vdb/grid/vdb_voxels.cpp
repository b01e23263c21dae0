// SPDX-License-Identifier: Apache-2.0
#include "openvdb_grids.h"

#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "vdb_data.h"

namespace subvol {

namespace {

using Tree = openvdb::FloatTree;

openvdb::Coord coord_of(const Voxel& voxel) {
    return {voxel[0], voxel[1], voxel[2]};
}
Voxel voxel_of(const openvdb::Coord& c) {
    return {c[0], c[1], c[2]};
}
Vec3 vec_of(const openvdb::Vec3d& v) {
    return {v[0], v[1], v[2]};
}

class Cursor : public VoxelCursor {
public:
    Cursor(const Tree& tree, bool is_level_set) : accessor_(tree), is_level_set_(is_level_set) {}

    VoxelBlock block(const Voxel& voxel) override {
        const openvdb::Coord c = coord_of(voxel);
        if (const auto* leaf = accessor_.probeConstLeaf(c)) {
            const bool nothing = leaf->isValueMaskOff() && !is_inside(leaf->getFirstValue());
            const auto kind = nothing ? VoxelBlock::Kind::Nothing : VoxelBlock::Kind::Mixed;
            return {kind, voxel_of(leaf->origin()), static_cast<std::int32_t>(Tree::LeafNodeType::DIM), 0};
        }
        float value = 0;
        const bool active = accessor_.probeValue(c, value) || is_inside(value);
        const std::int32_t size = tile_size(accessor_.getValueDepth(c));
        return {active ? VoxelBlock::Kind::Constant : VoxelBlock::Kind::Nothing,
                {c[0] & ~(size - 1), c[1] & ~(size - 1), c[2] & ~(size - 1)},
                size,
                static_cast<double>(value)};
    }

    VoxelCorners corners(const Voxel& lower) override {
        VoxelCorners corners;
        for (unsigned k = 0; k < 8; ++k) {
            const openvdb::Coord c = coord_of(lower).offsetBy(k & 1, k >> 1 & 1, k >> 2);
            float value = 0;
            if (accessor_.probeValue(c, value) || is_inside(value)) corners.active |= 1u << k;
            corners.values[k] = static_cast<double>(value);
        }
        return corners;
    }

private:
    /// Of an inactive voxel: it has a value if it lies inside a level set.
    [[nodiscard]] bool is_inside(float value) const { return is_level_set_ && value < 0; }

    /// depth: of the node with the tile: 2: lower inner node, 1: upper inner node, 0: root; -1: background
    static std::int32_t tile_size(int depth) {
        using Upper = Tree::RootNodeType::ChildNodeType;
        using Lower = Upper::ChildNodeType;
        constexpr std::int32_t kLeaf = Tree::LeafNodeType::DIM, kLower = Lower::DIM, kUpper = Upper::DIM;
        return depth == 2 ? kLeaf : depth == 1 ? kLower : kUpper;
    }

    // Not registered with the tree, hence cheap to make; safe in many threads as long as the tree does not change.
    openvdb::FloatGrid::ConstUnsafeAccessor accessor_;
    bool is_level_set_;
};

class GridVoxels : public Voxels {
public:
    explicit GridVoxels(openvdb::FloatGrid::ConstPtr grid) : grid_(std::move(grid)), axes_(detail::axes_of(*grid_)) {
        const openvdb::CoordBBox box = grid_->evalActiveVoxelBoundingBox();
        range_ = {voxel_of(box.min()), voxel_of(box.max())};
    }
    Mat3 to_world() const override { return axes_.first; }
    Vec3 origin() const override { return axes_.second; }
    std::array<Voxel, 2> range() const override { return range_; }
    std::unique_ptr<VoxelCursor> cursor() const override {
        return std::make_unique<Cursor>(grid_->constTree(), is_level_set());
    }
    bool is_level_set() const override { return grid_->getGridClass() == openvdb::GRID_LEVEL_SET; }

private:
    openvdb::FloatGrid::ConstPtr grid_;
    std::pair<Mat3, Vec3> axes_;
    std::array<Voxel, 2> range_;
};

}  // namespace

std::pair<Mat3, Vec3> detail::axes_of(const openvdb::GridBase& grid) {
    if (!grid.transform().isLinear()) {
        throw Error(ErrorCode::InvalidInput, "the grid's transform is not linear", "grid " + in_quotes(grid.getName()),
                    "a linear transform, not a frustum");
    }
    const auto map = grid.transform().baseMap();
    const auto edge = [&](const openvdb::Vec3d& axis) { return vec_of(map->applyJacobian(axis)); };
    return {Mat3(edge({1, 0, 0}), edge({0, 1, 0}), edge({0, 0, 1})), vec_of(map->applyMap(openvdb::Vec3d(0.0)))};
}

void detail::check_axes(const Mat3& to_world, const Vec3& origin, const std::string& name) {
    constexpr double kMostVoxel_world = 1e30, kLeastAngle = 1e-6;  // of the volume between edges of length 1
    const std::string where = "grid " + in_quotes(name);
    double box = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const double edge = glm::length(to_world[axis]);
        if (!(edge >= kLeastVoxel_world && edge <= kMostVoxel_world)) {
            throw Error(ErrorCode::InvalidInput, "an edge of its voxels is " + number_text(edge) + " long", where,
                        "1.45e-5 to 1e30");
        }
        box *= edge;
    }
    if (!(std::abs(glm::determinant(to_world)) >= kLeastAngle * box)) {
        throw Error(ErrorCode::InvalidInput, "its transform is singular: the voxels are flat", where);
    }
    for (int axis = 0; axis < 3; ++axis) {
        if (!(std::abs(origin[axis]) <= kMostVoxel_world)) {
            throw Error(ErrorCode::InvalidInput, "its transform moves by " + number_text(origin[axis]), where, "-1e30 to 1e30");
        }
    }
}

std::unique_ptr<Voxels> detail::VdbData::voxels() const {
    if (!floats) {
        throw Error(ErrorCode::InvalidInput, "its voxels are not floats", "grid " + detail::in_quotes(grid->getName()));
    }
    return std::make_unique<GridVoxels>(floats);
}

}  // namespace subvol
