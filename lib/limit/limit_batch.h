// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "jets.h"
#include "patch.h"

namespace subvol::detail {

/// Evaluates the queries of a few control cells by refining the patch about them, level by level, until two levels agree: for
/// surroundings that have no class.
class BatchEvaluator {
public:
    /// scales: of each channel, what tolerances are relative to. All references are kept.
    BatchEvaluator(const LimitOptions& options, std::span<const double> scales, const Channels& channels,
                   LimitSamples& samples);

    void run(const PatchSource& source, std::span<const LimitQuery> queries, std::span<const std::size_t> numbers);

    [[nodiscard]] const LimitReport& report() { return settling_.report(); }

private:
    /// cell: the wanted cell of the patch in which the place lies
    struct InPatch {
        Index cell;
        OpenPlace place;
    };
    [[nodiscard]] static std::vector<Index> number_cells(std::vector<InPatch>& open);
    void evaluate_level(const HexMesh& mesh, int level, std::vector<InPatch>& open);

    const LimitOptions& options_;
    Channels channels_;
    Settling settling_;
    CellJets jets_;
    std::vector<double> lasts_, jet_, rows_;
};

}  // namespace subvol::detail
