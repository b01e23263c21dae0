// SPDX-License-Identifier: Apache-2.0
#include "subvol/stream_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "lib/expect_error.h"

namespace subvol {
namespace stream_surface_test {

/// A circle of radius 1 as one line.
Streamlines circle(std::size_t count) {
    Streamlines lines;
    for (std::size_t i = 0; i < count; ++i) {
        const double t = 1.9 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count - 1);
        lines.points.emplace_back(std::cos(t), std::sin(t), 0);
        lines.times.push_back(t);
    }
    lines.firsts.push_back(count);
    lines.seeds = {0};
    lines.ends = {{StreamEnd::Seed, StreamEnd::Length}};
    return lines;
}

double area_of(const Surface& surface) {
    double sum = 0;
    for (const auto& [a, b, c] : surface.triangles)
        sum += glm::length(glm::cross(surface.points[b] - surface.points[a], surface.points[c] - surface.points[a])) / 2;
    return sum;
}

/// Whether every edge has two triangles.
bool is_closed(const Surface& surface) {
    std::map<std::pair<Index, Index>, int> edges;
    for (const auto& t : surface.triangles) {
        for (std::size_t k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
    }
    return std::ranges::all_of(edges, [](const auto& edge) { return edge.second == 2; });
}

TEST(StreamSurface, TubesAreClosedAndAsWideAsTheirRadius) {
    const ShellSurface tube = tube_surface(circle(400), .01);
    EXPECT_TRUE(is_closed(tube.surface));
    for (std::size_t p = 0; p < tube.surface.points.size(); ++p) {
        const Vec3& x = tube.surface.points[p];
        EXPECT_LE(std::hypot(glm::length(Vec2(x)) - 1, x.z), .01 + 1e-6);
        EXPECT_LT(tube.sources[p], 400U);
    }
    const double length = 1.9 * std::numbers::pi, around = 2 * 12 * std::sin(std::numbers::pi / 12) * .01;
    EXPECT_NEAR(area_of(tube.surface), length * around + 2 * std::numbers::pi * 1e-4, .01 * length * around);
}

TEST(StreamSurface, ArrowsAreAsLongAsTheirVectors) {
    const std::vector<Vec3> places{{0, 0, 0}, {5, 0, 0}, {9, 0, 0}}, vectors{{0, 0, 4}, {0, 2, 0}, {0, 0, 0}};
    const ShellSurface arrows = arrow_surface(places, vectors, 1);
    EXPECT_TRUE(is_closed(arrows.surface) || !arrows.surface.triangles.empty());
    Box first, second;
    for (std::size_t p = 0; p < arrows.sources.size(); ++p) {
        ASSERT_NE(arrows.sources[p], 2U) << "a vector of 0 has no arrow";
        (arrows.sources[p] == 0 ? first : second).add(arrows.surface.points[p]);
    }
    EXPECT_NEAR(first.upper.z - first.lower.z, 1, 1e-12);
    EXPECT_NEAR(first.upper.z, .5, 1e-12);
    EXPECT_NEAR(second.upper.y - second.lower.y, .5, 1e-12);
    test::expect_error(ErrorCode::InvalidInput, "vectors",
                       [&] { (void)arrow_surface(places, std::span(vectors).first(1), 1); });
    test::expect_error(ErrorCode::InvalidInput, "length", [&] { (void)arrow_surface(places, vectors, 0); });
    test::expect_error(ErrorCode::InvalidInput, "radius", [&] { (void)tube_surface(circle(5), -1); });
}

}  // namespace stream_surface_test
}  // namespace subvol
