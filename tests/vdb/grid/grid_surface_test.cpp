// SPDX-License-Identifier: Apache-2.0
#include "subvol/grid_surface.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "lib/temp_folder.h"
#include "subvol/model.h"
#include "subvol/rasterize.h"

namespace subvol {
namespace grid_surface_test {

using test::error_of;
using testing::HasSubstr;

/// The grids of a ball of radius 1: fog of 2 − |x|², and distances.
std::vector<VdbGrid> grids_of_ball() {
    HexMesh ball = make_model("ball", 8);
    ball.attributes = {{.name = "fog", .channels = 1, .values = {}}};
    for (const Vec3& x : ball.points) ball.attributes[0].values.push_back(2 - glm::dot(x, x));
    RasterizeOptions options;
    options.voxel_size_world = 0.05;
    options.level_set.emplace();
    const std::vector<std::string> fields{"fog"};
    return rasterize(ball, fields, options);
}

std::size_t open_edges(const Surface& surface) {
    std::map<std::pair<Index, Index>, int> sides;
    for (const auto& t : surface.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
            ++sides[{a, b}];
        }
    }
    return static_cast<std::size_t>(std::ranges::count_if(sides, [](const auto& side) { return side.second != 2; }));
}

TEST(GridSurface, LiesWhereTheGridHasTheValue) {
    const std::vector<VdbGrid> grids = grids_of_ball();
    const Surface inner = grid_surface(grids[0], 1.75);  // |x| = ½
    EXPECT_EQ(open_edges(inner), 0U);
    for (const Vec3& x : inner.points) EXPECT_NEAR(glm::length(x), 0.5, 0.03);
}

TEST(GridSurface, OfALevelSetIsAtTheDistanceZero) {
    const std::vector<VdbGrid> grids = grids_of_ball();
    const Surface hull = grid_surface(grids.back());
    EXPECT_EQ(open_edges(hull), 0U);
    const Surface larger = grid_surface(grids.back(), 0.05);
    Box box, larger_box;
    for (const Vec3& x : hull.points) box.add(x);
    for (const Vec3& x : larger.points) larger_box.add(x);
    EXPECT_NEAR(larger_box.size().x - box.size().x, 0.1, 0.01);
}

TEST(GridSurface, IsRoundFarFromTheOrigin) {
    HexMesh ball = make_model("ball", 4);
    RasterizeOptions options;
    options.voxel_size_world = 0.1;
    options.level_set.emplace();
    const auto radii = [&](const Vec3& center) {
        HexMesh moved = ball;
        for (Vec3& x : moved.points) x += center;
        moved.attributes = {{"one", 1, std::vector<double>(moved.points.size(), 1)}};
        const std::vector<std::string> fields{"one"};
        std::pair<double, double> least_and_most(10, 0);
        for (const Vec3& x : grid_surface(rasterize(moved, fields, options).back()).points) {
            least_and_most.first = std::min(least_and_most.first, glm::distance(x, center));
            least_and_most.second = std::max(least_and_most.second, glm::distance(x, center));
        }
        return least_and_most;
    };
    const auto near = radii(Vec3(0.0)), far = radii(Vec3(1e6, 1e6, -1e6));
    // Floats have steps of 0.06 there.
    EXPECT_NEAR(far.first, near.first, 1e-4);
    EXPECT_NEAR(far.second, near.second, 1e-4);
}

TEST(GridSurface, OfFogIsAtHalfOfItsGreatestValue) {
    const std::vector<VdbGrid> grids = grids_of_ball();
    EXPECT_EQ(grid_surface(grids[0]).points, grid_surface(grids[0], grids[0].report().max / 2).points);
    EXPECT_THAT(error_of([&] { std::ignore = grid_surface(grids[0], 7); }), HasSubstr("has the value 7 nowhere"));
}

}  // namespace grid_surface_test
}  // namespace subvol
