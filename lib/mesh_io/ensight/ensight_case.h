// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "text_scanner.h"

namespace subvol::detail {

/// Files of one kind in a case. name: with stars in place of the number of a step; time_set: 0 if there is one file for all
/// times
struct EnsightFiles {
    std::string name;
    int time_set = 0;
    std::size_t position = 0;  // in the case, for messages
};

/// A variable. components: of a value; at_cells: at the elements
struct EnsightVariable {
    std::string name;
    std::size_t components = 1;
    bool at_cells = false;
    EnsightFiles files;
};

/// The steps of a time set. numbers: in the names of the files
struct EnsightTimes {
    std::vector<double> times;
    std::vector<std::int64_t> numbers;
};

/// What an EnSight Gold case consists of: the file that names all others.
class EnsightCase {
public:
    /// text, file: must outlive it
    EnsightCase(std::string_view text, std::string_view file);

    /// The times of the largest time set in increasing order; none if there are no times.
    [[nodiscard]] const std::vector<double>& times() const { return times_; }
    /// The file at a time: of files with times the last one up to then, else the first.
    [[nodiscard]] std::filesystem::path file_at(const EnsightFiles& files, double time) const;
    /// Where the case names files, for messages.
    [[nodiscard]] std::string place_of(const EnsightFiles& files) const { return in_.place_of(files.position); }

    [[nodiscard]] const EnsightFiles& geometry() const { return geometry_; }
    [[nodiscard]] const std::vector<EnsightVariable>& variables() const { return variables_; }
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

private:
    void take_geometry(std::string_view key, std::string_view rest, std::size_t position);
    void take_variable(const std::string& key, std::string_view rest, std::size_t position);
    void take_time(std::string_view key, std::string_view rest, std::size_t position);
    void finish_times();
    [[nodiscard]] EnsightFiles files_of(std::vector<std::string> words, std::size_t position) const;

    TextScanner in_;
    std::filesystem::path folder_;
    EnsightFiles geometry_;
    std::vector<EnsightVariable> variables_;
    std::map<int, EnsightTimes> sets_;
    std::vector<double> times_;
    std::vector<std::string> warnings_;
    // For the time set that is being read:
    int set_ = 0;
    std::string list_;  // what the numbers of the next lines are
    struct Spread {
        std::size_t steps = 0;
        std::int64_t start = 0, increment = 1;
    };
    std::map<int, Spread> spreads_;
};

}  // namespace subvol::detail
