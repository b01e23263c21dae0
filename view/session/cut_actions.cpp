// SPDX-License-Identifier: Apache-2.0
// Actions that cut the volume open: planes, a box, slices; planes are moved and turned one by one.
#include <algorithm>

#include "camera_motion.h"
#include "cut_handles.h"
#include "seen_view.h"
#include "subvol/error.h"
#include "view_actions.h"

namespace subvol::detail {

namespace {

using Session = ViewSession::State;

constexpr double kArrow = 0.15;  // of the box's diagonal

/// One plane as six numbers, or an array of them.
std::vector<CutPlane> planes_of(const Json& value) {
    if (!value.is_array()) throw Error(ErrorCode::InvalidInput, "is not an array", {}, "[[px, py, pz, nx, ny, nz], ...]");
    std::vector<CutPlane> planes;
    for (const Json& one : value) {
        const auto n = numbers(one, 6);
        planes.push_back({{n[0], n[1], n[2]}, {n[3], n[4], n[5]}});
    }
    return planes;
}

template <class Cut>
void edit_clip(Session& session, const Cut& cut) {
    edit_state(session, [&](ViewState& next) {
        cut(next.clip);
        validate(next.clip);
    });
}

/// The point of a plane that is nearest to the middle of the body: there its handle is.
Vec3 handle_of(const CutPlane& plane, const ViewBody& body) {
    const Vec3 normal = glm::normalize(plane.normal), middle = body.box.center();
    return middle - glm::dot(middle - plane.point, normal) * normal;
}

/// Whether a value is about a slice, not about a plane that clips.
bool about_slice(const Json& value) {
    const bool slice = value.contains("slice");
    if (slice == value.contains("clip")) throw Error(ErrorCode::InvalidInput, "names no plane", {}, R"("clip" or "slice")");
    return slice;
}

/// Edits the list of planes that a value is about, and the place of one of them there.
template <class Edit>
void edit_planes(Session& session, const Json& value, const Edit& edit) {
    const bool slice = about_slice(value);
    edit_clip(session, [&](Clip& next) {
        std::vector<CutPlane>& planes = slice ? next.slices : next.planes;
        const int last = static_cast<int>(planes.size()) - 1;
        const int chosen = whole_number(value[slice ? "slice" : "clip"], 0, std::max(last, 0));
        if (chosen > last) throw Error(ErrorCode::InvalidInput, slice ? "there is no slice" : "there is no plane");
        edit(planes, static_cast<std::size_t>(chosen));
    });
}

/// The same for one plane, whose point is then its handle.
template <class Edit>
void edit_plane(Session& session, const Json& value, const Edit& edit) {
    edit_planes(session, value, [&](std::vector<CutPlane>& planes, std::size_t chosen) {
        CutPlane& plane = planes[chosen];
        plane = {handle_of(plane, *session.body), glm::normalize(plane.normal)};
        edit(plane);
    });
}

/// How far a plane moves along its normal when its handle is dragged by pixels.
double dragged_world(const Session& session, const CutPlane& plane, const Vec2& by) {
    const View view = seen_view(session.state, *session.body);
    const double step = 1e-3 * session.body->box.diagonal();
    const Vec3 foot = view.to_eye(plane.point), tip = view.to_eye(plane.point + step * plane.normal);
    if (view.perspective() && !(foot.z > 0 && tip.z > 0)) return 0;
    const Vec2 along = (view.to_pixels(tip) - view.to_pixels(foot)) / step;  // pixels for each world length
    const double across = view.pixel() * (view.perspective() ? foot.z : 1);  // a pixel there, world
    constexpr double kSteep = 0.1;  // a normal towards the eye cannot be dragged along the picture: then all of it counts
    const double length = std::max(glm::length(along), kSteep / across);
    return glm::dot(by, along) / (length * length);
}

}  // namespace

void clip(Session& session, const Json& value) {
    edit_clip(session, [&](Clip& next) { next.planes = planes_of(value); });
}

void clip_box(Session& session, const Json& value) {
    edit_clip(session, [&](Clip& next) {
        next.box.reset();
        if (value.is_null()) return;
        const auto n = numbers(value, 6);
        next.box = Box{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
    });
}

void slice(Session& session, const Json& value) {
    edit_clip(session, [&](Clip& next) { next.slices = planes_of(value); });
}

void around(Session& session, const Json& value) {
    edit_clip(session, [&](Clip& next) { next.around_slices = flag(value); });
}

void add_cut(Session& session, const Json& value) {
    check_keys(value, {"clip", "slice"});
    const bool slice = about_slice(value);
    const CutPlane plane{session.body->box.center(), vector(value[slice ? "slice" : "clip"])};
    edit_clip(session, [&](Clip& next) { (slice ? next.slices : next.planes).push_back(plane); });
}

void set_cut(Session& session, const Json& value) {
    check_keys(value, {"clip", "slice", "plane"});
    const auto n = numbers(member(value, "plane"), 6);
    edit_planes(session, value, [&](std::vector<CutPlane>& planes, std::size_t chosen) {
        planes[chosen] = {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
    });
}

void remove_cut(Session& session, const Json& value) {
    check_keys(value, {"clip", "slice"});
    edit_planes(session, value, [](std::vector<CutPlane>& planes, std::size_t chosen) {
        planes.erase(planes.begin() + static_cast<std::ptrdiff_t>(chosen));
    });
}

void move_cut(Session& session, const Json& value) {
    check_keys(value, {"clip", "slice", "by", "drag"});
    edit_plane(session, value, [&](CutPlane& plane) {
        double by = 0;
        if (value.contains("drag")) {
            const auto n = numbers(value["drag"], 2);
            by = dragged_world(session, plane, {n[0], n[1]});
        } else {
            by = number(member(value, "by"), -kMostWorld, kMostWorld);
        }
        plane.point += by * plane.normal;
    });
}

void turn_cut(Session& session, const Json& value) {
    check_keys(value, {"clip", "slice", "by", "flip"});
    if (value.contains("flip") && flag(value["flip"])) {
        edit_plane(session, value, [](CutPlane& plane) { plane.normal = -plane.normal; });
        return;
    }
    const auto angles = numbers(member(value, "by"), 2);
    const View view = seen_view(session.state, *session.body);
    const Vec3 &right = view.axes()[0], &up = view.axes()[1];
    edit_plane(session, value, [&](CutPlane& plane) {
        plane.normal = glm::normalize(turned(turned(plane.normal, up, angles[0]), right, -angles[1]));
    });
}

std::vector<CutHandle> cut_handles(const ViewState& state, const ViewBody& body) {
    std::vector<CutHandle> handles;
    const View view = seen_view(state, body);
    const auto add = [&](const std::vector<CutPlane>& planes, bool slice) {
        for (std::size_t k = 0; k < planes.size(); ++k) {
            const Vec3 at = handle_of(planes[k], body);
            const Vec3 tip = at + kArrow * body.box.diagonal() * glm::normalize(planes[k].normal);
            const Vec3 from = view.to_eye(at), to = view.to_eye(tip);
            if (!(from.z > 0) || (view.perspective() && !(to.z > 0))) continue;
            handles.push_back({slice, k, view.to_pixels(from), view.to_pixels(to)});
        }
    };
    add(state.clip.planes, false);
    add(state.clip.slices, true);
    return handles;
}

}  // namespace subvol::detail
