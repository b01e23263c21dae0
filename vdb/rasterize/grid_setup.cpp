// SPDX-License-Identifier: Apache-2.0
#include "grid_setup.h"

#include <algorithm>
#include <cmath>

#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "vdb_data.h"

namespace subvol::detail {

namespace {

double checked_voxel_size(const Box& box, const RasterizeOptions& options) {
    if (!(options.voxel_size_world >= 0) || !std::isfinite(options.voxel_size_world)) {
        throw Error(ErrorCode::InvalidInput, "the voxel size is not positive");
    }
    if (options.resolution < 1) throw Error(ErrorCode::InvalidInput, "the resolution is below one voxel");
    const double size = voxel_size_of(box, options);
    if (!(size > 0)) throw Error(ErrorCode::InvalidInput, "the mesh is a single point");
    return size;
}

ToVoxels to_voxels_of(const openvdb::GridBase& like) {
    const auto [to_world, origin] = axes_of(like);
    check_axes(to_world, origin, like.getName());
    const double size = std::cbrt(std::abs(glm::determinant(to_world)));
    const Mat3 linear = size * glm::inverse(to_world);
    return {linear, -(linear * origin), size};
}

}  // namespace

namespace {

/// "--scale 1e6": units a thousand, a million, … times smaller, in which the voxels are of some size.
std::string scale_for(double voxel_size) {
    constexpr double kSome_world = 1e-3;
    int thousands = 1;
    while (thousands < 100 && voxel_size * std::pow(1e3, thousands) < kSome_world) ++thousands;
    return "--scale 1e" + std::to_string(3 * thousands);
}

}  // namespace

void check_representable(double voxel_size) {
    if (voxel_size >= kLeastVoxel_world) return;
    throw Error(ErrorCode::InvalidInput,
                "voxel size " + number_text(voxel_size) + ": OpenVDB treats the transform of such small voxels as singular", {},
                "at least 1.45e-5: " + scale_for(voxel_size) + " makes the mesh larger");
}

ToVoxels to_voxels_of(const Box& box, const RasterizeOptions& options) {
    if (options.like) return to_voxels_of(*VdbData::of(*options.like).grid);
    return {.voxel_size = checked_voxel_size(box, options)};
}

void check_level_set(const RasterizeOptions& options) {
    const double half_width = options.level_set->half_width_voxels;
    if (!(half_width >= 1 && half_width <= 1000)) {
        throw Error(ErrorCode::InvalidInput, "the half width of the level set's band is not from 1 to 1000 voxels");
    }
    if (options.like && !VdbData::of(*options.like).grid->hasUniformVoxels()) {
        throw Error(ErrorCode::InvalidInput, "its voxels are not cubes, but a level set needs cubes",
                    "grid \"" + options.like->report().name + "\"");
    }
}

void describe(openvdb::GridBase& grid, const ToVoxels& to_voxels, const RasterizeOptions& options, const Box& frame) {
    if (options.like) {
        grid.setTransform(VdbData::of(*options.like).grid->transform().copy());
    } else {
        grid.setTransform(openvdb::math::Transform::createLinearTransform(to_voxels.voxel_size));
    }
    grid.setCreator(options.creator);
    set_frame(grid, options.frame.empty() ? frame : options.frame);
    grid.insertMeta("subvol_field", openvdb::StringMetadata(grid.getName()));
    for (const auto& [name, text] : options.metadata) grid.insertMeta(name, openvdb::StringMetadata(text));
    grid.setSaveFloatAsHalf(options.half);
}

openvdb::MaskGrid::Ptr mask_of(const openvdb::GridBase& grid) {
    auto mask = openvdb::MaskGrid::create();
    if (const auto* floats = dynamic_cast<const openvdb::FloatGrid*>(&grid)) {
        mask->setTree(std::make_shared<openvdb::MaskTree>(floats->constTree(), false, openvdb::TopologyCopy()));
    } else if (const auto* vectors = dynamic_cast<const openvdb::Vec3SGrid*>(&grid)) {
        mask->setTree(std::make_shared<openvdb::MaskTree>(vectors->constTree(), false, openvdb::TopologyCopy()));
    }
    mask->setName("mask");
    return mask;
}

}  // namespace subvol::detail
