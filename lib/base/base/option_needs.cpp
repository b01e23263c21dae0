// SPDX-License-Identifier: Apache-2.0
#include "subvol/option_needs.h"

#include <algorithm>

#include "subvol/error.h"
#include "subvol/option.h"

namespace subvol {
namespace {

/// "--order havs", "order='havs' or 'lists'"
std::string shown(const OptionNeed& need, const std::vector<std::string>& words, OptionNames names) {
    std::string all = option_name(need.option, names);
    const bool flags = names == OptionNames::Flags;
    for (const std::string& word : words) {
        all += &word == &words.front() ? (flags ? " " : "=") : " or ";
        all += flags ? word : "'" + word + "'";
    }
    return all;
}

}  // namespace

void check_needs(const Option& option, const GivenOptions& given, const GivenOptions& usual, OptionNames names) {
    const std::string where = names == OptionNames::Flags ? option_name(option.name, names) : option.key();
    for (const OptionNeed& need : option.needs) {
        if (!need.instead.empty() && given(need.instead)) continue;
        std::optional<std::string> other = given(need.option);
        if (!other && !need.words.empty()) other = usual(need.option);
        const bool matches = other && (need.words.empty() || std::ranges::find(need.words, *other) != need.words.end());
        if (matches && need.excluded) {
            const std::vector<std::string> word = need.words.empty() ? need.words : std::vector{*other};
            throw Error(ErrorCode::InvalidInput, "has no effect with " + shown(need, word, names), where,
                        "leave one of them out");
        }
        if (!matches && !need.excluded)
            throw Error(ErrorCode::InvalidInput, "has no effect without " + shown(need, need.words, names), where);
    }
    for (const std::string& other : option.excludes) {
        if (given(other))
            throw Error(ErrorCode::InvalidInput, "cannot be given together with " + where, option_name(other, names));
    }
}

void check_needs(const std::vector<Option>& options, const GivenOptions& given, OptionNames names) {
    const GivenOptions usual = [&](std::string_view name) -> std::optional<std::string> {
        const auto option = std::ranges::find(options, name, &Option::name);
        return option == options.end() ? std::nullopt : std::optional(option->text());
    };
    for (const Option& option : options) {
        if (given(option.name)) check_needs(option, given, usual, names);
    }
}

std::string need_text(const OptionNeed& need, OptionNames names) {
    return (need.excluded ? "not with " : "with ") + shown(need, need.words, names);
}

}  // namespace subvol
