// SPDX-License-Identifier: Apache-2.0
// Inside and outside of a closed surface, one column of centres at a time.
//
//   z ^      .   0        A column is the line of centres (i, j, ·). Each triangle that it meets gives one crossing: a
//     |  ----x---- -1     height, and a step of +1 where the column enters the surface upwards, or -1 where it leaves. The
//     |      .   1        winding number of a centre is the sum of the steps below it; 0 is outside. A region that the
//     |      .   1        surface encloses twice has 2, and inside-out parts have negative numbers.
//     |  ----x---- +1
//     |      .   0        A crossing counts exactly once, also where the column passes through an edge or a corner.
//
// The side on which the column passes an edge is the sign of an area. The two triangles of an edge compute this area from the
// same operands in the same order and get the same bits, up to the sign; an area of exactly 0 is decided by the direction of
// the edge, as if the column were moved by an infinitesimal step.
#include "surface_columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "fill_block.h"

namespace subvol::detail {

namespace {

/// Twice the signed area, seen from above, of the triangle between an edge and the column at (x, y). The two triangles that
/// share an edge get the same number with opposite signs.
double side_of(const Vec3& a, const Vec3& b, double x, double y) {
    const bool turned = std::tie(b.x, b.y, b.z) < std::tie(a.x, a.y, a.z);
    const Vec3 &from = turned ? b : a, &to = turned ? a : b;
    const double area = (from.x - x) * (to.y - y) - (to.x - x) * (from.y - y);
    return turned ? -area : area;
}

/// Whether the column lies left of an edge; exactly on the edge, its direction decides.
bool left_of(const Vec3& a, const Vec3& b, double side) {
    return side > 0 || (side == 0 && std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z));
}

}  // namespace

SurfaceColumns::SurfaceColumns(std::span<const VoxelTriangle> triangles) {
    for (const VoxelTriangle& triangle : triangles) add(triangle);
    std::ranges::sort(crossings_);
}

void SurfaceColumns::add(const VoxelTriangle& triangle) {
    const auto& [a, b, c] = triangle;
    const auto range = [](double p, double q, double r, double shift) {
        const auto [low, high] = std::minmax({p, q, r});
        return std::pair(static_cast<int>(std::ceil(low - shift)), static_cast<int>(std::floor(high - shift)));
    };
    const auto [x0, x1] = range(a.x, b.x, c.x, kCentreStep.x);
    const auto [y0, y1] = range(a.y, b.y, c.y, kCentreStep.y);
    for (int i = x0; i <= x1; ++i) {
        for (int j = y0; j <= y1; ++j) {
            const double x = i + kCentreStep.x, y = j + kCentreStep.y;
            const double of_c = side_of(a, b, x, y), of_a = side_of(b, c, x, y), of_b = side_of(c, a, x, y);
            const bool left = left_of(a, b, of_c);
            if (left_of(b, c, of_a) != left || left_of(c, a, of_b) != left) continue;
            const double sum = of_a + of_b + of_c;
            const double z = sum == 0 ? a.z : (of_a * a.z + of_b * b.z + of_c * c.z) / sum;
            crossings_.push_back({i, j, z, left ? -1 : 1});
        }
    }
}

int SurfaceColumns::winding(const VoxelCoord& voxel) const {
    const auto [x, y, z] = voxel;
    int sum = 0;
    for (auto at =
             std::ranges::lower_bound(crossings_, std::pair(x, y), {}, [](const Crossing& c) { return std::pair(c.x, c.y); });
         at != crossings_.end() && at->x == x && at->y == y && at->z < z + kCentreStep.z; ++at) {
        sum += at->step;
    }
    return sum;
}

void SurfaceColumns::for_each_run(const std::function<void(const VoxelCoord&, int)>& visit) const {
    int sum = 0;
    for (std::size_t i = 0; i + 1 < crossings_.size(); ++i) {
        const Crossing &here = crossings_[i], &next = crossings_[i + 1];
        if (i == 0 || here.x != crossings_[i - 1].x || here.y != crossings_[i - 1].y) sum = 0;
        sum += here.step;
        if (sum == 0 || next.x != here.x || next.y != here.y) continue;
        const auto above = [](double z) { return static_cast<int>(std::floor(z - kCentreStep.z)) + 1; };
        const int first = above(here.z), last = above(next.z) - 1;
        if (first <= last) visit({here.x, here.y, first}, last);
    }
}

}  // namespace subvol::detail
