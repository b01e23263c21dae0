// SPDX-License-Identifier: Apache-2.0
#include "subvol/grid_surface.h"

#include <openvdb/tools/VolumeToMesh.h>
#include "openvdb_grids.h"

#include <vector>

#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "vdb_data.h"

namespace subvol {

using namespace detail;

Surface grid_surface(const VdbGrid& grid, std::optional<double> value) {
    const auto& data = VdbData::of(grid);
    const GridReport& report = grid.report();
    if (!data.floats) throw Error(ErrorCode::InvalidInput, "the voxels are not floats", "grid " + in_quotes(report.name));
    const bool distances = data.floats->getGridClass() == openvdb::GRID_LEVEL_SET;
    constexpr double kHalf = 0.5;
    const double iso = value ? *value : distances ? 0 : kHalf * report.max;
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quads;
    // OpenVDB's points are of 32 bits, which far from the origin have no digits left for a voxel: they are counted in voxels
    // from the grid's lowest one.
    const openvdb::Vec3d lowest = data.floats->evalActiveVoxelBoundingBox().min().asVec3d();
    const auto in_voxels = openvdb::FloatGrid::create(data.floats->treePtr());
    in_voxels->setTransform(openvdb::math::Transform::createLinearTransform(1.0));
    in_voxels->transform().postTranslate(-lowest);
    openvdb::tools::volumeToMesh(*in_voxels, points, triangles, quads, iso);
    if (triangles.empty() && quads.empty()) {
        throw Error(ErrorCode::InvalidInput, "has the value " + number_text(iso) + " nowhere", "grid " + in_quotes(report.name),
                    "a value between " + number_text(report.min) + " and " + number_text(report.max));
    }
    Surface surface;
    surface.points.reserve(points.size());
    for (const auto& x : points) {
        const openvdb::Vec3d world = data.floats->indexToWorld(openvdb::Vec3d(x) + lowest);
        surface.points.emplace_back(world[0], world[1], world[2]);
    }
    surface.triangles.reserve(triangles.size() + 2 * quads.size());
    for (const auto& t : triangles) surface.triangles.push_back({t[0], t[1], t[2]});
    for (const auto& q : quads) {
        surface.triangles.push_back({q[0], q[1], q[2]});
        surface.triangles.push_back({q[0], q[2], q[3]});
    }
    return surface;
}

}  // namespace subvol
