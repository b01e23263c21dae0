// SPDX-License-Identifier: Apache-2.0
// Tables from the results of a study, and how their figures are shown.
//
//     cases that match ─► rows by the values of the row keys ─► columns by keys, and by the values of the key across
//                      ─► one case in a cell: its value;  several: their mean ± standard deviation, or the list of words
//
// A reference is known only to an accuracy: the metric's own floor, or what follows from the change r of its last refinement
// (rmse, mae: r; mse: r²; psnr: −20 log10 r). A figure beyond that is a bound: "≤" where less is better, "≥" where more is.
// Means take the floor for such figures and are marked likewise. Marks are for people: CSV has the numbers, and deviations in
// a column of their own.
#include "subvol/study_table.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "subvol/detail/number_text.h"
#include "subvol/picture_metrics.h"

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

/// Finds the columns of a table, and fills its cells with what one case or several have there.
class TableMaker {
public:
    TableMaker(const StudyResults& results, const StudyTableSpec& spec) : results_(results), spec_(spec) {
        table_.title = spec.title;
        table_.caption = spec.caption;
        table_.digits = spec.digits;
    }

    StudyTable table() {
        const std::vector<std::size_t> chosen = chosen_cases();
        name_columns();
        for (const std::size_t i : chosen) add(i);
        for (const auto& [place, cases] : cells_) fill(place, cases);
        if (!table_.spreads.empty()) {
            table_.caption += (table_.caption.empty() ? "" : " ") + std::string("Means, ± their standard deviation");
            if (!spec_.average.empty()) table_.caption += " over the values of " + listed(spec_.average);
            table_.caption += ".";
        }
        return std::move(table_);
    }

private:
    using CellIndex = std::pair<std::size_t, std::size_t>;

    static std::string listed(const std::vector<std::string>& keys) {
        std::string text;
        for (const std::string& key : keys) text += (text.empty() ? "" : ", ") + spaced(key);
        return text;
    }

    std::vector<std::size_t> chosen_cases() {
        std::vector<std::size_t> chosen;
        for (std::size_t i = 0; i < results_.results.size(); ++i) {
            if (!matches(results_.study.cases[i], results_.results[i], spec_.where)) continue;
            chosen.push_back(i);
            if (spec_.across.empty()) continue;
            // A failed case may have no such value.
            if (const auto which = value_text(results_.study.cases[i], results_.results[i], spec_.across); !which.empty()) {
                place_in(across_, which);
            }
        }
        return chosen;
    }

    void name_columns() {
        for (const auto* keys : {&spec_.rows, &spec_.columns}) {
            for (const std::string& key : *keys) table_.columns.push_back(heading(spec_, key));
        }
        for (const std::string& which : across_) {
            for (const std::string& value : spec_.values) {
                const std::string label = spec_.headings.contains(which) ? spec_.headings.at(which) : which;
                table_.columns.push_back(spec_.values.size() == 1 ? label : label + ": " + heading(spec_, value));
            }
        }
    }

    void add(std::size_t i) {
        const StudyCase& study_case = results_.study.cases[i];
        const CaseResult& result = results_.results[i];
        std::string group;
        for (const std::string& key : spec_.rows) group += value_text(study_case, result, key) + '\t';
        const std::size_t r = place_in(groups_, group);
        if (r == table_.rows.size()) {
            auto& row = table_.rows.emplace_back(table_.columns.size(), std::nan(""));
            for (std::size_t k = 0; k < spec_.rows.size(); ++k) row[k] = cell_of(study_case, result, spec_.rows[k]);
        }
        const auto put = [&](std::size_t c, const std::string& key) {
            keys_[c] = key;
            if (find_value(study_case, result, key) || mark_of(result, key)) cells_[{r, c}].push_back(i);
        };
        for (std::size_t k = 0; k < spec_.columns.size(); ++k) put(spec_.rows.size() + k, spec_.columns[k]);
        const auto which = spec_.across.empty() ? "" : value_text(study_case, result, spec_.across);
        if (which.empty()) return;
        const std::size_t first = spec_.rows.size() + spec_.columns.size() + place_in(across_, which) * spec_.values.size();
        for (std::size_t v = 0; v < spec_.values.size(); ++v) put(first + v, spec_.values[v]);
    }

