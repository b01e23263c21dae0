// SPDX-License-Identifier: Apache-2.0
// A session of the viewer: a state, the body that is drawn for it, and workers that draw on other threads. Changes come as
// actions, JSON objects with one key.
//
//     action ─► state ─► body (field, flow) ─► worker ─► picture ─┐
//                             └─► worker of another method ────────┴─► composed: side by side, or their difference
//
// A body is chosen whole or not at all: where the state does not fit it, the one before stays. Reading a step, writing, and
// measuring two pictures go on beside the window. Each ends in a function that `settle` runs on the session's own thread, so
// that the state is changed there alone. While a step is read, only the last one that was asked for besides is remembered.
// Pictures of different cameras are not composed, and coarse ones are enlarged before. Saved states and the render command are
// made from the state.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <utility>

#include "cut_handles.h"
#include "picture_overlays.h"
#include "session_state.h"
#include "subvol/detail/json_depth.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "subvol/image.h"
#include "subvol/vec.h"

namespace subvol::detail {

namespace {

/// Left of `slider` (0 to 1 of the width) one picture, right of it the other, with a line between them.
///
/// right: of the same size
Image side_by_side(const Image& left, const Image& right, double slider, const Vec3& line) {
    Image both = left;
    const int border = static_cast<int>(std::lround(slider * left.width));
    for (int y = 0; y < left.height; ++y) {
        for (int x = border; x < left.width; ++x) std::ranges::copy(right.pixel(x, y), both.pixel(x, y).begin());
        if (border <= 0 || border >= left.width) continue;
        const auto pixel = both.pixel(border, y);
        for (std::size_t c = 0; c < 3; ++c) pixel[c] = static_cast<float>(line[static_cast<int>(c)]);
        pixel[3] = 1;
    }
    return both;
}

/// The largest difference of a pixel's colours, over a background, as grey: white is a difference of 1/8 or more.
Image difference_of(const Image& left, const Image& right, const Vec3& background) {
    constexpr float kGain = 8;
    Image difference(left.width, left.height);
    for (int y = 0; y < left.height; ++y) {
        for (int x = 0; x < left.width; ++x) {
            const auto a = left.pixel(x, y), b = right.pixel(x, y);
            float most = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                const auto behind = static_cast<float>(background[static_cast<int>(c)]);
                most = std::max(most, std::abs(a[c] - b[c] - (a[3] - b[3]) * behind));
            }
            const auto pixel = difference.pixel(x, y);
            for (std::size_t c = 0; c < 3; ++c) pixel[c] = std::min(1.0F, kGain * most);
            pixel[3] = 1;
        }
    }
    return difference;
}

}  // namespace

}  // namespace subvol::detail

