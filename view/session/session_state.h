// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "subvol/detail/window_look.h"
#include "subvol/edit_mesh.h"
#include "subvol/probe.h"
#include "subvol/view_session.h"

namespace subvol::detail {

using Json = nlohmann::ordered_json;

/// Runs an action on a session.
///
/// throws: Error(InvalidInput), where() the name of the action
void run_action(ViewSession::State& session, const std::string& name, const Json& argument);

/// The state as an object whose keys are names of actions: running them one by one restores it.
[[nodiscard]] Json json_of(const ViewState& state);

/// The word-by-word command that draws the state.
[[nodiscard]] std::string render_command(const ViewState& state, const ViewBody& body, const ViewSource& source);

/// Where most of the light of a pixel comes from.
[[nodiscard]] std::optional<Picked> pick(const LimitProbe& probe, const Optics& optics, const Ray& ray);

/// Parses JSON. throws: Error(InvalidInput), in one sentence
[[nodiscard]] Json parsed(std::string_view text, const std::string& where);

}  // namespace subvol::detail

namespace subvol {

struct ViewSession::State {
    State(ViewSource from, HexMesh read, const ViewState& start, const DrawSettings& drawn, std::function<void()> on_picture);

    /// Takes the field of the state from the mesh.
    void choose_body();
    /// Lets the worker draw the state.
    void show();
    [[nodiscard]] const LimitProbe& limit();
    [[nodiscard]] std::shared_ptr<const DrawnPicture> wait();
    void note_wait();
    /// Keeps the mesh for `undo`.
    void remember();
    /// Shows another shape of the body's mesh.
    void replace(HexMesh next);
    /// The picture beside that of the other method, if two are compared and the other one is there.
    [[nodiscard]] Image composed(const DrawnPicture& picture) const;

    ViewSource source;
    DrawSettings settings;
    HexMesh mesh;  // all fields of the step
    ViewState state;
    std::shared_ptr<const ViewBody> body;
    std::optional<LimitProbe> probe;     // of `body`
    Selection selection;                 // empty: nothing
    std::vector<HexMesh> before, after;  // for undo and redo
    std::uint64_t shape = 0;             // of the cells that are edited; 0: none yet
    bool grabbed = false;                // a motion in many small edits, which are undone as one
    std::optional<Picked> picked;
    std::size_t action = 0;
    std::vector<WaitReport> waits;
    detail::WindowLook look;
    std::function<void()> on_picture;
    DrawWorker worker;
    std::unique_ptr<DrawWorker> reference;  // once two pictures have been compared
};

}  // namespace subvol
