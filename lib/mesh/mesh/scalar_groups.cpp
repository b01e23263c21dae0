// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/scalar_groups.h"
#include "subvol/detail/small_letters.h"

#include <algorithm>
#include <array>
#include <map>
#include <string_view>

namespace subvol::detail {
namespace {

/// The endings that the name of one component may have.
using Names = std::array<std::string_view, 2>;

/// A kind of field: its components, in the order of channels.
struct Kind {
    std::size_t letters;  // of an ending
    std::span<const Names> channels;
};

constexpr std::array<Names, 9> kTensor{{{"xx"}, {"xy"}, {"xz"}, {"yx"}, {"yy"}, {"yz"}, {"zx"}, {"zy"}, {"zz"}}};
constexpr std::array<Names, 6> kSymmetric{{{"xx"}, {"yy"}, {"zz"}, {"xy", "yx"}, {"yz", "zy"}, {"xz", "zx"}}};
constexpr std::array<Names, 3> kVector{{{"x"}, {"y"}, {"z"}}};
constexpr std::array<Kind, 3> kKinds{{{2, kTensor}, {2, kSymmetric}, {1, kVector}}};

/// Without the sign between a name and its component.
std::string without_separator(std::string stem) {
    if (stem.size() > 1 && std::string_view("_.:- ").find(stem.back()) != std::string_view::npos) stem.pop_back();
    return stem;
}

}  // namespace

std::vector<ScalarGroup> scalar_groups(std::span<const std::string> names) {
    std::vector<ScalarGroup> groups;
    std::vector<bool> grouped(names.size());
    for (const Kind& kind : kKinds) {
        std::map<std::string, std::map<std::string, std::size_t>> stems;  // numbers of names by stem and ending
        for (std::size_t n = 0; n < names.size(); ++n) {
            if (grouped[n] || names[n].size() <= kind.letters) continue;
            const std::size_t end = names[n].size() - kind.letters;
            stems[names[n].substr(0, end)].emplace(small_letters(names[n].substr(end)), n);
        }
        for (const auto& [stem, numbers] : stems) {
            ScalarGroup group{without_separator(stem), {}};
            for (const Names& endings : kind.channels) {
                for (const std::string_view ending : endings) {
                    const auto member = ending.empty() ? numbers.end() : numbers.find(std::string(ending));
                    if (member == numbers.end()) continue;
                    group.members.push_back(member->second);
                    break;
                }
            }
            if (group.members.size() != kind.channels.size()) continue;
            for (const std::size_t member : group.members) grouped[member] = true;
            groups.push_back(std::move(group));
        }
    }
    std::ranges::sort(groups, {}, [](const ScalarGroup& group) { return *std::ranges::min_element(group.members); });
    return groups;
}

}  // namespace subvol::detail
