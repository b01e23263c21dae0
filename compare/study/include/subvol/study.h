// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace subvol {

/// What a case of a study is described by: switches, numbers and texts under names.
using StudyValue = std::variant<bool, double, std::string>;
using StudyValues = std::map<std::string, StudyValue>;

/// One thing to be computed and measured.
///
/// id:     of the values, but for names that are only shown: 16 hexadecimal digits, the same on every machine
/// name:   for people: unique in its study, fit for a file
/// values: "input", "input.model", "view", "tf", "method", "label", a method's own options, "given.NAME" …
struct StudyCase {
    std::string id;
    std::string name;
    StudyValues values;

    [[nodiscard]] bool has(const std::string& key) const { return values.contains(key); }
    /// The value; for one that is not there "", 0, false. Of another type: Error(InvalidInput).
    [[nodiscard]] const std::string& text(const std::string& key) const;
    [[nodiscard]] double number(const std::string& key) const;
    [[nodiscard]] int whole(const std::string& key) const { return static_cast<int>(number(key)); }
    [[nodiscard]] bool flag(const std::string& key) const;
};

/// Which cases: those that have all these values, as text.
using StudyFilter = std::map<std::string, std::string>;

/// A table of the report: a row for each combination of the values under `rows`, first `columns`, then one column for each
/// value under `across`, with each of `values` in it. Keys are names of values, metrics and costs; headings say them to people.
///
/// digits: of numbers that are no counts
struct StudyTableSpec {
    std::string title;
    std::string caption;
    std::vector<std::string> rows;
    std::vector<std::string> columns;
    std::string across;
    std::vector<std::string> values;
    std::map<std::string, std::string> headings;
    StudyFilter where;
    int digits = 4;
};

/// A plot of the report: metric `y` over `x`, a line for each combination of the values under `series`, a plot for each of
/// `panels`. fit: the slope of each line is told
struct StudyPlotSpec {
    std::string title;
    std::string caption;
    std::string x, y;
    std::vector<std::string> series;
    std::string panels;
    std::map<std::string, std::string> headings;
    bool log_x = true, log_y = true;
    bool fit = false;
    StudyFilter where;
};

/// What the report judges: a metric that shall be at least or at most so much.
struct StudyDemand {
    std::string metric;
    std::optional<double> least{}, most{};
    StudyFilter where;
};

/// timed:    costs are measured: cases run one after the other, alone
/// pictures: the report shows pictures beside their reference, of the cases of `pictures_where`
struct Study {
    std::string name;
    std::string title;
    std::string about;
    bool timed = false;
    bool pictures = false;
    StudyFilter pictures_where;
    std::vector<StudyCase> cases;
    std::vector<StudyTableSpec> tables;
    std::vector<StudyPlotSpec> plots;
    std::vector<StudyDemand> demands;
};

/// What a method computes: a picture of a mesh, compared with a reference; numbers of a mesh's field; or numbers of a kernel,
/// without a mesh.
enum class StudyKind { Picture, Field, Kernel };

/// throws: Error(InvalidInput) if there is no such method; lists the known ones
[[nodiscard]] StudyKind method_kind(const std::string& method);

inline constexpr std::size_t kMaxStudyCases = 10'000;

/// Reads a study from JSON and expands it: inputs × cameras × transfer functions × methods, and the product of all lists among
/// their options; methods that make no picture need no camera. docs/studies.md has the keys.
///
/// file:   for messages, and the folder that relative paths start from
/// throws: Error(InvalidInput), with the path of the place in the JSON, for an unknown key, a wrong type, an empty list, a
/// value
///         out of range, more than kMaxStudyCases cases, or two cases that are the same; Error(Io)
[[nodiscard]] Study parse_study(std::string_view json, const std::filesystem::path& file);
[[nodiscard]] Study read_study(const std::filesystem::path& file);

struct StudyInfo {
    std::string name;
    std::string title;
};

/// The studies that come with the library, and their files' text.
///
/// throws: Error(InvalidInput) for an unknown name; lists the known ones
[[nodiscard]] std::vector<StudyInfo> list_studies();
[[nodiscard]] Study built_in_study(const std::string& name);
[[nodiscard]] std::string_view built_in_study_json(const std::string& name);

/// The case that makes the reference of a case's picture; none if it has none.
[[nodiscard]] std::optional<StudyCase> reference_of(const StudyCase& of);

/// A case as a JSON object and back.
///
/// throws: Error(InvalidInput) if the text is no case
[[nodiscard]] std::string to_json(const StudyCase& of);
[[nodiscard]] StudyCase study_case_from_json(std::string_view json);

/// The values, the numbers in the fewest digits that read back the same.
[[nodiscard]] std::string as_text(const StudyValue& value);

}  // namespace subvol
