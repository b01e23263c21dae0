// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "report.h"
#include "subvol/study_run.h"

namespace subvol::cli {

/// A study as it was read: its JSON, the file that its paths start from, and the command that runs it.
struct StudySource {
    std::string json;
    std::filesystem::path file;
    std::string command;
};

/// A study in a folder, and what has been finished of it.
struct KeptStudy {
    StudyResults results;
    std::string command;
};

/// Writes FOLDER/study.json, so that reports of later runs in the same folder contain the study, too.
void keep_study(const StudySource& source, const std::filesystem::path& folder);

/// The studies that earlier runs left in a folder, by name, without those of `but`. One that cannot be read any more, because
/// its meshes are gone, is left out with a warning.
[[nodiscard]] std::vector<KeptStudy> kept_studies(const std::filesystem::path& folder, const std::set<std::string>& but,
                                                  Report& report);

}  // namespace subvol::cli
