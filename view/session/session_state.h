// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "subvol/coarse_edit.h"
#include "subvol/detail/window_look.h"
#include "subvol/edit_mesh.h"
#include "subvol/probe.h"
#include "subvol/rbf_field.h"
#include "subvol/view_session.h"

namespace subvol::detail {

using Json = nlohmann::ordered_json;

/// Runs an action on a session; what is slow goes on by itself: see ViewSession::start.
void start_action(ViewSession::State& session, const std::string& name, const Json& argument);

/// Runs an action on a session.
///
/// throws: Error(InvalidInput), where() the name of the action
void run_action(ViewSession::State& session, const std::string& name, const Json& argument);
/// The same for an action that is a part of another one, with which it is undone.
void run_part(ViewSession::State& session, const std::string& name, const Json& argument);

/// The state as an object whose keys are names of actions: running them one by one restores it.
[[nodiscard]] Json json_of(const ViewState& state);

/// The same as it is saved: with the number of inverted cells, a fact that is not read again.
[[nodiscard]] Json saved_state(ViewSession::State& session);
inline constexpr const char* kInvertedCells = "inverted_cells";

/// The word-by-word command that draws the state.
///
/// read_words: options for reading the input
[[nodiscard]] std::string render_command(const ViewState& state, const ViewBody& body, const ViewSource& source,
                                         const std::vector<std::string>& read_words);

/// The field of a body that can be picked: the limit of its mesh, or the sum of its kernels. It is made ready by the first
/// call; several threads may call it.
class PickedField {
public:
    PickedField(std::shared_ptr<const ViewBody> body, const SchemeOptions& scheme) : body_(std::move(body)), scheme_(scheme) {}

    [[nodiscard]] Box box() const;
    /// For each place what is there; nothing outside.
    [[nodiscard]] std::vector<std::optional<Picked>> at(std::span<const Vec3> places) const;

private:
    void make() const;

    std::shared_ptr<const ViewBody> body_;
    SchemeOptions scheme_;
    mutable std::once_flag made_{};
    mutable std::optional<LimitProbe> limit_{};
    mutable std::optional<RbfField> kernels_{};
};

/// Where most of the light of a pixel comes from.
[[nodiscard]] std::optional<Picked> pick(const PickedField& field, const Optics& optics, const Ray& ray);

/// Parses JSON. throws: Error(InvalidInput), in one sentence
[[nodiscard]] Json parsed(std::string_view text, const std::string& where);

}  // namespace subvol::detail

namespace subvol {

struct ViewSession::State {
    State(ViewSource from, HexMesh read, const ViewState& start, const MethodOptions& drawn, std::function<void()> on_picture);

    /// Takes the field of the state from the mesh.
    void choose_body();
    /// What a method draws: of a scheme of tetrahedra one of two levels, of all else the body.
    [[nodiscard]] std::shared_ptr<const ViewBody> body_for(Method method);
    /// Lets the worker of the second picture draw the state.
    void show_reference();
    /// Lets the worker draw the state.
    void show();
    [[nodiscard]] std::shared_ptr<const detail::PickedField> field();
    /// Shows another step.
    void take_step(std::size_t number, HexMesh read);
    /// Reads a step on another thread, then shows it.
    void read_later(std::size_t number);
    /// Writes the picture of the state once it is done. Another thread may call the result.
    [[nodiscard]] std::function<void()> writer(const std::string& path) const;
    [[nodiscard]] std::shared_ptr<const DrawnPicture> wait();
    void note_wait();
    /// The mesh whose control points are edited.
    [[nodiscard]] const HexMesh& handles() const { return coarse ? coarse->coarse() : body->mesh; }

    /// What undo goes back to: all that actions change.
    struct Moment {
        ViewState state{};
        std::shared_ptr<const ViewBody> body{};
        std::shared_ptr<HexMesh> mesh{};  ///< the mesh of the step, with all fields
        bool edited = false;
    };
    [[nodiscard]] Moment moment() const { return {state, body, mesh, edited}; }
    /// Keeps for `undo` what was there before an action, unless the action changed nothing.
    ///
    /// motion: not empty: equal actions one after the other are undone as one
    void remember(Moment was, const std::string& motion);
    void restore(const Moment& moment);
    /// Takes the newest moment of one list for the state, which the other one keeps.
    void go_back(std::vector<Moment>& from, std::vector<Moment>& to);
    /// Gives the mesh the points of the body, and the values of its field.
    void take_values_of_body();
    /// Shows another shape of the body's mesh.
    void replace(HexMesh next);
    /// The numbers of the inverted cells of the body. They are counted when somebody asks, and from then on kept up to date.
    [[nodiscard]] const std::vector<std::size_t>& inverted_cells();
    /// The picture beside that of the other method, if two are compared and the other one is there.
    [[nodiscard]] Image composed(const DrawnPicture& picture) const;
    /// The two pictures that are compared, once both are full; else null.
    [[nodiscard]] std::array<std::shared_ptr<const DrawnPicture>, 2> compared_pictures() const;
    /// Measures them on another thread, if there are more pictures now.
    void measure_later(std::uint64_t number);

    ViewSource source;
    MethodOptions settings;
    std::shared_ptr<HexMesh> mesh;  // all fields of the step; its points are those of the body
    bool edited = false;            // the points or values are no longer those of the input
    ViewState state;
    std::shared_ptr<const ViewBody> body;
    std::array<std::shared_ptr<const ViewBody>, 2> tet_levels;  // of the field and step, as far as they were needed
    std::shared_ptr<const detail::PickedField> picked_field;    // of `body`
    /// The file that an edited body was saved in.
    struct SavedEdit {
        std::string file{};
        std::shared_ptr<const ViewBody> body{};
    };
    std::optional<SavedEdit> saved_edit;
    std::shared_ptr<const ViewBody> counted;  // a body that was not edited, and its inverted cells
    std::vector<std::size_t> inverted_at_first;
    std::optional<CoarseEdit> coarse;         // the level that is edited; none: the mesh itself
    int edit_level = 0;                       // how much coarser it is
    Selection selection;                      // of `handles`; empty: nothing
    std::vector<Moment> before, after;        // for undo and redo
    std::string last_motion;                  // that is not undone by itself; empty: none
    std::uint64_t shape = 0;                  // of the cells that are edited; 0: none yet
    bool grabbed = false, kept_grab = false;  // a motion in many small steps, which are undone as one
    std::optional<Picked> picked;
    std::optional<PictureFigures> compared;  // of the two pictures that are compared
    std::uint64_t measured_number = 0;       // how many pictures there were then
    std::size_t action = 0;
    std::vector<WaitReport> waits;
    std::vector<std::string> warnings;  // of actions
    detail::WindowLook look;
    std::function<void()> on_picture;
    DrawWorker worker;
    std::unique_ptr<DrawWorker> reference;       // once two pictures have been compared
    std::optional<std::size_t> reading, wanted;  // steps: that is being read, and that was asked for meanwhile

    /// What other threads are at. Each ends in what is to be done here then.
    using Done = std::function<void(State&)>;
    std::vector<std::future<Done>> later;  // the last member: it ends first
};

}  // namespace subvol
