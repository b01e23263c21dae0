// SPDX-License-Identifier: Apache-2.0
#pragma once

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

}  // namespace subvol::detail
