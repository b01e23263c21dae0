// SPDX-License-Identifier: Apache-2.0
#include "ensight_case.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

#include "subvol/detail/small_letters.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kMostSteps = 1000000;

// Words; one in quotes may have blanks.
std::vector<std::string> words_of(std::string_view text) {
    std::vector<std::string> words;
    for (std::size_t at = text.find_first_not_of(" \t"); at < text.size(); at = text.find_first_not_of(" \t", at)) {
        const bool quoted = text[at] == '"';
        const std::size_t end = std::min(text.find_first_of(quoted ? "\"" : " \t", at + 1), text.size());
        words.emplace_back(text.substr(at + quoted, end - at - quoted));
        at = end + quoted;
    }
    return words;
}

bool is_number(const std::string& word) {
    return !word.empty() && word.size() < 9 && std::ranges::all_of(word, [](char c) { return c >= '0' && c <= '9'; });
}

std::size_t components_of(std::string_view kind) {
    return kind == "scalar" ? 1 : kind == "vector" ? 3 : kind == "tensor symm" ? 6 : kind == "tensor asym" ? 9 : 0;
}

}  // namespace

EnsightCase::EnsightCase(std::string_view text, std::string_view file)
    : in_(text, file, TextScanner::Comments::None), folder_(std::filesystem::path(file).parent_path()) {
    std::string section;
    TextScanner lines = in_;
    while (!lines.at_end()) {
        std::string_view line = lines.line();
        const std::size_t position = lines.position();
        if (line.find('#') != std::string_view::npos) line = line.substr(0, line.find('#'));
        line = trimmed(line);
        if (line.empty()) continue;
        const std::size_t colon = line.find(':');
        if (colon == std::string_view::npos) {
            const std::string word = small_letters(line);
            if (word == "format" || word == "geometry" || word == "variable" || word == "time" || word == "file" ||
                word == "material" || word == "scripts" || word == "block_continuation") {
                section = word;
                list_.clear();
                if (section == "material" || section == "scripts") ignored_.push_back({"section", section});
            } else if (section == "time") {
                take_time({}, line, position);
            }
            continue;
        }
        const std::string key = small_letters(trimmed(line.substr(0, colon)));
        const std::string_view rest = trimmed(line.substr(colon + 1));
        if (section == "format" && key == "type") {
            six_ = small_letters(rest) == "ensight" || small_letters(rest) == "ensight6";
            if (!six_ && small_letters(rest) != "ensight gold") {
                in_.fail_at(position, "the format is " + in_quotes(rest), "ensight gold and ensight (6) are supported");
            }
        }
        if (section == "geometry") take_geometry(key, rest, position);
        if (section == "variable") take_variable(key, rest, position);
        if (section == "time") take_time(key, rest, position);
        if (section == "file") take_file(key, rest, position);
    }
    if (geometry_.name.empty()) in_.fail_at(0, "not an EnSight case, or it names no model");
    finish_times();
}

EnsightFiles EnsightCase::files_of(std::vector<std::string> words, std::size_t position) const {
    if (words.empty()) in_.fail_at(position, "it names no file");
    EnsightFiles files{words.back(), 0, 0, position};
    if (words.size() > 1 && is_number(words[0])) files.time_set = std::stoi(words[0]);
    if (words.size() > 2 && is_number(words[0]) && is_number(words[1])) files.file_set = std::stoi(words[1]);
    return files;
}

void EnsightCase::take_geometry(std::string_view key, std::string_view rest, std::size_t position) {
    if (key != "model") return;
    auto words = words_of(rest);
    const auto option = std::ranges::find_if(words, [](const std::string& word) {
        return small_letters(word) == "change_coords_only" || small_letters(word) == "changing_geometry_per_part";
    });
    if (option != words.end()) {
        if (small_letters(*option) != "change_coords_only") {
            in_.fail_at(position, "changing_geometry_per_part is not supported", "whole geometry files are");
        }
        const auto step = option + 1;
        coordinates_step_ = step != words.end() && is_number(*step) ? static_cast<std::size_t>(std::stoi(*step)) : 0;
        words.erase(option, words.end());
    }
    geometry_ = files_of(std::move(words), position);
}

void EnsightCase::take_variable(const std::string& key, std::string_view rest, std::size_t position) {
    const std::size_t per = key.find(" per ");
    if (per == std::string::npos) return;
    const std::string place = key.substr(per + 5);
    const std::size_t components = components_of(key.substr(0, per));
    auto words = words_of(rest);
    if (key.starts_with("constant")) {
        ignored_.push_back({"constant", words.empty() ? key : words[words.size() > 2 ? 1 : 0]});
        return;
    }
    if (components == 0 || (place != "node" && place != "element")) {
        ignored_.push_back({"variable", std::string(rest), 1, "variables of the kind " + in_quotes(key) + " are not read"});
        warnings_.push_back(ignored_text(ignored_.back()));
        return;
    }
    if (words.size() < 2) in_.fail_at(position, "a name and a file are needed");
    const std::string name = words[words.size() - 2];
    words.erase(words.end() - 2);
    variables_.push_back({name, components, place == "element", files_of(std::move(words), position)});
}

