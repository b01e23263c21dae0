// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "subvol/view_session.h"

namespace subvol {

/// A file with its options: how the command reads it.
struct OpenedFile {
    std::string name{};
    std::vector<std::string> only{};    ///< regions, as the option of the command; none: the whole mesh
    std::optional<std::string> warp{};  ///< a displacement, as the option of the command; none: the mesh at rest
    bool operator==(const OpenedFile&) const = default;
};

struct WindowOptions {
    int width = 1280, height = 800;
    std::string title = "subvol";
    std::string script{};       ///< a JSON array of actions that are played in the window; empty: none
    std::string script_file{};  ///< the name of the script's file in errors
    /// Gets the pixels of the whole window when the script has ended, and the window closes; empty: it stays open.
    std::function<void(const Image& window)> window_shot{};
    bool dark = true;  ///< dark panels
    /// Makes a session of a file, on another thread; empty: the window opens no files.
    std::function<std::unique_ptr<ViewSession>(const OpenedFile& file, Progress* progress)> open{};
    OpenedFile first{};  ///< the file of the session that the window begins with
    /// Endings of files that `open` reads, as ".vtu", and names that it takes as files, too.
    std::vector<std::string> extensions{}, models{};
    std::filesystem::path recent_list{};  ///< a file with the names of the files that were opened; empty: none is kept
};

/// Shows a session in a window until the user closes it. To be called from the main thread.
///
/// session: null: the window begins with a page that opens files
/// returns: the session that was shown last; null: none was
/// throws: Error(MissingCapability) if there is no display, or the library is built without a window; as
///         ViewSession::run_script
std::unique_ptr<ViewSession> open_view_window(std::unique_ptr<ViewSession> session, const WindowOptions& options = {});

}  // namespace subvol
