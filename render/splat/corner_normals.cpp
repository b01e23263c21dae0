// SPDX-License-Identifier: Apache-2.0
#include "corner_normals.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "subvol/detail/counted_rows.h"

namespace subvol::detail {

namespace {

// The boundary is that of level 1: neighbouring triangles of a round body meet at some ten degrees there, those at the edges of
// a machined part at 45 or more.
constexpr double kSmoothCosine = 0.766;  // of 40 degrees

/// The corners around each point: corner 3i + k is corner k of triangle i.
Rows<std::uint32_t> fans_of(const Surface& surface) {
    return counted_rows<std::uint32_t>(surface.points.size(), [&](const auto& put) {
        for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
            for (std::size_t k = 0; k < 3; ++k) put(surface.triangles[i][k], static_cast<std::uint32_t>(3 * i + k));
        }
    });
}

/// A vector of unit length, or (0, 0, 0).
Vec3 direction(const Vec3& v) {
    const double length = glm::length(v);
    return length > 0 ? v / length : Vec3(0.0);
}

double angle_at(const Surface& surface, const std::array<Index, 3>& t, std::size_t k) {
    const Vec3& point = surface.points[t[k]];
    const Vec3 a = direction(surface.points[t[(k + 1) % 3]] - point), b = direction(surface.points[t[(k + 2) % 3]] - point);
    return std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0));
}

}  // namespace

std::vector<CornerNormals> corner_normals(const Surface& surface) {
    const Rows<std::uint32_t> fans = fans_of(surface);
    const std::size_t count = surface.triangles.size();
    std::vector<Vec3> flat(count);
    std::vector<double> angles(3 * count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        const auto& [a, b, c] = surface.triangles[i];
        flat[i] = direction(glm::cross(surface.points[b] - surface.points[a], surface.points[c] - surface.points[a]));
        for (std::size_t k = 0; k < 3; ++k) angles[3 * i + k] = angle_at(surface, surface.triangles[i], k);
    });
    std::vector<CornerNormals> normals(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Index point = surface.triangles[i][k];
            Vec3 sum(0.0);
            for (const std::uint32_t corner : fans[point]) {
                const Vec3& other = flat[corner / 3];
                const bool smooth = flat[i] == Vec3(0.0) || glm::dot(flat[i], other) > kSmoothCosine;
                if (smooth) sum += angles[corner] * other;
            }
            const Vec3 normal = direction(sum);
            normals[i][k] = {static_cast<float>(normal.x), static_cast<float>(normal.y), static_cast<float>(normal.z)};
        }
    });
    return normals;
}

}  // namespace subvol::detail
