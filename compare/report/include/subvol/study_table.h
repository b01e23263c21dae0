// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
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
};

/// A value, metric, cost or note of a case by its key; the key "done" gives "yes" or the failure.
[[nodiscard]] std::optional<StudyValue> find_value(const StudyCase& of, const CaseResult& result, const std::string& key);

/// The same as text; "" if there is no such value.
[[nodiscard]] std::string value_text(const StudyCase& of, const CaseResult& result, const std::string& key);

/// A name with spaces instead of underscores, for people.
[[nodiscard]] std::string spaced(std::string name);

[[nodiscard]] bool matches(const StudyCase& of, const CaseResult& result, const StudyFilter& where);

/// The tables of a study, each with the cases that its specification selects. Their names are the study's, then NAME_2 and so
/// on.
[[nodiscard]] std::vector<StudyTable> make_tables(const StudyResults& results);

/// A cell as text: numbers in so many digits, counts in full, NaN as "–".
[[nodiscard]] std::string readable(const StudyTable::Cell& cell, int digits = 4);

/// The table as text with aligned columns, for people; as comma-separated values, for programs.
[[nodiscard]] std::string as_text(const StudyTable& table);
[[nodiscard]] std::string as_csv(const StudyTable& table);

}  // namespace subvol
