// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "report.h"
#include "subvol/refine.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// throws: Error(InvalidInput) unless it is mcq, cc, bsxw or linear
[[nodiscard]] Scheme scheme_named(const std::string& name);

/// How a mesh is refined, as every verb that refines asks for it.
struct RefineArguments {
    std::string scheme = "mcq";
    double tension = 1.0 / 16.0;
    std::optional<int> levels;
    std::optional<double> crease_angle_deg;

    /// levels_help: what --levels means for the verb
    void add_to(CLI::App& app, const std::string& levels_help);

    /// throws: Error(InvalidInput) if the scheme is unknown
    [[nodiscard]] RefineOptions options(int default_levels, Report& report) const;
};

enum class Vertices { OfTheLevel, OnTheLimit };

/// `refine`, timed and with its cells in the report; the vertices are those of the level, or moved on to the limit (which is
/// the same for schemes that interpolate).
///
/// throws: Error(MissingCapability) if the machine has not the memory for so many levels
[[nodiscard]] HexMesh refine_reported(const HexMesh& mesh, const RefineOptions& options, Vertices vertices, Report& report);

}  // namespace subvol::cli
