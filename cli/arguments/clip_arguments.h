// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "subvol/clip.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// The options that cut a volume open.
struct ClipArguments {
    std::vector<std::string> planes, slices;
    std::string box;
    bool around_slices = false;

    void add_to(CLI::App& app);

    /// throws: Error(InvalidInput) if an option is not so many numbers, a normal has no length or the box is empty
    [[nodiscard]] Clip clip() const;
};

}  // namespace subvol::cli
