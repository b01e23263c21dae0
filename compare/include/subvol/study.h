#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "subvol/progress.h"

namespace subvol {

/// A table of a study: a name and an explanation, and rows of words and numbers under headings.
struct StudyTable {
    using Cell = std::variant<std::string, double>;

    std::string name;
    std::string caption;
    std::vector<std::string> columns;
    std::vector<std::vector<Cell>> rows;
};

/// meshes: real meshes that take part besides the generated models, by their own field or an analytic density
struct StudyOptions {
    std::vector<std::filesystem::path> meshes;
    std::uint64_t seed = 0;
    Progress* progress = nullptr;
};

struct StudyInfo {
    std::string name;
    std::string description;
};

/// The studies that can be run by name.
[[nodiscard]] std::vector<StudyInfo> list_studies();

/// Runs a study.
///
/// throws: Error(InvalidInput) for an unknown name (lists the known ones), Error(Cancelled)
[[nodiscard]] std::vector<StudyTable> run_study(const std::string& name, const StudyOptions& options = {});

/// The table as text with aligned columns, for people; as comma-separated values, for programs.
[[nodiscard]] std::string as_text(const StudyTable& table);
[[nodiscard]] std::string as_csv(const StudyTable& table);

}  // namespace subvol
