// SPDX-License-Identifier: Apache-2.0
#include "subvol/grid_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "subvol/model.h"
#include "subvol/probe.h"
#include "subvol/rasterize.h"
#include "vdb/each_voxel.h"

namespace subvol {
namespace grid_error_test {

const std::vector<std::string> kDensity{"density"};

/// Asserts that the limit, evaluated to a hundredth of the usual tolerance, is within the bound at every voxel.
void expect_bound_holds(const HexMesh& mesh, const RasterizeOptions& options) {
    const std::vector<VdbGrid> grids = rasterize(mesh, kDensity, options);
    const GridError error = grid_error(grids.front(), mesh, "density");
    EXPECT_EQ(error.grid.report().name, "density_error");
    EXPECT_EQ(error.grid.report().active_voxels, grids.front().report().active_voxels);
    EXPECT_GE(error.max, error.rms);
    std::vector<Vec3> places;
    std::vector<double> bounds;
    const double size = error.grid.report().voxel_size_world;
    test::for_each_voxel(error.grid, [&](const Voxel& at, double bound) {
        places.push_back(size * Vec3(at[0], at[1], at[2]));
        bounds.push_back(bound);
    });
    ASSERT_GT(places.size(), 1000u);
    const ProbeResult exact = LimitProbe(mesh, {.limit = {.tolerance = 1e-8, .max_levels = 14}}).at(places);
    double most = 0, tightest = 0;
    for (std::size_t p = 0; p < places.size(); ++p) {
        if (!exact.inside(p)) continue;
        const double off = std::abs(*grids.front().value(places[p]) - exact.fields[0].values[p]);
        EXPECT_LE(off, bounds[p] + 1e-7) << p;  // the values are floats
        most = std::max(most, off);
        tightest = std::max(tightest, bounds[p]);
    }
    EXPECT_LE(most, error.max);
    EXPECT_LT(tightest, 3 * most + 1e-4) << "the bound is not far from the error";
}

TEST(GridError, BoundsTheDistanceFromTheLimitOfTheTwist) {
    expect_bound_holds(make_model("twist", 6), {.resolution = 24, .refine = {.levels = 1}});
}

TEST(GridError, BoundsTheDistanceFromTheLimitOfTheBall) {
    expect_bound_holds(make_model("ball", 4), {.resolution = 24, .refine = {.levels = 0}});
}

TEST(GridError, FallsWithTheLevelAndIsSmallForTheLimit) {
    const HexMesh mesh = make_model("twist", 6);
    double last = 1e9;
    for (const int level : {0, 1, 2}) {
        const auto grids = rasterize(mesh, kDensity, {.resolution = 20, .refine = {.levels = level}});
        const double rms = grid_error(grids.front(), mesh, "density").rms;
        EXPECT_LT(rms, last / 2);
        last = rms;
    }
    RasterizeOptions options{.resolution = 20};
    const LimitCells limit = limit_for_voxels(mesh, options.refine, 0.1);
    options.limit = &limit;
    EXPECT_LT(grid_error(rasterize(mesh, kDensity, options).front(), mesh, "density").rms, last);
}

TEST(GridError, OfSixteenBitsIsLargerByTheirRounding) {
    const HexMesh mesh = make_model("twist", 4);
    const auto grids = rasterize(mesh, kDensity, {.resolution = 16});
    const double full = grid_error(grids.front(), mesh, "density").rms;
    EXPECT_GT(grid_error(grids.front(), mesh, "density", {.half = true}).rms, full);
}

}  // namespace grid_error_test
}  // namespace subvol
