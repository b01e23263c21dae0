// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "subvol/option.h"

namespace subvol {

/// The description of a case of a study: switches, numbers and texts under names.
using StudyValue = std::variant<bool, double, std::string>;
using StudyValues = std::map<std::string, StudyValue>;

/// One computation to run and measure.
struct StudyCase {
    /// A hash of the values, without names that are only shown: 16 hexadecimal digits, the same on every machine.
    std::string id;
    std::string name;    ///< for people: unique in its study, and valid as part of a file name
    StudyValues values;  ///< "input", "input.model", "view", "tf", "method", "label", a method's own options, "given.NAME" …

    [[nodiscard]] bool has(const std::string& key) const { return values.contains(key); }
    /// The value; "", 0 or false if there is none.
    ///
    /// throws: Error(InvalidInput) if the value has another type
    [[nodiscard]] const std::string& text(const std::string& key) const;
    [[nodiscard]] double number(const std::string& key) const;
    [[nodiscard]] int whole(const std::string& key) const { return static_cast<int>(number(key)); }
    [[nodiscard]] bool flag(const std::string& key) const;
};

/// Selects the cases that have all these values, as text.
using StudyFilter = std::map<std::string, std::string>;

/// A table of the report: a row for each combination of the values of `rows`; after these come `columns`, then, for each value
/// of `across`, a column for each of `values`. Keys are names of values, metrics and costs.
struct StudyTableSpec {
    std::string title;
    std::string caption;
    std::vector<std::string> rows;
    std::vector<std::string> columns;
    std::string across;
    std::vector<std::string> values;
    std::vector<std::string> average{};           ///< keys over which cells have means with their standard deviations
    std::map<std::string, std::string> headings;  ///< the names of keys in the report
    StudyFilter where;
    int digits = 4;  ///< the digits of numbers that are not counts
};

/// A plot of the report: metric `y` over `x`, with a line for each combination of the values of `series`, and a plot for each
/// value of `panels`.
struct StudyPlotSpec {
    std::string title;
    std::string caption;
    std::string x, y;
    std::vector<std::string> series;
    std::string panels;
    /// Keys over which points are means, with bars of their standard deviations; `together` has keys in which the cases of a
    /// series may differ, and lines join only those that do not.
    std::vector<std::string> average{}, together{};
    std::map<std::string, std::string> headings;
    bool log_x = true, log_y = true;
    bool fit = false;  ///< show the slope of each line
    StudyFilter where;
};

/// A bound on a metric, which the report checks.
struct StudyDemand {
    std::string metric;
    std::optional<double> least{}, most{};
    StudyFilter where;
};

struct Study {
    std::string name;
    std::string title;
    std::string about;
    bool timed = false;     ///< costs are measured, so cases run one after the other
    double seconds = 0;     ///< about how long it takes on two cores; 0: not known
    bool pictures = false;  ///< the report shows pictures beside their reference, for the cases of `pictures_where`
    StudyFilter pictures_where;
    std::vector<std::string> measured{};  ///< what a function of the caller gives besides what the methods do
    std::vector<StudyCase> cases;
    std::vector<StudyTableSpec> tables;
    std::vector<StudyPlotSpec> plots;
    std::vector<StudyDemand> demands;
};

/// What a method computes: a picture of a mesh, compared with a reference; numbers of a mesh's field; or numbers of a kernel,
/// without a mesh.
enum class StudyKind { Pictures, Fields, Kernels };

/// The kind of a method of a case that was read.
[[nodiscard]] StudyKind method_kind(const std::string& method);

/// A method of pictures, and the options that it reads from a mesh: those are its keys in a study. Whoever draws passes them
/// in, as this component does not see the renderers. The descriptions refer to values, which must live as long and are changed.
struct PictureMethod {
    std::string name;
    std::vector<Option> options;
};

inline constexpr std::size_t kMaxStudyCases = 10'000;

/// Reads a study from JSON and expands it: inputs × cameras × transfer functions × methods × the product of all lists among
/// their options; methods that make no picture need no camera. docs/studies.md has the keys.
///
/// file:    for error messages, and as the folder that relative paths start from
/// methods: of pictures, besides those of this component
/// throws: Error(InvalidInput), with the path of the place in the JSON, for an unknown key, a wrong type, an empty list, a
///         value out of range, more than kMaxStudyCases cases, two equal cases, a table or a plot of what no case has, or one
///         that would merge cases without saying so; Error(Io)
[[nodiscard]] Study parse_study(std::string_view json, const std::filesystem::path& file,
                                std::span<const PictureMethod> methods);
[[nodiscard]] Study read_study(const std::filesystem::path& file, std::span<const PictureMethod> methods);

struct StudyInfo {
    std::string name;
    std::string title;
    double seconds = 0;  ///< as Study::seconds
};

/// The built-in studies, and the text of their files.
///
/// throws: Error(InvalidInput) for an unknown name; lists the known ones
[[nodiscard]] std::vector<StudyInfo> list_studies();
[[nodiscard]] Study built_in_study(const std::string& name, std::span<const PictureMethod> methods);
[[nodiscard]] std::string_view built_in_study_json(const std::string& name);

/// The case that makes the reference of a case's picture; nothing if the case has no reference.
[[nodiscard]] std::optional<StudyCase> reference_of(const StudyCase& study_case);

/// A case as a JSON object and back.
///
/// throws: Error(InvalidInput) if the text is not a case
[[nodiscard]] std::string to_json(const StudyCase& study_case);
[[nodiscard]] StudyCase study_case_from_json(std::string_view json);

/// A value as text; a number in the fewest digits that give the same number when read again.
[[nodiscard]] std::string as_text(const StudyValue& value);

}  // namespace subvol
