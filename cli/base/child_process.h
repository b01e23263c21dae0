// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>
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

/// How another program is run as a child.
///
/// file:        an open file that the child has as its number 3; -1: none
/// no_input:    it has an empty standard input
/// interrupted: the signal that it gets when this program is interrupted; SIGKILL: its own children get it, too
/// orphaned:    the signal that it gets when this program ends
struct ChildOptions {
    int file = -1;
    bool no_input = false;
    int interrupted = SIGTERM;
    int orphaned = SIGPIPE;
};

/// The same for another program. path: of its file
[[nodiscard]] ChildResult run_program(const std::string& path, const std::vector<std::string>& arguments,
                                      const ChildOptions& options);

}  // namespace subvol::cli
