// SPDX-License-Identifier: Apache-2.0
// Meshes into OpenVDB grids. Arguments are checked and collected in a request: fields, the map to voxels, levels or pieces of
// the limit, and which cells are filled. Then, for all of space or for one part after the other:
//
//     request ─► bricks of voxels ─► a grid for each field (3 channels: vectors), and for cell numbers
//                                 ├► mask: the active voxels
//                                 ├► coverage: a second filler on a finer lattice, counted for each voxel
//                                 └► level set: distances to the boundary, negative where the mask is active
//
// Values are clamped to the bounds of their field, and refused if they do not fit into its floats. Parts are slabs of whole
// bricks across x. Their bytes are estimated from the volumes of control cells; the outermost slabs reach as far as voxel
// indices do, as refined cells may leave the control mesh. With a limit the pieces are taken as they are known, or found while
// voxels are filled.
#include "openvdb_grids.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "boundary_triangles.h"
#include "brick_filler.h"
#include "brick_grids.h"
#include "check_voxels.h"
#include "coverage.h"
#include "distance_band.h"
#include "grid_setup.h"
#include "level_set.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/field_range.h"
#include "subvol/mesh_report.h"
#include "subvol/rasterize.h"
#include "subvol/vdb_contents.h"
#include "vdb_data.h"
#include "voxel_blocks.h"

