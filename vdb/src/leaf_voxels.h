#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "leaf_bins.h"

namespace subvol {

inline constexpr std::size_t kLeafVoxels = 512;

/// The voxels of one leaf, numbered x·64 + y·8 + z within it.
///
/// active: bit z + 8 y of word x
/// values: one array a field; 0 where inactive
struct LeafVoxels {
    std::array<std::uint64_t, 8> active{};
    std::vector<std::array<float, kLeafVoxels>> values;

    [[nodiscard]] bool empty() const;
};

/// Fills the voxels of a leaf whose centres lie inside the mesh; the cell with the smallest id counts.
///
/// fields: one-channel attributes
[[nodiscard]] LeafVoxels fill_leaf(const HexMesh& mesh, std::span<const Attribute* const> fields, const LeafBins& bins,
                                   std::size_t leaf);

}  // namespace subvol
