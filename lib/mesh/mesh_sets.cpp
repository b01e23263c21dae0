// SPDX-License-Identifier: Apache-2.0
#include "subvol/mesh_sets.h"

#include <algorithm>
#include <iterator>

#include "subvol/cell.h"
#include "subvol/error.h"

namespace subvol {
namespace {

template <class Named>
const Named& find(const std::vector<Named>& all, std::string_view name, const std::string& kind, const std::string& kinds) {
    const auto found = std::ranges::find(all, name, &Named::name);
    if (found != all.end()) return *found;
    std::string known;
    for (const Named& one : all) known += (known.empty() ? "" : ", ") + one.name;
    throw Error(ErrorCode::InvalidInput, "there is no " + kind + " \"" + std::string(name) + "\"", {},
                known.empty() ? "the mesh has no " + kinds : "the mesh has: " + known);
}

}  // namespace

const Patch& find_patch(const MeshSets& sets, std::string_view name) {
    return find(sets.patches, name, "patch", "patches");
}

const CellSet& find_set(const MeshSets& sets, std::string_view name) {
    return find(sets.sets, name, "set", "sets of cells");
}

std::vector<Patch> chosen_patches(const MeshSets& sets, std::span<const std::string> names) {
    std::vector<Patch> patches;
    for (const std::string& name : names) {
        const bool all =
            name == "all" && !sets.patches.empty() && std::ranges::find(sets.patches, name, &Patch::name) == sets.patches.end();
        if (all) {
            std::ranges::copy_if(sets.patches, std::back_inserter(patches), [](const Patch& p) { return !p.sides.empty(); });
            continue;
        }
        patches.push_back(find_patch(sets, name));
        if (patches.back().sides.empty())
            throw Error(ErrorCode::InvalidInput, "no face of patch \"" + name + "\" is left", {}, "a patch with faces");
    }
    return patches;
}

MeshSets sets_of_cells(MeshSets sets, std::span<const std::uint8_t> kept) {
    std::vector<Index> numbers(kept.size(), kNone);
    Index next = 0;
    for (std::size_t c = 0; c < kept.size(); ++c) {
        if (kept[c]) numbers[c] = next++;
    }
    for (Patch& patch : sets.patches) {
        std::erase_if(patch.sides, [&](const CellSide& side) { return numbers[side.cell] == kNone; });
        for (CellSide& side : patch.sides) side.cell = numbers[side.cell];
    }
    for (CellSet& set : sets.sets) {
        std::erase_if(set.cells, [&](Index c) { return numbers[c] == kNone; });
        for (Index& c : set.cells) c = numbers[c];
    }
    return sets;
}

std::array<double, 3> place_on_side(std::uint8_t side, double s, double t) {
    const auto& corners = kCellFaces[side];
    std::array<double, 3> place{};
    for (std::size_t a = 0; a < 3; ++a) {
        const double from = kCornerParameters[corners[0]][a];
        place[a] = from + s * (kCornerParameters[corners[1]][a] - from) + t * (kCornerParameters[corners[3]][a] - from);
    }
    return place;
}

}  // namespace subvol
