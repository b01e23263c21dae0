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

struct Action {
    const char* name;
    void (*run)(Session&, const Json&);
};

constexpr std::array kActions{Action{"orbit", orbit},
                              Action{"pan", pan},
                              Action{"zoom", zoom},
                              Action{"fit", fit},
                              Action{"view", view},
                              Action{"ortho", ortho},
                              Action{"camera", camera},
                              Action{"size", size},
                              Action{"field", field},
                              Action{"step", step},
                              Action{"method", method},
                              Action{"look", look},
                              Action{"tf", tf},
                              Action{"range", range},
                              Action{"opacity", opacity},
                              Action{"opacity_unit", opacity_unit},
                              Action{"clamp", clamp},
                              Action{"background", background},
                              Action{"axes", axes},
                              Action{"edges", edges},
                              Action{"legend", legend},
                              Action{"clip", clip},
                              Action{"clip_box", clip_box},
                              Action{"slice", slice},
                              Action{"around", around},
                              Action{"add_cut", add_cut},
                              Action{"remove_cut", remove_cut},
                              Action{"move_cut", move_cut},
                              Action{"turn_cut", turn_cut},
                              Action{"compare", compare},
                              Action{"slider", slider},
                              Action{"difference", difference},
                              Action{"window", window},
                              Action{"edit_level", edit_level},
                              Action{"select", select},
                              Action{"grab", grab},
                              Action{"move", move},
                              Action{"drag", drag},
                              Action{"rotate", rotate},
                              Action{"scale", scale},
                              Action{"twist", twist},
                              Action{"bend", bend},
                              Action{"paint", paint},
                              Action{"undo", undo},
                              Action{"redo", redo},
                              Action{"save_mesh", save_mesh},
                              Action{"pick", pick_place},
                              Action{"wait", wait},
                              Action{"screenshot", screenshot},
                              Action{"save_tf", save_tf},
                              Action{"save_state", save_state},
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

void run_action(ViewSession::State& session, const std::string& name, const Json& argument) {
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
    try {
        found->run(session, argument);
    } catch (const Error& error) {
        if (!error.where().empty()) throw;
        throw Error(error.code(), error.message(), name, error.allowed());
    }
}

}  // namespace subvol::detail
