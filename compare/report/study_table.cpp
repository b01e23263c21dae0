// SPDX-License-Identifier: Apache-2.0
#include "subvol/study_table.h"

#include <algorithm>
#include <cmath>

#include "subvol/detail/number_text.h"

namespace subvol {

using namespace detail;

namespace {

/// The number of characters of UTF-8 text.
std::size_t width_of(const std::string& text) {
    return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string heading(const StudyTableSpec& spec, const std::string& key) {
    const auto found = spec.headings.find(key);
    if (found != spec.headings.end()) return found->second;
    return spaced(key.starts_with("given.") ? key.substr(6) : key);
}

StudyTable::Cell cell_of(const StudyCase& study_case, const CaseResult& result, const std::string& key) {
    const auto value = find_value(study_case, result, key);
    if (!value) return std::nan("");
    if (const auto* number = std::get_if<double>(&*value)) return *number;
    return key == "input" ? spaced(as_text(*value)) : as_text(*value);
}

/// The index of a text among those found so far; new ones are appended.
std::size_t place_in(std::vector<std::string>& all, const std::string& one) {
    const auto found = std::ranges::find(all, one);
    if (found != all.end()) return static_cast<std::size_t>(found - all.begin());
    all.push_back(one);
    return all.size() - 1;
}

StudyTable make_table(const StudyResults& results, const StudyTableSpec& spec) {
    StudyTable table;
    table.title = spec.title;
    table.caption = spec.caption;
    table.digits = spec.digits;
    std::vector<std::size_t> chosen;
    std::vector<std::string> groups, across;
    for (std::size_t i = 0; i < results.results.size(); ++i) {
        if (!matches(results.study.cases[i], results.results[i], spec.where)) continue;
        chosen.push_back(i);
        if (spec.across.empty()) continue;
        // A failed case may have no such value.
        if (const auto which = value_text(results.study.cases[i], results.results[i], spec.across); !which.empty()) {
            place_in(across, which);
        }
    }
    for (const auto* keys : {&spec.rows, &spec.columns}) {
        for (const std::string& key : *keys) table.columns.push_back(heading(spec, key));
    }
    const std::size_t fixed = table.columns.size();
    for (const std::string& which : across) {
        for (const std::string& value : spec.values) {
            const std::string label = spec.headings.contains(which) ? spec.headings.at(which) : which;
            table.columns.push_back(spec.values.size() == 1 ? label : label + ": " + heading(spec, value));
        }
    }
    const auto put = [&](std::size_t r, std::size_t c, std::size_t i, const std::string& key) {
        table.rows[r][c] = cell_of(results.study.cases[i], results.results[i], key);
        if (const auto mark = mark_of(results.results[i], key, table.digits)) table.marks[{r, c}] = *mark;
    };
    for (const std::size_t i : chosen) {
        const StudyCase& study_case = results.study.cases[i];
        const CaseResult& result = results.results[i];
        std::string group;
        for (const std::string& key : spec.rows) group += value_text(study_case, result, key) + '\t';
        const std::size_t r = place_in(groups, group);
        if (r == table.rows.size()) {
            auto& row = table.rows.emplace_back(table.columns.size(), std::nan(""));
            for (std::size_t k = 0; k < spec.rows.size(); ++k) row[k] = cell_of(study_case, result, spec.rows[k]);
        }
        const auto& row = table.rows[r];
        for (std::size_t k = 0; k < spec.columns.size(); ++k) {  // from the first case that has the value
            const auto& cell = row[spec.rows.size() + k];
            const auto* number = std::get_if<double>(&cell);
            if (number != nullptr && std::isnan(*number)) put(r, spec.rows.size() + k, i, spec.columns[k]);
        }
        const auto which = spec.across.empty() ? "" : value_text(study_case, result, spec.across);
        if (which.empty()) continue;
        const std::size_t a = place_in(across, which);
        for (std::size_t v = 0; v < spec.values.size(); ++v) {
            put(r, fixed + a * spec.values.size() + v, i, spec.values[v]);
        }
    }
    return table;
}

}  // namespace

std::string spaced(std::string name) {
    std::ranges::replace(name, '_', ' ');
    return name;
}

std::optional<StudyValue> find_value(const StudyCase& study_case, const CaseResult& result, const std::string& key) {
    if (const auto found = study_case.values.find(key); found != study_case.values.end()) return found->second;
    for (const auto* numbers : {&result.metrics, &result.costs}) {
        if (const auto found = numbers->find(key); found != numbers->end()) return found->second;
    }
    if (const auto found = result.notes.find(key); found != result.notes.end()) return found->second;
    if (key == "done") return result.failure.empty() ? "yes" : result.failure;
    return {};
}

std::string value_text(const StudyCase& study_case, const CaseResult& result, const std::string& key) {
    const auto value = find_value(study_case, result, key);
    return value ? as_text(*value) : "";
}

bool matches(const StudyCase& study_case, const CaseResult& result, const StudyFilter& where) {
    return std::ranges::all_of(where,
                               [&](const auto& wish) { return value_text(study_case, result, wish.first) == wish.second; });
}

std::vector<StudyTable> make_tables(const StudyResults& results) {
    std::vector<StudyTable> tables;
    for (const StudyTableSpec& spec : results.study.tables) {
        tables.push_back(make_table(results, spec));
        tables.back().name = results.study.name + (tables.size() == 1 ? "" : "_" + std::to_string(tables.size()));
    }
    return tables;
}

std::string readable(const StudyTable::Cell& cell, int digits) {
    if (const auto* words = std::get_if<std::string>(&cell)) return *words;
    const double number = std::get<double>(cell);
    if (std::isnan(number)) return "–";
    if (std::isinf(number)) return number > 0 ? "∞" : "−∞";
    const bool count = number == std::floor(number) && std::abs(number) < 1e15;
    return count ? fixed_text(number, 0) : number_text(number, digits);
}

std::string shown(const StudyTable& table, std::size_t row, std::size_t column) {
    const auto mark = table.marks.find({row, column});
    return mark != table.marks.end() ? mark->second : readable(table.rows[row][column], table.digits);
}

std::optional<double> accuracy(const CaseResult& result, const std::string& metric) {
    const auto change = result.metrics.find("reference_change");
    if (change == result.metrics.end() || !(change->second > 0)) return {};
    const double rms = change->second;
    if (metric == "rmse" || metric == "mae") return rms;  // a mean of sizes is at most the root of the mean square
    if (metric == "mse") return rms * rms;
    if (metric == "psnr") return -20 * std::log10(rms);
    return {};
}

std::optional<std::string> mark_of(const CaseResult& result, const std::string& key, int digits) {
    const auto known = accuracy(result, key);
    const auto found = result.metrics.find(key);
    if (!known || found == result.metrics.end()) return {};
    const bool psnr = key == "psnr";
    if (psnr ? found->second <= *known : found->second >= *known) return {};
    return (psnr ? "≥ " : "≤ ") + readable(*known, std::min(digits, 2 + (psnr ? 1 : 0)));
}

std::string as_text(const StudyTable& table) {
    std::vector<std::vector<std::string>> lines{table.columns};
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
        auto& line = lines.emplace_back();
        for (std::size_t c = 0; c < table.rows[r].size(); ++c) line.push_back(shown(table, r, c));
    }
    std::vector<std::size_t> widths(table.columns.size());
    for (const auto& line : lines) {
        for (std::size_t c = 0; c < line.size(); ++c) widths[c] = std::max(widths[c], width_of(line[c]));
    }
    std::string text = table.caption + "\n";
    for (const auto& line : lines) {
        for (std::size_t c = 0; c < line.size(); ++c) {
            const std::string blanks(widths[c] - width_of(line[c]), ' ');
            text += c == 0 ? line[c] + blanks : "  " + blanks + line[c];
        }
        text += '\n';
    }
    return text;
}

std::string as_csv(const StudyTable& table) {
    std::string text;
    const auto put = [&](const std::string& field, bool last) {
        std::string quoted;
        for (const char c : field) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
        text += '"' + quoted + '"' + (last ? "\n" : ",");
    };
    for (std::size_t c = 0; c < table.columns.size(); ++c) put(table.columns[c], c + 1 == table.columns.size());
    for (const auto& row : table.rows) {
        for (std::size_t c = 0; c < row.size(); ++c) put(readable(row[c], table.digits), c + 1 == row.size());
    }
    return text;
}

}  // namespace subvol
