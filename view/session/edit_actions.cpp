// SPDX-License-Identifier: Apache-2.0
#include "view_actions.h"

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "action_values.h"
#include "seen_view.h"
#include "subvol/edit_mesh.h"
#include "subvol/error.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"
#include "subvol/raster.h"

namespace subvol::detail {

namespace {

using Session = ViewSession::State;

constexpr double kMost = 1e18;

void check_cells(const Session& session) {
    if (session.body->points.volume) throw Error(ErrorCode::InvalidInput, "points have no control mesh to edit");
    if (session.body->tets) {
        throw Error(ErrorCode::InvalidInput, "a level of a scheme of tetrahedra has no control points to edit", {},
                    "the schemes of hexahedra");
    }
}

const Selection& chosen(const Session& session) {
    if (session.selection.empty())
        throw Error(ErrorCode::InvalidInput, "no control point is selected", {}, "select comes first");
    return session.selection;
}

/// Changes a copy of the mesh, or of the coarser level that is edited, which takes its place if all goes well.
template <class Edit>
void edit(Session& session, const Edit& change) {
    HexMesh next = session.handles();
    change(next);
    for (const Vec3& p : next.points) {
        if (!(glm::dot(p, p) < kMost * kMost))
            throw Error(ErrorCode::InvalidInput, "moves a point too far", {}, "at most 1e18");
    }
    session.replace(session.coarse ? session.coarse->change(std::move(next)) : std::move(next));
}

/// The points around the place that the picture shows at a pixel.
Selection under_brush(const Session& session, const Vec2& pixel, double radius_px) {
    const auto picture = session.worker.latest();
    const View view = seen_view(session.state, *session.body);
    if (!(radius_px > 0)) throw Error(ErrorCode::InvalidInput, "the radius is not positive", {}, "[column, row, radius]");
    if (!picture || picture->depth.empty())
        throw Error(ErrorCode::InvalidInput, "this picture has no depths", {}, "method splat");
    const int x = static_cast<int>(pixel.x) / picture->scale, y = static_cast<int>(pixel.y) / picture->scale;
    const bool inside = x >= 0 && y >= 0 && x < picture->image.width && y < picture->image.height;
    const double depth =
        inside ? double{picture->depth[pixel_index(picture->image.width, x, y)]} : std::numeric_limits<double>::infinity();
    if (!std::isfinite(depth)) throw Error(ErrorCode::InvalidInput, "nothing is under the brush");
    const Ray ray = view.ray(pixel.x, pixel.y);
    const double radius = radius_px * view.pixel() * (view.perspective() ? depth : 1);
    return select_ball(session.handles(), ray.origin + depth * ray.direction, radius);
}

Vec3 center_of(const Session& session, const Json& value) {
    return value.contains("center") ? vector(value["center"]) : middle_of(session.handles(), session.selection);
}

Vec3 axis_of(const Json& value) {
    const Vec3 axis = value.contains("axis") ? vector(value["axis"]) : Vec3(0, 0, 1);
    if (!(glm::length(axis) > 0)) throw Error(ErrorCode::InvalidInput, "the axis has no length");
    return axis;
}

double angle_of(const Json& value) {
    return number(member(value, "angle"), -3600, 3600);
}

}  // namespace

void edit_level(Session& session, const Json& value) {
    const int level = whole_number(value, 0, 10);
    check_cells(session);
    if (level == session.edit_level) return;
    if (level == 0) {
        session.coarse.reset();
    } else {
        session.coarse = CoarseEdit(session.body->mesh, level, session.settings.kernels.sample.scheme);
    }
    session.edit_level = level;
    session.selection.clear();
}

void select(Session& session, const Json& value) {
    check_cells(session);
    const HexMesh& mesh = session.handles();
    if (value.is_null()) {
        session.selection.clear();
        return;
    }
    if (value == "all") {
        session.selection.assign(mesh.points.size(), 1);
        return;
    }
    check_keys(value, {"box", "ball", "pixels", "brush"});
    if (value.size() != 1) throw Error(ErrorCode::InvalidInput, "one of box, ball, pixels and brush selects");
    Selection next;
    if (value.contains("box")) {
        const auto n = numbers(value["box"], 6);
        next = select_box(mesh, {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}});
    } else if (value.contains("ball")) {
        const auto n = numbers(value["ball"], 4);
        if (!(n[3] > 0)) throw Error(ErrorCode::InvalidInput, "the radius is not positive", {}, "[x, y, z, radius]");
        next = select_ball(mesh, {n[0], n[1], n[2]}, n[3]);
    } else if (value.contains("brush")) {
        const auto n = numbers(value["brush"], 3);
        next = under_brush(session, {n[0], n[1]}, n[2]);
    } else {
        const auto n = numbers(value["pixels"], 4);
        const View view = seen_view(session.state, *session.body);
        next = select_pixels(mesh, view, {n[0], n[1]}, {n[2], n[3]});
    }
    (void)middle_of(mesh, next);  // refuses an empty one
    session.selection = std::move(next);
}

