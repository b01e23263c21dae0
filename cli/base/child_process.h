// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace subvol::cli {

/// The result of a child process.
struct ChildResult {
    int code = 0;
    int signal = 0;  ///< the signal that ended it; 0: it exited by itself
    std::string out, err;
};

/// Runs this program again with other arguments and waits for it. An interrupt of this program is passed on to the child, and
/// the child ends when this program does, for whatever reason. May be called from several threads.
///
/// throws: Error(MissingCapability) if it cannot be started
[[nodiscard]] ChildResult run_self(const std::vector<std::string>& arguments);

}  // namespace subvol::cli
