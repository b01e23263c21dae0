// SPDX-License-Identifier: Apache-2.0
#include "level_set_body.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "openvdb_grids.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "subvol/grid_surface.h"
#include "vdb_data.h"

namespace subvol::detail {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;

/// A closed surface is turned so that its triangles are counter-clockwise from outside: its volume is above 0 then.
void turn_outward(Surface& surface) {
    const Vec3 middle = surface.points.front();  // far from the origin, products would cancel
    double volume = 0;
    for (const auto& t : surface.triangles) {
        const Vec3 a = surface.points[t[0]] - middle, b = surface.points[t[1]] - middle, c = surface.points[t[2]] - middle;
        volume += glm::dot(a, glm::cross(b, c));
    }
    if (volume >= 0) return;
    for (auto& t : surface.triangles) std::swap(t[1], t[2]);
}

/// Blocks of n³ voxels that fill a box of voxels.
class Blocks {
public:
    Blocks(const CoordBBox& box, int n) : first_(box.min()), n_(n) {
        for (int k = 0; k < 3; ++k) count_[k] = (box.dim()[k] - 1) / n + 1;
        inside_.resize(static_cast<std::size_t>(count_[0]) * static_cast<std::size_t>(count_[1]) *
                       static_cast<std::size_t>(count_[2]));
    }

    /// Calls with the block's number, and its middle in voxels.
    template <class Call>
    void for_each(const Call& call) const {
        const double half = 0.5 * (n_ - 1);
        std::size_t number = 0;
        for (int z = 0; z < count_[2]; ++z) {
            for (int y = 0; y < count_[1]; ++y) {
                for (int x = 0; x < count_[0]; ++x, ++number) {
                    const Coord lower = first_ + Coord(n_ * x, n_ * y, n_ * z);
                    call(number, Vec3(lower[0] + half, lower[1] + half, lower[2] + half));
                }
            }
        }
    }

    [[nodiscard]] bool is_inside(std::size_t number) const { return inside_[number] != 0; }
    void mark(std::size_t number) { inside_[number] = 1; }

    /// Marks the blocks of some voxels.
    void mark(const CoordBBox& voxels) {
        Coord lower, upper;
        for (int k = 0; k < 3; ++k) {
            lower[k] = std::max((voxels.min()[k] - first_[k]) / n_, 0);
            upper[k] = std::min((voxels.max()[k] - first_[k]) / n_, count_[k] - 1);
        }
        for (int z = lower[2]; z <= upper[2]; ++z) {
            for (int y = lower[1]; y <= upper[1]; ++y) {
                for (int x = lower[0]; x <= upper[0]; ++x) {
                    mark(static_cast<std::size_t>(x) +
                         static_cast<std::size_t>(count_[0]) *
                             (static_cast<std::size_t>(y) + static_cast<std::size_t>(count_[1]) * static_cast<std::size_t>(z)));
                }
            }
        }
    }

private:
    Coord first_;
    int n_;
    std::array<int, 3> count_{};
    std::vector<char> inside_;
};

}  // namespace

LevelSetBody body_of_level_set(const VdbGrid& grid, int voxels_a_side, const Kernel& kernel) {
    const openvdb::FloatGrid& floats = *VdbData::of(grid).floats;
    LevelSetBody body;
    RbfVolume& volume = body.volume;
    volume.boundary = grid_surface(grid);
    turn_outward(volume.boundary);

    openvdb::BBoxd extent;
    for (const Vec3& x : volume.boundary.points) extent.expand(floats.worldToIndex({x.x, x.y, x.z}));
    constexpr double kMostVoxels = 1 << 30;
    if (!(extent.extents()[extent.maxExtent()] < kMostVoxels)) {
        throw Error(ErrorCode::InvalidInput, "its surface is too many voxels long", "grid " + in_quotes(grid.report().name),
                    "at most 2³⁰");
    }
    const CoordBBox box(Coord::round(extent.min()), Coord::round(extent.max()));
    constexpr int kUsual = 64, kMost = 256;  // blocks along the longest side
    const int longest = box.dim()[static_cast<int>(box.maxExtent())];
    const int least = (longest - 1) / (voxels_a_side == 0 ? kUsual : kMost) + 1;
    const int n = body.voxels_a_side = std::max(voxels_a_side, least);

    // Deep inside, the middle of a block decides. Near the surface there are active voxels; between a voxel inside and one
    // outside the surface may reach into the next block.
    Blocks blocks(box, n);
    const openvdb::FloatGrid::ConstUnsafeAccessor values(floats.constTree());
    blocks.for_each([&](std::size_t number, const Vec3& middle) {
        if (values.getValue(Coord::round(openvdb::Vec3d(middle.x, middle.y, middle.z))) < 0) blocks.mark(number);
    });
    for (auto voxel = floats.cbeginValueOn(); voxel; ++voxel) {
        if (!(*voxel < 0)) continue;
        CoordBBox reached;
        voxel.getBoundingBox(reached);
        reached.expand(1);
        if (reached.hasOverlap(box)) blocks.mark(reached);
    }

    const auto voxels = grid.voxels();
    const Mat3 to_world = voxels->to_world();
    const double radius = support_radius(kernel) * n;
    const Symmetric3 frame = symmetric3(radius * radius * to_world * glm::transpose(to_world));
    blocks.for_each([&](std::size_t number, const Vec3& middle) {
        if (!blocks.is_inside(number)) return;
        volume.centers.push_back(to_world * middle + voxels->origin());
        volume.frames.push_back(frame);
    });
    const std::size_t count = volume.centers.size();
    volume.kernel = kernel;
    volume.channels.push_back({.name = "density",
                               .values = std::vector<float>(count, 1),
                               .gradients = std::vector<std::array<float, 3>>(count),
                               .moments = std::vector<float>(count)});
    volume.bounds = box_of(volume);
    validate(volume);
    return body;
}

}  // namespace subvol::detail
