// SPDX-License-Identifier: Apache-2.0
#include "gmsh_groups.h"

#include <array>
#include <cstdlib>
#include <limits>

#include "gmsh_data.h"

namespace subvol::detail {

// The names of groups are text even in a binary file.
void GmshGroups::read_names(TextScanner& in) {
    const std::size_t count = in.count({"$PhysicalNames"});
    for (std::size_t n = 0; n < count; ++n) {
        const Place place{"physical name", static_cast<std::int64_t>(n + 1), count};
        const std::int64_t dimension = in.integer(place);
        const std::int64_t number = in.integer(place);
        names_[{dimension, number}] = unquoted(in.line());
    }
}

// An entity: number, bounding box, physical groups, and the entities that bound it.
void GmshGroups::read_entities(GmshValues& values, bool places) {
    values.begin();
    std::array<std::size_t, 4> counts;
    for (std::size_t& count : counts) count = values.count({"$Entities"}, NumberType::UInt64);
    for (std::size_t dimension = 0; dimension < counts.size(); ++dimension) {
        for (std::size_t e = 0; e < counts[dimension]; ++e) {
            const Place place{"entity", static_cast<std::int64_t>(e + 1), counts[dimension]};
            auto& groups = groups_of_[{static_cast<std::int64_t>(dimension), values.integer(place)}];
            for (int k = 0; k < (dimension == 0 && places ? 3 : 6); ++k) values.real(place);
            const std::size_t of_groups = values.count(place, NumberType::UInt64);
            for (std::size_t g = 0; g < of_groups; ++g) groups.push_back(values.integer(place));
            const std::size_t bounds = dimension == 0 ? 0 : values.count(place, NumberType::UInt64);
            for (std::size_t b = 0; b < bounds; ++b) values.integer(place);
        }
    }
}

bool GmshGroups::is_sharp(std::int64_t dimension, std::int64_t group) {
    constexpr std::int64_t kMostGroup = std::numeric_limits<std::int64_t>::max();
    if (!any() || (dimension != 1 && dimension != 2) || group == 0 || group < -kMostGroup) return false;
    const auto [known, is_new] = sharp_.try_emplace({dimension, group}, false);
    if (!is_new) return known->second;
    const std::string number = std::to_string(std::abs(group));
    const auto named = names_.find({dimension, std::abs(group)});
    return known->second = wanted_.takes(named == names_.end() ? number : named->second, number);
}

bool GmshGroups::has_sharp(std::int64_t dimension, std::int64_t entity) {
    const auto groups = groups_of_.find({dimension, entity});
    if (groups == groups_of_.end()) return false;
    bool sharp = false;
    for (const std::int64_t group : groups->second) sharp = is_sharp(dimension, group) || sharp;
    return sharp;
}

}  // namespace subvol::detail
