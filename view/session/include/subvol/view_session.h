// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/detail/cut_handle.h"
#include "subvol/detail/window_look.h"
#include "subvol/draw_worker.h"
#include "subvol/edit_mesh.h"
#include "subvol/image.h"

namespace subvol {

/// How far two pictures are apart: as of `compare_images` and `flip`.
struct PictureFigures {
    double psnr = 0, flip = 0;
};

/// Where a session gets its meshes from.
struct ViewSource {
    std::string input{};                              ///< the name of the input, for the render command
    std::function<HexMesh(std::size_t step)> read{};  ///< reads a mesh with all its fields. `step`: of a series, from 0
    std::vector<double> times{0.0};                   ///< the time of each step; at least one
    /// Writes a picture over a background; empty: the action `screenshot` is refused.
    std::function<void(const std::filesystem::path& path, const Image& image, const Vec3& background)> write_picture{};
    /// Compares two pictures of one size; empty: comparisons have no figures.
    std::function<PictureFigures(const Image& test, const Image& reference)> measure{};
    /// The places in a mesh where streamlines start; empty: streamlines and arrows are refused.
    std::function<std::vector<Vec3>(const ViewFlow& flow, const HexMesh& mesh, const LimitOptions& limit)> seeds{};
    std::vector<std::string> notes{};  ///< warnings of reading the input
    /// Further words of the render command: options that no action changes; `read_words` has those for reading the input, which
    /// a mesh that was saved here does not need.
    std::vector<std::string> more_words{}, read_words{};
    /// Shown instead of a mesh: kernels or voxels, which have one step and are not edited; without a volume: a mesh is.
    ViewPoints points{};
    /// A level of a scheme of tetrahedra for a mesh with one field, on its limit, in hexahedra, which is shown instead of the
    /// mesh and not edited; the settings then have the scheme `linear` and no levels. The `level` is 1 for kernels, 2 for other
    /// methods, unless the user chose another. Empty: the mesh is shown.
    std::function<HexMesh(HexMesh mesh, int level)> tets{};
};

/// What is under a pixel: where most of its light comes from, with the value of the limit, or of the kernels, there.
struct Picked {
    Vec3 place{0.0};
    double value = 0;
    Vec3 gradient{0.0};
    Index cell = kNone;  ///< kNone for points and for schemes of tetrahedra
};

/// What waiting for a picture showed.
struct WaitReport {
    std::size_t action = 0;  ///< the number of the action in the script
    double seconds_first = 0, seconds_full = 0;
    int coarse_scale = 0;
    double seconds_boundary = 0, seconds_kernels = 0, seconds_draw = 0;  ///< for the first picture
};

/// A mesh that is looked at: the state, the actions that change it, and the thread that draws it. It needs no window; the
/// window does nothing but run actions, too.
///
/// An action is a JSON object with one key, its name, as `{"orbit": [30, -10]}` (docs/view.md has all).
class ViewSession {
public:
    struct State;  // private: defined in a private header

    /// start:      its field may be empty; its camera is taken as it is
    /// mesh:       of the state's step, with all fields; of points as of `mesh_of_points`
    /// on_picture: as of DrawWorker
    ViewSession(ViewSource source, HexMesh mesh, const ViewState& start, const MethodOptions& settings,
                std::function<void()> on_picture = {});
    ~ViewSession();
    ViewSession(const ViewSession&) = delete;
    ViewSession& operator=(const ViewSession&) = delete;

    [[nodiscard]] const ViewState& state() const;
    [[nodiscard]] const ViewBody& body() const;
    [[nodiscard]] const ViewSource& source() const;
    /// The names of the fields of the mesh.
    [[nodiscard]] std::vector<std::string> fields() const;
    /// The methods that can draw it.
    [[nodiscard]] std::vector<std::string> methods() const { return methods_of(body()); }
    [[nodiscard]] const DrawWorker& worker() const;
    /// The mesh whose control points are edited: that of the body, or a coarser level of it (`CoarseEdit`).
    [[nodiscard]] const HexMesh& handles() const;
    /// How much coarser it is.
    [[nodiscard]] int edit_level() const;
    /// The control points of `handles` that edits move; empty: none.
    [[nodiscard]] const Selection& selection() const;
    /// What the last action `pick` found; none: it missed the volume.
    [[nodiscard]] const std::optional<Picked>& picked() const;
    [[nodiscard]] const std::vector<WaitReport>& waits() const;
    /// What users should know about what actions did, such as inverted cells of a mesh that was saved.
    [[nodiscard]] const std::vector<std::string>& warnings() const;
    /// The numbers of the cells with a negative Jacobian at a corner, ascending; of points none.
    ///
    /// cost: the first call measures all cells; after an edit only those about moved points are measured
    [[nodiscard]] const std::vector<std::size_t>& inverted_cells() const;

    /// Runs one action. Nothing changes if it throws.
    ///
    /// action: its JSON
    /// throws: Error(InvalidInput) if it is not an action, or its argument is out of range; Error(Io)
    void run(std::string_view action);

    /// The same for a window, which must not wait: picking, reading a step and writing a picture go on by themselves.
    ///
    /// throws: as `run`, for what is known at once
    void start(std::string_view action);
    /// Takes what has been finished of these.
    ///
    /// throws: the error of one of them
    void settle();

    /// Runs a script, a JSON array of actions, from its first action on, and waits for the last full picture.
    ///
    /// file:   named in errors
    /// throws: as `run`, with the number of the action, from 1
    void run_script(std::string_view script, const std::string& file, Progress* progress = nullptr);

    /// The actions of a script, and one of them: for those who play it bit by bit. number: from 1
    [[nodiscard]] static std::vector<std::string> split_script(std::string_view script, const std::string& file);
    void run_numbered(std::string_view action, std::size_t number, const std::string& file);

    /// Waits for the full picture of the state as it is.
    [[nodiscard]] std::shared_ptr<const DrawnPicture> wait();

    /// What is to be seen of a picture of the worker: if two methods are compared, both.
    [[nodiscard]] Image composed(const DrawnPicture& picture) const;
    /// Whether the second picture of a comparison is there for this camera; else only the first one is shown.
    [[nodiscard]] bool shows_reference() const;
    /// Whether a picture is still being drawn, or something goes on that was started.
    [[nodiscard]] bool busy() const;
    /// What the workers are at; of the reference, if the picture is done.
    [[nodiscard]] DrawWorker::Work work() const;
    /// The figures of a comparison; none: no two pictures are compared, or they are not done yet.
    [[nodiscard]] const std::optional<PictureFigures>& compared() const;
    /// Measures them now, if the pictures are there.
    void measure();
    /// How many pictures were drawn, coarse and full ones.
    [[nodiscard]] std::uint64_t pictures() const;
    [[nodiscard]] detail::WindowLook& look();
    /// Where the planes that cut can be taken hold of.
    [[nodiscard]] std::vector<detail::CutHandle> cut_handles() const;

    /// The body with edits of the mesh that are in no file; null: there are none.
    [[nodiscard]] const ViewBody* unsaved_edits() const;

    /// Shows the same as another session, as far as the mesh has it.
    void take_state(const ViewSession& other);

    /// The state as JSON, which the action `load_state` reads.
    [[nodiscard]] std::string state_json() const;
    /// The command that makes the same picture. An edited mesh has to be saved first; else a comment says so.
    [[nodiscard]] std::string render_command() const;

private:
    std::unique_ptr<State> state_;
};

}  // namespace subvol
