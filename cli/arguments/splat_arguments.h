// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "report.h"
#include "subvol/splat.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// The method of a backend's name (auto, gl, cpu).
[[nodiscard]] SplatMethod splat_method(const std::string& backend, bool by_sheets);

/// The options of splatting.
struct SplatArguments {
    std::string backend = "auto";
    std::optional<int> device;
    int sheets = 0;  // as many as needed
    bool shade = false;
    bool shadows = false;
    double ambient_occlusion = 0;
    bool plain_sums = false;
    std::optional<std::string> color_field;
    std::optional<double> seconds;

    void add_to(CLI::App& app);

    /// If there is a --color-field, it is the volume's second channel.
    ///
    /// by_sheets: --method sheets
    /// throws:    Error(InvalidInput) if a name is unknown, or the backend cannot draw sheets
    [[nodiscard]] SplatOptions options(bool by_sheets) const;
};

/// Adds the seconds, the backend and the device of a splatted picture to the report.
void report_splats(const SplatReport& splats, Report& report);

}  // namespace subvol::cli
