// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "subvol/study_run.h"

namespace subvol {

/// A table: rows of texts and numbers under headings. An unknown number is NaN.
///
/// marks: for people, instead of numbers that are below what the reference can tell: "≤ 0.0002", by row and column
struct StudyTable {
    using Cell = std::variant<std::string, double>;

    std::string name;
    std::string title;
    std::string caption;
    std::vector<std::string> columns;
    std::vector<std::vector<Cell>> rows;
    int digits = 4;
    std::map<std::pair<std::size_t, std::size_t>, std::string> marks{};
};

/// How well a figure of a picture is known: the change of the reference at its last refinement, in the figure's unit. Nothing
/// for figures without such a bound, or if the reference had a fixed level.
[[nodiscard]] std::optional<double> accuracy(const CaseResult& result, const std::string& metric);

/// A value, metric, cost or note of a case by its key; the key "done" gives "yes" or the failure.
[[nodiscard]] std::optional<StudyValue> find_value(const StudyCase& study_case, const CaseResult& result,
                                                   const std::string& key);

/// The same as text; "" if there is no such value.
[[nodiscard]] std::string value_text(const StudyCase& study_case, const CaseResult& result, const std::string& key);

/// "≤ 0.0002" for an error below what is known, "≥ 73.9" for such a PSNR; nothing for other figures.
[[nodiscard]] std::optional<std::string> mark_of(const CaseResult& result, const std::string& key, int digits = 4);

/// A name with spaces instead of underscores, for people.
[[nodiscard]] std::string spaced(std::string name);

[[nodiscard]] bool matches(const StudyCase& study_case, const CaseResult& result, const StudyFilter& where);

/// The tables of a study, each with the cases that its specification selects. Their names are the study's, then NAME_2 and so
/// on.
[[nodiscard]] std::vector<StudyTable> make_tables(const StudyResults& results);

/// A cell as text: numbers in so many digits, counts in full, NaN as "–".
[[nodiscard]] std::string readable(const StudyTable::Cell& cell, int digits = 4);

/// A cell for people, with its mark.
[[nodiscard]] std::string shown(const StudyTable& table, std::size_t row, std::size_t column);

/// How the pictures of a study were made: a row for each reference, with the mesh, the camera, the colours, the size, and the
/// reference's level and last change. Nothing without pictures.
[[nodiscard]] std::optional<StudyTable> setup_table(const StudyResults& results);

/// The table as text with aligned columns, for people; as comma-separated values, for programs, where numbers have no marks; as
/// a LaTeX table with the rules of the package booktabs.
[[nodiscard]] std::string as_text(const StudyTable& table);
[[nodiscard]] std::string as_csv(const StudyTable& table);
[[nodiscard]] std::string as_tex(const StudyTable& table);

}  // namespace subvol
