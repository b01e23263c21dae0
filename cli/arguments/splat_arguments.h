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

/// How the method of that name splats (splat, sheets, footprints), and where (auto, gl, cpu).
[[nodiscard]] SplatMethod splat_method(const std::string& method, const std::string& backend);

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
    /// method: of --method
    /// throws: Error(InvalidInput) if a name is unknown, or the backend cannot draw so
    [[nodiscard]] SplatOptions options(const std::string& method) const;
};

/// Adds the seconds, the backend and the device of a splatted picture to the report.
void report_splats(const SplatReport& splats, Report& report);

}  // namespace subvol::cli
