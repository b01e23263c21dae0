// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "subvol/view_session.h"

namespace subvol {

/// script:      a JSON array of actions that are played in the window; empty: none
/// script_file: named in errors
/// window_shot: gets the pixels of the whole window when the script has ended, and the window closes; empty: it stays open
/// dark:        dark panels
struct WindowOptions {
    int width = 1280, height = 800;
    std::string title = "subvol";
    std::string script{};
    std::string script_file{};
    std::function<void(const Image& window)> window_shot{};
    bool dark = true;
};

/// Shows a session in a window until the user closes it. To be called from the main thread.
///
/// throws: Error(MissingCapability) if there is no display, or the library is built without a window; as
///         ViewSession::run_script
void open_view_window(ViewSession& session, const WindowOptions& options = {});

}  // namespace subvol
