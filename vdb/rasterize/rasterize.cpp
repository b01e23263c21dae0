// SPDX-License-Identifier: Apache-2.0
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "brick_grids.h"
#include "coverage.h"
#include "distance_band.h"
#include "grid_setup.h"
#include "level_set.h"
#include "rasterize_cells.h"
#include "subvol/error.h"
#include "subvol/mesh_report.h"
#include "vdb_data.h"

namespace subvol {

using namespace detail;

namespace {

using detail::GridKind;
using detail::GridOfChannels;

constexpr double kMaxHalf = 65504;
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

/// Everything that is checked and set up once, for one part of space after the other.
class Rasterizer {
public:
    Rasterizer(const HexMesh& mesh, std::span<const std::string> fields, const RasterizeOptions& options)
        : options_(options), rasterizer_(request(mesh, fields, options)) {
        detail::check_representable(to_voxels_.voxel_size);
        const detail::RasterizeCells shape = request(mesh, options);
        if (options.coverage) samples_.emplace(detail::samples_within(shape));
        if (options.level_set) {
            detail::check_level_set(options);
            boundary_ = detail::boundary_triangles(shape);
            detail::check_band(boundary_, options.level_set->half_width_voxels);
        }
        openvdb::initialize();
    }

    [[nodiscard]] const detail::ToVoxels& to_voxels() const { return to_voxels_; }
    [[nodiscard]] std::size_t bytes_per_voxel() const {
        std::size_t bytes = options_.coverage ? 16 : 0;
        for (const Attribute* field : attributes_) bytes += sizeof(float) * static_cast<std::size_t>(field->channels);
        return bytes + (options_.cell_numbers ? sizeof(std::int32_t) : 0);
    }

    /// part: whole bricks; none: all
    [[nodiscard]] std::vector<VdbGrid> run(const std::optional<detail::VoxelBox>& part = {}) {
        detail::VoxelBricks bricks = rasterizer_.run(part);
        report_progress(options_.progress, "make grids", 0);
        auto grids = detail::make_grids(std::move(bricks), grids_of(attributes_, options_.cell_numbers));
        if (attributes_.front()->channels == 1) grids.front()->setGridClass(openvdb::GRID_FOG_VOLUME);
        const auto mask = options_.mask || options_.level_set ? detail::mask_of(*grids.front()) : nullptr;
        if (options_.mask) grids.push_back(mask);
        if (samples_) grids.push_back(coverage(part));
        if (options_.level_set) grids.push_back(level_set(*mask, part));
        std::vector<VdbGrid> result;
        for (const auto& grid : grids) {
            detail::describe(*grid, to_voxels_, options_);
            result.push_back(make_vdb_grid(grid));
        }
        return result;
    }

private:
    detail::RasterizeCells request(const HexMesh& mesh, std::span<const std::string> fields, const RasterizeOptions& options) {
        validate(mesh);
        if (fields.empty()) throw Error(ErrorCode::InvalidInput, "no field is named to be rasterized");
        for (const auto& name : fields) attributes_.push_back(&field_of(mesh, name, options.half));
        to_voxels_ = detail::voxels_asked_for(bounds(mesh), options);
        detail::RasterizeCells all = request(mesh, options);
        all.fields = attributes_;
        all.cell_numbers = options.cell_numbers;
        return all;
    }

    /// Without values.
    [[nodiscard]] detail::RasterizeCells request(const HexMesh& mesh, const RasterizeOptions& options) const {
        detail::RasterizeCells request{.mesh = &mesh,
                                       .fields = {},
                                       .to_voxels = to_voxels_,
                                       .refine = options.refine,
                                       .on_limit = options.on_limit,
                                       .tables = options.tables,
                                       .progress = options.progress};
        if (options.limit) detail::set_limit(*options.limit, request);
        return request;
    }

    [[nodiscard]] openvdb::GridBase::Ptr level_set(const openvdb::MaskGrid& inside,
                                                   const std::optional<detail::VoxelBox>& part) const {
        report_progress(options_.progress, "level set", 0);
        const auto& [name, half_width] = *options_.level_set;
        const auto grid =
            detail::level_set(detail::distance_band(boundary_, half_width, part), inside, to_voxels_.voxel_size, half_width);
        grid->setName(name);
        return grid;
    }

