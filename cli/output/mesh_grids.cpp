// SPDX-License-Identifier: Apache-2.0
#include "mesh_grids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "input.h"
#include "quantities.h"
#include "subvol/error.h"
#include "subvol/field_range.h"
#include "subvol/grid_error.h"
#include "subvol/mesh_motion.h"
#include "subvol/mesh_report.h"
#include "subvol/part_of_limit.h"
#include "subvol/region.h"
#include "subvol/vdb_contents.h"
#include "subvol/version.h"
#include "text.h"
#include "vdb_functions.h"
#include "voxels_of_points.h"

namespace subvol::cli {
namespace {

constexpr double kBytesOfChannel = 5.5;             // a voxel's float in leaves that are not all full, with their masks
constexpr std::size_t kManyCells = 1 << 18;         // whose pieces of the limit are not kept: 450 bytes each
constexpr const char* kLevelName = "subvol_level";  // of a grid's text

Facts facts_of(const LimitCells& limit, const HexMesh& mesh, double voxel_size) {
    Facts facts;
    const int levels = finest_level(limit);
    facts["levels"] = levels;
    facts["cells"] = limit.piece_count;
    Facts& deviation = facts.group("limit_deviation");
    deviation["voxels"] = limit.position_world / voxel_size;
    double rounding = 0;  // where floats lose more than the origin of their values keeps
    for (const Attribute& field : mesh.attributes) {
        const auto [low, high] = std::ranges::minmax(own_values(field));
        if (value_origin(low, high) != 0) rounding = std::max(rounding, float_rounding(field));
    }
    deviation["of_range"] = limit.value_of_range + rounding;
    if (!limit.converged) {
        facts.warn(text("level ", levels, " was the finest within limits; the last step still moved points by ",
                        limit.position_world / voxel_size, " voxels and values by ", limit.value_of_range, " of their range"));
    }
    return facts;
}

/// The velocity of a flow: a vector field with the name of one.
std::optional<Attribute> flow_of(const HexMesh& mesh) {
    constexpr std::array<std::string_view, 8> kNames{"U", "V", "vel", "Vel", "VEL", "velocity", "Velocity", "VELOCITY"};
    for (const std::string_view name : kNames) {
        const Attribute* field = mesh.find_attribute(name);
        if (field != nullptr && field->channels == 3) return *field;
    }
    return std::nullopt;
}

}  // namespace

WithFacts<LimitCells> reported_limit(const HexMesh& mesh, const RefineOptions& refinement, double voxel_size) {
    Facts facts;
    LimitCells limit =
        facts.timed(refinement.progress, "limit level", [&] { return limit_for_voxels(mesh, refinement, voxel_size); });
    facts.merge(facts_of(limit, mesh, voxel_size));
    return {std::move(limit), std::move(facts)};
}

const HexMesh& rasterized_cells(const HexMesh& mesh, std::span<const Index> cells, HexMesh& part) {
    if (cells.empty()) return mesh;
    std::vector<std::uint8_t> flags;
    for (const Index number : cells) flags.push_back(number != kNone);
    part = only_cells(mesh, flags);
    return part;
}

MeshGrids::MeshGrids(std::string input, const VdbArguments& asked, RefineArguments& refine)
    : input_(std::move(input)), asked_(asked), refine_(refine), fields_(asked), tets_(refine) {
    if (!asked.like.empty()) like_grids_ = vdb().read_vdb(asked.like);
}

WithFacts<HexMesh> MeshGrids::load(const std::string& input, const CommonOptions& options, Progress* progress,
                                   std::vector<Index>* numbers) const {
    Facts facts;
    CommonOptions reading = options;
    for (const GridField& field : fields_.asked()) reading.at_rest.push_back(field.source);
    reading.parts_in_whole = numbers != nullptr && !tets_.asked() && asked_.from != "points";
    if (numbers == nullptr) reading.part_levels = 0;  // meshes of a sequence have the same cells
    Reshaped reshaped;
    ReadResult read = facts.unpack(read_input(input, reading, progress, ShellsAlone::Refuse, &reshaped));
    HexMesh mesh = facts.unpack(mesh_of(std::move(read), reading, nullptr));
    if (!reshaped.in_part.empty()) {
        PartWithHalo part = part_with_halo(mesh, reshaped.in_part);
        mesh = std::move(part.mesh);
        *numbers = std::move(part.numbers);
    }
    mesh = facts.unpack(tets_.hexes(std::move(mesh), 2, progress));
    std::optional<Attribute> flow;
    if (asked_.velocity) flow = flow_of(mesh);
    mesh = facts.unpack(fields_.chosen(std::move(mesh), options));
    if (flow && mesh.find_attribute(kVelocity) == nullptr) {
        facts.note("vel is the field " + flow->name + ", unless the mesh moves");
        for (double& v : flow->values) v *= asked_.scale;
        flow->name = kVelocity;
        mesh.attributes.push_back(std::move(*flow));
    }
    if (asked_.up == "y") turn_y_up(mesh);
    if (asked_.scale != 1) scale_points(mesh, asked_.scale);
    return {std::move(mesh), std::move(facts)};
}

RasterizeOptions MeshGrids::options(Progress* progress) const {
    return {.like = like_grids_.empty() ? nullptr : &like_grids_.front(),
            .half = asked_.grids.half,
            .cell_numbers = asked_.grids.cell_numbers,
            .mask = asked_.grids.mask,
            .coverage = asked_.grids.coverage,
            .metadata = {{"subvol_input", input_}, {"subvol_from", asked_.from}, {"subvol_version", SUBVOL_VERSION}},
            .progress = progress};
}

double MeshGrids::voxel_size_world(const HexMesh& mesh, const RasterizeOptions& options) const {
    if (!like_grids_.empty()) return like_grids_.front().report().voxel_size_world;
    if (asked_.grids.voxel_size_world > 0) return asked_.grids.voxel_size_world;
    if (asked_.budget_bytes > 0) {
        double channels = asked_.grids.cell_numbers ? 1 : 0;
        for (const Attribute& attribute : mesh.attributes) channels += attribute.channels;
        HexMesh part;
        return std::cbrt(std::abs(measure_cells(rasterized_cells(mesh, options.cells, part)).volume) * kBytesOfChannel *
                         channels / static_cast<double>(asked_.budget_bytes));
    }
    return voxel_size_of(rasterized_box(mesh, options), asked_.grids);
}

WithFacts<RasterizeOptions> MeshGrids::set_up(const HexMesh& mesh, Progress* progress, bool once,
                                              std::span<const Index> cells) {
    Facts facts;
    RasterizeOptions options = this->options(progress);
    options.cells = cells;
    const double voxel_size = voxel_size_world(mesh, options);
    options.voxel_size_world = voxel_size;
    options.level_set = asked_.level_set();
    vdb().check_voxels(mesh, options);
    RefineOptions refinement = refine_.options(0, progress);
    int levels = refinement.levels;
    options.find_limit = !refine_.levels && once && mesh.cells.size() > kManyCells && asked_.from != "points" &&
                         !options.coverage && !options.level_set;
    if (refine_.levels) {
        facts["levels"] = refinement.levels;
        facts["cells"] = mesh.cells.size() << (3 * refinement.levels);
    } else if (!options.find_limit) {
        limit_ = facts.unpack(reported_limit(mesh, refinement, voxel_size));
        levels = finest_level(limit_);
    }
    options.refine = refinement;
    options.on_limit = !interpolates(refinement.scheme.kind);
    options.limit = refine_.levels || options.find_limit ? nullptr : &limit_;
    if (options.level_set && mesh.find_attribute(options.level_set->name)) {
        throw Error(ErrorCode::InvalidInput, "the mesh has a field of this name", options.level_set->name,
                    "--sdf with another name");
    }
    options.metadata.emplace_back("subvol_scheme", tets_.asked() ? tets_.name() : refine_.scheme);
    if (!options.find_limit) options.metadata.emplace_back(kLevelName, std::to_string(levels));
    for (const Attribute& field : mesh.attributes) facts.warn(rounding_warning(field, options.half));
    return {std::move(options), std::move(facts)};
}

WithFacts<std::vector<VdbGrid>> MeshGrids::make(const HexMesh& mesh, const RasterizeOptions& options) const {
    WithFacts<std::vector<VdbGrid>> made;
    if (asked_.from == "points") {
        made = kernel_sums(mesh, options, asked_.per_edge);
    } else if (options.find_limit) {
        LimitGrids found = made.facts.timed(options.progress, "rasterize",
                                            [&] { return vdb().rasterize_limit(mesh, names_of(mesh), options); });
        made.facts.merge(facts_of(found.limit, mesh, options.voxel_size_world));
        made.value = std::move(found.grids);
        for (VdbGrid& grid : made.value) vdb().set_text_of_grid(grid, kLevelName, std::to_string(finest_level(found.limit)));
    } else {
        made.value =
            made.facts.timed(options.progress, "rasterize", [&] { return vdb().rasterize(mesh, names_of(mesh), options); });
    }
    fields_.clamp(mesh, made.value);
    return made;
}

WithFacts<std::vector<GridErrorFigures>> MeshGrids::add_errors(const HexMesh& mesh, const RasterizeOptions& options,
                                                               std::vector<VdbGrid>& grids) const {
    WithFacts<std::vector<GridErrorFigures>> result;
    const std::size_t count = grids.size();
    std::size_t outside = 0;
    for (std::size_t g = 0; g < count; ++g) {
        const Attribute* field = mesh.find_attribute(grids[g].report().name);
        if (field == nullptr || field->channels != 1) continue;
        GridError error = result.facts.timed(options.progress, "error", [&] {
            return vdb().grid_error(grids[g], mesh, field->name,
                                    {.scheme = options.refine.scheme, .half = asked_.grids.half, .progress = options.progress});
        });
        result.value.push_back({g, error.max, error.rms});
        outside = std::max(outside, error.outside);
        grids.push_back(std::move(error.grid));
    }
    if (outside > 0) {
        result.facts.note(text(count_text(outside), " voxels' centres lie outside the limit, by less than the grid resolves"));
    }
    return result;
}

}  // namespace subvol::cli
