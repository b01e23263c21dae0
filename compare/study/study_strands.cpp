// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/study_strands.h"

#include <algorithm>
#include <map>
#include <set>
#include <variant>

namespace subvol::detail {

namespace {

/// A value of a case as text; "" if it has none.
std::string value_of(const StudyCase& one, const std::string& key) {
    const auto found = one.values.find(key);
    return found == one.values.end() ? "" : as_text(found->second);
}

bool is_number(const StudyCase& one, const std::string& key) {
    const auto found = one.values.find(key);
    return found != one.values.end() && std::holds_alternative<double>(found->second);
}

bool contains(std::span<const std::string> keys, const std::string& key) {
    return std::ranges::find(keys, key) != keys.end();
}

/// The keys whose values differ, with the number of their values.
std::map<std::string, std::size_t> varying(const Study& study, std::span<const std::size_t> cases) {
    std::map<std::string, std::set<std::string>> values;
    for (const std::size_t c : cases) {
        for (const auto& [key, value] : study.cases[c].values) {
            if (key != "label" && !key.starts_with("given.")) values[key].insert(as_text(value));
        }
    }
    std::map<std::string, std::size_t> counts;
    for (const auto& [key, different] : values) {
        const bool everywhere =
            std::ranges::all_of(cases, [&, &name = key](std::size_t c) { return study.cases[c].has(name); });
        if (different.size() + (everywhere ? 0 : 1) > 1) counts[key] = different.size() + (everywhere ? 0 : 1);
    }
    return counts;
}

/// "" if no number differs.
std::string swept_key(const Study& study, std::span<const std::size_t> cases, const std::string& x,
                      std::span<const std::string> averaged) {
    const auto numeric = [&](const std::string& key) {
        return std::ranges::all_of(cases, [&](std::size_t c) { return is_number(study.cases[c], key); });
    };
    if (!cases.empty() && numeric(x)) return x;
    std::string best;
    std::size_t most = 1;
    for (const auto& [key, count] : varying(study, cases)) {
        if (key == "seed" || contains(averaged, key) || count <= most || !numeric(key)) continue;
        best = key;
        most = count;
    }
    return best;
}

/// Whether a key has one value only for all values of some others, as a distance that shrinks with the spacing.
bool follows(const Study& study, std::span<const std::size_t> cases, const std::string& key,
             std::span<const std::string> others) {
    std::map<std::string, std::string> values;
    return std::ranges::all_of(cases, [&](std::size_t c) {
        const std::string value = value_of(study.cases[c], key);
        return values.try_emplace(values_text(study.cases[c], others), value).first->second == value;
    });
}

/// The group of a text, appended if it is new.
template <class T>
T& group_named(std::vector<std::pair<std::string, T>>& groups, const std::string& name) {
    const auto found = std::ranges::find(groups, name, [](const auto& group) { return group.first; });
    return found != groups.end() ? found->second : groups.emplace_back(name, T{}).second;
}

}  // namespace

std::vector<std::string> differing_keys(const Study& study, std::span<const std::size_t> cases) {
    std::vector<std::string> keys;
    for (const auto& [key, count] : varying(study, cases)) keys.push_back(key);
    return keys;
}

std::string values_text(const StudyCase& study_case, std::span<const std::string> keys) {
    std::string text;
    for (const std::string& key : keys) text += value_of(study_case, key) + '\n';
    return text;
}

std::vector<StudyStrand> strands_of(const Study& study, std::span<const std::size_t> cases, const std::string& x,
                                    std::span<const std::string> averaged) {
    const std::string sweep = swept_key(study, cases, x, averaged);
    std::vector<std::string> along(averaged.begin(), averaged.end()), apart;
    if (!sweep.empty()) along.push_back(sweep);
    for (const std::string& key : differing_keys(study, cases)) {
        if (!contains(along, key) && (along.empty() || !follows(study, cases, key, along))) apart.push_back(key);
    }
    std::vector<std::pair<std::string, std::vector<std::size_t>>> groups;
    for (const std::size_t c : cases) group_named(groups, values_text(study.cases[c], apart)).push_back(c);
    std::vector<StudyStrand> strands;
    for (auto& [name, members] : groups) {
        if (!sweep.empty()) {
            std::ranges::stable_sort(members, {},
                                     [&](std::size_t c) { return std::get<double>(study.cases[c].values.at(sweep)); });
        }
        // Without averages each case has a place of its own.
        std::vector<std::pair<std::string, std::vector<std::size_t>>> places;
        for (const std::size_t c : members) {
            const std::string place = averaged.empty() ? std::to_string(c) : value_of(study.cases[c], sweep);
            group_named(places, place).push_back(c);
        }
        StudyStrand& strand = strands.emplace_back();
        for (auto& [place, at_place] : places) strand.push_back(std::move(at_place));
    }
    return strands;
}

}  // namespace subvol::detail
