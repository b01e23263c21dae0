// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/vdb_grid.h"

namespace subvol {

/// Puts the grids of several shares together, as `rasterize_share` makes them: grids of floats, vectors, integers or masks
/// whose active voxels do not overlap. The result has the leaves, tiles and metadata of a grid that was made in one piece; the
/// metadata are those of the first share. A level set gets its signs again.
///
/// parts:  at least one; their leaves are moved, not copied
/// throws: Error(InvalidInput) if a grid is of another kind, name, voxels or metadata of transform than the first, or if two
///         have a leaf in the same place
/// cost:   one visit of every leaf
[[nodiscard]] VdbGrid join_grids(std::vector<VdbGrid> parts);

/// A text in a grid's metadata; nothing if there is none of that name.
[[nodiscard]] std::optional<std::string> text_of_grid(const VdbGrid& grid, const std::string& name);

/// Sets a text in a grid's metadata, or removes it.
void set_text_of_grid(VdbGrid& grid, const std::string& name, const std::optional<std::string>& text);

/// Whether files have the floats of the grid in 16 bits.
void store_in_half(VdbGrid& grid, bool half);

/// A hash over the kind, name, transform, leaves and tiles of a grid in the order of their places: two grids with one hash have
/// the same bits in the same voxels. The identity that OpenVDB draws at random for each file is left out.
[[nodiscard]] std::uint64_t hash_of_grid(const VdbGrid& grid);

namespace detail {

/// Grids as the bytes of a .vdb file, uncompressed, to be sent to another process of this program.
[[nodiscard]] std::string bytes_of_grids(std::span<const VdbGrid> grids);

/// throws: Error(InvalidInput) if they are not what `bytes_of_grids` returned
[[nodiscard]] std::vector<VdbGrid> grids_from_bytes(const std::string& bytes);

}  // namespace detail

}  // namespace subvol
