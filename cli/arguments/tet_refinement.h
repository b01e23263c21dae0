// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "refine_arguments.h"
#include "subvol/refine_mixed.h"

namespace subvol::cli {

/// The refinement by a scheme of tetrahedra, for verbs that do all else with hexahedra: the mesh is refined so often, put on
/// its limit and cut into hexahedra, whose volume is then the linear one.
class TetRefinement {
public:
    TetRefinement() = default;

    /// Takes a scheme of tetrahedra out of the arguments; they then say "linear" and have no levels.
    explicit TetRefinement(RefineArguments& arguments);

    [[nodiscard]] bool asked() const { return scheme_.has_value(); }

    /// "tetoct" or "boxspline"; only if asked.
    [[nodiscard]] std::string name() const { return std::string(name_of(*scheme_)); }

    /// throws: Error(InvalidInput) if asked; bricks: the folder
    void refuse_bricks(const std::string& bricks) const;

    /// The refined mesh; timed and with its cells in the facts. On the limit: the one that passes through the points and
    /// values of the mesh, since values of a file are those at its points; else the level of the mesh as it is.
    ///
    /// parents: gets the `control_cells` of its cells; null: they are not asked for
    [[nodiscard]] WithFacts<MixedMesh> refined(const HexMesh& mesh, int default_levels, Vertices vertices, Progress* progress,
                                               std::vector<Index>* parents = nullptr) const;

    /// The mesh as it is, if no such scheme is asked for; else `refined`, on the limit, as hexahedra.
    [[nodiscard]] WithFacts<HexMesh> hexes(HexMesh mesh, int default_levels, Progress* progress) const;

    /// The figures of the refined mesh on the limit, without fields: those that `refined` finds, and its volume.
    /// Seconds and warnings are facts beside the value.
    [[nodiscard]] WithFacts<Facts> figures(const HexMesh& mesh, int default_levels, Progress* progress) const;

private:
    std::optional<TetScheme> scheme_;
    std::optional<int> levels_;
    std::optional<double> crease_angle_deg_;
};

}  // namespace subvol::cli
