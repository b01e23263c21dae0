// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "mesh_file.h"

namespace subvol::detail {

/// A block of points and of the hexahedra between them, both counted along i first, then along j, then along k.
///
/// points: how many there are along each
struct StructuredGrid {
    std::array<std::size_t, 3> points{};

    /// How many; kNone if they are more than an Index can count.
    [[nodiscard]] std::size_t point_count() const;
    [[nodiscard]] std::size_t cell_count() const;
};

/// "3 x 4 x 5 points"
[[nodiscard]] std::string size_text(const StructuredGrid& grid);

/// How many points a grid may have whose points its file does not list: few, or as many as the file can hold values for.
[[nodiscard]] std::size_t most_points(std::size_t values);

/// Appends the points of a grid whose planes are parallel to the axes. at: where they cut each axis
void add_points(MeshFile& into, const std::array<std::vector<double>, 3>& at, std::size_t position);

/// Appends the hexahedra. first_point, first_cell: the numbers of the block's first ones among all of the file
void add_hexes(MeshFile& into, const StructuredGrid& grid, std::size_t first_point, std::size_t first_cell);

}  // namespace subvol::detail
