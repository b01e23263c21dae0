// SPDX-License-Identifier: Apache-2.0
// What can be undone. Bodies are never changed but replaced, so a moment holds them without a copy; the mesh with all fields is
// shared by the moments of a step, and takes its points from the body that is shown.
#include <utility>

#include "session_state.h"

namespace subvol {

namespace {

constexpr std::size_t kMostSteps = 50;  // that can be undone

}  // namespace

void ViewSession::State::remember(Moment was, const std::string& motion) {
    if (was.body == body && detail::json_of(was.state) == detail::json_of(state)) return;
    const bool goes_on = grabbed ? std::exchange(kept_grab, true) : !motion.empty() && motion == last_motion;
    last_motion = grabbed ? "" : motion;
    if (goes_on) return;
    before.push_back(std::move(was));
    if (before.size() > kMostSteps) before.erase(before.begin());
    after.clear();
}

void ViewSession::State::go_back(std::vector<Moment>& from, std::vector<Moment>& to) {
    if (from.empty()) return;
    to.push_back(moment());
    Moment next = std::move(from.back());
    from.pop_back();
    next.state.width = state.width;  // the window's
    next.state.height = state.height;
    restore(next);
    last_motion.clear();
}

void ViewSession::State::restore(const Moment& moment) {
    const bool same_cells = moment.mesh == mesh && moment.state.field == state.field;
    state = moment.state;
    body = moment.body;
    mesh = moment.mesh;
    edited = moment.edited;
    if (source.tets) {
        if (!same_cells) tet_levels = {};
        tet_levels[static_cast<std::size_t>(default_tet_level(state.method)) - 1] = body;
    }
    if (!body->points.volume && !body->tets) take_values_of_body();
    if (!same_cells) {
        coarse.reset();
        edit_level = 0;
        selection.clear();
        ++shape;
    } else if (coarse) {
        coarse->take(body->mesh);
    }
    picked_field.reset();
    show();
}

void ViewSession::State::take_values_of_body() {
    mesh->points = body->mesh.points;
    const Attribute& shown = body->mesh.attributes.front();
    for (Attribute& field : mesh->attributes) {
        if (field.name == shown.name && field.channels == 1) field.values = shown.values;
    }
}

}  // namespace subvol