namespace subvol {

using namespace detail;

namespace {

bool same_camera(const Camera& a, const Camera& b) {
    return a.eye == b.eye && a.target == b.target && a.up == b.up && a.fovy_deg == b.fovy_deg &&
           a.ortho_height == b.ortho_height;
}

/// The same picture with more pixels: each is the one that lies there.
Image enlarged(const Image& image, int width, int height) {
    if (image.width == width && image.height == height) return image;
    Image larger(width, height);
    for (int y = 0; y < height; ++y) {
        const int from = std::min(image.height - 1, y * image.height / height);
        for (int x = 0; x < width; ++x)
            std::ranges::copy(image.pixel(std::min(image.width - 1, x * image.width / width), from),
                              larger.pixel(x, y).begin());
    }
    return larger;
}

/// The picture beside that of another method, or their difference. A coarse one is enlarged; one of another camera is left out.
Image composed_of(const DrawnPicture& picture, const DrawnPicture& other, const ViewState& state) {
    if (!same_camera(picture.state.camera, other.state.camera)) return picture.image;
    const int width = std::max(picture.image.width, other.image.width);
    const int height = std::max(picture.image.height, other.image.height);
    const Image left = enlarged(picture.image, width, height), right = enlarged(other.image, width, height);
    const Vec3 behind = background_of(state);
    return state.difference ? difference_of(left, right, behind) : side_by_side(left, right, state.slider, ink_on(behind));
}

/// The one key and value of an action.
std::pair<std::string, Json> split_action(std::string_view action) {
    const Json json = parsed(action, "action");
    if (!json.is_object() || json.size() != 1) {
        throw Error(ErrorCode::InvalidInput, "is not an object with one key", "action", R"(such as {"orbit": [30, 0]})");
    }
    return {json.begin().key(), json.begin().value()};
}

std::shared_ptr<const ViewBody> tet_body(const ViewSource& source, HexMesh mesh, const std::string& field, Method method) {
    auto made = std::make_shared<ViewBody>(view_body(source.tets(std::move(mesh), default_tet_level(method)), field));
    made->tets = true;
    return made;
}

}  // namespace

detail::Json detail::parsed(std::string_view text, const std::string& where) {
    try {
        return Json::parse(of_limited_depth(text, where));
    } catch (const nlohmann::json::exception& error) {
        throw Error(ErrorCode::InvalidInput, "is not JSON: " + parser_message(error.what()), where);
    }
}

ViewSession::State::State(ViewSource from, HexMesh read, const ViewState& start, const MethodOptions& drawn,
                          std::function<void()> wake)
    : source(std::move(from)),
      settings(drawn),
      mesh(std::make_shared<HexMesh>(std::move(read))),
      state(start),
      on_picture(std::move(wake)),
      worker(settings, on_picture) {
    choose_body();
    show();
}

namespace {

/// The vectors of streamlines and arrows, and where streamlines start.
std::shared_ptr<const Flow> flow_of(const ViewSource& source, const HexMesh& mesh, const ViewFlow& wanted,
                                    const SchemeOptions& scheme) {
    if (!wanted.chosen.any()) return nullptr;
    if (!source.seeds || source.points.volume || source.tets)
        throw Error(ErrorCode::InvalidInput, "needs a mesh of hexahedra in memory", "flow");
    Flow flow = flow_in(mesh, wanted.chosen, OptionNames::Keywords);
    flow.limit = {.scheme = scheme};
    if (!flow.stream_vectors.empty()) flow.seeds = source.seeds(wanted, mesh, flow.limit);
    return std::make_shared<const Flow>(std::move(flow));
}

}  // namespace

void ViewSession::State::choose_body() {
    const auto field = state.field.empty() ? std::nullopt : std::optional(state.field);
    ViewBody shown = source.points.volume ? view_body(*mesh, source.points, field) : view_body(*mesh, field);
    shown.flow = flow_of(source, *mesh, state.flow, settings.kernels.sample.scheme);
    std::shared_ptr<const ViewBody> chosen = std::make_shared<const ViewBody>(std::move(shown));
    decltype(tet_levels) levels;
    if (source.tets) {
        chosen = tet_body(source, chosen->mesh, chosen->field(), state.method);
        levels[static_cast<std::size_t>(default_tet_level(state.method)) - 1] = chosen;
    }
    (void)optics_of(state, *chosen);  // a logarithmic scale does not fit every field
    state.field = chosen->field();
    body = std::move(chosen);
    tet_levels = std::move(levels);
    picked_field.reset();
    coarse.reset();
    edit_level = 0;
    selection.clear();  // of the points before
    ++shape;
    grabbed = false;
}

std::shared_ptr<const ViewBody> ViewSession::State::body_for(Method method) {
    if (!source.tets) return body;
    auto& level = tet_levels[static_cast<std::size_t>(default_tet_level(method)) - 1];
    if (!level) level = tet_body(source, view_body(*mesh, state.field).mesh, state.field, method);
    return level;
}

std::shared_ptr<const PickedField> ViewSession::State::field() {
    if (!picked_field) picked_field = std::make_shared<const PickedField>(body, settings.kernels.sample.scheme);
    return picked_field;
}

void ViewSession::State::take_step(std::size_t number, HexMesh read) {
    auto of_step = std::make_shared<HexMesh>(std::move(read));
    std::swap(mesh, of_step);
    const std::size_t shown = std::exchange(state.step, number);
    try {
        choose_body();
    } catch (...) {  // a step may lack the field
        std::swap(mesh, of_step);
        state.step = shown;
        throw;
    }
    edited = false;
    show();
}

void ViewSession::State::read_later(std::size_t number) {
    if (reading) {
        wanted = number;
        return;
    }
    reading = number;
    later.push_back(std::async(std::launch::async, [number, read = source.read]() -> Done {
        std::shared_ptr<HexMesh> found;
        std::exception_ptr wrong;
        try {
            found = std::make_shared<HexMesh>(read(number));
        } catch (...) {
            wrong = std::current_exception();
        }
        return [number, found, wrong](State& session) {
            session.reading.reset();
            const auto next = std::exchange(session.wanted, std::nullopt);
            if (next && *next != number) session.read_later(*next);
            if (wrong) std::rethrow_exception(wrong);
            Moment was = session.moment();
            session.take_step(number, std::move(*found));
            session.remember(std::move(was), "step");
        };
    }));
}

std::function<void()> ViewSession::State::writer(const std::string& path) const {
    const DrawWorker* other = state.compare ? reference.get() : nullptr;
    return [path, other, &drawn = worker, shown = state, &write = source.write_picture] {
        const auto picture = drawn.wait();
        const Image image = other != nullptr ? composed_of(*picture, *other->wait(), shown) : picture->image;
        write(path, image, background_of(shown));
    };
}

std::array<std::shared_ptr<const DrawnPicture>, 2> ViewSession::State::compared_pictures() const {
    if (!state.compare || !reference || !source.measure || worker.busy() || reference->busy()) return {};
    auto left = worker.latest(), right = reference->latest();
    const bool alike = left && right && left->scale == 1 && right->scale == 1 && left->image.width == right->image.width &&
                       left->image.height == right->image.height;
    if (!alike) return {};
    return {std::move(left), std::move(right)};
}

void ViewSession::State::measure_later(std::uint64_t number) {
    if (number == measured_number) return;
    compared.reset();
    const auto pictures = compared_pictures();
    if (!pictures[0]) return;
    measured_number = number;
    later.push_back(std::async(std::launch::async, [number, pictures, measure = source.measure]() -> Done {
        return [number, figures = measure(pictures[0]->image, pictures[1]->image)](State& session) {
            if (session.measured_number == number && session.state.compare) session.compared = figures;
        };
    }));
}

void ViewSession::State::show() {
    worker.show(state, body);
    show_reference();
}

void ViewSession::State::show_reference() {
    compared.reset();
    if (!state.compare) return;
    if (!reference) reference = std::make_unique<DrawWorker>(settings, on_picture);
    ViewState other = state;
    other.method = *state.compare;
    reference->show(other, body_for(*state.compare));
}

Image ViewSession::State::composed(const DrawnPicture& picture) const {
    if (!state.compare || !reference) return picture.image;
    const auto other = reference->latest();
    return other ? composed_of(picture, *other, state) : picture.image;
}

std::shared_ptr<const DrawnPicture> ViewSession::State::wait() {
    auto picture = worker.wait();
    if (state.compare) (void)reference->wait();
    note_wait();
    return picture;
}

void ViewSession::State::note_wait() {
    const DrawTimes times = worker.times();
    waits.push_back({action, times.first, times.full, times.coarse_scale, times.boundary, times.kernels, times.draw});
}

ViewSession::ViewSession(ViewSource source, HexMesh mesh, const ViewState& start, const MethodOptions& settings,
                         std::function<void()> on_picture)
    : state_(std::make_unique<State>(std::move(source), std::move(mesh), start, settings, std::move(on_picture))) {
}
ViewSession::~ViewSession() = default;

const ViewState& ViewSession::state() const {
    return state_->state;
}
const ViewBody& ViewSession::body() const {
    return *state_->body;
}
const ViewSource& ViewSession::source() const {
    return state_->source;
}
const DrawWorker& ViewSession::worker() const {
    return state_->worker;
}
const std::optional<Picked>& ViewSession::picked() const {
    return state_->picked;
}
const std::vector<WaitReport>& ViewSession::waits() const {
    return state_->waits;
}

const std::vector<std::string>& ViewSession::warnings() const {
    return state_->warnings;
}

const std::vector<std::size_t>& ViewSession::inverted_cells() const {
    return state_->inverted_cells();
}

std::vector<std::string> ViewSession::fields() const {
    std::vector<std::string> names;
    for (const Attribute& field : state_->mesh->attributes) names.push_back(field.name);
    return names;
}

void ViewSession::run(std::string_view action) {
    const auto [name, argument] = split_action(action);
    run_action(*state_, name, argument);
}

void ViewSession::start(std::string_view action) {
    const auto [name, argument] = split_action(action);
    start_action(*state_, name, argument);
}

const std::optional<PictureFigures>& ViewSession::compared() const {
    return state_->compared;
}

void ViewSession::measure() {
    const auto drawn = state_->compared_pictures();
    state_->measured_number = pictures();
    state_->compared = drawn[0] ? std::optional(state_->source.measure(drawn[0]->image, drawn[1]->image)) : std::nullopt;
}

DrawWorker::Work ViewSession::work() const {
    DrawWorker::Work work = state_->worker.work();
    if (!work.stage.empty() || !state_->reference || !state_->state.compare) return work;
    work = state_->reference->work();
    if (!work.stage.empty()) work.stage = "reference: " + work.stage;
    return work;
}

void ViewSession::settle() {
    state_->measure_later(pictures());
    auto& later = state_->later;
    for (std::size_t k = 0; k < later.size();) {
        if (later[k].wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
            ++k;
            continue;
        }
        auto ready = std::move(later[k]);
        later.erase(later.begin() + static_cast<std::ptrdiff_t>(k));
        ready.get()(*state_);
    }
}

std::vector<std::string> ViewSession::split_script(std::string_view script, const std::string& file) {
    std::vector<std::string> actions;
    if (script.empty()) return actions;
    const Json json = parsed(script, file);
    if (!json.is_array()) {
        throw Error(ErrorCode::InvalidInput, "is not an array of actions", file,
                    R"(such as [{"orbit": [30, 0]}, {"wait": true}])");
    }
    for (const Json& action : json) actions.push_back(action.dump(-1, ' ', false, Json::error_handler_t::replace));
    return actions;
}

void ViewSession::run_numbered(std::string_view action, std::size_t number, const std::string& file) {
    state_->action = number;
    try {
        run(action);
    } catch (const Error& error) {
        if (error.code() == ErrorCode::Cancelled) throw;
        const std::string what = error.where().empty() || error.where() == "action" ? "" : error.where() + ": ";
        throw Error(error.code(), what + error.message(), file + ", action " + std::to_string(number), error.allowed());
    }
}

void ViewSession::run_script(std::string_view script, const std::string& file, Progress* progress) {
    const std::vector<std::string> actions = split_script(script, file);
    for (std::size_t k = 0; k < actions.size(); ++k) {
        report_progress(progress, "play", k, actions.size());
        run_numbered(actions[k], k + 1, file);
    }
}

std::shared_ptr<const DrawnPicture> ViewSession::wait() {
    auto picture = state_->worker.wait();
    if (state_->reference && state_->state.compare) (void)state_->reference->wait();
    return picture;
}

Image ViewSession::composed(const DrawnPicture& picture) const {
    return state_->composed(picture);
}

const Selection& ViewSession::selection() const {
    return state_->selection;
}

const HexMesh& ViewSession::handles() const {
    return state_->handles();
}

int ViewSession::edit_level() const {
    return state_->edit_level;
}

bool ViewSession::shows_reference() const {
    const auto picture = state_->worker.latest(), other = state_->reference ? state_->reference->latest() : nullptr;
    return state_->state.compare && picture && other && same_camera(picture->state.camera, other->state.camera);
}

bool ViewSession::busy() const {
    return !state_->later.empty() || state_->worker.busy() ||
           (state_->reference && state_->state.compare && state_->reference->busy());
}

std::uint64_t ViewSession::pictures() const {
    return state_->worker.count() + (state_->reference ? state_->reference->count() : 0);
}

detail::WindowLook& ViewSession::look() {
    return state_->look;
}

std::vector<detail::CutHandle> ViewSession::cut_handles() const {
    return detail::cut_handles(state_->state, *state_->body);
}

void ViewSession::take_state(const ViewSession& other) {
    const Json shown = json_of(other.state_->state);
    for (const auto& [name, value] : shown.items()) {
        try {
            run_part(*state_, name, value);
        } catch (const Error&) {  // such as a field that this mesh does not have: stays as it is
        }
    }
}

std::string ViewSession::state_json() const {
    return saved_state(*state_).dump(2) + "\n";
}

const ViewBody* ViewSession::unsaved_edits() const {
    const auto& saved = state_->saved_edit;
    return !state_->edited || (saved && saved->body == state_->body) ? nullptr : state_->body.get();
}

std::string ViewSession::render_command() const {
    const ViewSource& source = state_->source;
    if (!state_->edited) return detail::render_command(state_->state, *state_->body, source, source.read_words);
    if (unsaved_edits() == nullptr) {
        ViewSource of_file = source;
        of_file.input = state_->saved_edit->file;
        of_file.times = {0.0};
        const bool marked = state_->state.inverted && !state_->inverted_cells().empty();
        return detail::render_command(state_->state, *state_->body, of_file, {}) +
               (marked ? "  # without the marks of inverted cells" : "");
    }
    return detail::render_command(state_->state, *state_->body, source, source.read_words) +
           "  # without the edits of the mesh, which is not saved";
}

}  // namespace subvol
