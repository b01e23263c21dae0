// SPDX-License-Identifier: Apache-2.0
#include "report.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <iomanip>
#include <iostream>
#include <variant>

#include "interrupt.h"
#include "quantities.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "text.h"

namespace subvol::cli {
namespace {

bool progress_visible(const CommonOptions& options) {
    if (options.quiet || options.progress == "off") return false;
    return options.progress == "on" || isatty(STDERR_FILENO) != 0;
}

/// A value for people: text without quotes, real numbers with six digits, an object as "key value, key value".
std::string for_people(const Json& value) {
    if (value.is_string()) return detail::printable(value.get<std::string>());
    if (value.is_number_float()) return text(std::setprecision(6), value.get<double>());
    if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
    if (value.is_null()) return "none";
    if (!value.is_structured()) return value.dump();
    std::vector<std::string> parts;
    for (const auto& [key, part] : value.items())
        parts.push_back(value.is_object() ? detail::printable(key) + " " + for_people(part) : for_people(part));
    return value.is_array() ? "(" + join(parts) + ")" : join(parts);
}

std::string stages(const Json& seconds) {
    std::vector<std::string> parts;
    for (const auto& [stage, value] : seconds.items()) parts.push_back(stage + " " + seconds_text(value.get<double>()));
    return join(parts);
}

/// The columns that a text takes on a terminal: its characters, not its bytes.
std::size_t width_of(const std::string& text) {
    return static_cast<std::size_t>(
        std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80; }));
}

/// The rows of a list of objects under the names of their keys, in columns.
std::vector<std::string> columns_of(const Json& rows) {
    std::vector<std::string> keys;
    for (const Json& row : rows) {
        for (const auto& [key, value] : row.items()) {
            if (std::ranges::find(keys, key) == keys.end()) keys.push_back(key);
        }
    }
    std::vector<std::string> lines(rows.size() + 1);
    for (const std::string& key : keys) {
        std::vector<std::string> cells{detail::printable(key)};
        for (const Json& row : rows) {
            const bool bytes = key == "bytes" && row.contains(key);
            cells.push_back(!row.contains(key) ? "" : bytes ? bytes_text(row[key].get<double>()) : for_people(row[key]));
        }
        std::size_t width = 0;
        for (const std::string& cell : cells) width = std::max(width, width_of(cell));
        for (std::size_t i = 0; i < lines.size(); ++i) {
            if (key != keys.back()) cells[i].append(width + 2 - width_of(cells[i]), ' ');
            lines[i] += cells[i];
        }
    }
    return lines;
}

void print_table(const Json& json) {
    Lines lines;
    for (const auto& [key, value] : json.items()) {
        if (value.is_array() && !value.empty() && value.front().is_object()) {
            std::string name = key;
            for (const std::string& line : columns_of(value)) lines.emplace_back(std::exchange(name, ""), line);
            continue;
        }
        const bool bytes = (key.ends_with("bytes") || key.starts_with("bytes_")) && value.is_number();
        const bool in_file = key == "file_bytes" || key == "mesh_bytes";
        const std::string name =
            key.ends_with("_bytes") ? key.substr(0, key.size() - 6) + (in_file ? "_size" : "_memory") : key;
        lines.emplace_back(detail::printable(name), key == "seconds" && value.is_object() ? stages(value)
                                                    : bytes                               ? bytes_text(value.get<double>())
                                                                                          : for_people(value));
    }
    std::cout << aligned(lines);
}

struct JsonOf {
    Json operator()(std::monostate) const { return nullptr; }
    template <class Plain>
    Json operator()(const Plain& value) const {
        return value;
    }
    Json operator()(const FactValue::List& list) const {
        Json array = Json::array();
        for (const FactValue& item : list) array.push_back(std::visit(*this, item.value));
        return array;
    }
    Json operator()(const Facts& facts) const {
        Json object = Json::object();
        for (const Fact& fact : facts.all()) object[fact.name] = std::visit(*this, fact.value.value);
        return object;
    }
};

