// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "subvol/topology.h"
#include "voxel_bricks.h"

namespace subvol::detail {

/// The six tetrahedra of a cell, by corner numbers of the cell: corner k of tetrahedron t is corners[k][t]. Two copies of the
/// last one fill vectors of eight.
struct CornerSplit {
    std::array<std::array<std::int64_t, 8>, 4> corners;
};

/// diagonals: bit f is set if face f of those away from the apex is cut from its corner 1 to 3, else it is cut from 0 to 2
[[nodiscard]] const CornerSplit& corner_split(std::size_t apex, std::size_t diagonals);

/// The three faces that do not touch a corner, in the order of `kCellFaces`.
[[nodiscard]] const std::array<std::array<std::size_t, 4>, 3>& faces_away_from(std::size_t corner);

/// The tetrahedra of `split_cell`. less: any order of the corners that is the same in all cells that share them
template <class Less>
const CornerSplit& corner_split(const Less& less) {
    std::size_t apex = 0;
    for (std::size_t k = 1; k < 8; ++k) {
        if (less(k, apex)) apex = k;
    }
    std::size_t diagonals = 0;
    const auto& faces = faces_away_from(apex);
    for (std::size_t f = 0; f < 3; ++f) {
        std::size_t least = 0;
        for (std::size_t k = 1; k < 4; ++k) {
            if (less(faces[f][k], faces[f][least])) least = k;
        }
        diagonals |= (least & 1) << f;
    }
    return corner_split(apex, diagonals);
}

// Cells into voxels. A control cell is a block of nodes (+); every small cell between 8 of its nodes fills the voxels whose
// centres (.) it contains:
//
//     +-----+-----+     1. Inside?  The small cell is split into six tetrahedra (`corner_split`). Neighbours split a shared
//     | .  .|  .  |                 face alike, so each centre belongs to exactly one cell. See fill_rows-inl.h.
//     |  .  | .  .|     2. Where?   Newton's method inverts the cell's map x(u, v, w) at the centre: fill_values-inl.h.
//     +-----+-----+     3. Value:   the cell's trilinear or triquadratic interpolant at (u, v, w).
//     |.  . |.  . |
//     +-----+-----+
//
// A curved cell is a block of pieces of 27 nodes. Its pieces contain the centres for which Newton's method finds parameters
// within [0,1]³, so that steps 1 and 2 are one: fill_curved-inl.h. Only pieces that are folded, flat or much bent are split.

/// A control cell as a grid of smaller ones: side³ nodes, u fastest, then v, then w.
struct CellBlock {
    Index cell = 0;
    std::size_t side = 2;
    std::size_t step = 1;  ///< nodes from one corner of a smaller cell to the next; 1 if curved
    /// Positions and values are triquadratic through 27 nodes, those of two smaller cells along each axis.
    bool curved = false;
    std::size_t channels = 1;   ///< numbers per node
    bool cell_numbers = false;  ///< leaves have one more channel, the number of the control cell
    double orientation = 1;     ///< 1, or -1 for a mesh of left-handed cells
    std::uint8_t boundary = 0;  ///< for a curved block, bit 2d + e: the side where parameter d is e lies on the mesh's boundary
    /// Voxels by which the other sides of a curved block may be exceeded: neighbours of other levels, or split into tetrahedra,
    /// have a slightly different shared side, and no centre between the two is to be missed.
    double slack = 0;
    const Vec3* points = nullptr;    ///< positions in voxels: centres have whole coordinates
    const double* values = nullptr;  ///< node-major, `channels` numbers per node
    /// The ids of the nodes of a block of 8: they decide how the cell is split into tetrahedra; null: the positions decide.
    const Index* ids = nullptr;
    const VoxelBox* piece_boxes = nullptr;  ///< for a curved block: what set_piece_boxes has set

    /// How many pieces of 27 nodes it has.
    [[nodiscard]] std::size_t pieces() const { return (side - 1) / 2 * ((side - 1) / 2) * ((side - 1) / 2); }
    [[nodiscard]] std::size_t leaf_channels() const { return channels + (cell_numbers ? 1 : 0); }
};

/// Centres are moved by this small step, in voxels, before they are tested; so a centre on a surface belongs to exactly one
/// side (half-open: a box of n³ voxels fills n³ of them, and two boxes that touch share none). The step is far above the
/// rounding and parallel to no plane that meshes are likely to contain; as a multiple of 2⁻³² it keeps differences of centres
/// whole numbers.
inline const Vec3 kCentreStep = Vec3(4295, 3565, 3049) / 4294967296.0;  // about 1e-6 voxels

/// The nodes of a curved cell: three along each axis, u fastest, then v, then w.
constexpr std::size_t kCurvedNodes = 27;
constexpr std::size_t kPaddedNodes = 32;  // whole vectors

/// One of a block's small cells. Positions are relative to `origin`, its first corner; corners are in VTK order.
struct CellShape {
    Vec3 origin;
    std::array<std::array<double, 8>, 3> corners;
    std::vector<double> values;                                         ///< channels × 8 numbers
    bool curved = false;                                                ///< the cell is a part of a larger one with these nodes
    alignas(64) std::array<std::array<double, kPaddedNodes>, 3> nodes;  ///< the nodes of the larger cell, the last one repeated
    double part = 1;                     ///< length of the cell along each axis, in the parameters of the larger one
    std::array<double, 3> first_part{};  ///< where the cell begins, in the parameters of the larger one
    std::vector<double> node_values;     ///< channels × 27 numbers
    double size = 0;                     ///< the longest side of its bounding box
    const CornerSplit* split = nullptr;
};

/// Sets the voxels whose centres may lie in each piece of a curved block, u fastest, then v, then w.
void set_piece_boxes(const CellBlock& block, VoxelBox* boxes);

/// The voxels whose centres may lie in a block, slightly enlarged for rounding. Empty where there is none.
[[nodiscard]] VoxelBox voxels_of(const CellBlock& block);

/// Activates the voxels of a brick whose centres lie in the block and sets their values; voxels that are already active are
/// left unchanged.
///
/// The six tetrahedra of each small cell decide what is inside, or the parameters in a curved piece, so neighbours agree.
/// Values are trilinear or triquadratic at the inverse of the cell's map; where the map has no clear inverse they are linear in
/// the tetrahedron. Left-handed, folded and flat cells are allowed; tetrahedra without volume contain nothing. A tetrahedron
/// that is oriented against `orientation` may contain centres that lie outside the mesh: the voxels of its cell are added to
/// the brick's `doubtful` boxes.
///
/// shape: scratch memory, reused from one call to the next
void fill_block(const CellBlock& block, CellShape& shape, VoxelBrick& brick);

// The rest is for fill_block.cpp and its vector code only.

/// Centres found in a cell: their positions relative to its first corner, and where their first values are stored.
struct FoundVoxels {
    static constexpr std::size_t kMost = 64;
    alignas(64) std::array<std::array<double, kMost>, 3> places;
    std::array<float*, kMost> values;
    std::size_t count = 0;
};

/// The parameters that a piece contains, along each axis; at a side that is not on the boundary some more than [0,1].
struct PieceBounds {
    std::array<double, 3> lower{}, upper{1, 1, 1};
};

/// The weights of the corners at x, linear in the tetrahedron whose least barycentric coordinate there is largest: the one that
/// contains x, if any does.
[[nodiscard]] std::array<double, 8> linear_weights(const CellShape& shape, const Vec3& x);

}  // namespace subvol::detail
