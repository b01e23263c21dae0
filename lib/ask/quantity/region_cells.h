// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "subvol/certificate.h"
#include "subvol/region.h"

namespace subvol::detail {

/// The cells of a mesh that belong to regions. What several regions need, the verdicts on folds, is found once.
class RegionCells {
public:
    /// mesh, sets: referred to
    RegionCells(const HexMesh& mesh, const MeshSets& sets);

    /// A flag for each cell. throws: as `cells_in`, but not if there are none
    [[nodiscard]] std::vector<std::uint8_t> in(const Region& region);

private:
    /// Calls use(set) for each of several sets, whose names have commas between, unless one is called so.
    template <class Sets, class Find, class Use>
    void each_set(const Sets& sets, const std::string& names, const Find& find, const Use& use) const;

    const HexMesh& mesh_;
    const MeshSets& sets_;
    std::vector<FoldVerdict> verdicts_;
};

/// throws: Error(InvalidInput) if no cell is marked
void refuse_none(std::span<const std::uint8_t> cells);

}  // namespace subvol::detail