void grab(Session& session, const Json& value) {
    const bool on = flag(value);
    if (on == session.grabbed) return;
    session.grabbed = on;
    session.kept_grab = false;
    if (!on && session.body->moved) session.replace(session.body->mesh);  // the last picture is as exact as any
}

void move(Session& session, const Json& value) {
    const Vec3 by = vector(value);
    edit(session, [&](HexMesh& mesh) { move_points(mesh, chosen(session), by); });
}

/// Along the picture, in heights of it at the depth of the selection.
void drag(Session& session, const Json& value) {
    const auto n = numbers(value, 2);
    const View view = seen_view(session.state, *session.body);
    const double depth = view.to_eye(middle_of(session.handles(), chosen(session))).z;
    const double height = view.height() * view.pixel() * (view.perspective() ? depth : 1);
    const Vec3 by = height * (n[0] * view.axes()[0] + n[1] * view.axes()[1]);
    edit(session, [&](HexMesh& mesh) { move_points(mesh, session.selection, by); });
}

void rotate(Session& session, const Json& value) {
    check_keys(value, {"angle", "axis", "center"});
    (void)chosen(session);
    const Vec3 center = center_of(session, value), axis = axis_of(value);
    edit(session, [&](HexMesh& mesh) { rotate_points(mesh, session.selection, center, axis, angle_of(value)); });
}

void scale(Session& session, const Json& value) {
    (void)chosen(session);
    const Vec3 factors = value.is_array() ? vector(value) : Vec3(number(value, -1e6, 1e6));
    const Vec3 center = middle_of(session.handles(), session.selection);
    edit(session, [&](HexMesh& mesh) { scale_points_about(mesh, session.selection, center, factors); });
}

void twist(Session& session, const Json& value) {
    check_keys(value, {"angle", "axis", "center"});
    (void)chosen(session);
    const Vec3 center = center_of(session, value), axis = axis_of(value);
    edit(session, [&](HexMesh& mesh) { twist_points(mesh, session.selection, center, axis, angle_of(value)); });
}

void bend(Session& session, const Json& value) {
    check_keys(value, {"angle", "axis", "center", "toward"});
    (void)chosen(session);
    const Vec3 center = center_of(session, value), axis = axis_of(value);
    const Vec3 toward = value.contains("toward") ? vector(value["toward"]) : Vec3(1, 0, 0);
    edit(session, [&](HexMesh& mesh) { bend_points(mesh, session.selection, center, axis, toward, angle_of(value)); });
}

void paint(Session& session, const Json& value) {
    check_keys(value, {"value", "strength"});
    const double to = number(member(value, "value"), -kMost, kMost);
    const double strength = value.contains("strength") ? number(value["strength"], 0, 1) : 1.0;
    edit(session, [&](HexMesh& mesh) { paint_values(mesh.attributes.front().values, chosen(session), to, strength); });
}

void undo(Session& session, const Json& value) {
    if (flag(value)) session.go_back(session.before, session.after);
}

void redo(Session& session, const Json& value) {
    if (flag(value)) session.go_back(session.after, session.before);
}

void save_mesh(Session& session, const Json& value) {
    check_cells(session);
    const std::string file = word(value);
    (void)write_mesh(file, session.body->mesh);
    session.saved_edit = {file, session.body};
    if (const std::size_t count = session.inverted_cells().size(); count > 0) {
        session.warnings.push_back(file + ": " + std::to_string(count) + " of its " +
                                   std::to_string(session.body->mesh.cells.size()) + " cells " + (count == 1 ? "is" : "are") +
                                   " inverted (subvol check --mend moves points to mend them)");
    }
}

}  // namespace subvol::detail

namespace subvol {

const std::vector<std::size_t>& ViewSession::State::inverted_cells() {
    if (body->inverted) return *body->inverted;
    if (counted != body) {
        const bool cells = !body->points.volume && !body->tets;
        inverted_at_first = cells ? subvol::inverted_cells(body->mesh, body->mesh.cells.size()) : std::vector<std::size_t>();
        counted = body;
    }
    return inverted_at_first;
}

void ViewSession::State::replace(HexMesh next) {
    const std::string field = next.attributes.front().name;
    auto changed = std::make_shared<ViewBody>(view_body(std::move(next), field));
    changed->shape = shape;
    changed->moved = grabbed;
    changed->flow = body->flow;
    changed->inverted = std::make_shared<const std::vector<std::size_t>>(
        subvol::inverted_cells(changed->mesh, body->mesh.points, inverted_cells()));
    body = std::move(changed);
    take_values_of_body();
    edited = true;
    picked_field.reset();
    show();
}

}  // namespace subvol
