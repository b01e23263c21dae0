// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "study_keys.h"
#include "subvol/detail/near_name.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/several_errors.h"
#include "subvol/detail/study_strands.h"
#include "subvol/picture_metrics.h"
#include "subvol/study_measures.h"

// Tables and plots are checked before the first case runs. A key must exist. Cases may only meet in one cell of a table, or on
// one line of a plot, if the study names the keys in which they differ: else a figure would stand for cases that it is not of.

namespace subvol::detail {

namespace {

using Cases = std::vector<std::size_t>;

std::string joined(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
}

class Checker {
public:
    Checker(const Study& study, const std::string& root, const std::vector<StudyMethod>& unread, bool keys_alone)
        : study_(study), root_(root), keys_(all_keys(study)), complete_(!keys_alone) {
        if (unread.empty()) return;
        for (const StudyMethod& method : unread) {
            for (const Key& key : method.keys) keys_.push_back(key.name);
        }
        for (const StudyMeasure& one : study_measures()) keys_.emplace_back(one.key);
        for (const std::string& metric : study_metrics()) keys_.insert(keys_.end(), {metric, "floor_" + metric});
        keys_.insert(keys_.end(),
                     {"study", "method", "label", "input", "view", "camera", "tf", "width", "height", "metrics", "exr"});
    }

    void check() const {
        Mistakes mistakes;
        for (std::size_t i = 0; i < study_.tables.size(); ++i)
            mistakes.none_in([&] { check(study_.tables[i], at(in(root_, "tables"), i)); });
        for (std::size_t i = 0; i < study_.plots.size(); ++i)
            mistakes.none_in([&] { check(study_.plots[i], at(in(root_, "plots"), i)); });
        for (std::size_t i = 0; i < study_.demands.size(); ++i) {
            const std::string path = at(in(root_, "demands"), i);
            Cases cases;
            const bool chosen_well = mistakes.none_in([&] { cases = chosen(study_.demands[i].where, in(path, "where")); });
            const bool known = mistakes.none_in([&] { check_key(study_.demands[i].metric, in(path, "metric")); });
            if (chosen_well && known)
                mistakes.none_in([&] { check_measured(study_.demands[i].metric, cases, in(path, "metric")); });
        }
        mistakes.none_in([&] { (void)chosen(study_.pictures_where, in(root_, "pictures")); });
        mistakes.check();
    }

private:
    void check_key(const std::string& key, const std::string& path) const {
        if (key.empty() || std::ranges::find(keys_, key) != keys_.end() || key.starts_with("parameter.")) return;
        if (!complete_ && key.find('.') != std::string::npos) return;  // such as given.KEY, of a case that could not be read
        refuse(path, "no case has the key '" + shortened(key) + "'" + did_you_mean(key, keys_), joined(keys_));
    }

    void check_keys(const std::vector<std::string>& keys, const std::string& path) const {
        Mistakes mistakes;
        for (std::size_t i = 0; i < keys.size(); ++i)
            mistakes.none_in([&] { check_key(keys[i], keys.size() == 1 ? path : at(path, i)); });
        mistakes.check();
    }

    /// Whether some case has the key before it runs.
    [[nodiscard]] bool is_value(const std::string& key) const {
        return std::ranges::any_of(study_.cases, [&](const StudyCase& one) { return one.has(key); });
    }

    /// The cases that a filter selects, as far as that is known before they run.
    [[nodiscard]] Cases chosen(const StudyFilter& where, const std::string& path) const {
        for (const auto& [key, wish] : where) {
            check_key(key, in(path, key));
            if (!is_value(key) || !complete_) continue;
            std::set<std::string> values;
            for (const StudyCase& one : study_.cases) {
                if (one.has(key)) values.insert(as_text(one.values.at(key)));
            }
            if (!values.contains(wish))
                refuse(in(path, key), "no case has the value '" + shortened(wish) + "'",
                       joined({values.begin(), values.end()}));
        }
        Cases cases;
        for (std::size_t c = 0; c < study_.cases.size(); ++c) {
            const auto fits = [&](const auto& wish) {
                const auto& values = study_.cases[c].values;
                return !is_value(wish.first) || (values.contains(wish.first) && as_text(values.at(wish.first)) == wish.second);
            };
            if (std::ranges::all_of(where, fits)) cases.push_back(c);
        }
        if (cases.empty() && complete_) refuse(path, "no case has all these values");
        return cases;
    }

    /// A known key.
    void check_measured(const std::string& key, const Cases& cases, const std::string& path) const {
        if (!complete_) return;
        if (std::ranges::any_of(cases, [&](std::size_t c) { return has_key(study_, study_.cases[c], key); })) return;
        refuse(path, "none of the cases is measured by '" + shortened(key) + "'");
    }

    /// The keys by which some cases differ and that are not named; "" if there are none.
    [[nodiscard]] std::string unnamed(const Cases& cases, const std::vector<std::string>& named) const {
        std::vector<std::string> keys;
        for (const std::string& key : differing_keys(study_, cases)) {
            // The camera's numbers follow from its name, the parts of a transfer function from its own, a file's from the
            // input's.
            const bool part = key.find('.') != std::string::npos || key == "camera";
            if (!part && std::ranges::find(named, key) == named.end()) keys.push_back(key);
        }
        return joined(keys.empty() ? differing_keys(study_, cases) : keys);
    }

