#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "report.h"
#include "subvol/refine.h"

namespace subvol::cli {

/// How a mesh is refined, as every verb that refines asks for it.
struct RefineArguments {
    std::string scheme = "mcq";
    std::optional<int> levels;
    std::optional<double> crease_angle_deg;

    /// levels_help: what --levels means for the verb
    void add_to(CLI::App& app, const std::string& levels_help);

    /// throws: Error(InvalidInput) if the scheme is unknown or not there yet
    [[nodiscard]] RefineOptions options(int default_levels, Report& report) const;
};

/// `refine`, timed and with its cells in the report.
///
/// throws: Error(MissingCapability) if the machine has not the memory for so many levels
[[nodiscard]] HexMesh refine_reported(const HexMesh& mesh, const RefineOptions& options, Report& report);

}  // namespace subvol::cli
