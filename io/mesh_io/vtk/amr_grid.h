// SPDX-License-Identifier: Apache-2.0
// Adaptive mesh refinement in blocks: boxes of cells on a few lattices, of which each is finer than the one before, and the
// mesh of their finest cells.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_file.h"

namespace subvol::detail {

/// Cells of a lattice, from the first to the last one along each axis.
struct AmrBox {
    std::array<std::int64_t, 3> low{}, high{};

    /// Makes it contain another box.
    void add(const AmrBox& other);
    [[nodiscard]] bool meets(const AmrBox& other) const;
    /// The cells that are in both boxes, which meet.
    [[nodiscard]] AmrBox common(const AmrBox& other) const;
    /// The points of its cells; kNone of them, or more, if they are too many.
    [[nodiscard]] StructuredGrid grid() const;
};

struct AmrBlock {
    AmrBox box;
    std::string place;       ///< where the file has it, for messages
    bool has_values = true;  ///< false: it may be there if finer blocks cover all of it
};

/// The blocks of equal cells. They have no cell twice.
struct AmrLevel {
    std::array<double, 3> spacing{};
    std::vector<AmrBlock> blocks;
    /// With the values of all cells, or of all points, of one block after the other, along x first
    std::vector<FileArray> arrays;
};

/// The cell of number 0 of each level begins at the origin.
struct AmrGrid {
    std::array<double, 3> origin{};
    std::vector<AmrLevel> levels;  ///< the coarsest first
};

/// Checks spacings and boxes, before their values are read: each level divides the cells of the one before by whole numbers,
/// its boxes do not overlap, consist of whole cells of the level before, and lie within the boxes there.
///
/// throws: Error(InvalidInput)
/// cost:   O(n log n) for n boxes
void check_amr(const AmrGrid& grid, std::string_view file);

/// Makes a mesh of the cells that no finer block covers, level by level in the order of the blocks. Cells that the array of
/// ghosts leaves out are left out, too. Points are joined by their numbers on the finest lattice: at a joined point the values
/// of the finest level stay, and there those of the first block; it is in a set of nodes if any block says so. Arrays that a
/// level with cells lacks are left out.
///
/// grid:    checked
/// throws:  Error(InvalidInput) if there are more points than values, or a block without values is not covered
[[nodiscard]] MeshFile mesh_of_amr(const AmrGrid& grid, std::string_view file);

}  // namespace subvol::detail
