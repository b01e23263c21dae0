// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "subvol/detail/cut_handle.h"
#include "subvol/detail/window_look.h"
#include "subvol/view_state.h"
#include "subvol/view_window.h"

namespace subvol::detail {

/// A picture for the screen.
struct ScreenPicture {
    int width = 0, height = 0, scale = 1;
    std::vector<std::uint8_t> rgba{};  ///< 8 bits each, sRGB, over the background
    std::uint64_t number = 0;          ///< rises with each picture; 0: none yet
};

/// A colour map at a value: sRGB, 0..1, and the opacity.
struct CurvePlace {
    float red = 0, green = 0, blue = 0, alpha = 0;
};

/// What is at work.
struct WindowWork {
    std::string stage{};  ///< the stage; empty: nothing is at work
    double fraction = 0;  ///< the fraction of the stage that is done
    double seconds = 0;   ///< since it was asked for
};

/// What the window needs of the session. The window is in a module of its own, which has no other way to it; all that it
/// changes, it changes by actions.
class WindowHost {
public:
    virtual ~WindowHost() = default;

    /// Whether a file is shown. All below that is about a picture needs one.
    [[nodiscard]] virtual bool has_session() const = 0;
    /// What is shown, as it was opened.
    [[nodiscard]] virtual const OpenedFile& opened() const = 0;
    /// Edits of the mesh that are in no file, one after another by another number; 0: there are none.
    [[nodiscard]] virtual std::uintptr_t unsaved_edits() const = 0;
    /// Begins to read a file, which then takes the place of what is shown.
    virtual void open(const OpenedFile& file) = 0;
    /// Gives up reading a file, or drawing.
    virtual void stop() = 0;
    [[nodiscard]] virtual WindowWork work() const = 0;
    /// Files that were opened before, the newest first.
    [[nodiscard]] virtual std::vector<std::string> recent() const = 0;
    /// Endings of files that can be opened, as ".vtu"; models: names of generated meshes.
    [[nodiscard]] virtual const std::vector<std::string>& extensions() const = 0;
    [[nodiscard]] virtual const std::vector<std::string>& models() const = 0;
    /// Warnings of reading the file.
    [[nodiscard]] virtual std::vector<std::string> notes() const = 0;

    [[nodiscard]] virtual const ViewState& state() const = 0;
    /// Runs an action. returns: what is wrong with it, in one sentence; empty: nothing
    [[nodiscard]] virtual std::string run(const std::string& action) = 0;
    /// Takes the results of actions that went on by themselves. returns: what is wrong with one of them; empty: nothing
    [[nodiscard]] virtual std::string settle() = 0;
    [[nodiscard]] virtual WindowLook& look() = 0;

    /// Replaces the picture if there is a newer one. returns: whether there was
    [[nodiscard]] virtual bool take_picture(ScreenPicture& picture) = 0;
    [[nodiscard]] virtual bool busy() const = 0;
    /// Whether the picture of the other method is there, too.
    [[nodiscard]] virtual bool shows_reference() const = 0;
    /// The error of the picture; empty: none.
    [[nodiscard]] virtual std::string problem() const = 0;
    /// A line of figures about the picture.
    [[nodiscard]] virtual std::string figures() const = 0;

    [[nodiscard]] virtual std::vector<std::string> fields() const = 0;
    [[nodiscard]] virtual std::vector<std::string> methods() const = 0;
    /// The colour maps that need no file.
    [[nodiscard]] virtual std::vector<std::string> maps() const = 0;
    [[nodiscard]] virtual const std::vector<double>& times() const = 0;
    [[nodiscard]] virtual ValueRange field_range() const = 0;
    [[nodiscard]] virtual ValueRange shown_range() const = 0;
    /// How many control points have values in each of the bins of a range.
    [[nodiscard]] virtual std::vector<double> histogram(const ValueRange& range, std::size_t bins) const = 0;
    /// The colour map at equally spaced values.
    [[nodiscard]] virtual std::vector<CurvePlace> curve(const ValueRange& range, std::size_t count) const = 0;
    [[nodiscard]] virtual std::vector<TransferFunction::OpacityKnot> opacity() const = 0;
    /// How much coarser the level is that is edited.
    [[nodiscard]] virtual int edit_level() const = 0;
    /// How many cells of the mesh are inverted.
    [[nodiscard]] virtual std::size_t inverted_cells() const = 0;
    /// Where selected control points are in the picture (column, row) and their shares.
    [[nodiscard]] virtual std::vector<Vec3> selected_pixels() const = 0;
    [[nodiscard]] virtual std::vector<CutHandle> cut_handles() const = 0;
    [[nodiscard]] virtual std::vector<std::string> picked() const = 0;
    [[nodiscard]] virtual std::string render_command() const = 0;

    /// Plays the next action of the script, if there is one and it does not have to wait.
    ///
    /// returns: whether the script has ended, and the window is to be saved and closed
    [[nodiscard]] virtual bool play_script() = 0;
    /// pixels: RGB, rows from the top
    virtual void save_window(int width, int height, const std::vector<std::uint8_t>& pixels) = 0;
};

/// A session as the window sees it. options: referred to
[[nodiscard]] std::unique_ptr<WindowHost> window_host(std::unique_ptr<ViewSession> session, const WindowOptions& options);

/// What the window is opened with.
struct WindowStart {
    int width = 1280, height = 800;
    const char* title = "subvol";
};

/// The function of the module. It throws nothing but std::bad_alloc, and what the host throws.
struct WindowFunctions {
    /// returns: why there is no window; nothing: it was there, and was closed
    std::optional<std::string> (*run)(WindowHost& host, const WindowStart& start);
};

}  // namespace subvol::detail
