// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gmsh_values.h"
#include "sharp_groups.h"

namespace subvol::detail {

/// The physical groups of a Gmsh file, and which of them the user wants to be sharp. They are of curves (dimension 1) and
/// surfaces (2).
class GmshGroups {
public:
    explicit GmshGroups(std::span<const std::string> wanted) : wanted_(wanted) {}

    /// Whether any are wanted; if not, the sections of groups need not be read.
    [[nodiscard]] bool any() const { return wanted_.any(); }

    /// Reads the section $PhysicalNames, whose keyword was the last word.
    void read_names(TextScanner& in);

    /// Reads the section $Entities, whose keyword was the last word.
    ///
    /// places: points of the geometry have their coordinates there, as in version 4.1, and no box
    void read_entities(GmshValues& values, bool places);

    /// Whether the user wants a group. group: negative where the element is turned round
    [[nodiscard]] bool is_sharp(std::int64_t dimension, std::int64_t group);

    /// Whether the user wants one of the groups that an entity of the geometry is in.
    [[nodiscard]] bool has_sharp(std::int64_t dimension, std::int64_t entity);

    /// To be called after the last element. throws: as SharpGroups::check
    void check(std::string_view file) const { wanted_.check(file); }

private:
    using Key = std::pair<std::int64_t, std::int64_t>;  // dimension and number

    SharpGroups wanted_;
    std::map<Key, std::string> names_;
    std::map<Key, std::vector<std::int64_t>> groups_of_;  // of an entity of the geometry
    std::map<Key, bool> sharp_;                           // groups that occurred
};

}  // namespace subvol::detail
