// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "subvol/certificate.h"
#include "subvol/facts.h"

namespace subvol {

/// folds:          how the limit is checked
/// boundary_edges: how far a point of the boundary may move, as a part of its shortest edge; with 0 the boundary stays
/// rounds:         how often points are moved and the limit is checked again, at most
struct MendOptions {
    FoldOptions folds{};
    double boundary_edges = 0.1;
    int rounds = 10;
};

/// The options without those of the check.
[[nodiscard]] std::vector<Option> options_of(MendOptions& options);

/// before:         what the check found
/// moved:          control points that lie elsewhere now
/// farthest_edges: the longest way of a point, in its shortest edges; boundary_edges: the same of the points of the boundary
/// rounds:         that were made
/// work, budget:   what was done and the most that is done, in tests of the check and steps that take as long: some 40 µs each.
///                 Mending ends when the budget is used up, and with what was best until then
/// left:           cells that still fold or are undecided though they are regular, and why each could not be mended
struct MendReport {
    FoldReport before;
    std::size_t moved = 0;
    double farthest_edges = 0, boundary_edges = 0;
    int rounds = 0;
    std::size_t work = 0, budget = 0;
    struct Left {
        Index cell = 0;
        std::string reason;
    };
    std::vector<Left> left;
};

/// The report under its members' names, but "folded" and "open" for the numbers of cells before.
[[nodiscard]] Facts facts_of(const MendReport& report);

/// check: of the mesh as it is now
struct Mended {
    HexMesh mesh;
    FoldCheck check;
    MendReport report;
};

/// Moves control points, as little as it can, until the limit is proved not to fold.
///
/// Points near cells that fold or are undecided move; what is minimised is the sum of the squares of their ways, each in its
/// shortest edge, under the condition that the determinants of the cells' children keep a part of the cell's volume. Points of
/// the boundary move along it rather than across it. The check decides whether that was enough; what is not mended is named.
/// Attributes stay with their points. A mesh without folds is returned as it is.
///
/// throws: Error(InvalidInput) as `check_folds`, or if an option is out of range
/// cost:   two checks, and some seconds for each thousand cells that are near to folds, but no more than a budget of 200,000
///         tests and 200 for each cell of the mesh: 8 s and 8 s for each thousand cells; parallel, the same bits for any number
///         of threads
[[nodiscard]] Mended mend_folds(HexMesh mesh, const MendOptions& options = {});

}  // namespace subvol
