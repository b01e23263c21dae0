// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "subvol/field_range.h"
#include "subvol/vdb_grid.h"

namespace subvol {

struct VdbContents {
    struct Other {
        std::string name, type;
    };
    std::vector<VdbGrid> grids;  ///< grids of floats, vectors of floats, integers of 32 and 64 bits, and masks
    std::vector<Other> others;   ///< grids of other types, which are not read
};

/// Reads all grids of a `.vdb` file, in the file's order.
///
/// throws: Error(Io), Error(InvalidInput) if it is not a VDB file
[[nodiscard]] VdbContents read_vdb_contents(const std::filesystem::path& path);

/// A grid of floats with the same active voxels: the lengths of vectors or one of their components, integers as floats, 1 where
/// a mask is. A grid of floats is shared, not copied.
///
/// component: 0..2 of vectors; none: their length
/// name:      of the result
/// throws:    Error(InvalidInput) if the grid has no such component
[[nodiscard]] VdbGrid scalar_of(const VdbGrid& grid, std::optional<int> component, const std::string& name);

/// Moves the active values of a grid of floats or vectors that are beyond the range to its nearer end, component by component.
/// Other grids stay as they are.
///
/// throws: Error(InvalidInput) if the range has another number of components
void clamp_voxels(VdbGrid& grid, const FieldRange& range);

/// Makes the active voxels of a grid of floats or vectors whose value is within `tolerance` of the background, which they get,
/// inactive; of vectors the length of the difference counts. Level sets and other grids stay as they are.
///
/// tolerance: in the unit of the values, ≥ 0
void prune_voxels(VdbGrid& grid, double tolerance);

}  // namespace subvol
