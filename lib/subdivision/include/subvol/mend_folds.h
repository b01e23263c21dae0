// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "subvol/certificate.h"
#include "subvol/facts.h"

namespace subvol {

struct MendOptions {
    FoldOptions folds{};  ///< how the limit is checked
    /// How far a point of the boundary may move, as a part of its shortest edge; with 0 the boundary stays
    double boundary_edges = 0.1;
    int rounds = 10;  ///< how often points are moved and the limit is checked again, at most
};

/// The options without those of the check.
[[nodiscard]] std::vector<Option> options_of(MendOptions& options);

struct MendReport {
    FoldReport before;          ///< what the check found
    std::size_t moved = 0;      ///< control points that lie elsewhere now
    double farthest_edges = 0;  ///< longest way of a point, in its shortest edges
    double boundary_edges = 0;  ///< the same for the points of the boundary
    int rounds = 0;             ///< rounds that were made
    /// What was done and the most that is done, in tests of the check and steps that take as long: some 15 µs each. Mending
    /// ends when the budget is used up, and with what was best until then
    std::size_t work = 0, budget = 0;
    struct Left {
        Index cell = 0;
        std::string reason;
    };
    /// Cells that still fold or are undecided though they are regular, and why each could not be mended
    std::vector<Left> left;
};

/// The report under its members' names, but "folded" and "open" for the numbers of cells before.
[[nodiscard]] Facts facts_of(const MendReport& report);

struct Mended {
    HexMesh mesh;
    FoldCheck check;  ///< check of the mesh as it is now
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
///         tests and 200 for each cell of the mesh: 3 s and 3 s for each thousand cells; parallel, the same bits for any number
///         of threads
[[nodiscard]] Mended mend_folds(HexMesh mesh, const MendOptions& options = {});

}  // namespace subvol
