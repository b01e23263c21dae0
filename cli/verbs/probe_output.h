// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "report.h"
#include "subvol/measure.h"
#include "subvol/patch_measure.h"
#include "subvol/probe.h"

namespace subvol::cli {

/// Places that were probed: into the report, and into a table (.csv) or a plot over the distance (.svg).
///
/// chosen: the fields of the lines for people, the table, which has their values alone, and the plot, a curve for each; empty:
///         all fields and their gradients, and a curve for the first
/// file: empty: none
/// options: with --json the report gets the values of all places; with --quiet they are not said if a file has them
void show_probed(const ProbeResult& found, const std::vector<Vec3>& places, const std::vector<std::string>& chosen,
                 const std::string& file, const CommonOptions& options, Report& report);

/// The places with their values, as `show_probed` puts them into the report.
[[nodiscard]] Json json_of(const ProbeResult& found, const std::vector<Vec3>& places);
/// Integrals and extremes, as `show_measured` puts them into the report.
[[nodiscard]] Json json_of(const LimitMeasure& found);

/// The names of a field's channels: NAME, or NAME.x and so on.
[[nodiscard]] std::vector<std::string> channel_names(const ProbedField& field);
/// "0.1,0,2".
[[nodiscard]] std::string place_text(const Vec3& place);
/// A text as a cell of a .csv file.
[[nodiscard]] std::string csv_text(const std::string& text);

/// Patches of the boundary: into the report, and as lines for people, with the sum of the flows of several.
///
/// mesh, of_file: as of `show_measured`
void show_patches(const std::vector<PatchMeasure>& found, const HexMesh& mesh, bool of_file, Report& report);
[[nodiscard]] Json json_of(const std::vector<PatchMeasure>& found);

/// Integrals and extremes, into the report.
///
/// mesh:    whose points are named; may be null
/// of_file: a file has the cells, so that a limit that differs from them is worth a warning
/// file:    of the histograms: a table (.csv) or a plot (.svg); empty: none
void show_measured(const LimitMeasure& found, const HexMesh* mesh, bool of_file, const std::string& file, Report& report);

}  // namespace subvol::cli