    [[nodiscard]] openvdb::GridBase::Ptr coverage(const std::optional<detail::VoxelBox>& part) {
        std::optional<detail::VoxelBox> of_samples = part;
        if (part) {
            for (std::size_t d = 0; d < 3; ++d) {
                of_samples->lower[d] = std::max(part->lower[d], -kFarthest) * detail::kCoverageSamples;
                of_samples->upper[d] = (std::min(part->upper[d], kFarthest - 1) + 1) * detail::kCoverageSamples - 1;
            }
        }
        const std::vector<GridOfChannels> wanted{{"coverage", GridKind::Float, 0}};
        return detail::make_grids(detail::coverage_of(samples_->run(of_samples)), wanted).front();
    }

    static constexpr int kFarthest = 1 << 28;  // of voxels whose samples have numbers

    const RasterizeOptions& options_;
    std::vector<const Attribute*> attributes_;
    detail::ToVoxels to_voxels_;
    detail::CellRasterizer rasterizer_;
    std::optional<detail::CellRasterizer> samples_;
    std::vector<detail::VoxelTriangle> boundary_;  // of the level set
};

constexpr int kFar = 1 << 30;
constexpr double kOverhead = 2;  // leaves that are not full, the trees above them, what lies beyond the control cells

/// The bytes of the grids in each layer of bricks across x, by the volumes of the control cells. first: the lowest layer
std::vector<double> bytes_of_layers(const HexMesh& mesh, const Rasterizer& rasterizer, int& first) {
    const detail::ToVoxels& to_voxels = rasterizer.to_voxels();
    const auto layer = [](double x) { return static_cast<int>(std::floor(x / detail::kBrickSide)); };
    Box box;
    for (const auto& cell : mesh.cells) {
        for (const Index p : cell) box.add(to_voxels(mesh.points[p]));
    }
    first = layer(box.lower.x);
    std::vector<double> bytes(static_cast<std::size_t>(layer(box.upper.x) - first + 1));
    for (const auto& cell : mesh.cells) {
        std::array<Vec3, 8> corners;
        Box of_cell;
        for (std::size_t k = 0; k < 8; ++k) of_cell.add(corners[k] = to_voxels(mesh.points[cell[k]]));
        const int lower = layer(of_cell.lower.x), upper = layer(of_cell.upper.x);
        const double share =
            std::abs(cell_volume(corners)) * static_cast<double>(rasterizer.bytes_per_voxel()) / (upper - lower + 1);
        for (int l = lower; l <= upper; ++l) bytes[static_cast<std::size_t>(l - first)] += kOverhead * share;
    }
    return bytes;
}

/// Slabs of whole bricks across x; the outermost reach as far as voxels do, for what lies beyond the control cells.
std::vector<detail::VoxelBox> slabs_of(const HexMesh& mesh, const Rasterizer& rasterizer, std::size_t memory_bytes) {
    int first = 0;
    const std::vector<double> bytes = bytes_of_layers(mesh, rasterizer, first);
    std::vector<detail::VoxelBox> slabs{{{-kFar, -kFar, -kFar}, {kFar - 1, kFar - 1, kFar - 1}}};
    double held = 0;
    for (std::size_t l = 0; l < bytes.size(); ++l) {
        if (held > 0 && held + bytes[l] > static_cast<double>(memory_bytes)) {
            const int next = (first + static_cast<int>(l)) * detail::kBrickSide;
            slabs.push_back(slabs.back());
            slabs[slabs.size() - 2].upper[0] = next - 1;
            slabs.back().lower[0] = next;
            held = 0;
        }
        held += bytes[l];
    }
    return slabs;
}

}  // namespace

std::vector<VdbGrid> rasterize(const HexMesh& mesh, std::span<const std::string> fields, const RasterizeOptions& options) {
    return Rasterizer(mesh, fields, options).run();
}

RefinementTables rasterization_tables(const HexMesh& mesh, const RasterizeOptions& options) {
    detail::RasterizeCells request;
    request.refine = options.refine;
    request.on_limit = options.on_limit;
    if (options.limit) detail::set_limit(*options.limit, request);
    request.refine.levels = request.levels();
    return detail::tables_of(mesh, request.refine, request.on_limit);
}

void rasterize_parts(const HexMesh& mesh, std::span<const std::string> fields, const RasterizeOptions& options,
                     std::size_t memory_bytes, const std::function<void(GridPart)>& take) {
    Rasterizer rasterizer(mesh, fields, options);
    const auto slabs = slabs_of(mesh, rasterizer, memory_bytes);
    for (std::size_t s = 0; s < slabs.size(); ++s) {
        take({static_cast<int>(s), static_cast<int>(slabs.size()), rasterizer.run(slabs[s])});
    }
}

}  // namespace subvol
