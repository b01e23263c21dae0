// SPDX-License-Identifier: Apache-2.0
#include "steps.h"

#include <algorithm>

#include "subvol/detail/printable.h"
#include "subvol/error.h"

namespace subvol::detail {

BlockChoice::BlockChoice(std::span<const std::string> wanted, const std::vector<std::string>& there, std::string_view file)
    : wanted_(wanted.begin(), wanted.end()) {
    for (const std::string& name : wanted_) {
        if (std::ranges::find(there, name) != there.end()) continue;
        constexpr std::size_t kListed = 20;
        std::string list;
        for (std::size_t b = 0; b < std::min(there.size(), kListed); ++b) list += (b == 0 ? "" : ", ") + printable(there[b]);
        if (there.size() > kListed) list += " and " + std::to_string(there.size() - kListed) + " more";
        throw Error(ErrorCode::InvalidInput, "there is no block " + in_quotes(name), std::string(file),
                    list.empty() ? "it has none" : "it has: " + list);
    }
}

std::size_t chosen_step(const ReadOptions& options, std::size_t steps, std::string_view file,
                        std::vector<std::string>& warnings) {
    if (!options.step) {
        if (steps > 1) warnings.push_back("of " + std::to_string(steps) + " steps the last one is taken");
        return steps - 1;
    }
    if (*options.step < steps) return *options.step;
    throw Error(ErrorCode::InvalidInput, "there is no step " + std::to_string(*options.step), std::string(file),
                steps == 1 ? "it has one step, number 0" : "steps are 0 to " + std::to_string(steps - 1));
}

}  // namespace subvol::detail
