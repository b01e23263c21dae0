// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/space_order.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cstdint>
#include <utility>

#include "subvol/detail/parallel_each.h"

namespace subvol::detail {
namespace {

constexpr double kSteps = 1023;  // 10 bits per axis

std::uint32_t spread(std::uint32_t x) {
    x = (x | x << 16) & 0x030000ffU;
    x = (x | x << 8) & 0x0300f00fU;
    x = (x | x << 4) & 0x030c30c3U;
    return (x | x << 2) & 0x09249249U;
}

}  // namespace

std::vector<Index> space_order(std::span<const Vec3> points) {
    Box box;
    for (const Vec3& p : points) box.add(p);
    const Vec3 size = box.size();
    const double longest = std::max({size.x, size.y, size.z});
    const double scale = longest > 0 ? kSteps / longest : 0;
    std::vector<std::pair<std::uint32_t, Index>> keys(points.size());
    parallel_each(points.size(), [&](std::size_t i) {
        const Vec3 p = scale * (points[i] - box.lower);
        // Points need not be finite: the order is then only less local.
        const auto key = [](double x) { return spread(x > 0 ? static_cast<std::uint32_t>(std::min(x, kSteps)) : 0); };
        keys[i] = {key(p.x) | key(p.y) << 1 | key(p.z) << 2, static_cast<Index>(i)};
    });
    tbb::parallel_sort(keys.begin(), keys.end());
    std::vector<Index> order(points.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = keys[i].second;
    return order;
}

std::vector<Index> in_space_order(const HexMesh& mesh, std::span<const Index> cells) {
    std::vector<Vec3> middles(cells.size());
    parallel_each(cells.size(), [&](std::size_t i) {
        const auto& corners = mesh.cells[cells[i]];
        middles[i] = 0.5 * (mesh.points[corners[0]] + mesh.points[corners[6]]);
    });
    std::vector<Index> ordered = space_order(middles);
    for (Index& i : ordered) i = cells[i];
    return ordered;
}

}  // namespace subvol::detail
