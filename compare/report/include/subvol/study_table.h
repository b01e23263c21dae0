// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "subvol/study_run.h"

namespace subvol {

/// A table: rows of texts and numbers under headings. An unknown number is NaN.
struct StudyTable {
    using Cell = std::variant<std::string, double>;

    std::string name;
    std::string title;
    std::string caption;
    std::vector<std::string> columns;
    std::vector<std::vector<Cell>> rows;
    int digits = 4;
    /// For people, instead of numbers that are below what the reference can tell: "≤ 0.0002", by row and column.
    std::map<std::pair<std::size_t, std::size_t>, std::string> marks{};
    /// Standard deviations of numbers that are means of several cases.
    std::map<std::pair<std::size_t, std::size_t>, double> spreads{};
};

/// How well a figure of a picture is known: its floor, which is the same metric of the reference and the picture of the level
/// before. Nothing for figures without such a bound, or if the reference is exact.
[[nodiscard]] std::optional<double> accuracy(const CaseResult& result, const std::string& metric);

/// A value, metric, cost or note of a case by its key; the key "done" gives "yes" or the failure.
[[nodiscard]] std::optional<StudyValue> find_value(const StudyCase& study_case, const CaseResult& result,
                                                   const std::string& key);

/// The same as text; "" if there is no such value.
[[nodiscard]] std::string value_text(const StudyCase& study_case, const CaseResult& result, const std::string& key);

/// The values of a metric for which less is known than they say: at the floor or below it; of those for which more is better,
/// at it or above.
[[nodiscard]] bool is_beyond_floor(const CaseResult& result, const std::string& key);

/// "≤ 0.0002" for an error below what is known, "≥ 73.9" for such a PSNR, "= reference" for a picture that is drawn as its
/// reference is; nothing for other figures.
[[nodiscard]] std::optional<std::string> mark_of(const CaseResult& result, const std::string& key, int digits = 4);

/// The mean of some numbers, and their standard deviation (0 of one number).
struct Spread {
    double mean = 0, deviation = 0;
};
[[nodiscard]] Spread mean_and_spread(std::span<const double> values);

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

/// Text with the special characters of LaTeX escaped.
[[nodiscard]] std::string tex_text(std::string_view text);

}  // namespace subvol
