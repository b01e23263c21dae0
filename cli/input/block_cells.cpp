// SPDX-License-Identifier: Apache-2.0
#include "block_cells.h"

#include <algorithm>
#include <array>
#include <map>

#include "input.h"
#include "quantities.h"
#include "text.h"

namespace subvol::cli {
namespace {

/// The sum of a cell's corners and one corner, which are the same wherever the cell is read.
using Key = std::array<double, 6>;

Key key_of(const HexMesh& mesh, const std::array<Index, 8>& cell) {
    Vec3 sum(0.0);
    for (const Index p : cell) sum += mesh.points[p];
    const Vec3& first = mesh.points[cell[0]];
    return {sum.x, sum.y, sum.z, first.x, first.y, first.z};
}

}  // namespace

WithFacts<BlockCells> cells_of_blocks(const std::string& input, const std::vector<MeshBlock>& blocks, const HexMesh& mesh,
                                      const CommonOptions& options) {
    WithFacts<BlockCells> result;
    BlockCells& found = result.value;
    if (blocks.size() < 2) return result;
    std::map<Key, Index> cells;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) cells.emplace(key_of(mesh, mesh.cells[c]), static_cast<Index>(c));
    const auto others = static_cast<Index>(blocks.size());
    found.groups.assign(mesh.cells.size(), others);
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        found.names.push_back(blocks[b].name);
        CommonOptions one = options;
        one.blocks = {blocks[b].name};
        const HexMesh part = read_input(input, one, nullptr).value.mesh;
        for (const auto& cell : part.cells) {
            const auto at = cells.find(key_of(part, cell));
            if (at != cells.end()) found.groups[at->second] = static_cast<Index>(b);
        }
    }
    const auto lost = static_cast<std::size_t>(std::count(found.groups.begin(), found.groups.end(), others));
    if (lost > 0) {
        found.names.emplace_back("(others)");
        result.facts.warn(text(counted(lost, "cell"), " could not be assigned to a block"));
    }
    return result;
}

}  // namespace subvol::cli
