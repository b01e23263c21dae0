// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "corner_split.h"
#include "voxel_bricks.h"

namespace subvol::detail {

/// A cell of the control mesh as a grid of smaller ones: side³ nodes, u fastest, then v, then w.
///
/// step:   nodes from one corner of a smaller cell to the next: 1 or even
/// curved: what is inside is triquadratic through 27 nodes: those half way between the corners, or of two cells along each axis
///         if the step is 1
/// points: in voxels: their centres have whole numbers
/// values: node-major, so many a node as there are channels
/// ids:    of the nodes of a grid of 8, by which the cell is split into tetrahedra; null: by the places of the nodes
struct CellBlock {
    Index cell = 0;
    std::size_t side = 2;
    std::size_t step = 1;
    bool curved = false;
    const Vec3* points = nullptr;
    const double* values = nullptr;
    const Index* ids = nullptr;
};

/// channels:     of the blocks
/// cell_numbers: one more channel of the leaves, whole numbers: the control cell
/// orientation:  1, or -1 of a mesh of left-handed cells
struct FillOptions {
    std::size_t channels = 1;
    bool cell_numbers = false;
    double orientation = 1;

    [[nodiscard]] std::size_t leaf_channels() const { return channels + (cell_numbers ? 1 : 0); }
};

/// Centres on a surface go to the side of a small step along all axes, in voxels (half-open: a box of n³ voxels fills n³ of
/// them, and two boxes that touch share none). The step is far above the rounding and in no plane that meshes like to have; as
/// a multiple of 2⁻³² it keeps the distance of two centres a whole number.
inline const Vec3 kCentreStep = Vec3(4295, 3565, 3049) / 4294967296.0;  // about 1e-6 voxels

/// The nodes of a curved cell: three along each axis, u fastest, then v, then w.
constexpr std::size_t kCurvedNodes = 27;

/// One of a block's cells, corners in VTK order, relative to the first.
///
/// values: channels × 8; size: the longest side of its bounding box
/// curved: with these nodes, relative to the first corner, and their channels × 27 values; in the parameters of these nodes it
/// is
///         as long as `part`, from `first_part` on
struct CellShape {
    Vec3 origin;
    std::array<std::array<double, 8>, 3> corners;
    std::vector<double> values;
    bool curved = false;
    std::array<std::array<double, kCurvedNodes>, 3> nodes;
    double part = 1;
    std::array<double, 3> first_part{};
    std::vector<double> node_values;
    double size = 0;
    const CornerSplit* split = nullptr;
    Index cell = 0;
};

/// The voxels whose centres may lie in a block; a little generous. Empty where there is none.
[[nodiscard]] VoxelBox voxels_of(const CellBlock& block);

/// Activates the voxels of a brick whose centres lie in the block and gives them its values; those that are active stay as they
/// are.
///
/// A cell's six tetrahedra decide what is inside, so neighbours agree; the values are trilinear or triquadratic, at the inverse
/// of the cell's map, or linear in the tetrahedron where the map has no clear inverse. Left-handed, folded and flat cells are
/// allowed; tetrahedra without volume hold nothing. Where a tetrahedron is oriented against `orientation`, what it holds may
/// lie outside the mesh: its voxels become `doubtful`. shape: memory, from one call to the next
void fill_block(const CellBlock& block, const FillOptions& options, CellShape& shape, VoxelBrick& brick);

// What is below is for fill_block.cpp and its vector code.

/// Centres in a cell: their places relative to its first corner and where their first values go.
struct FoundVoxels {
    static constexpr std::size_t kMost = 64;
    alignas(64) std::array<std::array<double, kMost>, 3> places;
    std::array<float*, kMost> values;
    std::size_t count = 0;
};

/// The weights of the corners at x: linear in the first tetrahedron that holds it, or else in that which does so best.
[[nodiscard]] std::array<double, 8> linear_weights(const CellShape& shape, const Vec3& x);

}  // namespace subvol::detail
