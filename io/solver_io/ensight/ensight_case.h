// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/detail/text_scanner.h"

namespace subvol::detail {

/// Files of one kind in a case.
struct EnsightFiles {
    std::string name;          ///< with stars in place of the number of a step or a file
    int time_set = 0;          ///< 0 if there is one file for all times
    int file_set = 0;          ///< file set of files with several steps, else 0
    std::size_t position = 0;  ///< in the case, for messages
};

/// A variable.
struct EnsightVariable {
    std::string name;
    std::size_t components = 1;  ///< components of a value
    bool at_cells = false;       ///< the values are at the elements
    EnsightFiles files;
};

/// The steps of a time set.
struct EnsightTimes {
    std::vector<double> times;
    std::vector<std::int64_t> numbers;  ///< numbers in the names of the files
    std::vector<std::size_t> places;    ///< places among the steps in the order of the case
};

/// A file, and which of its steps; nothing if the file is one step.
struct EnsightStep {
    std::filesystem::path path;
    std::optional<std::size_t> step;
};

/// What a case of EnSight Gold or 6 consists of: the file that names all others.
class EnsightCase {
public:
    /// text, file: must outlive it
    EnsightCase(std::string_view text, std::string_view file);

    /// The times of the largest time set in increasing order; none if there are no times.
    [[nodiscard]] const std::vector<double>& times() const { return times_; }
    /// The file at a time: of files with times the last one up to then, else the first.
    [[nodiscard]] EnsightStep file_at(const EnsightFiles& files, double time) const;
    /// Where the case names files, for messages.
    [[nodiscard]] std::string place_of(const EnsightFiles& files) const { return in_.place_of(files.position); }

    /// The step whose geometry has the elements of all; nothing if each step has its own.
    [[nodiscard]] std::optional<std::size_t> coordinates_step() const { return coordinates_step_; }
    /// Whether the files are those of version 6.
    [[nodiscard]] bool six() const { return six_; }
    [[nodiscard]] const EnsightFiles& geometry() const { return geometry_; }
    [[nodiscard]] const std::vector<EnsightVariable>& variables() const { return variables_; }
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
    [[nodiscard]] const std::vector<IgnoredPart>& ignored() const { return ignored_; }

private:
    void take_geometry(std::string_view key, std::string_view rest, std::size_t position);
    void take_variable(const std::string& key, std::string_view rest, std::size_t position);
    void take_file(std::string_view key, std::string_view rest, std::size_t position);
    void take_time(std::string_view key, std::string_view rest, std::size_t position);
    void finish_times();
    [[nodiscard]] EnsightFiles files_of(std::vector<std::string> words, std::size_t position) const;

    TextScanner in_;
    std::filesystem::path folder_;
    EnsightFiles geometry_;
    bool six_ = false;
    std::optional<std::size_t> coordinates_step_;
    std::vector<EnsightVariable> variables_;
    std::map<int, EnsightTimes> sets_;
    std::vector<double> times_;
    std::vector<std::string> warnings_;
    std::vector<IgnoredPart> ignored_;
    // For the time set that is being read:
    int set_ = 0;
    std::string list_;  // what the numbers of the next lines are
    struct Spread {
        std::size_t steps = 0;
        std::int64_t start = 0, increment = 1;
    };
    std::map<int, Spread> spreads_;
    // Files with several steps, in the order of their steps.
    struct Several {
        std::int64_t index = 0;  ///< number in place of the stars
        std::size_t steps = 0;
    };
    int file_set_ = 0;
    std::map<int, std::vector<Several>> file_sets_;
};

}  // namespace subvol::detail
