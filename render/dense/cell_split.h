// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// One of the 64 ways to split a hexahedron into 6 tetrahedra about a corner, given by the corner and by the diagonals of the
/// three faces that do not touch it. The same splits as those of `split_cell`, with tables of the neighbours.
///
/// corners:   of each tetrahedron, as corners of the cell
/// neighbors: what lies across the face opposite to a corner: a tetrahedron of the cell, or 8 + a face of the cell
/// missing:   if that is a face of the cell: the face's corner that the triangle leaves out
/// owners:    for a face and the corner that a triangle on it leaves out: 4 · tetrahedron + opposite corner of that triangle;
///            kNoOwner where the split has no such triangle
struct CellSplit {
    static constexpr std::uint8_t kNoOwner = 255;
    std::array<std::array<std::uint8_t, 4>, 6> corners{};
    std::array<std::array<std::uint8_t, 4>, 6> neighbors{};
    std::array<std::array<std::uint8_t, 4>, 6> missing{};
    std::array<std::array<std::uint8_t, 8>, 6> owners{};
};

[[nodiscard]] const std::array<CellSplit, 64>& cell_splits();

/// The number of the split that `split_cell` chooses for these point ids.
[[nodiscard]] std::uint8_t cell_split_of(const std::array<Index, 8>& cell);

/// The axis that a face of a cell is perpendicular to, and the end of the axis at which it lies. kCellFaces lists the faces in
/// pairs, one pair for each axis.
struct CellSide {
    int axis = 0, end = 0;
};
[[nodiscard]] constexpr CellSide cell_side(std::size_t face) {
    return {static_cast<int>(face / 2), static_cast<int>(face % 2)};
}
[[nodiscard]] constexpr std::size_t opposite_face(std::size_t face) {
    return face ^ 1;
}

/// Lattice coordinates of a cell's corners.
inline constexpr std::array<std::array<int, 3>, 8> kCellCorners{
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

/// The corner at the other end of an axis.
[[nodiscard]] constexpr std::size_t corner_across(std::size_t corner, int axis) {
    constexpr std::array<std::array<std::uint8_t, 8>, 3> kAcross{
        {{1, 0, 3, 2, 5, 4, 7, 6}, {3, 2, 1, 0, 7, 6, 5, 4}, {4, 5, 6, 7, 0, 1, 2, 3}}};
    return kAcross[static_cast<std::size_t>(axis)][corner];
}

}  // namespace subvol::detail
