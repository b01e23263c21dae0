// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/mesh_bodies.h"

#include <numeric>
#include <unordered_map>

namespace subvol::detail {

std::vector<Box> boxes_of_bodies(const HexMesh& mesh) {
    std::vector<Index> before(mesh.points.size());  // the first point of the body, or one on the way to it
    std::iota(before.begin(), before.end(), Index{0});
    const auto first_of = [&](Index p) {
        while (before[p] != p) p = before[p] = before[before[p]];
        return p;
    };
    for (const auto& cell : mesh.cells) {
        for (const Index corner : cell) {
            const Index a = first_of(cell[0]), b = first_of(corner);
            before[std::max(a, b)] = std::min(a, b);
        }
    }
    std::vector<Box> boxes;
    std::unordered_map<Index, std::size_t> numbers;
    for (const auto& cell : mesh.cells) {
        const auto [at, added] = numbers.try_emplace(first_of(cell[0]), boxes.size());
        if (added) boxes.emplace_back();
        for (const Index corner : cell) boxes[at->second].add(mesh.points[corner]);
    }
    return boxes;
}

}  // namespace subvol::detail
