// SPDX-License-Identifier: Apache-2.0
// The table of actions: a name, and what it does with its argument. Everything that the window can do is here.
#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <utility>

#include "action_values.h"
#include "camera_motion.h"
#include "edit_actions.h"
#include "subvol/camera_fit.h"
#include "subvol/detail/atomic_file.h"
#include "subvol/detail/near_name.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

using Session = ViewSession::State;

constexpr double kMost = 1e18;
constexpr int kLargestSide_px = 8192;
const std::vector<std::string> kMethods{"splat", "sheets", "tets", "dense"};
const std::vector<std::string> kSides{"+x", "-x", "+y", "-y", "+z", "-z", "iso"};

double aspect_of(const ViewState& state) {
    return static_cast<double>(state.width) / state.height;
}

/// Moves the camera along its line of sight until it sees what `subvol render` frames.
Camera framed(const Camera& camera, const Session& session) {
    const Optics optics = optics_of(session.state, *session.body);
    const std::vector<Vec3> points = framed_points(session.body->mesh, session.state.look.look, optics);
    const double aspect = aspect_of(session.state);
    return points.empty() ? fit_camera(camera, session.body->box, aspect) : fit_camera_to_points(camera, points, aspect);
}

/// Changes the state, unless it cannot be drawn.
void change(Session& session, ViewState next) {
    (void)View(next.camera, next.width, next.height);
    (void)optics_of(next, *session.body);
    session.state = std::move(next);
    session.show();
}

void set_camera(Session& session, const Camera& camera) {
    ViewState next = session.state;
    next.camera = camera;
    change(session, std::move(next));
}

template <class Edit>
void edit_state(Session& session, const Edit& edit) {
    ViewState next = session.state;
    edit(next);
    change(session, std::move(next));
}

void orbit(Session& session, const Json& by) {
    const auto angles = numbers(by, 2);
    set_camera(session, orbited(session.state.camera, angles[0], angles[1]));
}

void pan(Session& session, const Json& by) {
    const auto parts = numbers(by, 2);
    set_camera(session, panned(session.state.camera, parts[0], parts[1]));
}

void zoom(Session& session, const Json& by) {
    set_camera(session, zoomed(session.state.camera, number(by, 1e-3, 1e3)));
}

void fit(Session& session, const Json& wanted) {
    if (flag(wanted)) set_camera(session, framed(session.state.camera, session));
}

void view(Session& session, const Json& side) {
    const std::string name = word_of(side, kSides);
    const bool parallel = session.state.camera.ortho_height > 0;
    const Camera named = parse_camera(name, session.body->box, aspect_of(session.state));
    const Optics optics = optics_of(session.state, *session.body);
    const auto points = framed_points(session.body->mesh, session.state.look.look, optics);
    Camera next = points.empty() ? named : fit_camera_to_points(named, points, aspect_of(session.state));
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
    if (value.contains("ortho_height")) next.ortho_height = number(value["ortho_height"], 0, kMost);
    set_camera(session, next);
}

void size(Session& session, const Json& value) {
    const auto n = numbers(value, 2);
    edit_state(session, [&](ViewState& next) {
        next.width = whole_number(value[0], 1, kLargestSide_px);
        next.height = whole_number(value[1], 1, kLargestSide_px);
    });
}

void field(Session& session, const Json& name) {
    const std::string before = std::exchange(session.state.field, word(name));
    try {
        session.choose_body();
    } catch (...) {
        session.state.field = before;
        throw;
    }
    session.show();
}

void step(Session& session, const Json& value) {
    const auto steps = static_cast<int>(session.source.times.size());
    const auto wanted = static_cast<std::size_t>(whole_number(value, 0, steps - 1));
    if (wanted == session.state.step) return;
    session.mesh = session.source.read(wanted);
    session.state.step = wanted;
    session.choose_body();
    session.show();
}

void method(Session& session, const Json& name) {
    edit_state(session, [&](ViewState& next) { next.method = word_of(name, kMethods); });
}

void look(Session& session, const Json& name) {
    edit_state(session, [&](ViewState& next) {
        next.look.look = *look_named(word_of(name, {"solid", "volume", "xray", "isosurface"}));
    });
}

void tf(Session& session, const Json& name) {
    edit_state(session, [&](ViewState& next) { next.look.colors = word(name); });
}

void range(Session& session, const Json& value) {
    edit_state(session, [&](ViewState& next) {
        next.look.range.reset();
        next.look.stretch = !value.is_null();
        if (value.is_null() || value == "field") return;
        const auto ends = numbers(value, 2);
        if (!(ends[0] < ends[1])) throw Error(ErrorCode::InvalidInput, "is not ascending", {}, "[MIN, MAX]");
        next.look.range = ValueRange{ends[0], ends[1]};
    });
}

