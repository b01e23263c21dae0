// SPDX-License-Identifier: Apache-2.0
// Actions that move the camera.
#include "camera_motion.h"
#include "seen_view.h"
#include "subvol/camera_fit.h"
#include "subvol/detail/points_frame.h"
#include "view_actions.h"

namespace subvol::detail {

namespace {

using Session = ViewSession::State;

const std::vector<std::string> kSides{"+x", "-x", "+y", "-y", "+z", "-z", "iso"};

/// The aspect ratio of the part of the picture beside its legend.
double aspect_of(const Session& session) {
    const View seen = seen_view(session.state, *session.body);
    return static_cast<double>(seen.width()) / seen.height();
}

/// What a camera is fitted to; empty: the box of the body.
std::vector<Vec3> points_in_view(const Session& session, const Optics& optics) {
    const RbfVolume* const kernels = session.body->points.volume.get();
    if (kernels != nullptr) return session.state.look.look == Look::Solid ? detail::outline_of(*kernels) : std::vector<Vec3>{};
    return framed_points(session.body->mesh, session.state.look.look, optics);
}

/// Moves the camera along its line of sight until it sees what `subvol render` frames.
Camera framed(const Camera& camera, const Session& session) {
    const Optics optics = optics_of(session.state, *session.body);
    const std::vector<Vec3> points = points_in_view(session, optics);
    const double aspect = aspect_of(session);
    return points.empty() ? fit_camera(camera, session.body->box, aspect) : fit_camera_to_points(camera, points, aspect);
}

void set_camera(Session& session, const Camera& camera) {
    ViewState next = session.state;
    next.camera = camera;
    change(session, std::move(next));
}

}  // namespace

void orbit(Session& session, const Json& by) {
    const auto angles = numbers(by, 2);
    set_camera(session, orbited(session.state.camera, angles[0], angles[1]));
}

void pan(Session& session, const Json& by) {
    const auto parts = numbers(by, 2);
    set_camera(session, panned(session.state.camera, parts[0], parts[1]));
}

/// By a factor about the middle of the picture, or `[factor, column, row]`: about a pixel.
void zoom(Session& session, const Json& by) {
    if (!by.is_array()) return set_camera(session, zoomed(session.state.camera, number(by, 1e-3, 1e3)));
    const auto n = numbers(by, 3);
    const View seen = seen_view(session.state, *session.body);
    const Vec2 about((n[1] - 0.5 * seen.width()) / seen.height(), (0.5 * seen.height() - n[2]) / seen.height());
    set_camera(session, zoomed(session.state.camera, number(by[0], 1e-3, 1e3), about));
}

void fit(Session& session, const Json& wanted) {
    if (flag(wanted)) set_camera(session, framed(session.state.camera, session));
}

void view(Session& session, const Json& side) {
    const std::string name = word_of(side, kSides);
    const bool parallel = session.state.camera.ortho_height > 0;
    const Camera named = parse_camera(name, session.body->box, aspect_of(session), session.state.up);
    const Optics optics = optics_of(session.state, *session.body);
    const auto points = points_in_view(session, optics);
    Camera next = points.empty() ? named : fit_camera_to_points(named, points, aspect_of(session));
    set_camera(session, with_parallel_rays(next, parallel));
}

void ortho(Session& session, const Json& wanted) {
    set_camera(session, with_parallel_rays(session.state.camera, flag(wanted)));
}

void camera(Session& session, const Json& value) {
    if (value.is_array() && (value.size() == 10 || value.size() == 11)) {
        const auto n = numbers(value, value.size());
        set_camera(session, {.eye = {n[0], n[1], n[2]},
                             .target = {n[3], n[4], n[5]},
                             .up = {n[6], n[7], n[8]},
                             .fovy_deg = n[9],
                             .ortho_height = n.size() == 11 ? n[10] : 0.0});
        return;
    }
    check_keys(value, {"eye", "target", "up", "fovy_deg", "ortho_height"});
    Camera next = session.state.camera;
    next.eye = vector(member(value, "eye"));
    next.target = vector(member(value, "target"));
    if (value.contains("up")) next.up = vector(value["up"]);
    if (value.contains("fovy_deg")) next.fovy_deg = number(value["fovy_deg"], 0, 180);
    if (value.contains("ortho_height")) next.ortho_height = number(value["ortho_height"], 0, kMostWorld);
    set_camera(session, next);
}

}  // namespace subvol::detail
