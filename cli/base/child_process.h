// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace subvol::cli {

/// What a program that has ended left.
///
/// signal: that ended it; 0: it ended by itself
struct ChildResult {
    int code = 0;
    int signal = 0;
    std::string out, err;
};

/// Runs this program again with other arguments and waits for it. It is asked to stop when this program is, and ends with it,
/// whatever ends that. Callable from several threads.
///
/// throws: Error(MissingCapability) if it cannot be started
[[nodiscard]] ChildResult run_self(const std::vector<std::string>& arguments);

}  // namespace subvol::cli