    void fill(const CellIndex& place, const std::vector<std::size_t>& cases) {
        const std::string& key = keys_.at(place.second);
        StudyTable::Cell& cell = table_.rows[place.first][place.second];
        cell = cell_of(results_.study.cases[cases.front()], results_.results[cases.front()], key);
        std::vector<std::string> texts;
        for (const std::size_t i : cases) (void)place_in(texts, value_text(results_.study.cases[i], results_.results[i], key));
        if (texts.size() == 1) {
            if (const auto mark = mark_of(results_.results[cases.front()], key, table_.digits)) table_.marks[place] = *mark;
            return;
        }
        if (std::holds_alternative<std::string>(cell)) {
            std::string all;
            for (const std::string& text : texts) all += (all.empty() ? "" : ", ") + text;
            cell = all;
            return;
        }
        fill_mean(place, cases, key);
    }

    /// The mean, of floors where less is known; the mark has the standard deviation of the cases.
    void fill_mean(const CellIndex& place, const std::vector<std::size_t>& cases, const std::string& key) {
        std::vector<double> values;
        bool bounded = false;
        for (const std::size_t i : cases) {
            const CaseResult& result = results_.results[i];
            const bool beyond = is_beyond_floor(result, key);
            bounded = bounded || beyond;
            const auto value = find_value(results_.study.cases[i], result, key);
            const double* const number = value ? std::get_if<double>(&*value) : nullptr;
            if (number != nullptr) values.push_back(beyond ? *accuracy(result, key) : *number);
        }
        const auto [mean, spread] = mean_and_spread(values);
        table_.rows[place.first][place.second] = mean;
        table_.spreads[place] = spread;
        const PictureMetric* const metric = find_metric(key);
        const std::string bound = !bounded ? "" : metric != nullptr && metric->more_is_better ? "≥ " : "≤ ";
        table_.marks[place] = bound + readable(mean, table_.digits) + " ± " + readable(spread, 2);
    }

    const StudyResults& results_;
    const StudyTableSpec& spec_;
    StudyTable table_;
    std::vector<std::string> groups_, across_;
    std::map<std::size_t, std::string> keys_;              // of columns
    std::map<CellIndex, std::vector<std::size_t>> cells_;  // the cases of each
};

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
        tables.push_back(TableMaker(results, spec).table());
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
    if (const auto floor = result.metrics.find("floor_" + metric); floor != result.metrics.end()) return floor->second;
    const auto change = result.metrics.find("reference_change");
    if (change == result.metrics.end() || !(change->second > 0)) return {};
    const double rms = change->second;
    if (metric == "rmse" || metric == "mae") return rms;  // a mean of sizes is at most the root of the mean square
    if (metric == "mse") return rms * rms;
    if (metric == "psnr") return -20 * std::log10(rms);
    return {};
}

bool is_beyond_floor(const CaseResult& result, const std::string& key) {
    const auto known = accuracy(result, key);
    const auto found = result.metrics.find(key);
    const PictureMetric* const metric = find_metric(key);
    if (!known || !std::isfinite(*known) || metric == nullptr || found == result.metrics.end()) return false;
    return metric->more_is_better ? found->second >= *known : *known > 0 && found->second <= *known;
}

std::optional<std::string> mark_of(const CaseResult& result, const std::string& key, int digits) {
    const bool missing = !result.metrics.contains(key) && find_metric(key) != nullptr;
    if (missing && result.notes.contains("own_reference")) return "= reference";
    if (!is_beyond_floor(result, key)) return {};
    const PictureMetric* const metric = find_metric(key);
    const int most = !metric->more_is_better ? 2 : metric->unit.empty() ? 6 : 3;  // of SSIM much is near 1
    return (metric->more_is_better ? "≥ " : "≤ ") + readable(*accuracy(result, key), std::min(digits, most));
}

Spread mean_and_spread(std::span<const double> values) {
    const auto count = static_cast<double>(values.size());
    double sum = 0, squares = 0;
    for (const double value : values) sum += value;
    const double mean = sum / count;
    for (const double value : values) squares += (value - mean) * (value - mean);
    return {mean, values.size() < 2 ? 0 : std::sqrt(squares / (count - 1))};
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
    std::set<std::size_t> spread;  // columns with means
    for (const auto& [place, value] : table.spreads) spread.insert(place.second);
    std::string text;
    const auto put = [&](const std::string& field) {
        std::string quoted;
        for (const char c : field) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
        text += (text.empty() || text.back() == '\n' ? "\"" : ",\"") + quoted + '"';
    };
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
        put(table.columns[c]);
        if (spread.contains(c)) put(table.columns[c] + " ±");
    }
    text += '\n';
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
        for (std::size_t c = 0; c < table.rows[r].size(); ++c) {
            put(readable(table.rows[r][c], table.digits));
            if (!spread.contains(c)) continue;
            const auto found = table.spreads.find({r, c});
            put(found == table.spreads.end() ? "–" : readable(found->second, table.digits));
        }
        text += '\n';
    }
    return text;
}

}  // namespace subvol
