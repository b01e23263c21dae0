// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "subvol/study_run.h"
#include "subvol/study_table.h"

namespace subvol::detail {

// Parts of the report as HTML.

[[nodiscard]] std::string table_html(const StudyTable& table);

/// All panels of a plot.
[[nodiscard]] std::string plots_html(const StudyResults& results, const StudyPlotSpec& spec);

/// The pictures of all cases that have one, each beside its reference and their difference.
[[nodiscard]] std::string pictures_html(const StudyResults& results, const std::filesystem::path& folder);

/// The cases that failed, with their messages.
[[nodiscard]] std::string failures_html(const StudyResults& results);

}  // namespace subvol::detail
