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
///
/// only: regions; warp: a displacement; both as the options of the command; none: the whole mesh, at rest
struct OpenedFile {
    std::string name{};
    std::vector<std::string> only{};
    std::optional<std::string> warp{};
    bool operator==(const OpenedFile&) const = default;
};

/// script:      a JSON array of actions that are played in the window; empty: none
/// script_file: named in errors
/// window_shot: gets the pixels of the whole window when the script has ended, and the window closes; empty: it stays open
/// dark:        dark panels
/// open:        makes a session of a file, on another thread; empty: the window opens no files
/// first:       the file of the session that the window begins with
/// extensions:  endings of files that `open` reads, as ".vtu"; models: names that it takes as files, too
/// recent_list: a file with the names of those that were opened; empty: none is kept
struct WindowOptions {
    int width = 1280, height = 800;
    std::string title = "subvol";
    std::string script{};
    std::string script_file{};
    std::function<void(const Image& window)> window_shot{};
    bool dark = true;
    std::function<std::unique_ptr<ViewSession>(const OpenedFile& file, Progress* progress)> open{};
    OpenedFile first{};
    std::vector<std::string> extensions{}, models{};
    std::filesystem::path recent_list{};
};

/// Shows a session in a window until the user closes it. To be called from the main thread.
///
/// session: null: the window begins with a page that opens files
/// returns: the session that was shown last; null: none was
/// throws: Error(MissingCapability) if there is no display, or the library is built without a window; as
///         ViewSession::run_script
std::unique_ptr<ViewSession> open_view_window(std::unique_ptr<ViewSession> session, const WindowOptions& options = {});

}  // namespace subvol
