// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "mesh_file.h"

namespace subvol::detail {

/// A block of points and the hexahedra between them, both counted along i first, then j, then k.
///
/// points: their number along i, j and k
struct StructuredGrid {
    std::array<std::size_t, 3> points{};

    /// The number of points and of cells; kNone if it is out of the range of Index.
    [[nodiscard]] std::size_t point_count() const;
    [[nodiscard]] std::size_t cell_count() const;
};

/// "3 x 4 x 5 points"
[[nodiscard]] std::string size_text(const StructuredGrid& grid);

/// A limit for the points of a grid that the file does not list one by one: a fixed number, plus one for each value that the
/// file can have.
[[nodiscard]] std::size_t most_points(std::size_t values);

/// Appends the points of a grid with planes perpendicular to the axes. at: the coordinates of the planes on each axis
void add_points(MeshFile& into, const std::array<std::vector<double>, 3>& at, std::size_t position);

/// Appends the hexahedra. first_point, first_cell: the numbers in the file of the first point and cell of the block
void add_hexes(MeshFile& into, const StructuredGrid& grid, std::size_t first_point, std::size_t first_cell);

}  // namespace subvol::detail
