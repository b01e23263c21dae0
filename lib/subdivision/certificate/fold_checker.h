// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "cell_parts.h"
#include "subvol/certificate.h"
#include "subvol/detail/fold_samples.h"

namespace subvol::detail {

/// How much is done for a cell.
///
/// Whole:   all that the options allow, and samples where that does not decide
/// Verdict: the same until it is clear that the cell will stay undecided, whose open volume is then too large; cells that touch
///          irregular edges only as far as Witness
/// Witness: looks for folds at the corners of its children, and proves nothing
enum class FoldEffort : std::uint8_t { Whole, Verdict, Witness };

/// The checks of a mesh whose points move.
class FoldChecker {
public:
    /// options: referred to
    /// throws:  as `check_folds`
    FoldChecker(const HexMesh& mesh, const FoldOptions& options);

    /// As many new points.
    void move(const std::vector<Vec3>& points) { mesh_.points = points; }

    /// Points that move straight: at time s from −1 to 1 they are at `middle` + s `motion`. A cell is proved if it is at all of
    /// these times, and folded if it is in the middle of them.
    ///
    /// halvings: how often the time may be halved; then cells that move much are left to shorter times
    void move_straight(std::vector<Vec3> middle, const std::vector<Vec3>& motion, int halvings);

    /// Checks some cells anew, ascending.
    void check(std::span<const Index> cells, FoldEffort effort);

    /// All tests so far, and what refinement and samples took in tests that take about as long.
    [[nodiscard]] std::size_t tests() const { return tests_; }

    /// What the last check of a cell found.
    [[nodiscard]] FoldVerdict verdict(Index cell) const;

    /// What is known of all cells.
    [[nodiscard]] FoldCheck found() const;

    /// Counts the kinds of the cells that are not decided.
    void count_kinds(const std::vector<FoldVerdict>& verdicts, FoldReport& report) const;

    /// What is known of a cell.
    struct CellState {
        double open = 0;
        double irregular = 0;  ///< the volume that touches irregular edges and is not decided
        std::size_t tests = 0;
        int deepest = 0;
        bool moves = false;  ///< it may be proved for shorter times
        bool is_folded = false;
    };
    /// What is known of all cells. Few have a fold or samples.
    struct States {
        std::vector<CellState> cells;
        std::map<Index, FoldPlace> folds;
        std::map<Index, CellSamples> samples;
    };
    [[nodiscard]] const States& states() const { return states_; }

    /// Finds the positions of places in the cells.
    void place(std::vector<FoldPlace>& places) const;

    /// Goes back to what was known with points that have been moved to again.
    void restore(States states) { states_ = std::move(states); }

private:
    /// A descendant of a control cell that is not decided: its number in its level.
    struct OpenCell {
        Index cell, control;
        PartFrame frame;
    };
    struct PartResult;
    struct Limits;
    class Grids;
    template <class Part>
    [[nodiscard]] static PartResult decide_part(Part part, const Limits& limits);
    [[nodiscard]] static std::vector<Index> with_neighbors(const HexMesh& mesh, const std::vector<OpenCell>& open, int layers);

    void forget(Index cell);
    void add(Index control, const PartResult& result, int level = 0);
    void add_fold(const FoldPlace& fold);
    void descend_together(const std::vector<OpenCell>& irregular, FoldEffort effort);
    void descend(const HexMesh& mesh, std::vector<OpenCell> open, int level, FoldEffort effort);
    void sample(std::span<const Index> cells);

    HexMesh mesh_;  // its only attribute, if any, is the motion of its points
    const FoldOptions& options_;
    SchemeOptions scheme_;
    States states_;
    std::size_t tests_ = 0;
    int halvings_ = 0;  // of the time that may follow
};

}  // namespace subvol::detail
