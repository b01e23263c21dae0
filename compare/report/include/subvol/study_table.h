// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "subvol/study_run.h"

namespace subvol {

/// A table: a name and an explanation, and rows of words and numbers under headings. A number that is not known is NaN.
struct StudyTable {
    using Cell = std::variant<std::string, double>;

    std::string name;
    std::string title;
    std::string caption;
    std::vector<std::string> columns;
    std::vector<std::vector<Cell>> rows;
    int digits = 4;
};

/// A value, metric, cost or note of a case by its key; "done" is "yes", or the failure.
[[nodiscard]] std::optional<StudyValue> find_value(const StudyCase& of, const CaseResult& result, const std::string& key);

/// The same as text; "" if there is none.
[[nodiscard]] std::string value_text(const StudyCase& of, const CaseResult& result, const std::string& key);

/// A name for people: with spaces for its underscores.
[[nodiscard]] std::string spaced(std::string name);

[[nodiscard]] bool matches(const StudyCase& of, const CaseResult& result, const StudyFilter& where);

/// The tables of a study, each of the cases that its specification chooses; named as the study, with _2 and so on.
[[nodiscard]] std::vector<StudyTable> make_tables(const StudyResults& results);

/// A number as people read it: in so many digits, counts in full; NaN is "–".
[[nodiscard]] std::string readable(const StudyTable::Cell& cell, int digits = 4);

/// The table as text with aligned columns, for people; as comma-separated values, for programs.
[[nodiscard]] std::string as_text(const StudyTable& table);
[[nodiscard]] std::string as_csv(const StudyTable& table);

}  // namespace subvol