namespace subvol {

using namespace detail;

namespace {

double largest_float(bool half) {
    return half ? 65504 : static_cast<double>(std::numeric_limits<float>::max());
}

const Attribute& field_of(const HexMesh& mesh, const std::string& name, bool half) {
    const std::string where = "field \"" + name + "\"";
    const Attribute* field = mesh.find_attribute(name);
    if (!field) throw Error(ErrorCode::InvalidInput, "the mesh has no such field", where);
    if (field->channels != 1 && field->channels != 3) {
        throw Error(ErrorCode::InvalidInput, "has " + std::to_string(field->channels) + " channels", where, "one or three");
    }
    const double largest = largest_float(half);
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

/// How a mesh is refined.
///
/// by_tables: all cells have nodes of one level
CellRequest refinement_of(const HexMesh& mesh, const RasterizeOptions& options, bool by_tables) {
    CellRequest request{.mesh = &mesh,
                        .fields = {},
                        .to_voxels = {},
                        .refine = options.refine,
                        .on_limit = options.on_limit,
                        .tables = options.tables,
                        .progress = options.progress};
    if (!options.limit) return request;
    const LimitCells& limit = *options.limit;
    if (!limit.cell_levels.empty() && limit.cell_levels.size() != mesh.cells.size()) {
        throw Error(ErrorCode::InvalidInput, "the cells of the limit belong to another mesh");
    }
    request.refine.levels = limit.level;
    request.curved = !limit.cell_levels.empty();
    request.slack_voxels = kLimitTolerance_voxels;
    request.on_limit = request.curved || !interpolates(request.refine.scheme.kind);
    if (request.curved && !by_tables) request.cell_levels = &limit.cell_levels;
    if (request.curved && by_tables) request.refine.levels = finest_level(limit) - 1;
    return request;
}

/// Takes the limit's pieces, if it has some, and they are those of the mesh and its fields.
void take_pieces(const LimitCells& limit, CellRequest& request) {
    if (!limit.pieces || !are_pieces_of(*limit.pieces, *request.mesh)) return;
    for (const Attribute* field : request.fields) {
        const auto place = place_in(*limit.pieces, *field);
        if (!place) return;
        request.places_in_pieces.push_back(*place);
    }
    request.pieces = limit.pieces.get();
}

/// Checks the arguments, and collects what is to be rasterized.
CellRequest make_request(const HexMesh& mesh, std::span<const std::string> fields, const RasterizeOptions& options) {
    validate(mesh);
    if (fields.empty()) throw Error(ErrorCode::InvalidInput, "no field is named to be rasterized");
    std::vector<const Attribute*> attributes;
    for (const auto& name : fields) attributes.push_back(&field_of(mesh, name, options.half));
    if (!options.cells.empty() && options.cells.size() != mesh.cells.size()) {
        throw Error(ErrorCode::InvalidInput, "there are " + std::to_string(options.cells.size()) + " numbers of cells", "cells",
                    "one for each of the " + std::to_string(mesh.cells.size()) + " cells");
    }
    const ToVoxels to_voxels = to_voxels_of(rasterized_box(mesh, options), options);
    CellRequest request = refinement_of(mesh, options, options.tables != nullptr);
    request.fields = std::move(attributes);
    if (options.limit && !options.tables) take_pieces(*options.limit, request);
    request.to_voxels = to_voxels;
    request.cell_numbers = options.cell_numbers;
    request.numbers = options.cells;
    return request;
}

std::size_t bytes_per_voxel(const CellRequest& request, const RasterizeOptions& options) {
    std::size_t bytes = options.coverage ? 16 : 0;
    for (const Attribute* field : request.fields) bytes += sizeof(float) * static_cast<std::size_t>(field->channels);
    return bytes + (request.cell_numbers ? sizeof(std::int32_t) : 0);
}

/// Makes grids from a mesh, for one part of space after the other.
class MeshRasterizer {
public:
    MeshRasterizer(const CellRequest& request, const RasterizeOptions& options)
        : request_(request), options_(options), filler_(request) {
        check_representable(request.to_voxels.voxel_size);
        if (options.coverage) samples_.emplace(samples_within(request));
        if (options.level_set) {
            check_level_set(options);
            boundary_ = boundary_triangles(request);
            check_band(boundary_, options.level_set->half_width_voxels);
        }
        openvdb::initialize();
    }

    /// part: whole bricks; none: all
    [[nodiscard]] std::vector<VdbGrid> run(const std::optional<VoxelBox>& part = {}) {
        VoxelBricks bricks = filler_.run(part);
        report_progress(options_.progress, "make grids", 0);
        auto grids = make_grids(std::move(bricks), grids_of(request_.fields, request_.cell_numbers));
        if (request_.fields.front()->channels == 1) grids.front()->setGridClass(openvdb::GRID_FOG_VOLUME);
        const auto mask = options_.mask || options_.level_set ? mask_of(*grids.front()) : nullptr;
        if (options_.mask) grids.push_back(mask);
        if (samples_) grids.push_back(coverage(part));
        if (options_.level_set) grids.push_back(distances(*mask, part));
        std::vector<VdbGrid> result;
        const Box frame = rasterized_box(*request_.mesh, options_);
        for (std::size_t g = 0; g < grids.size(); ++g) {
            describe(*grids[g], request_.to_voxels, options_, frame);
            result.push_back(make_vdb_grid(grids[g]));
            if (g < request_.fields.size()) finish(*request_.fields[g], result.back());
        }
        return result;
    }

    [[nodiscard]] bool folded() const { return filler_.folded(); }
    [[nodiscard]] LimitCells& found() { return filler_.found(); }

private:
    /// Keeps values within the field's bounds, and refuses those that its floats cannot hold: schemes overshoot between points.
    void finish(const Attribute& field, VdbGrid& grid) const {
        if (const auto bounds = bounds_of(field)) clamp_voxels(grid, *bounds);
        const double low = grid.report().min, high = grid.report().max;  // of a vector its length
        const double allowed = (field.channels == 3 ? std::sqrt(3.) : 1) * largest_float(options_.half);
        if (std::max(std::abs(low), std::abs(high)) <= allowed) return;
        throw Error(ErrorCode::InvalidInput,
                    "reaches " + number_text(std::abs(low) > std::abs(high) ? low : high) +
                        " between points, which does not fit into a " + (options_.half ? "16" : "32") + "-bit float",
                    "field \"" + field.name + "\"", "values clamped to the field's range, or larger floats");
    }

    [[nodiscard]] openvdb::GridBase::Ptr distances(const openvdb::MaskGrid& inside, const std::optional<VoxelBox>& part) const {
        report_progress(options_.progress, "level set", 0);
        const auto& [name, half_width] = *options_.level_set;
        const auto grid =
            level_set(distance_band(boundary_, half_width, part), inside, request_.to_voxels.voxel_size, half_width);
        grid->setName(name);
        return grid;
    }

    [[nodiscard]] openvdb::GridBase::Ptr coverage(const std::optional<VoxelBox>& part) {
        std::optional<VoxelBox> of_samples = part;
        if (part) {
            for (std::size_t d = 0; d < 3; ++d) {
                of_samples->lower[d] = std::max(part->lower[d], -kFarthest) * kCoverageSamples;
                of_samples->upper[d] = (std::min(part->upper[d], kFarthest - 1) + 1) * kCoverageSamples - 1;
            }
        }
        const std::vector<GridOfChannels> wanted{{"coverage", GridKind::Float, 0}};
        return make_grids(coverage_of(samples_->run(of_samples)), wanted).front();
    }

    static constexpr int kFarthest = 1 << 28;  // voxels: beyond, the indices of their samples would overflow

    CellRequest request_;
    const RasterizeOptions& options_;
    BrickFiller filler_;
    std::optional<BrickFiller> samples_;   // of coverage
    std::vector<VoxelTriangle> boundary_;  // of the level set
};

constexpr int kFar = 1 << 30;
constexpr double kOverhead = 2;  // for partly filled leaves, inner nodes, and what lies beyond the control cells

/// Estimates the bytes of the grids in each layer of bricks across x from the volumes of the control cells.
///
/// first: set to the lowest layer
std::vector<double> bytes_of_layers(const CellRequest& request, std::size_t bytes_per_voxel, int& first) {
    const HexMesh& mesh = *request.mesh;
    const ToVoxels& to_voxels = request.to_voxels;
    const auto layer = [](double x) { return static_cast<int>(std::floor(x / kBrickSide)); };
    Box box;
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        if (!request.fills(c)) continue;
        for (const Index p : mesh.cells[c]) box.add(to_voxels(mesh.points[p]));
    }
    first = layer(box.lower.x);
    std::vector<double> bytes(static_cast<std::size_t>(layer(box.upper.x) - first + 1));
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        if (!request.fills(c)) continue;
        const auto& cell = mesh.cells[c];
        std::array<Vec3, 8> corners;
        Box of_cell;
        for (std::size_t k = 0; k < 8; ++k) of_cell.add(corners[k] = to_voxels(mesh.points[cell[k]]));
        const int lower = layer(of_cell.lower.x), upper = layer(of_cell.upper.x);
        const double share = std::abs(cell_volume(corners)) * static_cast<double>(bytes_per_voxel) / (upper - lower + 1);
        for (int l = lower; l <= upper; ++l) bytes[static_cast<std::size_t>(l - first)] += kOverhead * share;
    }
    return bytes;
}

/// The slab of whole bricks across x that is a share; the outermost two extend to the largest voxel index. No voxels if there
/// are more shares than layers of bricks.
///
/// layers: becomes the range of layers
VoxelBox slab_of_share(const CellRequest& request, std::size_t bytes_per_voxel, const Share& share, ShareRange& layers) {
    constexpr VoxelBox kNowhere{{kBrickSide, kBrickSide, kBrickSide}, {kBrickSide - 1, kBrickSide - 1, kBrickSide - 1}};
    int first = 0;
    const std::vector<double> bytes = bytes_of_layers(request, bytes_per_voxel, first);
    const auto [begin, end] = share.range_by_weight(bytes);
    layers = {begin, end, bytes.size()};
    if (begin >= end) return kNowhere;
    const auto layer = [&](std::size_t number) { return (first + static_cast<int>(number)) * kBrickSide; };
    return VoxelBox{{begin == 0 ? -kFar : layer(begin), -kFar, -kFar},
                    {end == bytes.size() ? kFar - 1 : layer(end) - 1, kFar - 1, kFar - 1}};
}

/// Slabs of whole bricks across x. The outermost two extend to the largest voxel index, as refined cells may lie beyond the
/// control cells.
std::vector<VoxelBox> slabs_of(const CellRequest& request, std::size_t bytes_per_voxel, std::size_t memory_bytes) {
    int first = 0;
    const std::vector<double> bytes = bytes_of_layers(request, bytes_per_voxel, first);
    std::vector<VoxelBox> slabs{{{-kFar, -kFar, -kFar}, {kFar - 1, kFar - 1, kFar - 1}}};
    double held = 0;
    for (std::size_t l = 0; l < bytes.size(); ++l) {
        if (held > 0 && held + bytes[l] > static_cast<double>(memory_bytes)) {
            const int next = (first + static_cast<int>(l)) * kBrickSide;
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

void check_voxels(const HexMesh& mesh, const RasterizeOptions& options) {
    const ToVoxels to_voxels = to_voxels_of(rasterized_box(mesh, options), options);
    (void)check_voxel_count(mesh, to_voxels, options.cells);
    check_representable(to_voxels.voxel_size);
    if (options.level_set) check_level_set(options);
}

std::vector<VdbGrid> rasterize(const HexMesh& mesh, std::span<const std::string> fields, const RasterizeOptions& options) {
    return MeshRasterizer(make_request(mesh, fields, options), options).run();
}

LimitGrids rasterize_limit(const HexMesh& mesh, std::span<const std::string> fields, const RasterizeOptions& options) {
    if (options.coverage || options.level_set) {
        throw Error(ErrorCode::InvalidInput, "the limit is found for voxels only, not for coverage and level sets");
    }
    CellRequest request = make_request(mesh, fields, options);
    const double voxel = options.voxel_size_world > 0 ? options.voxel_size_world : request.to_voxels.voxel_size;
    const LimitCellsOptions search{.position_world = kLimitTolerance_voxels * voxel};
    request.search = &search;
    request.curved = request.on_limit = true;
    request.slack_voxels = kLimitTolerance_voxels;
    request.refine.levels = 0;
    for (const Attribute* field : request.fields) {
        std::size_t place = 3;
        for (const Attribute* before = mesh.attributes.data(); before != field; ++before) {
            place += static_cast<std::size_t>(before->channels);
        }
        request.places_in_pieces.push_back(place);
    }
    MeshRasterizer rasterizer(request, options);
    std::vector<VdbGrid> grids = rasterizer.run();
    return {std::move(grids), std::move(rasterizer.found())};
}

RefinementTables rasterization_tables(const HexMesh& mesh, const RasterizeOptions& options) {
    CellRequest request = refinement_of(mesh, options, true);
    request.refine.levels = request.levels();
    return tables_of(mesh, request.refine, request.on_limit);
}

PartsReport rasterize_parts(const MeshSource& source, std::span<const std::string> fields, const RasterizeOptions& options,
                            std::size_t memory_bytes, const std::function<void(GridPart)>& take) {
    if (source.mesh() == nullptr) return rasterize_blocks(source, fields, options, static_cast<double>(memory_bytes), take);
    const CellRequest request = make_request(*source.mesh(), fields, options);
    MeshRasterizer rasterizer(request, options);
    const auto slabs = slabs_of(request, bytes_per_voxel(request, options), memory_bytes);
    for (std::size_t s = 0; s < slabs.size(); ++s) {
        take({static_cast<int>(s), static_cast<int>(slabs.size()), rasterizer.run(slabs[s])});
    }
    return {};
}

BlockGrids detail::rasterize_block(const HexMesh& part, std::span<const std::string> fields, const RasterizeOptions& options,
                                   const VoxelCubes& block) {
    static_assert(VoxelCubes::kSide == kBrickSide);
    if (options.cell_numbers || options.coverage || options.level_set) {
        throw Error(ErrorCode::InvalidInput, "blocks of voxels have no cell numbers, coverage and level sets");
    }
    if (!options.like && !(options.voxel_size_world > 0)) {
        throw Error(ErrorCode::InvalidInput, "blocks of voxels need a voxel size");
    }
    const CellRequest request = make_request(part, fields, options);
    MeshRasterizer rasterizer(request, options);
    VoxelBox box;
    for (std::size_t d = 0; d < 3; ++d) {
        box.lower[d] = block.lower[d] * kBrickSide;
        box.upper[d] = block.upper[d] * kBrickSide - 1;
    }
    BlockGrids result{rasterizer.run(box), false};
    result.folded = rasterizer.folded();
    return result;
}

GridShare rasterize_share(const MeshSource& source, std::span<const std::string> fields, const RasterizeOptions& options,
                          const Share& share) {
    validate(share);
    if (source.mesh() == nullptr) return rasterize_share_of_pieces(source, fields, options, share);
    const CellRequest request = make_request(*source.mesh(), fields, options);
    MeshRasterizer rasterizer(request, options);
    GridShare made;
    made.grids = rasterizer.run(slab_of_share(request, bytes_per_voxel(request, options), share, made.layers));
    return made;
}

}  // namespace subvol
