// SPDX-License-Identifier: Apache-2.0
#include "subvol/part_opacity.h"

#include <algorithm>
#include <string_view>

#include "region_cells.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "subvol/topology.h"

namespace subvol {

namespace {

constexpr std::size_t kRest = 0;  // the number of the opaque part; that of what is not drawn follows the parts

/// The sides of a part that are drawn with it: those at the hull, and those at parts that come later or are not drawn.
Patch sides_of(const HexMesh& mesh, const Topology& topology, const std::vector<std::size_t>& numbers, std::size_t part) {
    Patch patch;
    for (Index cell = 0; cell < mesh.cells.size(); ++cell) {
        if (numbers[cell] != part) continue;
        for (std::uint8_t side = 0; side < kCellFaces.size(); ++side) {
            const auto& [a, b] = topology.face_cells[topology.cell_faces[cell][side]];
            const Index other = a == cell ? b : a;
            if (other == kNone || numbers[other] > part) patch.sides.push_back({cell, side});
        }
    }
    return patch;
}

}  // namespace

PartOpacity parse_part_opacity(const std::string& text) {
    constexpr const char* kAllowed = "a set of cells or a region, and a number from 0 to 1, such as casing=.2";
    const std::size_t sign = text.rfind('=');
    if (sign == std::string::npos || sign == 0)
        throw Error(ErrorCode::InvalidInput, "'" + text + "' gives no part an opacity", {}, kAllowed);
    double opacity = 0;
    Option("opacity", opacity).between(0, 1).read(text.substr(sign + 1), text);
    const std::string region = text.substr(0, sign);
    if (region.starts_with("block:")) return {Region("set:" + region.substr(6)), opacity};
    return {Region(region.find(':') == std::string::npos ? "set:" + region : region), opacity};
}

TranslucentParts translucent_parts(const HexMesh& mesh, std::span<const PartOpacity> parts, const MeshSets& sets) {
    std::vector<std::size_t> numbers(mesh.cells.size(), kRest);
    const std::size_t hidden = parts.size() + 1;
    detail::RegionCells in_regions(mesh, sets);
    for (std::size_t k = 0; k < parts.size(); ++k) {
        if (parts[k].region.kind() == Region::Kind::Set && sets.sets.empty()) {
            throw Error(ErrorCode::InvalidInput, "there is no set \"" + parts[k].region.quantity() + "\"", {},
                        "the mesh has no sets of cells and no blocks; a region such as half:0,0,0,1,0,0=.3 or where:T>500=.3");
        }
        const auto cells = in_regions.in(parts[k].region);
        detail::refuse_none(cells);
        const std::size_t number = parts[k].opacity >= 1 ? kRest : parts[k].opacity <= 0 ? hidden : k + 1;
        for (std::size_t c = 0; c < cells.size(); ++c) {
            if (cells[c]) numbers[c] = number;
        }
    }
    if (std::ranges::all_of(numbers, [&](std::size_t number) { return number == hidden; }))
        throw Error(ErrorCode::InvalidInput, "no part is left to be seen", {}, "an opacity above 0");
    TranslucentParts result;
    const Topology topology = build_topology(mesh);
    std::vector<Patch> patches;
    for (std::size_t k = 0; k < parts.size(); ++k) {
        patches.push_back(sides_of(mesh, topology, numbers, k + 1));
        result.opacities.insert(result.opacities.end(), patches.back().sides.size(), static_cast<float>(parts[k].opacity));
    }
    result.shells = patch_shells(mesh, patches);
    for (const std::size_t number : numbers) result.cells.push_back(number == kRest);
    if (std::ranges::find(numbers, kRest) != numbers.end()) {
        result.rest = only_cells(mesh, result.cells);
    } else {
        result.rest = mesh;
        result.rest.cells.clear();
    }
    return result;
}

}  // namespace subvol
