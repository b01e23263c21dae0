// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/facts.h"
#include "subvol/option_names.h"
#include "subvol/refine.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// Whether it is a scheme of tetrahedra only.
[[nodiscard]] bool is_tet_scheme(const std::string& name);
[[nodiscard]] std::vector<std::string> tet_schemes();

/// throws: Error(InvalidInput) unless it is mcq, cc, bsxw or linear
[[nodiscard]] Scheme scheme_named(const std::string& name);

/// The options of refinement, the same for every verb that refines.
struct RefineArguments {
    std::string scheme = "mcq";
    SchemeOptions rules{};  // all but its kind, which may be one of tetrahedra
    std::optional<int> levels;

    [[nodiscard]] std::vector<Option> described();
    /// All but --levels, for verbs that evaluate the limit.
    void add_scheme_to(CLI::App& app);
    /// levels_help: what --levels means for the verb
    void add_to(CLI::App& app, const std::string& levels_help);

    /// throws: Error(InvalidInput) if the scheme is unknown
    [[nodiscard]] RefineOptions options(int default_levels, Progress* progress) const;
};

/// As `detail::check_memory`; the error names --levels.
void check_memory(int level, double cells, double bytes_per_cell);

enum class Vertices { OfTheLevel, OnTheLimit };

/// `refine`, timed and with the number of cells in the facts. The vertices are those of the level, or moved to the limit
/// (which is the same for schemes that interpolate).
///
/// part:   a flag for each cell: only these are refined, as `refined_part`; empty: all
/// throws: Error(MissingCapability) if the machine does not have the memory for so many levels
[[nodiscard]] WithFacts<HexMesh> refine_reported(const HexMesh& mesh, const RefineOptions& options, Vertices vertices,
                                                 std::span<const std::uint8_t> part = {});

}  // namespace subvol::cli
