// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report.h"
#include "subvol/measure.h"
#include "subvol/patch_measure.h"
#include "subvol/probe.h"

namespace subvol::cli {

/// What was found in one step of a series.
struct ProbedStep {
    std::size_t step = 0;
    double time = 0;
    std::optional<ProbeResult> places;       ///< if values at places were asked for
    std::optional<LimitMeasure> measure;     ///< if the measure was asked for
    std::vector<PatchMeasure> patches = {};  ///< if patches were asked for
};

/// The steps of a series: into the report as `steps`, as lines for people, and into a table with a row for each step and place,
/// or each step and part (.csv), or a plot over time (.svg).
///
/// chosen: of places, the fields of the lines, the table and the plot; empty: all fields, and the first one in the plot
/// file: empty: none; with --quiet there are no lines if a file has them
void show_steps(const std::vector<ProbedStep>& steps, const std::vector<Vec3>& places, const std::vector<std::string>& chosen,
                const std::string& file, const CommonOptions& options, Report& report);

}  // namespace subvol::cli
