// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "action_values.h"
#include "session_state.h"

namespace subvol::detail {

// Actions on the mesh: choose a level and its control points, move them, paint; undo.
void edit_level(ViewSession::State& session, const Json& value);
void select(ViewSession::State& session, const Json& value);
void grab(ViewSession::State& session, const Json& value);
void move(ViewSession::State& session, const Json& value);
void drag(ViewSession::State& session, const Json& value);
void rotate(ViewSession::State& session, const Json& value);
void scale(ViewSession::State& session, const Json& value);
void twist(ViewSession::State& session, const Json& value);
void bend(ViewSession::State& session, const Json& value);
void paint(ViewSession::State& session, const Json& value);
void undo(ViewSession::State& session, const Json& value);
void redo(ViewSession::State& session, const Json& value);
void save_mesh(ViewSession::State& session, const Json& value);

inline constexpr double kMostWorld = 1e18;

/// Changes the state, unless it cannot be drawn.
void change(ViewSession::State& session, ViewState next);

template <class Edit>
void edit_state(ViewSession::State& session, const Edit& edit) {
    ViewState next = session.state;
    edit(next);
    change(session, std::move(next));
}

// The camera.
void orbit(ViewSession::State& session, const Json& value);
void pan(ViewSession::State& session, const Json& value);
void zoom(ViewSession::State& session, const Json& value);
void fit(ViewSession::State& session, const Json& value);
void view(ViewSession::State& session, const Json& value);
void ortho(ViewSession::State& session, const Json& value);
void camera(ViewSession::State& session, const Json& value);

// What is shown, and how.
void field(ViewSession::State& session, const Json& value);
void step(ViewSession::State& session, const Json& value);
void size(ViewSession::State& session, const Json& value);
void method(ViewSession::State& session, const Json& value);
void look(ViewSession::State& session, const Json& value);
void tf(ViewSession::State& session, const Json& value);
void range(ViewSession::State& session, const Json& value);
void opacity(ViewSession::State& session, const Json& value);
void log(ViewSession::State& session, const Json& value);
void symlog(ViewSession::State& session, const Json& value);
void bands(ViewSession::State& session, const Json& value);
void below(ViewSession::State& session, const Json& value);
void above(ViewSession::State& session, const Json& value);
void opacity_unit(ViewSession::State& session, const Json& value);
void clamp(ViewSession::State& session, const Json& value);
void background(ViewSession::State& session, const Json& value);
void axes(ViewSession::State& session, const Json& value);
void edges(ViewSession::State& session, const Json& value);
void legend(ViewSession::State& session, const Json& value);
void inverted(ViewSession::State& session, const Json& value);
void flow(ViewSession::State& session, const Json& value);
void clip(ViewSession::State& session, const Json& value);
void clip_box(ViewSession::State& session, const Json& value);
void slice(ViewSession::State& session, const Json& value);
void around(ViewSession::State& session, const Json& value);
void add_cut(ViewSession::State& session, const Json& value);
void set_cut(ViewSession::State& session, const Json& value);
void remove_cut(ViewSession::State& session, const Json& value);
void move_cut(ViewSession::State& session, const Json& value);
void turn_cut(ViewSession::State& session, const Json& value);
void compare(ViewSession::State& session, const Json& value);
void slider(ViewSession::State& session, const Json& value);
void difference(ViewSession::State& session, const Json& value);

// Waiting, picking, files, and the window's own look.
void wait(ViewSession::State& session, const Json& value);
void pick_place(ViewSession::State& session, const Json& value);
void focus(ViewSession::State& session, const Json& value);
void stop(ViewSession::State& session, const Json& value);
void screenshot(ViewSession::State& session, const Json& value);
void save_tf(ViewSession::State& session, const Json& value);
void save_state(ViewSession::State& session, const Json& value);
void load_state(ViewSession::State& session, const Json& value);
void window(ViewSession::State& session, const Json& value);

}  // namespace subvol::detail