void opacity(Session& session, const Json& value) {
    if (!value.is_array()) throw Error(ErrorCode::InvalidInput, "is not an array", {}, "[[VALUE, OPACITY], ...]");
    edit_state(session, [&](ViewState& next) {
        next.look.opacity.clear();
        for (const Json& knot : value) {
            const auto pair = numbers(knot, 2);
            next.look.opacity.push_back({pair[0], number(knot[1], 0, 1)});
        }
    });
}

void opacity_unit(Session& session, const Json& value) {
    edit_state(session, [&](ViewState& next) {
        next.look.opacity_unit_world.reset();
        if (!value.is_null()) next.look.opacity_unit_world = number(value, 1e-18, kMost);
    });
}

void clamp(Session& session, const Json& value) {
    edit_state(session, [&](ViewState& next) { next.look.clamp = flag(value); });
}

void background(Session& session, const Json& value) {
    edit_state(session, [&](ViewState& next) {
        next.background.reset();
        if (value.is_null()) return;
        for (const Json& part : value) (void)number(part, 0, 1);
        next.background = vector(value);
    });
}

void axes(Session& session, const Json& value) {
    edit_state(session, [&](ViewState& next) { next.axes = flag(value); });
}

void edges(Session& session, const Json& value) {
    edit_state(session, [&](ViewState& next) { next.edges = flag(value); });
}

void legend(Session& session, const Json& value) {
    edit_state(session, [&](ViewState& next) { next.legend = flag(value); });
}

void compare(Session& session, const Json& name) {
    session.state.compare = name.is_null() ? "" : word_of(name, kMethods);
    session.show();
}

void slider(Session& session, const Json& value) {
    session.state.slider = number(value, 0, 1);
}

void difference(Session& session, const Json& value) {
    session.state.difference = flag(value);
}

/// Of the window; without one it has no effect.
void window(Session& session, const Json& value) {
    check_keys(value, {"dark", "help", "log_counts", "log_opacity", "play", "section", "tool", "brush"});
    WindowLook next = session.look;
    if (value.contains("dark")) next.dark = flag(value["dark"]);
    if (value.contains("help")) next.help = flag(value["help"]);
    if (value.contains("log_counts")) next.log_counts = flag(value["log_counts"]);
    if (value.contains("log_opacity")) next.log_opacity = flag(value["log_opacity"]);
    if (value.contains("play")) next.play = flag(value["play"]);
    if (value.contains("section")) next.section = word(value["section"]);
    if (value.contains("tool"))
        next.tool = word_of(value["tool"], {"turn", "brush", "move", "rotate", "scale", "twist", "bend", "paint"});
    if (value.contains("brush")) next.brush_px = number(value["brush"], 1, 1000);
    session.look = next;
}

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

void pick_place(Session& session, const Json& value) {
    const auto place = numbers(value, 2);
    const View seen(session.state.camera, session.state.width, session.state.height);
    session.picked = pick(session.limit(), optics_of(session.state, *session.body), seen.ray(place[0], place[1]));
}

void wait(Session& session, const Json& wanted) {
    if (wanted == "first") {
        session.worker.wait_first();
        session.note_wait();
    } else if (flag(wanted)) {
        (void)session.wait();
    }
}

void screenshot(Session& session, const Json& file) {
    const std::string path = word(file);
    if (!session.source.write_picture) throw Error(ErrorCode::InvalidInput, "pictures cannot be written here");
    const auto picture = session.wait();
    session.source.write_picture(path, session.composed(*picture), background_of(session.state));
}

void save_state(Session& session, const Json& file) {
    write_text_file(word(file), json_of(session.state).dump(2) + "\n");
}

void restore(Session& session, const Json& json, const Json& known, const std::string& path) {
    for (const auto& [key, value] : json.items()) {
        if (!known.contains(key)) throw Error(ErrorCode::InvalidInput, "the key " + in_quotes(key) + " is not known", path);
        run_action(session, key, value);
    }
}

void load_state(Session& session, const Json& file) {
    const std::string path = word(file);
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw Error(ErrorCode::Io, "cannot be opened", path);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    const Json json = parsed(text, path);
    if (!json.is_object()) throw Error(ErrorCode::InvalidInput, "is not the state of a session", path);
    const Json known = json_of(session.state);
    const ViewState before = session.state;
    const auto body = session.body;
    HexMesh mesh = session.mesh;
    try {
        restore(session, json, known, path);
    } catch (...) {
        session.state = before;
        session.body = body;
        session.mesh = std::move(mesh);
        session.show();
        throw;
    }
}

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
                              Action{"compare", compare},
                              Action{"slider", slider},
                              Action{"difference", difference},
                              Action{"window", window},
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
                              Action{"save_state", save_state},
                              Action{"load_state", load_state}};

}  // namespace

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
