// SPDX-License-Identifier: Apache-2.0
// The table of actions: a name, and what it does with its argument. Everything that the window can do is here.
#include <algorithm>
#include <array>

#include "subvol/detail/near_name.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "view_actions.h"

namespace subvol::detail {

namespace {

using Session = ViewSession::State;

/// Not:    undo does not take it back
/// Step:   undo takes it back
/// Motion: the same, together with the same actions right before it, as of a wheel or a key that is held
enum class Undo { Not, Step, Motion };

struct Action {
    const char* name;
    void (*run)(Session&, const Json&);
    Undo undo = Undo::Step;
};

constexpr std::array kActions{Action{"orbit", orbit, Undo::Motion},
                              Action{"pan", pan, Undo::Motion},
                              Action{"zoom", zoom, Undo::Motion},
                              Action{"fit", fit},
                              Action{"view", view},
                              Action{"ortho", ortho},
                              Action{"camera", camera},
                              Action{"size", size, Undo::Not},
                              Action{"field", field},
                              Action{"step", step, Undo::Motion},
                              Action{"method", method},
                              Action{"look", look},
                              Action{"tf", tf},
                              Action{"range", range, Undo::Motion},
                              Action{"opacity", opacity, Undo::Motion},
                              Action{"log", log},
                              Action{"symlog", symlog, Undo::Motion},
                              Action{"bands", bands, Undo::Motion},
                              Action{"below", below, Undo::Motion},
                              Action{"above", above, Undo::Motion},
                              Action{"opacity_unit", opacity_unit},
                              Action{"clamp", clamp},
                              Action{"background", background},
                              Action{"axes", axes},
                              Action{"edges", edges},
                              Action{"legend", legend},
                              Action{"inverted", inverted},
                              Action{"flow", flow},
                              Action{"clip", clip},
                              Action{"clip_box", clip_box},
                              Action{"slice", slice},
                              Action{"around", around},
                              Action{"add_cut", add_cut},
                              Action{"set_cut", set_cut, Undo::Motion},
                              Action{"remove_cut", remove_cut},
                              Action{"move_cut", move_cut, Undo::Motion},
                              Action{"turn_cut", turn_cut, Undo::Motion},
                              Action{"compare", compare},
                              Action{"slider", slider, Undo::Motion},
                              Action{"difference", difference},
                              Action{"window", window, Undo::Not},
                              Action{"edit_level", edit_level, Undo::Not},
                              Action{"select", select, Undo::Not},
                              Action{"grab", grab, Undo::Not},
                              Action{"move", move},
                              Action{"drag", drag},
                              Action{"rotate", rotate},
                              Action{"scale", scale},
                              Action{"twist", twist},
                              Action{"bend", bend},
                              Action{"paint", paint},
                              Action{"undo", undo, Undo::Not},
                              Action{"redo", redo, Undo::Not},
                              Action{"save_mesh", save_mesh, Undo::Not},
                              Action{"pick", pick_place, Undo::Not},
                              Action{"focus", focus},
                              Action{"wait", wait, Undo::Not},
                              Action{"stop", stop, Undo::Not},
                              Action{"screenshot", screenshot, Undo::Not},
                              Action{"save_tf", save_tf, Undo::Not},
                              Action{"save_state", save_state, Undo::Not},
                              Action{"load_state", load_state}};

}  // namespace

/// Changes the state, unless it cannot be drawn.
void change(ViewSession::State& session, ViewState next) {
    (void)View(next.camera, next.width, next.height);
    auto body = session.body_for(next.method);
    (void)optics_of(next, *body);
    if (body != session.body) {
        session.body = std::move(body);
        session.picked_field.reset();
    }
    session.state = std::move(next);
    session.show();
}

namespace {

const Action& find_action(const std::string& name) {
    const auto found = std::ranges::find_if(kActions, [&](const Action& action) { return name == action.name; });
    if (found == kActions.end()) {
        std::vector<std::string> names;
        std::string all;
        for (const Action& action : kActions) {
            names.emplace_back(action.name);
            all += (all.empty() ? "" : ", ") + names.back();
        }
        throw Error(ErrorCode::InvalidInput, in_quotes(name) + " is not an action" + did_you_mean(name, names), {}, all);
    }
    return *found;
}

}  // namespace

void run_part(ViewSession::State& session, const std::string& name, const Json& argument) {
    const Action& found = find_action(name);
    try {
        found.run(session, argument);
    } catch (const Error& error) {
        if (!error.where().empty()) throw;
        throw Error(error.code(), error.message(), name, error.allowed());
    }
}

void run_action(ViewSession::State& session, const std::string& name, const Json& argument) {
    const Undo undo = find_action(name).undo;
    if (undo == Undo::Not) return run_part(session, name, argument);
    Session::Moment before = session.moment();
    run_part(session, name, argument);
    session.remember(std::move(before), undo == Undo::Motion ? name : "");
}

}  // namespace subvol::detail
