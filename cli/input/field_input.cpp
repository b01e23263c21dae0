// SPDX-License-Identifier: Apache-2.0
#include "field_input.h"

#include <algorithm>

#include "grid_input.h"
#include "input.h"
#include "points_input.h"
#include "subvol/error.h"
#include "subvol/mesh_field.h"
#include "subvol/points_field.h"
#include "text.h"

namespace subvol::cli {
namespace {

FieldInput mesh_field(const std::string& input, const CommonOptions& options, const RefineArguments& refine, Progress* progress,
                      KeepMesh keep, Facts& facts) {
    CommonOptions chosen = is_model(input) ? CommonOptions() : options;  // how a file is read concerns the other field then
    chosen.density = options.density;
    chosen.field = options.field;
    chosen.warp = options.warp;
    chosen.only = options.only;
    FieldInput made;
    HexMesh all = facts.unpack(load_mesh(input, chosen, progress, made.sets));
    if (keep == KeepMesh::Yes) made.read = std::make_shared<HexMesh>(all);
    auto mesh = std::make_shared<HexMesh>(facts.unpack(with_selected_field(std::move(all), chosen)));
    const std::string name = mesh->attributes.front().name;
    made.mesh = mesh;
    made.field = name;
    const RefineOptions refinement = refine.options(0, progress);
    if (refine.levels) {
        auto field = std::make_shared<MeshField>(facts.unpack(refine_reported(*mesh, refinement, Vertices::OnTheLimit)), name);
        made.view = field->view();
        made.owner = field;
        return made;
    }
    auto field = facts.timed(progress, "limit", [&] { return std::make_shared<LimitField>(*mesh, name, refinement); });
    const LimitCells& limit = field->limit();
    facts["pieces"] = limit.piece_count;
    Facts& deviation = facts.group("limit_deviation");
    deviation["position_world"] = limit.position_world;
    deviation["of_range"] = limit.value_of_range;
    made.view = view_of(*field);
    made.owner = field;
    return made;
}

FieldInput points_field(const std::string& input, const CommonOptions& options, Progress* progress, Facts& facts) {
    const RbfVolume volume = facts.unpack(read_points_input(input, progress));
    const std::string name = options.field.value_or(volume.channels.front().name);
    auto field = std::make_shared<PointsField>(volume, find_channel(volume, name, input));
    facts["field"] = name;
    return {.view = field->view(), .owner = field, .mesh = {}, .field = name};
}

FieldInput grid_field(const std::string& input, const CommonOptions& options, Progress* progress, Facts& facts) {
    auto grid = std::make_shared<VdbGrid>(facts.unpack(load_grid(input, options, progress)));
    const GridReport& about = grid->report();
    FieldView view{.value = [grid = grid.get()](const Vec3& x) { return grid->value(x); },
                   .box = box_of(about),
                   .step = about.voxel_size_world / 2};
    return {.view = std::move(view), .owner = grid, .mesh = {}, .field = about.name};
}

}  // namespace

WithFacts<FieldInput> load_field(const std::string& input, const CommonOptions& options, const RefineArguments& refine,
                                 const char* key, Progress* progress, KeepMesh keep) {
    Facts found;
    WithFacts<FieldInput> field;
    switch (kind_of(input)) {
        case InputKind::Mesh:
        case InputKind::Bricks:
            field.value = mesh_field(input, options, refine, progress, keep, found);
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