    void check(const StudyTableSpec& table, const std::string& path) const {
        Mistakes mistakes;
        Cases cases;
        mistakes.none_in([&] { cases = chosen(table.where, in(path, "where")); });
        for (const auto& [keys, name] : {std::pair{&table.rows, "rows"},
                                         {&table.columns, "columns"},
                                         {&table.values, "values"},
                                         {&table.average, "average"}}) {
            const auto* const list = keys;
            const std::string place = in(path, name);
            mistakes.none_in([&] { check_keys(*list, place); });
        }
        std::vector<std::string> named = table.rows;
        if (!table.across.empty()) {
            mistakes.none_in([&] { check_key(table.across, in(path, "across")); });
            named.push_back(table.across);
        }
        mistakes.check();
        named.insert(named.end(), table.average.begin(), table.average.end());
        for (const auto* keys : {&table.columns, &table.values}) {
            for (const std::string& key : *keys)
                mistakes.none_in([&] { check_measured(key, cases, in(path, keys == &table.columns ? "columns" : "values")); });
        }
        mistakes.check();
        if (!complete_) return;
        // What is measured is known after the cases ran: such rows show the spread of what they merge.
        if (!std::ranges::all_of(named, [&](const std::string& key) { return is_value(key); })) return;
        std::vector<std::string> shown = table.columns;
        shown.insert(shown.end(), table.values.begin(), table.values.end());
        for (const std::string& key : shown) {
            std::map<std::string, Cases> cells;
            for (const std::size_t c : cases) {
                if (has_key(study_, study_.cases[c], key)) cells[values_text(study_.cases[c], named)].push_back(c);
            }
            for (const auto& [cell, members] : cells) {
                const std::vector<std::string> only{key};
                if (members.size() < 2 || (is_value(key) && same(members, only))) continue;
                refuse(in(path, "rows"),
                       "'" + key + "' of " + std::to_string(members.size()) + " cases would share a cell; they differ in " +
                           unnamed(members, named),
                       "name these keys in 'rows', select with 'where', or take means with 'average'");
            }
        }
    }

    [[nodiscard]] bool same(const Cases& cases, std::span<const std::string> keys) const {
        return std::ranges::all_of(cases, [&](std::size_t c) {
            return values_text(study_.cases[c], keys) == values_text(study_.cases[cases.front()], keys);
        });
    }

    void check(const StudyPlotSpec& plot, const std::string& path) const {
        Mistakes mistakes;
        Cases cases;
        mistakes.none_in([&] { cases = chosen(plot.where, in(path, "where")); });
        const bool known = mistakes.none_in([&] { check_key(plot.x, in(path, "x")); }) &
                           mistakes.none_in([&] { check_key(plot.y, in(path, "y")); });
        mistakes.none_in([&] { check_keys(plot.series, in(path, "series")); });
        mistakes.none_in([&] { check_keys(plot.average, in(path, "average")); });
        mistakes.none_in([&] { check_keys(plot.together, in(path, "together")); });
        std::vector<std::string> named = plot.series;
        if (!plot.panels.empty()) {
            mistakes.none_in([&] { check_key(plot.panels, in(path, "panels")); });
            named.push_back(plot.panels);
        }
        if (known && !cases.empty()) {
            mistakes.none_in([&] { check_measured(plot.x, cases, in(path, "x")); });
            mistakes.none_in([&] { check_measured(plot.y, cases, in(path, "y")); });
        }
        mistakes.check();
        if (!complete_) return;
        named.insert(named.end(), plot.together.begin(), plot.together.end());
        if (!std::ranges::all_of(named, [&](const std::string& key) { return is_value(key); })) return;
        std::map<std::string, Cases> series;
        for (const std::size_t c : cases) {
            const StudyCase& one = study_.cases[c];
            if (has_key(study_, one, plot.x) && has_key(study_, one, plot.y)) series[values_text(one, named)].push_back(c);
        }
        for (const auto& [line, members] : series) {
            const auto strands = strands_of(study_, members, plot.x, plot.average);
            if (strands.size() < 2) continue;
            Cases firsts;
            for (const StudyStrand& strand : strands) firsts.push_back(strand.front().front());
            named.insert(named.end(), plot.average.begin(), plot.average.end());
            refuse(
                in(path, "series"), "cases of one series differ in " + unnamed(firsts, named),
                "name these keys in 'series' or 'panels', select with 'where', take means with 'average', or allow them with "
                "'together'");
        }
    }

    const Study& study_;
    const std::string& root_;
    std::vector<std::string> keys_;
    bool complete_;
};

}  // namespace

void check_presentation(const Study& study, const std::string& root, const std::vector<StudyMethod>& unread, bool keys_alone) {
    Checker(study, root, unread, keys_alone).check();
}

}  // namespace subvol::detail
