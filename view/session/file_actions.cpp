// SPDX-License-Identifier: Apache-2.0
// Actions that wait, pick, and write or read files.
#include <filesystem>

#include "camera_motion.h"
#include "seen_view.h"
#include "subvol/color_map_file.h"
#include "subvol/detail/atomic_file.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/read_file.h"
#include "subvol/error.h"
#include "subvol/mesh_io.h"
#include "view_actions.h"

namespace subvol::detail {

namespace {

using Session = ViewSession::State;

void restore(Session& session, const Json& json, const Json& known, const std::string& path) {
    for (const auto& [key, value] : json.items()) {
        if (key == "mesh" || key == kInvertedCells) continue;  // a file, and a fact
        if (!known.contains(key)) throw Error(ErrorCode::InvalidInput, "the key " + in_quotes(key) + " is not known", path);
        run_part(session, key, value);
    }
}

}  // namespace

namespace {

/// The ray through a pixel of the picture, and the field that it is picked from.
auto picker(Session& session, const Json& value) {
    const auto place = numbers(value, 2);
    const View seen = seen_view(session.state, *session.body);
    return [field = session.field(), optics = optics_of(session.state, *session.body), ray = seen.ray(place[0], place[1])] {
        return pick(*field, optics, ray);
    };
}

}  // namespace

void pick_place(Session& session, const Json& value) {
    session.picked = picker(session, value)();
}

namespace {

/// Looks at a place that was picked; where nothing was, the camera stays.
void look_at(Session& session, const std::optional<Picked>& found) {
    session.picked = found;
    if (found) edit_state(session, [&](ViewState& next) { next.camera = aimed(next.camera, found->place); });
}

}  // namespace

void focus(Session& session, const Json& value) {
    look_at(session, picker(session, value)());
}

/// Gives up the pictures that are being drawn.
void stop(Session& session, const Json& value) {
    if (!flag(value)) return;
    session.worker.stop();
    if (session.reference) session.reference->stop();
}

void wait(Session& session, const Json& wanted) {
    if (wanted == "first") {
        session.worker.wait_first();
        session.note_wait();
    } else if (flag(wanted)) {
        (void)session.wait();
    }
}

namespace {

std::string writable(const Session& session, const Json& file) {
    std::string path = word(file);
    if (!session.source.write_picture) throw Error(ErrorCode::InvalidInput, "pictures cannot be written here");
    return path;
}

}  // namespace

void screenshot(Session& session, const Json& file) {
    const std::string path = writable(session, file);
    (void)session.wait();
    session.writer(path)();
}

/// The colours and opacities that are shown, for ParaView and for `--tf`.
void save_tf(Session& session, const Json& file) {
    const std::filesystem::path path = word(file);
    if (path.extension() != ".json") throw Error(ErrorCode::InvalidInput, "a colour map is a .json file", path.string());
    const Optics optics = optics_of(session.state, *session.body);
    write_text_file(path, color_map_json(optics.function(), path.stem().string()));
}

/// An edited mesh is saved beside the state, as NAME.edits.vtu: NAME.vtu may be the mesh that it was made of.
void save_state(Session& session, const Json& file) {
    const std::filesystem::path path = word(file);
    Json json = saved_state(session);
    if (session.edited) {
        std::filesystem::path mesh = path;
        mesh.replace_extension(".edits.vtu");
        std::error_code ignored;
        if (std::filesystem::equivalent(mesh, session.source.input, ignored)) {
            throw Error(ErrorCode::InvalidInput, "is the mesh that is shown, which the edits would replace", mesh.string(),
                        "another name for the state");
        }
        run_part(session, "save_mesh", mesh.string());
        json["mesh"] = mesh.filename().string();
    }
    write_text_file(path, json.dump(2) + "\n");
}

namespace {

/// Takes points and values from a file that has the same cells.
void take_edits(Session& session, const std::filesystem::path& file) {
    HexMesh read = read_mesh(file.string(), {}).mesh;
    HexMesh next = session.body->mesh;
    const Attribute* values = read.find_attribute(session.body->field());
    if (read.cells != next.cells || read.points.size() != next.points.size() || values == nullptr) {
        throw Error(ErrorCode::InvalidInput, "does not have the cells or the field of this mesh", file.string(),
                    "the mesh that was saved with the state");
    }
    next.points = std::move(read.points);
    Attribute& field = next.attributes.front();
    field = {field.name, 1, values->values, field.bounds};
    session.replace(std::move(next));
}

}  // namespace

void load_state(Session& session, const Json& file) {
    const std::string path = word(file);
    const std::string text = read_regular(path);
    const Json json = parsed(text, path);
    if (!json.is_object()) throw Error(ErrorCode::InvalidInput, "is not the state of a session", path);
    const Json known = json_of(session.state);
    const Session::Moment before = session.moment();
    try {
        if (json.contains("log")) session.state.look.shape = {};  // else it would have to fit what is read before it
        restore(session, json, known, path);
        if (json.contains("mesh")) {
            const std::filesystem::path folder = std::filesystem::path(path).parent_path();
            take_edits(session, named_file(folder, word(json["mesh"]), [&] { return path + ", mesh"; }));
        }
    } catch (...) {
        session.restore(before);
        throw;
    }
}

/// Changes the settings of the window; without a window it has no effect.
void window(Session& session, const Json& value) {
    check_keys(value, {"dark", "help", "log_counts", "log_opacity", "panel", "play", "section", "tool", "brush"});
    WindowLook next = session.look;
    if (value.contains("dark")) next.dark = flag(value["dark"]);
    if (value.contains("help")) next.help = flag(value["help"]);
    if (value.contains("log_counts")) next.log_counts = flag(value["log_counts"]);
    if (value.contains("log_opacity")) next.log_opacity = flag(value["log_opacity"]);
    if (value.contains("panel")) next.panel = flag(value["panel"]);
    if (value.contains("play")) next.play = flag(value["play"]);
    if (value.contains("section")) next.section = word(value["section"]);
    if (value.contains("tool")) {
        next.tool = word_of(value["tool"], {"turn", "brush", "move", "rotate", "scale", "twist", "bend", "paint"});
        next.section = "sculpt";  // a tool is seen where it is chosen
    }
    if (value.contains("brush")) next.brush_px = number(value["brush"], 1, 1000);
    session.look = next;
}

void start_action(ViewSession::State& session, const std::string& name, const Json& argument) {
    using Done = Session::Done;
    if (name == "pick") {
        session.later.push_back(std::async(std::launch::async, [find = picker(session, argument)]() -> Done {
            return [picked = find()](Session& now) { now.picked = picked; };
        }));
    } else if (name == "focus") {
        session.later.push_back(std::async(std::launch::async, [find = picker(session, argument)]() -> Done {
            return [found = find()](Session& now) {
                Session::Moment was = now.moment();
                look_at(now, found);
                now.remember(std::move(was), {});
            };
        }));
    } else if (name == "step") {
        const auto steps = static_cast<int>(session.source.times.size());
        const auto wanted = static_cast<std::size_t>(whole_number(argument, 0, steps - 1));
        if (wanted != session.state.step || session.reading) session.read_later(wanted);
    } else if (name == "screenshot") {
        session.later.push_back(std::async(std::launch::async, [write = session.writer(writable(session, argument))]() -> Done {
            write();
            return [](Session&) {};
        }));
    } else {
        run_action(session, name, argument);
    }
}

}  // namespace subvol::detail
