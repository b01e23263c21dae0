// SPDX-License-Identifier: Apache-2.0
#include "field_input.h"

#include <algorithm>

#include "grid_input.h"
#include "input.h"
#include "points_input.h"
#include "subvol/error.h"
#include "subvol/limit_level.h"
#include "subvol/mesh_field.h"
#include "subvol/points_field.h"
#include "text.h"

namespace subvol::cli {
namespace {

constexpr double kVoxels = 200;    // along the longest side: what the limit's tolerance is relative to, as of `vdb`
constexpr double kMaxCells = 8e6;  // the field keeps them all

WithFacts<HexMesh> refined(const HexMesh& mesh, const RefineArguments& refine, Progress* progress) {
    RefineOptions options = refine.options(0, progress);
    if (refine.levels) return refine_reported(mesh, options, Vertices::OnTheLimit);
    const Vec3 size = bounds(mesh).size();
    const double voxel = std::max({size.x, size.y, size.z}) / kVoxels;
    Facts facts;
    const LimitLevel limit = facts.timed(progress, "limit level", [&] {
        return find_limit_level(mesh, options, {.position_world = kLimitTolerance_voxels * voxel, .max_cells = kMaxCells});
    });
    options.levels = limit.level;
    if (!limit.converged) {
        facts.warn(text("level ", limit.level, " was the finest within limits; the last step still changed values by ",
                        limit.value_of_range, " of their range; --levels sets the level"));
    }
    HexMesh fine = facts.unpack(refine_reported(mesh, options, Vertices::OnTheLimit));
    return {std::move(fine), std::move(facts)};
}

FieldInput mesh_field(const std::string& input, const CommonOptions& options, const RefineArguments& refine, Progress* progress,
                      Facts& facts) {
    CommonOptions chosen = is_model(input) ? CommonOptions() : options;  // how a file is read concerns the other field then
    chosen.density = options.density;
    chosen.field = options.field;
    auto mesh =
        std::make_shared<HexMesh>(facts.unpack(with_selected_field(facts.unpack(load_mesh(input, chosen, progress)), chosen)));
    const std::string name = mesh->attributes.front().name;
    auto field = std::make_shared<MeshField>(facts.unpack(refined(*mesh, refine, progress)), name);
    return {field->view(), field, mesh, name};
}

FieldInput points_field(const std::string& input, const CommonOptions& options, Progress* progress, Facts& facts) {
    const RbfVolume volume = facts.unpack(read_points_input(input, progress));
    const std::string name = options.field.value_or(volume.channels.front().name);
    auto field = std::make_shared<PointsField>(volume, find_channel(volume, name, input));
    facts["field"] = name;
    return {field->view(), field, {}, name};
}

FieldInput grid_field(const std::string& input, const CommonOptions& options, Progress* progress, Facts& facts) {
    auto grid = std::make_shared<VdbGrid>(facts.unpack(load_grid(input, options, progress)));
    const GridReport& about = grid->report();
    FieldView view{.value = [grid = grid.get()](const Vec3& x) { return grid->value(x); },
                   .box = box_of(about),
                   .step = about.voxel_size_world / 2};
    return {std::move(view), grid, {}, about.name};
}

}  // namespace

WithFacts<FieldInput> load_field(const std::string& input, const CommonOptions& options, const RefineArguments& refine,
                                 const char* key, Progress* progress) {
    Facts found;
    WithFacts<FieldInput> field;
    switch (kind_of(input)) {
        case InputKind::Mesh:
        case InputKind::Bricks:
            field.value = mesh_field(input, options, refine, progress, found);
            break;
        case InputKind::Points:
            field.value = points_field(input, options, progress, found);
            break;
        case InputKind::Grid:
            field.value = grid_field(input, options, progress, found);
            break;
        case InputKind::Picture:
            throw Error(ErrorCode::InvalidInput, "is not a field", input, "a mesh, points or a .vdb grid");
    }
    for (const Fact& fact : found.all()) {
        const bool shared = fact.name == "seconds" || fact.name == "warnings" || fact.name == "notes";
        (shared ? field.facts : field.facts.group(key))[fact.name] = fact.value;
    }
    return field;
}

}  // namespace subvol::cli
