// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "subvol/vec.h"

namespace subvol {

using Voxel = std::array<std::int32_t, 3>;

/// Voxels lower … lower + size − 1 that are all inactive, all active with one value, or neither of the two.
struct VoxelBlock {
    enum class Kind { Nothing, Constant, Mixed };
    Kind kind = Kind::Mixed;
    Voxel lower{};
    std::int32_t size = 1;
    double value = 0;
};

/// The eight voxels lower + (0|1, 0|1, 0|1), x fastest. active: a bit for each of them
struct VoxelCorners {
    std::array<double, 8> values{};
    unsigned active = 0;
};

/// Reads voxels, and remembers where it was last: one for each thread.
class VoxelCursor {
public:
    virtual ~VoxelCursor() = default;

    /// The largest block known to hold a voxel; Mixed is right for any.
    [[nodiscard]] virtual VoxelBlock block(const Voxel& voxel) = 0;
    [[nodiscard]] virtual VoxelCorners corners(const Voxel& lower) = 0;
};

/// A sparse grid of values as renderers see it. As a field it is trilinear between the voxels' centres and nothing where the
/// voxel that holds the place is inactive; inactive neighbours do not count, the weights of the active ones are normalised.
///
/// Centres have whole numbers; world = to_world · index + origin.
class Voxels {
public:
    virtual ~Voxels() = default;

    [[nodiscard]] virtual Mat3 to_world() const = 0;
    [[nodiscard]] virtual Vec3 origin() const = 0;
    /// All active voxels lie in lower … upper, both included; lower > upper if there are none.
    [[nodiscard]] virtual std::array<Voxel, 2> range() const = 0;
    [[nodiscard]] virtual std::unique_ptr<VoxelCursor> cursor() const = 0;
};

}  // namespace subvol
