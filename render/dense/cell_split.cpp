// SPDX-License-Identifier: Apache-2.0
#include "cell_split.h"

#include <algorithm>

#include "subvol/topology.h"

namespace subvol::detail {

namespace {

std::size_t corner_of_face(std::size_t face, std::size_t k) {
    return static_cast<std::size_t>(kCellFaces[face][k % 4]);
}

unsigned mask_of_face(std::size_t face) {
    unsigned mask = 0;
    for (std::size_t k = 0; k < 4; ++k) mask |= 1u << corner_of_face(face, k);
    return mask;
}

unsigned mask_of_triangle(const CellSplit& split, std::size_t tet, std::size_t opposite) {
    unsigned mask = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        if (k != opposite) mask |= 1u << split.corners[tet][k];
    }
    return mask;
}

std::uint8_t lowest_bit(unsigned mask) {
    std::uint8_t bit = 0;
    while ((mask >> bit & 1u) == 0) ++bit;
    return bit;
}

void connect(CellSplit& split, std::size_t tet, std::size_t opposite) {
    const unsigned triangle = mask_of_triangle(split, tet, opposite);
    for (std::size_t other = 0; other < 6; ++other) {
        for (std::size_t k = 0; k < 4; ++k) {
            if (other == tet || mask_of_triangle(split, other, k) != triangle) continue;
            split.neighbors[tet][opposite] = static_cast<std::uint8_t>(other);
            return;
        }
    }
    for (std::size_t face = 0; face < 6; ++face) {
        if ((mask_of_face(face) & triangle) != triangle) continue;
        const std::uint8_t missing = lowest_bit(mask_of_face(face) & ~triangle);
        split.neighbors[tet][opposite] = static_cast<std::uint8_t>(8 + face);
        split.missing[tet][opposite] = missing;
        split.owners[face][missing] = static_cast<std::uint8_t>(4 * tet + opposite);
        return;
    }
}

CellSplit make_split(std::size_t apex, unsigned diagonals) {
    CellSplit split;
    for (auto& owners : split.owners) owners.fill(CellSplit::kNoOwner);
    std::size_t count = 0;
    for (std::size_t face = 0; face < 6; ++face) {
        if (mask_of_face(face) >> apex & 1u) continue;
        const std::size_t first = diagonals >> (count / 2) & 1u;
        const auto corner = [&](std::size_t k) { return static_cast<std::uint8_t>(corner_of_face(face, first + k)); };
        const auto top = static_cast<std::uint8_t>(apex);
        split.corners[count++] = {corner(0), corner(2), corner(1), top};
        split.corners[count++] = {corner(0), corner(3), corner(2), top};
    }
    for (std::size_t tet = 0; tet < 6; ++tet) {
        for (std::size_t k = 0; k < 4; ++k) connect(split, tet, k);
    }
    return split;
}

}  // namespace

const std::array<CellSplit, 64>& cell_splits() {
    static const auto kSplits = [] {
        std::array<CellSplit, 64> all;
        for (std::size_t s = 0; s < all.size(); ++s) all[s] = make_split(s % 8, static_cast<unsigned>(s / 8));
        return all;
    }();
    return kSplits;
}

std::uint8_t cell_split_of(const std::array<Index, 8>& cell) {
    const auto apex = static_cast<std::size_t>(std::min_element(cell.begin(), cell.end()) - cell.begin());
    unsigned diagonals = 0, count = 0;
    for (std::size_t face = 0; face < 6; ++face) {
        if (mask_of_face(face) >> apex & 1u) continue;
        const auto id = [&](std::size_t k) { return cell[corner_of_face(face, k)]; };
        if (std::min(id(1), id(3)) < std::min(id(0), id(2))) diagonals |= 1u << count;
        ++count;
    }
    return static_cast<std::uint8_t>(apex + std::size_t{8} * diagonals);
}

}  // namespace subvol::detail
