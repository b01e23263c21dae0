// SPDX-License-Identifier: Apache-2.0
#include "study_input.h"

#include <algorithm>
#include <cmath>

#include "input.h"
#include "picture_arguments.h"
#include "subvol/expression.h"
#include "subvol/limit_level.h"
#include "subvol/mesh_io.h"
#include "subvol/model.h"
#include "subvol/option.h"
#include "subvol/quantity.h"
#include "subvol/rasterize.h"
#include "subvol/refine.h"
#include "subvol/region.h"
#include "subvol/warp.h"
#include "vdb_functions.h"

namespace subvol::cli {
namespace {

/// A unit cube of one cell; its density is not trilinear after refinement.
HexMesh one_cell() {
    HexMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    mesh.cells = {{0, 1, 2, 3, 4, 5, 6, 7}};
    mesh.attributes = {{"density", 1, {-1, 0, .5, 1, 0, 1, -.5, .25}}};
    return mesh;
}

std::vector<double> smooth_density(const HexMesh& mesh) {
    const Box box = bounds(mesh);
    const double unit = 2 / box.diagonal() * std::sqrt(3.0);
    std::vector<double> values;
    for (const Vec3& p : mesh.points) {
        const Vec3 x = unit * (p - box.center());
        values.push_back(.5 * (std::sin(3 * x.x) * std::cos(2 * x.y) + x.z));
    }
    return values;
}

/// sets: of the file's cells
HexMesh load(const StudyCase& item, MeshSets& sets) {
    if (item.has("input.file")) {
        ReadOptions options;
        if (item.has("crease_angle")) options.crease_angle_deg = 0;  // the method says which edges are sharp
        if (item.has("input.crease_angle")) {
            const std::vector<Option> described = options_of(options);
            std::ranges::find(described, "crease-angle", &Option::name)->read(item.text("input.crease_angle"), "crease_angle");
        }
        ReadResult read = read_mesh(item.text("input.file"), options);
        sets = std::move(read.sets);
        return without_unused_points(std::move(read.mesh));
    }
    if (item.text("input.model") == "cell") return one_cell();
    return make_model(item.text("input.model"), item.whole("input.resolution"));
}

/// The scalar that the case is about.
Attribute scalar_of(const StudyCase& item, const HexMesh& mesh) {
    const std::string& density = item.text("input.density");
    if (density == "smooth") return {"density", 1, smooth_density(mesh)};
    if (!density.empty()) return {"density", 1, evaluate_expression(density, mesh.points)};
    const auto field = item.has("input.field") ? std::optional(item.text("input.field")) : std::nullopt;
    return select_field(mesh, field).scalar;
}

}  // namespace

HexMesh study_mesh(const StudyCase& item) {
    MeshSets sets;
    HexMesh mesh = load(item, sets);
    if (item.whole("input.refine") > 0) {
        mesh = refine(mesh, {.levels = item.whole("input.refine")});
        sets = {};  // of the file's cells
    }
    // As with --only and --warp of the command, the field is that of the whole mesh at rest.
    mesh.attributes.push_back(scalar_of(item, mesh));
    if (item.has("input.only")) {
        const std::vector<std::string> region{item.text("input.only")};
        mesh = only_cells(mesh, cells_in(mesh, parse_regions(region), sets));
    }
    if (item.has("input.warp")) move_points(mesh, parse_warp(item.text("input.warp")));
    mesh.attributes = {Attribute(std::move(mesh.attributes.back()))};
    validate(mesh);
    return mesh;
}

VdbGrid study_grid(const StudyCase& item, const HexMesh& mesh, CaseResult& result) {
    const Vec3 size = bounds(mesh).size();
    const double voxel = std::max({size.x, size.y, size.z}) / item.whole("resolution");
    const LimitCells limit = limit_for_voxels(mesh, {}, voxel);
    const std::vector<std::string> names{mesh.attributes.front().name};
    auto grids = vdb().rasterize(mesh, names, {.voxel_size_world = voxel, .limit = &limit, .half = item.flag("half")});
    const GridReport& about = grids.front().report();
    result.metrics["voxels"] = static_cast<double>(about.active_voxels);
    result.metrics["grid_bytes"] = static_cast<double>(about.bytes);
    result.metrics["voxel_size"] = voxel;
    return std::move(grids.front());
}

View study_view(const StudyCase& item, const HexMesh& mesh, const Optics& optics) {
    const int width = item.whole("width"), height = item.whole("height");
    const Box box = item.flag("camera.visible") ? visible_bounds(mesh, optics) : bounds(mesh);
    return {parse_camera(item.text("camera"), box, static_cast<double>(width) / height), width, height};
}

Optics study_optics(const StudyCase& item, const HexMesh& mesh) {
    LookChoices choices;
    if (item.has("tf.colors")) choices.colors = item.text("tf.colors");
    if (item.has("tf.opacity")) choices.opacity = item.text("tf.opacity");
    if (item.has("tf.opacity_unit")) choices.opacity_unit_world = item.number("tf.opacity_unit");
    const Range range = field_range(mesh);
    return picture_optics(look_options(choices, Look::Volume, range, OptionNames::Flags), bounds(mesh), range, range);
}

}  // namespace subvol::cli
