// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mcq_grid.h"
#include "patch.h"
#include "regular_grid.h"
#include "subvol/limit.h"

namespace subvol::detail {

/// Values and derivatives of all channels at one place: entry 4c is the value of channel c, followed by its derivatives by u, v
/// and w. Channels 0 to 2 are the position.
using Jet = std::vector<double>;

/// A query that has not converged yet.
///
/// cell:   the wanted cell of the patch in which it lies; uvw: its place there
/// last:   its jet at the level before
/// agreed: number of consecutive levels whose jets agreed within the tolerance
struct OpenQuery {
    std::size_t query;
    Index cell;
    Vec3 uvw;
    Jet last;
    int agreed = 0;
};

/// Evaluates the queries of a few control cells.
///
/// A query whose cell lies in a regular grid is evaluated there, by B-splines or by cubic interpolation. If the grid is wide
/// enough, it is refined inside the grid, without topology. For all other queries the patch about their cells is refined, level
/// by level, until two levels agree.
class BatchEvaluator {
public:
    /// scales: of each channel, what tolerances are relative to. All references are kept.
    BatchEvaluator(const LimitOptions& options, const std::vector<double>& scales, LimitSamples& samples);

    /// Evaluates the queries that need no patch; the others stay in `open`.
    void begin(const HexMesh& control, const Topology& topology, std::vector<OpenQuery>& open);

    /// Evaluates the others, refining the cells about them.
    void finish(const PatchSource& source, std::vector<OpenQuery> open);

    [[nodiscard]] const LimitReport& report() const { return report_; }

private:
    void evaluate_level(const HexMesh& mesh, const Topology& topology, int level, std::vector<OpenQuery>& open);
    [[nodiscard]] bool settle(OpenQuery& at, const Jet& jet, int level, bool regular, bool exact);
    void load(const HexMesh& mesh, const WideGridPoints& points);
    void refine_in_grid(OpenQuery& at, int level);
    [[nodiscard]] bool is_close(const Jet& a, const Jet& b, int level) const;
    void write(std::size_t query, const Jet& jet);

    const LimitOptions& options_;
    const std::vector<double>& scales_;
    LimitSamples& samples_;
    LimitReport report_;
    McqGrid grid_rule_;
    std::vector<double> wide_data_;
};

}  // namespace subvol::detail
