// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "subvol/detail/flat_array.h"
#include "subvol/hex_mesh.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// One of the 48 ways in which the axes of one cell can lie along those of another: a signed permutation of u, v, w.
struct CellTurn {
    std::array<std::uint8_t, 8> octants;  ///< octant u + 2v + 4w of the one → octant of the other
    std::array<std::uint8_t, 6> sides;    ///< side 2·axis + (0 low, 1 high) likewise
};

inline constexpr std::uint8_t kIdentityTurn = 0;

/// All turns; the identity is the first.
[[nodiscard]] const std::array<CellTurn, 48>& cell_turns();

/// The turn that does `first` and then `second`.
[[nodiscard]] std::uint8_t composed(std::uint8_t first, std::uint8_t second);

/// What lies across the sides of the cells of a mesh, so that one can walk from cell to cell with the axes in hand.
///
/// Sides are numbered as kCellFaces: u=0, u=1, v=0, v=1, w=0, w=1.
struct CellLinks {
    static constexpr std::uint8_t kSharp = 0x80;  // a flag of `turns`: the face is tagged as sharp

    /// The cell across each side, kNone on the hull.
    FlatArray<std::array<Index, 6>> neighbors;
    /// From the axes of a cell to those of its neighbour, as if that were moved on to the cell.
    FlatArray<std::array<std::uint8_t, 6>> turns;
    /// Whether all edges of a cell are inside with four cells each, and no face or edge of it is tagged.
    std::vector<std::uint8_t> regular;
    /// A number for each point that depends on how the cells up to two layers around it meet, and on nothing else: by these the
    /// corners of a cell are put into the same order wherever its neighbourhood is the same.
    std::vector<std::uint64_t> colors;
    /// How many cells each point has.
    std::vector<std::uint32_t> cells_at;
    /// Tagged edges of each cell, bit k for edge k of kCellEdges; empty if the mesh has no creases.
    std::vector<std::uint16_t> creases;

    [[nodiscard]] std::uint8_t turn(Index cell, std::size_t side) const {
        return static_cast<std::uint8_t>(turns[cell][side] & ~kSharp);
    }
    [[nodiscard]] bool is_sharp(Index cell, std::size_t side) const { return (turns[cell][side] & kSharp) != 0; }
};

inline constexpr int kColorRounds = 3;

/// throws: Error(InvalidInput) if more than two cells share a face, or two cells have the same corners
/// cost:   parallel; 28 bytes a cell beside the result
[[nodiscard]] CellLinks build_links(const HexMesh& mesh);

/// The same from the faces of a topology that is there already.
///
/// color_rounds: so many layers of cells around a point decide its colour
[[nodiscard]] CellLinks build_links(const HexMesh& mesh, const Topology& faces, int color_rounds = kColorRounds);

}  // namespace subvol::detail
