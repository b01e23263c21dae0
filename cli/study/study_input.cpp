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
#include "subvol/rasterize.h"
#include "subvol/refine.h"
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

HexMesh load(const StudyCase& of) {
    if (of.has("input.file")) return without_unused_points(read_mesh(of.text("input.file")).mesh);
    if (of.text("input.model") == "cell") return one_cell();
    return make_model(of.text("input.model"), of.whole("input.resolution"));
}

}  // namespace

HexMesh study_mesh(const StudyCase& of) {
    HexMesh mesh = load(of);
    if (of.whole("input.refine") > 0) mesh = refine(mesh, {.levels = of.whole("input.refine")});
    const std::string& density = of.text("input.density");
    if (density == "smooth") {
        mesh.attributes = {{"density", 1, smooth_density(mesh)}};
    } else if (!density.empty()) {
        mesh.attributes = {{"density", 1, evaluate_expression(density, mesh.points)}};
    } else {
        const auto field = of.has("input.field") ? std::optional(of.text("input.field")) : std::nullopt;
        mesh.attributes = {select_field(mesh, field).scalar};
    }
    validate(mesh);
    return mesh;
}

VdbGrid study_grid(const StudyCase& of, const HexMesh& mesh, CaseResult& result) {
    const Vec3 size = bounds(mesh).size();
    const double voxel = std::max({size.x, size.y, size.z}) / of.whole("resolution");
    const LimitCells limit = limit_for_voxels(mesh, {}, voxel);
    const std::vector<std::string> names{mesh.attributes.front().name};
    auto grids = vdb().rasterize(mesh, names, {.voxel_size_world = voxel, .limit = &limit, .half = of.flag("half")});
    const GridReport& about = grids.front().report();
    result.metrics["voxels"] = static_cast<double>(about.active_voxels);
    result.metrics["grid_bytes"] = static_cast<double>(about.bytes);
    result.metrics["voxel_size"] = voxel;
    return std::move(grids.front());
}

View study_view(const StudyCase& of, const HexMesh& mesh, const Optics& optics) {
    const int width = of.whole("width"), height = of.whole("height");
    const Box box = of.flag("camera.visible") ? visible_bounds(mesh, optics) : bounds(mesh);
    return {parse_camera(of.text("camera"), box, static_cast<double>(width) / height), width, height};
}

Optics study_optics(const StudyCase& of, const HexMesh& mesh) {
    PictureArguments arguments;
    if (of.has("tf.colors")) arguments.transfer_function = of.text("tf.colors");
    if (of.has("tf.opacity")) arguments.opacity = of.text("tf.opacity");
    if (of.has("tf.opacity_unit")) arguments.opacity_unit_world = of.number("tf.opacity_unit");
    const Range range = field_range(mesh);
    return arguments.make_optics(bounds(mesh), range, range);
}

}  // namespace subvol::cli
