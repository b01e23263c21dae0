// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "bind.h"
#include "subvol/vdb_grid.h"

namespace subvol::python {

/// A grid of an array (nx, ny, nz), or (nx, ny, nz, 3) of vectors.
///
/// transform: (4,4), in place of voxel_size and origin
[[nodiscard]] std::shared_ptr<VdbGrid> grid_of_array(const py::object& array, const py::object& voxel_size,
                                                     const py::object& origin, const std::string& name,
                                                     const py::object& transform, bool level_set,
                                                     std::optional<double> background);

/// The voxels in the box of the active ones, as an array that Python owns.
[[nodiscard]] py::array array_of_grid(const VdbGrid& grid);

/// Where that array lies, without its values.
[[nodiscard]] py::tuple shape_of_grid(const VdbGrid& grid);
[[nodiscard]] py::array transform_of_grid(const VdbGrid& grid);
[[nodiscard]] py::array origin_of_grid(const VdbGrid& grid);
/// throws: Error(InvalidInput) if voxels are no cubes along the axes
[[nodiscard]] double voxel_size_of_grid(const VdbGrid& grid);

}  // namespace subvol::python
