#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "brick_grids.h"
#include "rasterize_cells.h"
#include "subvol/error.h"
#include "vdb_data.h"

namespace subvol {

namespace {

using detail::GridKind;
using detail::GridOfChannels;

constexpr double kMaxHalf = 65504;
constexpr double kLeastVoxel_world = 1.45e-5;  // OpenVDB takes a transform for singular whose determinant is below 3e-15

void check_representable(double voxel_size) {
    if (voxel_size >= kLeastVoxel_world) return;
    std::ostringstream message;
    message << "voxel size " << voxel_size << ": OpenVDB takes a grid of such small voxels for flat";
    throw Error(ErrorCode::InvalidInput, message.str(), {}, "at least 1.45e-5; a mesh in smaller units has larger voxels");
}

double voxel_size_of(const Box& box, const RasterizeOptions& options) {
    if (!(options.voxel_size_world >= 0) || !std::isfinite(options.voxel_size_world)) {
        throw Error(ErrorCode::InvalidInput, "the voxel size is not positive");
    }
    if (options.voxel_size_world > 0) return options.voxel_size_world;
    if (options.resolution < 1) throw Error(ErrorCode::InvalidInput, "the resolution is below one voxel");
    const double side = std::max({box.size().x, box.size().y, box.size().z});
    if (!(side > 0)) throw Error(ErrorCode::InvalidInput, "the mesh is a single point");
    return side / options.resolution;
}

detail::ToVoxels to_voxels_of(const openvdb::GridBase& like) {
    if (!like.transform().isLinear()) {
        throw Error(ErrorCode::InvalidInput, "the grid's transform is not linear", "grid \"" + like.getName() + "\"",
                    "a linear transform, not a frustum");
    }
    const auto vec = [](const openvdb::Vec3d& v) { return Vec3(v[0], v[1], v[2]); };
    const auto map = like.transform().baseMap();
    const Mat3 to_world(vec(map->applyJacobian({1, 0, 0})), vec(map->applyJacobian({0, 1, 0})),
                        vec(map->applyJacobian({0, 0, 1})));
    const double size = std::cbrt(std::abs(glm::determinant(to_world)));
    const Mat3 linear = size * glm::inverse(to_world);
    return {linear, -(linear * vec(map->applyMap(openvdb::Vec3d(0.0)))), size};
}

const Attribute& field_of(const HexMesh& mesh, const std::string& name, bool half) {
    const std::string where = "field \"" + name + "\"";
    const Attribute* field = mesh.find_attribute(name);
    if (!field) throw Error(ErrorCode::InvalidInput, "the mesh does not have it", where);
    if (field->channels != 1 && field->channels != 3) {
        throw Error(ErrorCode::InvalidInput, "has " + std::to_string(field->channels) + " channels", where, "one or three");
    }
    const double largest = half ? kMaxHalf : static_cast<double>(std::numeric_limits<float>::max());
    if (std::any_of(field->values.begin(), field->values.end(), [=](double v) { return std::abs(v) > largest; })) {
        throw Error(ErrorCode::InvalidInput,
                    "has a value that does not fit into a " + std::string(half ? "16" : "32") + "-bit float", where);
    }
    return *field;
}

std::vector<GridOfChannels> grids_of(std::span<const Attribute* const> fields, bool cell_numbers) {
    std::vector<GridOfChannels> grids;
    std::size_t channel = 0;
    for (const Attribute* field : fields) {
        grids.push_back({field->name, field->channels == 3 ? GridKind::Vector : GridKind::Float, channel});
        channel += static_cast<std::size_t>(field->channels);
    }
    if (cell_numbers) grids.push_back({"cell", GridKind::Integer, channel});
    return grids;
}

void describe(openvdb::GridBase& grid, const RasterizeOptions& options, double voxel_size) {
    if (options.like) {
        grid.setTransform(options.like->data().grid->transform().copy());
    } else {
        grid.setTransform(openvdb::math::Transform::createLinearTransform(voxel_size));
    }
    grid.setCreator(options.creator);
    grid.insertMeta("subvol_field", openvdb::StringMetadata(grid.getName()));
    for (const auto& [name, text] : options.metadata) grid.insertMeta(name, openvdb::StringMetadata(text));
    grid.setSaveFloatAsHalf(options.half);
}

}  // namespace

std::vector<VdbGrid> rasterize(const HexMesh& mesh, std::span<const std::string> fields, const RasterizeOptions& options) {
    validate(mesh);
    if (fields.empty()) throw Error(ErrorCode::InvalidInput, "no field is named to be rasterized");
    std::vector<const Attribute*> attributes;
    for (const auto& name : fields) attributes.push_back(&field_of(mesh, name, options.half));

    detail::ToVoxels to_voxels;
    if (options.like) {
        to_voxels = to_voxels_of(*options.like->data().grid);
    } else {
        to_voxels.voxel_size = voxel_size_of(bounds(mesh), options);
    }
    detail::CellRasterizer rasterizer({.mesh = &mesh,
                                       .fields = attributes,
                                       .to_voxels = to_voxels,
                                       .refine = options.refine,
                                       .on_limit = options.on_limit,
                                       .cell_numbers = options.cell_numbers,
                                       .progress = options.progress});
    check_representable(to_voxels.voxel_size);

    openvdb::initialize();
    detail::VoxelBricks bricks = rasterizer.run();
    report_progress(options.progress, "make grids", 0);
    const auto grids = detail::make_grids(std::move(bricks), grids_of(attributes, options.cell_numbers));
    if (attributes.front()->channels == 1) grids.front()->setGridClass(openvdb::GRID_FOG_VOLUME);
    std::vector<VdbGrid> result;
    for (const auto& grid : grids) {
        describe(*grid, options, to_voxels.voxel_size);
        result.push_back(make_vdb_grid(grid));
    }
    return result;
}

}  // namespace subvol
