// SPDX-License-Identifier: Apache-2.0
#include "choices.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "subvol/detail/near_name.h"
#include "text.h"

namespace subvol::cli {
namespace {

/// "{a,b}", as CLI11 describes sets; completion and the manual page read it.
std::string as_set(const std::vector<std::string>& words) {
    std::string set;
    for (const std::string& word : words) set += (set.empty() ? "" : ",") + word;
    return "{" + set + "}";
}

}  // namespace

CLI::Validator one_of(const std::vector<std::string>& words) {
    const auto check = [words](const std::string& value) -> std::string {
        if (std::ranges::find(words, value) != words.end()) return {};
        return "'" + value + "' is unknown" + detail::did_you_mean(value, words) + " (supported: " + join(words) + ")";
    };
    return {check, as_set(words), "one of"};
}

CLI::Validator offered(const std::vector<std::string>& words) {
    return {[](const std::string&) { return std::string(); }, as_set(words), "offered"};
}

}  // namespace subvol::cli