// The lines of a set: its number, then for each file its index and how many steps it has.
void EnsightCase::take_file(std::string_view key, std::string_view rest, std::size_t position) {
    const std::string word(rest.substr(0, rest.find_first_of(" \t")));
    if (!is_number(word)) in_.fail_at(position, "a number is expected, not " + in_quotes(word));
    const int number = std::stoi(word);
    auto& files = file_sets_[file_set_];
    if (key == "file set") {
        file_set_ = number;
        file_sets_.try_emplace(number);
    } else if (key == "filename index") {
        files.push_back({number, 0});
    } else if (key == "number of steps") {
        if (files.empty() || files.back().steps > 0) files.emplace_back();
        files.back().steps = static_cast<std::size_t>(number);
    }
}

void EnsightCase::take_time(std::string_view key, std::string_view rest, std::size_t position) {
    if (!key.empty()) list_ = key;
    TextScanner numbers(rest, {}, TextScanner::Comments::None);
    const auto next = [&]() -> double {
        const std::string_view word = numbers.word();
        double value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
            in_.fail_at(position, "a number is expected, not " + in_quotes(word));
        }
        return value;
    };
    const auto whole = [&]() -> std::int64_t {
        const double value = next();
        if (value != std::floor(value) || std::abs(value) > 1e12) in_.fail_at(position, "a whole number is expected");
        return static_cast<std::int64_t>(value);
    };
    if (key == "time set") set_ = static_cast<int>(std::clamp<std::int64_t>(whole(), 0, 1 << 20));
    if (key == "filename start number") spreads_[set_].start = whole();
    if (key == "filename increment") spreads_[set_].increment = whole();
    if (key == "number of steps") {
        const std::int64_t steps = whole();
        if (steps < 1 || static_cast<std::size_t>(steps) > kMostSteps)
            in_.fail_at(position, "there cannot be " + std::to_string(steps) + " steps");
        spreads_[set_].steps = static_cast<std::size_t>(steps);
    }
    if (list_ == "time values") {
        while (!numbers.at_end()) sets_[set_].times.push_back(next());
    } else if (list_ == "filename numbers") {
        while (!numbers.at_end()) sets_[set_].numbers.push_back(whole());
    }
}

void EnsightCase::finish_times() {
    for (auto& [number, set] : sets_) {
        const auto& spread = spreads_[number];
        if (set.numbers.empty()) {
            for (std::size_t k = 0; k < std::min(set.times.size(), kMostSteps); ++k) {
                set.numbers.push_back(spread.start + static_cast<std::int64_t>(k) * spread.increment);
            }
        }
        if (set.times.empty() || set.times.size() != set.numbers.size() ||
            (spread.steps > 0 && spread.steps != set.times.size())) {
            in_.fail_at(0,
                        "time set " + std::to_string(number) + " has " + counted(set.times.size(), "time", "times") + " and " +
                            counted(set.numbers.size(), "number", "numbers") + " of files",
                        spread.steps > 0 ? "for " + counted(spread.steps, "step", "steps") : std::string());
        }
        std::vector<std::size_t> order(set.times.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::stable_sort(order, {}, [&times = set.times](std::size_t k) { return times[k]; });
        EnsightTimes sorted;
        for (const std::size_t k : order) {
            sorted.times.push_back(set.times[k]);
            sorted.numbers.push_back(set.numbers[k]);
            sorted.places.push_back(k);
        }
        set = std::move(sorted);
        if (set.times.size() > times_.size()) times_ = set.times;
    }
    const auto check = [&](const EnsightFiles& files) {
        if (files.name.find('*') != std::string::npos && !sets_.contains(files.time_set) && sets_.size() != 1) {
            in_.fail_at(files.position, "there is no time set " + std::to_string(files.time_set));
        }
    };
    check(geometry_);
    for (const EnsightVariable& variable : variables_) check(variable.files);
}

EnsightStep EnsightCase::file_at(const EnsightFiles& files, double time) const {
    std::string name = files.name;
    const std::size_t star = name.find('*');
    const auto several = file_sets_.find(files.file_set);
    std::optional<std::size_t> step;
    std::int64_t number = 0;
    if (!sets_.empty() && (star != std::string::npos || several != file_sets_.end())) {
        const auto time_set = sets_.find(files.time_set);
        const EnsightTimes& set = time_set != sets_.end() ? time_set->second : sets_.begin()->second;
        const auto after = std::ranges::upper_bound(set.times, time);
        const std::size_t k = after == set.times.begin() ? 0 : static_cast<std::size_t>(after - set.times.begin()) - 1;
        number = set.numbers[k];
        if (files.file_set > 0 && several != file_sets_.end()) {
            step = set.places[k];
            for (const Several& file : several->second) {
                number = file.index;
                if (file.steps == 0 || *step < file.steps) break;
                if (&file != &several->second.back()) *step -= file.steps;
            }
        }
    }
    if (star != std::string::npos) {
        const std::size_t end = std::min(name.find_first_not_of('*', star), name.size());
        std::string digits = std::to_string(number);
        if (digits.size() < end - star) digits.insert(0, end - star - digits.size(), '0');
        name.replace(star, end - star, digits);
    }
    return {named_file(folder_, name, [&] { return in_.place_of(files.position); }), step};
}

}  // namespace subvol::detail
