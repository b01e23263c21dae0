// SPDX-License-Identifier: Apache-2.0
#include "subvol/mixed_cells.h"

#include "mixed_cells_split.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

HexMesh split_into_hexes(const HexMesh& hexes, const MixedCells& others) {
    if (!hexes.creases.empty() || !hexes.sharp_faces.empty()) {
        throw Error(ErrorCode::InvalidInput, "creases and sharp faces cannot be split with the cells");
    }
    for (const Attribute& attribute : hexes.attributes) {
        if (attribute.values.size() == hexes.points.size() * static_cast<std::size_t>(attribute.channels)) continue;
        throw Error(ErrorCode::InvalidInput, "its length is not that of the points", "attribute \"" + attribute.name + "\"");
    }
    HexSplit split = plan_split(hexes.points, hexes.cells, others);
    HexMesh result;
    result.points = means(split.sources, hexes.points);
    result.cells = std::move(split.cells);
    for (const Attribute& attribute : hexes.attributes) {
        result.attributes.push_back({attribute.name, attribute.channels,
                                     means(split.sources, attribute.values, static_cast<std::size_t>(attribute.channels))});
    }
    return result;
}

}  // namespace subvol
