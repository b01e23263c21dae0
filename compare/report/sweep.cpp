// SPDX-License-Identifier: Apache-2.0
#include "sweep.h"

#include <algorithm>
#include <map>
#include <set>

namespace subvol::detail {

namespace {

/// A value of a case as text; "" if it has none.
std::string value_of(const StudyCase& of, const std::string& key) {
    const auto found = of.values.find(key);
    return found == of.values.end() ? "" : as_text(found->second);
}

bool is_number(const StudyCase& of, const std::string& key) {
    const auto found = of.values.find(key);
    return found != of.values.end() && std::holds_alternative<double>(found->second);
}

/// The keys whose values differ among the cases; those that are only shown do not count.
std::map<std::string, std::size_t> varying(const Study& study, std::span<const std::size_t> cases) {
    std::map<std::string, std::set<std::string>> values;
    for (const std::size_t c : cases) {
        for (const auto& [key, value] : study.cases[c].values) {
            if (key != "label" && !key.starts_with("given.")) values[key].insert(as_text(value));
        }
    }
    std::map<std::string, std::size_t> counts;
    for (const auto& [key, different] : values) {
        const bool everywhere = std::ranges::all_of(cases, [&](std::size_t c) { return study.cases[c].has(key); });
        if (different.size() + (everywhere ? 0 : 1) > 1) counts[key] = different.size() + (everywhere ? 0 : 1);
    }
    return counts;
}

/// "" if no number differs.
std::string swept_key(const Study& study, std::span<const std::size_t> cases, const std::string& x) {
    const auto numeric = [&](const std::string& key) {
        return std::ranges::all_of(cases, [&](std::size_t c) { return is_number(study.cases[c], key); });
    };
    if (!cases.empty() && numeric(x)) return x;
    std::string best;
    std::size_t most = 1;
    for (const auto& [key, count] : varying(study, cases)) {
        if (key == "seed" || count <= most || !numeric(key)) continue;
        best = key;
        most = count;
    }
    return best;
}

/// Whether a key has one value only for each value of the sweep, as a distance that shrinks with the spacing.
bool follows(const Study& study, std::span<const std::size_t> cases, const std::string& key, const std::string& sweep) {
    std::map<std::string, std::string> values;
    return std::ranges::all_of(cases, [&](std::size_t c) {
        const std::string value = value_of(study.cases[c], key);
        return values.try_emplace(value_of(study.cases[c], sweep), value).first->second == value;
    });
}

}  // namespace

std::vector<std::vector<std::size_t>> strands_of(const Study& study, std::span<const std::size_t> cases, const std::string& x) {
    const std::string sweep = swept_key(study, cases, x);
    std::vector<std::string> apart;
    for (const auto& [key, count] : varying(study, cases)) {
        if (key != sweep && (sweep.empty() || !follows(study, cases, key, sweep))) apart.push_back(key);
    }
    std::vector<std::string> groups;
    std::vector<std::vector<std::size_t>> strands;
    for (const std::size_t c : cases) {
        std::string group;
        for (const std::string& key : apart) group += value_of(study.cases[c], key) + '\n';
        const auto found = std::ranges::find(groups, group);
        if (found == groups.end()) {
            groups.push_back(group);
            strands.push_back({c});
        } else {
            strands[static_cast<std::size_t>(found - groups.begin())].push_back(c);
        }
    }
    if (sweep.empty()) return strands;
    for (auto& strand : strands) {
        std::ranges::stable_sort(strand, {}, [&](std::size_t c) { return std::get<double>(study.cases[c].values.at(sweep)); });
    }
    return strands;
}

}  // namespace subvol::detail
