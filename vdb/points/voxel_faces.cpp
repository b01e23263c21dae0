// SPDX-License-Identifier: Apache-2.0
#include "voxel_faces.h"

#include <array>
#include <unordered_map>
#include <utility>

#include "subvol/error.h"

namespace subvol::detail {

namespace {

using openvdb::Coord;

struct CoordHash {
    std::size_t operator()(const Coord& corner) const { return corner.hash<20>(); }
};

/// The corners of voxels that faces have, numbered in the order in which they are met: corner ijk is before voxel ijk.
class Corners {
public:
    Index index(const Coord& corner) {
        const auto [entry, isnew] = numbers_.try_emplace(corner, static_cast<Index>(all_.size()));
        if (isnew) {
            if (all_.size() >= kNone)
                throw Error(ErrorCode::InvalidInput, "the voxels have too many faces", {}, "a larger spacing");
            all_.push_back(corner);
        }
        return entry->second;
    }

    [[nodiscard]] const std::vector<Coord>& all() const { return all_; }

private:
    std::unordered_map<Coord, Index, CoordHash> numbers_;
    std::vector<Coord> all_;
};

Coord moved(Coord voxel, int axis, int by) {
    voxel[axis] += by;
    return voxel;
}

}  // namespace

BoundaryValues voxel_faces(const openvdb::FloatTree& tree, const Mat3& to_world, const Vec3& origin) {
    const openvdb::FloatGrid::ConstUnsafeAccessor voxels(tree);
    const bool mirrored = glm::determinant(to_world) < 0;
    BoundaryValues faces;
    Corners corners;
    for (auto voxel = tree.cbeginValueOn(); voxel; ++voxel) {
        for (int axis = 0; axis < 3; ++axis) {
            for (const int side : {0, 1}) {
                if (voxels.isValueOn(moved(voxel.getCoord(), axis, 2 * side - 1))) continue;
                const int u = (axis + 1) % 3, v = (axis + 2) % 3;
                const Coord first = moved(voxel.getCoord(), axis, side);
                std::array<Index, 4> quad{corners.index(first), corners.index(moved(first, u, 1)),
                                          corners.index(moved(moved(first, u, 1), v, 1)), corners.index(moved(first, v, 1))};
                if ((side == 0) != mirrored) std::swap(quad[1], quad[3]);
                faces.surface.triangles.push_back({quad[0], quad[1], quad[2]});
                faces.surface.triangles.push_back({quad[0], quad[2], quad[3]});
            }
        }
    }
    faces.values.emplace_back();
    for (const Coord& corner : corners.all()) {
        faces.surface.points.push_back(origin + to_world * (Vec3(corner[0], corner[1], corner[2]) - 0.5));
        double sum = 0;
        int count = 0;
        for (int k = 0; k < 8; ++k) {
            float value = 0;
            if (!voxels.probeValue(corner.offsetBy(-(k & 1), -(k >> 1 & 1), -(k >> 2)), value)) continue;
            sum += static_cast<double>(value);
            ++count;
        }
        faces.values.front().push_back(sum / count);
    }
    return faces;
}

}  // namespace subvol::detail
