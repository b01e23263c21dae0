// SPDX-License-Identifier: Apache-2.0
// The time between two meshes is halved where cells are not decided, as cells are where their volume is: a part is proved for a
// stretch of time if what its derivatives change in it fits into the rest that the test allows.
//
//     0 ├───────────────┤ 1      all cells
//       ├───────┼───────┤        those that are open
//       ├───┼───┤                …
#include <algorithm>
#include <numeric>
#include <utility>

#include "fold_checker.h"
#include "subvol/error.h"
#include "subvol/mesh_motion.h"
#include "subvol/option.h"

namespace subvol {

using namespace detail;

namespace {

/// A stretch of the time from 0 to 1, and the cells that are open in it.
struct Stretch {
    double begin = 0, end = 1;
    std::vector<Index> cells{};
};

class MotionCheck {
public:
    MotionCheck(const HexMesh& before, const HexMesh& after, const FoldMotionOptions& options)
        : before_(before), after_(after), levels_(options.time_levels), checker_(before, options.folds) {
        result_.verdicts.assign(before.cells.size(), FoldVerdict::Proved);
        result_.open.assign(before.cells.size(), 0);
        irregular_.assign(before.cells.size(), 0);
    }

    FoldCheck run() {
        std::vector<Stretch> stretches(1);
        stretches[0].cells.resize(before_.cells.size());
        std::iota(stretches[0].cells.begin(), stretches[0].cells.end(), Index{0});
        for (int level = 0; !stretches.empty(); ++level) {
            std::vector<Stretch> next;
            for (Stretch& stretch : stretches) check(stretch, levels_ - level, next);
            stretches = std::move(next);
        }
        std::ranges::sort(result_.places, {}, &FoldPlace::cell);
        FoldReport& report = result_.report;
        for (Index c = 0; c < result_.verdicts.size(); ++c) {
            const FoldVerdict verdict = result_.verdicts[c];
            if (verdict == FoldVerdict::Folded) {
                result_.open[c] = irregular_[c] = 0;
            }
            report.open_volume += result_.open[c];
            report.irregular_volume += irregular_[c];
            result_.open[c] += irregular_[c];
            ++(verdict == FoldVerdict::Folded      ? report.folded
               : verdict == FoldVerdict::Irregular ? report.irregular
               : verdict == FoldVerdict::Open      ? report.open
                                                   : report.proved);
        }
        checker_.count_kinds(result_.verdicts, result_.report);
        return std::move(result_);
    }

private:
    void check(Stretch& stretch, int halvings, std::vector<Stretch>& next) {
        std::erase_if(stretch.cells, [&](Index c) { return result_.verdicts[c] == FoldVerdict::Folded; });
        if (stretch.cells.empty()) return;
        const double middle = (stretch.begin + stretch.end) / 2, half = (stretch.end - stretch.begin) / 2;
        std::vector<Vec3> points(before_.points.size()), motion(points.size());
        for (std::size_t p = 0; p < points.size(); ++p) {
            points[p] = (1 - middle) * before_.points[p] + middle * after_.points[p];
            motion[p] = half * (after_.points[p] - before_.points[p]);
        }
        checker_.move_straight(std::move(points), motion, halvings);
        const std::size_t tests = checker_.tests();
        checker_.check(stretch.cells, FoldEffort::Whole);
        result_.report.tests += checker_.tests() - tests;
        std::vector<Index> open;
        std::vector<FoldPlace> places;
        for (const Index c : stretch.cells) {
            const FoldChecker::CellState& state = checker_.states().cells[c];
            result_.report.deepest = std::max(result_.report.deepest, state.deepest);
            const FoldVerdict verdict = checker_.verdict(c);
            if (verdict == FoldVerdict::Proved) continue;
            if (verdict == FoldVerdict::Folded) {
                result_.verdicts[c] = verdict;
                places.push_back(checker_.states().folds.at(c));
                places.back().time = middle;
            } else if (halvings > 0 && state.moves) {
                open.push_back(c);
            } else {
                leave(c, verdict, state, 2 * half);
            }
        }
        checker_.place(places);
        result_.places.insert(result_.places.end(), places.begin(), places.end());
        if (open.empty()) return;
        next.push_back({stretch.begin, middle, open});
        next.push_back({middle, stretch.end, std::move(open)});
    }

    void leave(Index cell, FoldVerdict verdict, const FoldChecker::CellState& state, double time) {
        result_.verdicts[cell] = std::max(result_.verdicts[cell], verdict);  // irregular if it is in one of the stretches
        result_.open[cell] += state.open * time;
        irregular_[cell] += state.irregular * time;
    }

    const HexMesh &before_, &after_;
    int levels_;
    FoldChecker checker_;
    FoldCheck result_;
    std::vector<double> irregular_;  // volume near irregular edges that is open, of each cell
};

}  // namespace

std::vector<Option> options_of(FoldMotionOptions& options) {
    return {Option("time-levels", options.time_levels)
                .between(0, 10)
                .help("L", "halve the time between two steps up to L times where that does not decide")};
}

FoldCheck check_folds_between(const HexMesh& before, const HexMesh& after, const FoldMotionOptions& options) {
    check_options(options);
    if (!same_cells(before, after)) {
        throw Error(ErrorCode::InvalidInput, "the cells or sharp edges of the two meshes differ", "between two steps",
                    "meshes that differ in their points alone");
    }
    return MotionCheck(before, after, options).run();
}

}  // namespace subvol
