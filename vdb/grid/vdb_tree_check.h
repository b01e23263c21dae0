// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "vdb_bytes.h"

namespace subvol::detail {

enum class LeafLayout { Values, Booleans, Mask, Points };

/// How the trees of one type of grid are stored.
struct TreeLayout {
    std::size_t value_bytes = 0;
    std::size_t half_bytes = 0;  // of a value if floats are stored in 16 bits
    LeafLayout leaves = LeafLayout::Values;
};

/// type: as OpenVDB names it; nothing for types whose layout is not known here
[[nodiscard]] std::optional<TreeLayout> tree_layout(const std::string& type);

/// Where a block's size comes from, and how its values are packed.
struct BlockCoding {
    bool blosc = false, zip = false;
    bool masked = false;  // values of inactive voxels are left out
};

/// Goes over a compressed block for blosc, which has a size of its own that must not exceed the buffer's.
///
/// size: of the block in the file; raw: what it unpacks into
void check_blosc(VdbBytes& file, std::uint64_t size, std::uint64_t raw);

/// Goes over a grid's tree, from the count of buffers to its last value.
///
/// in_half: floats are stored in 16 bits
void check_tree(VdbBytes& file, const TreeLayout& layout, const BlockCoding& coding, bool in_half);

/// Goes over metadata: of a file, of a grid, of attributes of points.
void check_metadata(VdbBytes& file);

/// Goes over the values of a point grid's leaves, which are stored in passes over all leaves.
void check_point_leaves(VdbBytes& file, std::size_t leaves);

}  // namespace subvol::detail
