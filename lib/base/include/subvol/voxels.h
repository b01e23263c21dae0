// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "subvol/vec.h"

namespace subvol {

using Voxel = std::array<std::int32_t, 3>;

/// The voxels from lower to lower + size − 1 along each axis.
struct VoxelBlock {
    enum class Kind { Nothing, Constant, Mixed };
    /// Nothing if all are inactive, Constant if all are active with one value, Mixed otherwise or if that is not known
    Kind kind = Kind::Mixed;
    Voxel lower{};
    std::int32_t size = 1;
    double value = 0;
};

/// The eight voxels lower + (0|1, 0|1, 0|1), x fastest.
struct VoxelCorners {
    std::array<double, 8> values{};
    unsigned active = 0;  ///< a bit for each of the voxels
};

/// Reads voxels and remembers its last place, so that neighbours are found fast. Each thread needs its own.
class VoxelCursor {
public:
    virtual ~VoxelCursor() = default;

    /// The largest known block around a voxel. A block of that voxel alone with kind Mixed is always a valid answer.
    [[nodiscard]] virtual VoxelBlock block(const Voxel& voxel) = 0;
    [[nodiscard]] virtual VoxelCorners corners(const Voxel& lower) = 0;
};

/// A sparse grid of values, as renderers use it. As a field it is trilinear between voxel centres. It has no value in inactive
/// voxels; elsewhere inactive neighbours are left out, and the weights of the active ones are normalised.
///
/// Voxel centres have integer indices; world = to_world · index + origin.
class Voxels {
public:
    virtual ~Voxels() = default;

    [[nodiscard]] virtual Mat3 to_world() const = 0;
    [[nodiscard]] virtual Vec3 origin() const = 0;
    /// All active voxels lie in lower … upper, both included; lower > upper if there are none.
    [[nodiscard]] virtual std::array<Voxel, 2> range() const = 0;
    [[nodiscard]] virtual std::unique_ptr<VoxelCursor> cursor() const = 0;
    /// Whether the values are distances from a surface, below 0 inside.
    [[nodiscard]] virtual bool is_level_set() const { return false; }
};

}  // namespace subvol