/// A sentence without its numbers: what is left is the same at all steps of a series. Digits in names and in quotes stay.
std::string without_numbers(const std::string& sentence) {
    std::string result;
    bool in_word = false, quoted = false;
    for (std::size_t i = 0; i < sentence.size(); ++i) {
        const auto c = static_cast<unsigned char>(sentence[i]);
        if (c == '"') quoted = !quoted;
        std::size_t end = i;
        const auto in_number = [&](char d) { return std::isdigit(static_cast<unsigned char>(d)) != 0 || d == '.' || d == ','; };
        if (!in_word && !quoted && std::isdigit(c) != 0) {
            while (end + 1 < sentence.size() && in_number(sentence[end + 1])) ++end;
            if (sentence.compare(end + 1, 2, "e-") == 0 || sentence.compare(end + 1, 2, "e+") == 0) {
                end += 2;
                while (end + 1 < sentence.size() && in_number(sentence[end + 1])) ++end;
            }
            while (end > i && !std::isdigit(static_cast<unsigned char>(sentence[end]))) --end;  // a comma or stop after it
            result += '#';
            i = end;
            continue;
        }
        in_word = std::isalnum(c) != 0 || c == '_' || c >= 128;
        result += sentence[i];
    }
    return result;
}

}  // namespace

Json json_of(const Facts& facts) {
    return JsonOf()(facts);
}

std::int64_t peak_memory_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return std::int64_t{usage.ru_maxrss} * 1024;  // Linux counts it in KiB
}

Report::Report(const CommonOptions& options)
    : print_json_(options.json), quiet_(options.quiet), progress_(progress_visible(options)) {
}

void Report::warn(const std::string& text) {
    if (text.empty()) return;
    const std::string warning = detail::printable_message(text);  // whichever library it comes from
    Json& warnings = json_["warnings"];
    if (std::ranges::find(warnings, Json(warning)) != warnings.end()) return;  // already reported, for another frame
    warnings.push_back(warning);
    if (print_json_ || quiet_) return;
    if (!said_.insert(without_numbers(warning)).second && series_) {
        ++repeated_;
        return;
    }
    progress_.clear();
    std::cerr << "subvol: warning: " << warning << '\n';
}

void Report::merge(const Facts& facts) {
    for (const auto& [name, fact, unit] : facts.all()) {
        const Json value = std::visit(JsonOf{}, fact.value);
        if (name == "warnings") {
            for (const Json& warning : value) warn(warning.get<std::string>());
        } else if (name == "notes") {
            for (const Json& remark : value) note(remark.get<std::string>());
        } else if (name == "seconds") {
            for (const auto& [stage, seconds] : value.items()) add_seconds(stage, seconds.get<double>());
        } else {
            json_[name] = value;
        }
    }
}

void Report::note(const std::string& note) {
    if (note.empty() || print_json_ || quiet_) return;
    if (!said_.insert(without_numbers(note)).second && series_) return;
    progress_.clear();
    std::cerr << "subvol: note: " << detail::printable_message(note) << '\n';
}

void Report::end_series() {
    series_ = false;
    if (repeated_ == 0) return;
    progress_.clear();
    std::cerr << "subvol: note: " << counted(repeated_, "more warning") << " " << (repeated_ == 1 ? "differs" : "differ")
              << " from these in numbers alone; --json has all\n";
    repeated_ = 0;
}

void Report::add_seconds(const std::string& stage, double seconds) {
    Json& all = json_["seconds"];
    all[stage] = all.is_null() ? seconds : all.value(stage, 0.0) + seconds;
}

void Report::if_long(const std::string& quicker) {
    if (print_json_ || quiet_) return;
    progress_.hint_at(quicker, [](const std::string& words) { std::cerr << "subvol: note: " << words << std::endl; });
}

void Report::say(const std::string& line) {
    if (!quiet_) answer(line);
}

void Report::answer(const std::string& line) {
    if (print_json_) return;
    progress_.clear();
    std::cout << line << std::endl;
}

void Report::finish() {
    progress_.clear();
    if (json_.contains("seconds")) json_["peak_bytes"] = peak_memory_bytes();
    say_at_last([&] {
        if (print_json_) {
            if (!json_.contains("warnings")) json_["warnings"] = Json::array();
            std::cout << json_.dump(2, ' ', false, Json::error_handler_t::replace) << std::endl;
        } else if (!quiet_ && !all_said_) {
            json_.erase("warnings");
            print_table(json_);
        }
    });
    if (!std::cout.flush()) throw Error(ErrorCode::Io, "could not be written", "standard output");
}

}  // namespace subvol::cli
