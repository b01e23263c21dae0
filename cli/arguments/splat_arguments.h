// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "subvol/splat_options.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// The options of splatting.
///
/// chosen: those that the library describes
struct SplatArguments {
    SplatOptions chosen{};
    bool shade = false;
    bool plain_sums = false;
    std::optional<std::string> color_field{};

    void add_to(CLI::App& app);

    [[nodiscard]] SplatOptions options() const;
};

}  // namespace subvol::cli
