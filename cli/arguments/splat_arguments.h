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
struct SplatArguments {
    std::string backend = "auto";
    std::optional<int> device{};
    int sheets = 0;  // as many as needed
    bool shade = false;
    bool shadows = false;
    double ambient_occlusion = 0;
    bool plain_sums = false;
    std::optional<std::string> color_field{};
    std::optional<double> seconds{};

    void add_to(CLI::App& app);

    /// throws: Error(InvalidInput) if a name is unknown
    [[nodiscard]] SplatOptions options() const;
};

}  // namespace subvol::cli
