// SPDX-License-Identifier: Apache-2.0
#include "field_input.h"

#include <algorithm>
#include <filesystem>

#include "bricks_input.h"
#include "grid_input.h"
#include "input.h"
#include "points_input.h"
#include "subvol/error.h"
#include "subvol/limit_level.h"
#include "subvol/mesh_field.h"
#include "subvol/mesh_io.h"
#include "subvol/points_field.h"
#include "text.h"

namespace subvol::cli {
namespace {

constexpr double kVoxels = 200;    // along the longest side: what the limit's tolerance is relative to, as of `vdb`
constexpr double kMaxCells = 8e6;  // the field keeps them all

HexMesh refined(const HexMesh& mesh, const RefineArguments& refine, Report& report) {
    RefineOptions options = refine.options(0, report);
    if (refine.levels) return refine_reported(mesh, options, Vertices::OnTheLimit, report);
    const Vec3 size = bounds(mesh).size();
    const double voxel = std::max({size.x, size.y, size.z}) / kVoxels;
    const LimitLevel limit = report.timed("limit level", [&] {
        return find_limit_level(mesh, options, {.position_world = kLimitTolerance_voxels * voxel, .max_cells = kMaxCells});
    });
    options.levels = limit.level;
    if (!limit.converged) {
        report.warn(text("level ", limit.level, " was the finest within limits; the last step still changed values by ",
                         limit.value_of_range, " of their range; --levels sets the level"));
    }
    return refine_reported(mesh, options, Vertices::OnTheLimit, report);
}

FieldInput mesh_field(const std::string& input, const CommonOptions& options, const RefineArguments& refine, Report& report) {
    CommonOptions own = is_model(input) ? CommonOptions() : options;  // how a file is read concerns the other field then
    own.density = options.density;
    own.field = options.field;
    auto mesh = std::make_shared<HexMesh>(with_selected_field(load_mesh(input, own, report), own, report));
    const std::string name = mesh->attributes.front().name;
    auto field = std::make_shared<MeshField>(refined(*mesh, refine, report), name);
    return {field->view(), field, mesh, name};
}

FieldInput points_field(const std::string& input, const CommonOptions& options, Report& report) {
    const RbfVolume volume = read_points_input(input, report);
    const std::string name = options.field.value_or(volume.channels.front().name);
    auto field = std::make_shared<PointsField>(volume, find_channel(volume, name, input));
    report["field"] = name;
    return {field->view(), field, {}, name};
}

FieldInput grid_field(const std::string& input, const CommonOptions& options, Report& report) {
    auto grid = std::make_shared<VdbGrid>(load_grid(input, options, report));
    const GridReport& about = grid->report();
    FieldView view{.value = [grid = grid.get()](const Vec3& x) { return grid->value(x); },
                   .box = box_of(about),
                   .step = about.voxel_size_world / 2};
    return {std::move(view), grid, {}, about.name};
}

}  // namespace

InputKind kind_of(const std::string& input) {
    const std::string extension = extension_of(input);
    const std::vector<std::string> meshes = readable_mesh_extensions();
    const bool is_mesh =
        input.starts_with("model:") || std::ranges::find(meshes, extension) != meshes.end() || is_bricks_input(input);
    if (is_mesh) return InputKind::Mesh;
    if (holds_points(input)) return InputKind::Points;
    return is_vdb_file(input) ? InputKind::Grid : InputKind::Picture;
}

FieldInput load_field(const std::string& input, const CommonOptions& options, const RefineArguments& refine, const char* key,
                      Report& report) {
    report["input"] = input;  // for errors
    Report part(options);
    FieldInput field;
    switch (kind_of(input)) {
        case InputKind::Mesh:
            field = mesh_field(input, options, refine, part);
            break;
        case InputKind::Points:
            field = points_field(input, options, part);
            break;
        case InputKind::Grid:
            field = grid_field(input, options, part);
            break;
        case InputKind::Picture:
            throw Error(ErrorCode::InvalidInput, "is not a field", input, "a mesh, points or a .vdb grid");
    }
    for (const auto& [name, value] : part.json().items()) {
        if (name == "seconds") {
            for (const auto& [stage, seconds] : value.items()) report.add_seconds(stage, seconds.template get<double>());
        } else if (name == "warnings") {
            for (const Json& warning : value) report["warnings"].push_back(warning);
        } else {
            report[key][name] = value;
        }
    }
    return field;
}

}  // namespace subvol::cli
