// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "report.h"
#include "subvol/measure.h"
#include "subvol/probe.h"

namespace subvol::cli {

/// Places that were probed: into the report, and into a table (.csv) or a plot of the first field over the distance (.svg).
///
/// file: empty: none
/// options: with --json the report gets the values of all places; with --quiet they are not said if a file has them
void show_probed(const ProbeResult& found, const std::vector<Vec3>& places, const std::string& file, const CommonOptions& options, Report& report);

/// Integrals and extremes, into the report.
void show_measured(const LimitMeasure& found, Report& report);

}  // namespace subvol::cli
