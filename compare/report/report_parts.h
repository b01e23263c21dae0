// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "subvol/plot.h"
#include "subvol/study_run.h"
#include "subvol/study_table.h"

namespace subvol::detail {

// Parts of the report as HTML.

[[nodiscard]] std::string table_html(const StudyTable& table);

/// One of the plots of a specification: that of one value of its panels, or the only one.
struct PlotPanel {
    std::string name;
    Plot plot;
};
[[nodiscard]] std::vector<PlotPanel> plot_panels(const StudyResults& results, const StudyPlotSpec& spec);

/// files: the names of the panels' files, without endings
[[nodiscard]] std::string plots_html(const StudyResults& results, const StudyPlotSpec& spec,
                                     const std::vector<std::string>& files);

/// The pictures of all cases that have one, each beside its reference and their difference.
[[nodiscard]] std::string pictures_html(const StudyResults& results, const std::filesystem::path& folder);

/// How the pictures and figures were made, as a paragraph for a paper; "" without pictures.
[[nodiscard]] std::string methods_text(const StudyResults& results, const std::string& program, const std::string& machine);

/// The cases that failed, with their messages.
[[nodiscard]] std::string failures_html(const StudyResults& results);

}  // namespace subvol::detail
