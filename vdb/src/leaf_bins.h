#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/progress.h"

namespace subvol {

/// Integer voxel coordinates, and a box of them with both ends in it.
using VoxelCoord = std::array<int, 3>;
struct VoxelBox {
    VoxelCoord lower, upper;
};

inline constexpr int kLeafSide = 8;  // voxels; OpenVDB's leaf

/// A cell among those whose bounding box holds a voxel centre of the leaf.
struct LeafCell {
    std::uint64_t leaf;
    Index cell;
    friend auto operator<=>(const LeafCell&, const LeafCell&) = default;
};

/// Cells sorted into the leaves of 8³ voxels that they may fill; voxel centres lie at voxel_size · ijk (world).
///
/// entries: by leaf, within it by cell
/// offsets: leaf i has entries[offsets[i] .. offsets[i+1])
struct LeafBins {
    double voxel_size = 0;
    VoxelCoord first_leaf{};  // in leaves
    std::array<std::uint64_t, 3> leaves_per_side{};
    std::vector<LeafCell> entries;
    std::vector<std::size_t> offsets{0};

    [[nodiscard]] std::size_t size() const { return offsets.size() - 1; }
    [[nodiscard]] std::span<const LeafCell> cells_of(std::size_t leaf) const {
        return std::span(entries).subspan(offsets[leaf], offsets[leaf + 1] - offsets[leaf]);
    }
    /// The lowest voxel of a leaf.
    [[nodiscard]] VoxelCoord origin_of(std::size_t leaf) const;
};

/// The voxels whose centres may lie in the box; a little generous. Empty (lower > upper) where there is none.
[[nodiscard]] VoxelBox voxels_in(const Box& box, double voxel_size);

/// The bounding box of a cell.
[[nodiscard]] Box cell_box(const HexMesh& mesh, Index cell);

/// Sorts the cells of a valid mesh into leaves, in parallel; the same for any number of threads.
///
/// throws: Error(InvalidInput) if the voxels are too small: 2³⁰ from the origin, or too many; says what would be right
/// cost:   16 bytes for each cell and leaf it may touch
[[nodiscard]] LeafBins bin_cells(const HexMesh& mesh, double voxel_size, Progress* progress);

}  // namespace subvol
