// SPDX-License-Identifier: Apache-2.0
// How many sheets kernels need.
#include "sheet_count.h"

#include <gtest/gtest.h>

#include <array>
#include <barrier>
#include <cmath>
#include <numbers>
#include <random>
#include <thread>
#include <vector>

#include "splat_scenes.h"
#include "subvol/detail/points_range.h"
#include "subvol/error.h"
#include "subvol/sample.h"
#include "subvol/splat.h"
#include "subvol/splat_shares.h"

namespace subvol::test {
namespace sheet_count_test {

struct Reach {
    float reach;
    double volume;
};

std::vector<Reach> many_reaches() {
    std::mt19937 random(7);
    std::vector<Reach> reaches;
    for (int i = 0; i < 500; ++i) {
        const float reach = std::ldexp(1.0F + static_cast<float>(random() % 1000) / 1000, -static_cast<int>(random() % 9));
        reaches.push_back({reach, 1e-3 * static_cast<double>(random() % 1000) / 1000});
    }
    return reaches;
}

detail::ReachCounts counts_of(const std::vector<Reach>& reaches, std::size_t begin, std::size_t end) {
    detail::ReachCounts counts;
    for (std::size_t i = begin; i < end; ++i) counts.add(reaches[i].reach, reaches[i].volume);
    return counts;
}

TEST(SheetCount, FinestKernelsHaveAPartOfTheVolume) {
    const std::vector<Reach> reaches = many_reaches();
    const detail::ReachCounts counts = counts_of(reaches, 0, reaches.size());
    double all = 0;
    for (const Reach& r : reaches) all += r.volume;
    for (const double part : {.01, .05, .5, .9}) {
        const float finest = counts.finest(part);
        double below = 0, soon = 0;  // as far as the next reach that is told apart
        for (const Reach& r : reaches) {
            if (r.reach < finest) below += r.volume;
            if (r.reach < finest * (1 + 1.0F / 32)) soon += r.volume;
        }
        EXPECT_LE(below, part * all * (1 + 1e-6));
        EXPECT_GE(soon, part * all * (1 - 1e-6));
    }
    EXPECT_EQ(detail::ReachCounts().finest(.05), 0);
}

TEST(SheetCount, ProcessesFindTheReachOfAllKernels) {
    const std::vector<Reach> reaches = many_reaches();
    const detail::ReachCounts whole = counts_of(reaches, 0, reaches.size());
    detail::ReachCounts own = counts_of(reaches, 0, 100), others = counts_of(reaches, 100, reaches.size());
    std::array<std::vector<std::int64_t>, 2> told;
    std::barrier<> both(2);
    const auto process = [&](detail::ReachCounts& counts, std::size_t number) {
        counts.add_up([&](std::vector<std::int64_t>& sums) {
            EXPECT_LT(sums.size(), 2000U) << "what is sent is a few kilobytes";
            told[number] = sums;
            both.arrive_and_wait();
            for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += told[1 - number].at(i);
            both.arrive_and_wait();
        });
    };
    std::thread other([&] { process(others, 1); });
    process(own, 0);
    other.join();
    EXPECT_EQ(own.kernels(), static_cast<std::int64_t>(reaches.size()));
    for (const double part : {.01, .05, .5}) {
        EXPECT_EQ(own.finest(part), whole.finest(part));
        EXPECT_EQ(others.finest(part), whole.finest(part));
    }
}

/// A cube of unit size whose cells are 1/8 wide; with a layer, twelve more layers of them lie in the last 1/50 of its depth.
RbfVolume cube(bool layer) {
    HexMesh mesh = test::box(20);
    for (Vec3& p : mesh.points) {
        const double k = std::round(20 * p.x);
        if (layer) p.x = k <= 8 ? .98 * k / 8 : .98 + .02 * (k - 8) / 12;
    }
    mesh.attributes = {{"f", 1, {}}};
    for (const Vec3& p : mesh.points) mesh.attributes[0].values.push_back(std::sin(5 * p.x) + p.y);
    return sample_rbf_points(mesh).volume;
}

const View kAlongX({.eye = {-4, .5, .5}, .target = {0, .5, .5}, .up = {0, 0, 1}, .ortho_height = 1.2}, 64, 64);

Optics ramp() {
    return {{.color = {{-1, {.1, .2, .9}}, {2, {.9, .2, .1}}}, .opacity = {{-1, 0}, {2, .4}}}, .05};
}

SplatResult draw(const RbfVolume& volume, int sheets, double tolerance) {
    return render_splats(volume, kAlongX, ramp(), {.method = SplatMethod::Cpu, .sheets = sheets, .image_tolerance = tolerance});
}

TEST(SheetCount, AFineLayerDoesNotMakeThePictureFine) {
    const RbfVolume layered = cube(true);
    EXPECT_LT(draw(layered, 0, 1e-4).report.sheets, draw(cube(false), 0, 1e-4).report.sheets)
        << "the cells beside the layer are wider";
    EXPECT_LT(rmse(draw(layered, 0, 1e-3).image, draw(layered, 4000, 1).image), 1e-3);
}

TEST(SheetCount, PicturesAreAsExactAsIsAskedFor) {
    const RbfVolume volume = cube(false);
    const Image exact = draw(volume, 8000, 1).image;
    double before = 1;
    for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5}) {
        const SplatResult drawn = draw(volume, 0, tolerance);
        const double off = rmse(drawn.image, exact);
        EXPECT_LT(off, tolerance);
        EXPECT_LT(off, before);
        before = off;
    }
    // The error falls with the square of the number.
    EXPECT_NEAR(draw(volume, 0, 2.5e-5).report.sheets, 2 * draw(volume, 0, 1e-4).report.sheets, 2);
    for (const double tolerance : {0.0, -1.0, std::nan("")}) EXPECT_THROW((void)draw(volume, 0, tolerance), Error);
}

float largest_difference(const Image& a, const Image& b) {
    float largest = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) largest = std::max(largest, std::abs(a.rgba[i] - b.rgba[i]));
    return largest;
}

TEST(SheetCount, ABendIsThePartOfAKernelsChangeThatIsNotInProportion) {
    RbfVolume volume = cube(false);
    // Kernels of reach 1/2: v = 1 + 3 x + 2 y + .25 e changes by √13 / 2 and by .25; a constant bends as much as it changes.
    const std::size_t count = volume.size();
    volume.frames.assign(count, {.25F, 0, 0, .25F, 0, .25F});
    volume.channels[0].gradients.assign(count, {3, 2, 0});
    volume.channels[0].moments.assign(count, .25F);
    const auto median = [&](const RbfVolume& kernels) {
        const detail::SplatScene scene = detail::make_scene(kernels, {});
        EXPECT_EQ(scene.bends.kernels(), static_cast<std::int64_t>(count));
        return scene.bends.finest(.5);
    };
    EXPECT_NEAR(median(volume), .25 / (std::sqrt(13) / 2), .02 * .14);
    // x² − y²: what a moment does not have is in the Hessian, H S = diag(.5, −.5, 0) at the end of the reach, half of it a
    // change.
    volume.channels[0].moments.assign(count, 0);
    EXPECT_EQ(median(volume), 0);
    volume.channels[0].hessians.assign(count, {2, 0, 0, -2, 0, 0});
    EXPECT_NEAR(median(volume), std::sqrt(.5) / 2 / (std::sqrt(13) / 2), .02 * .2);
    volume.channels[0].hessians.clear();
    volume.channels[0].gradients.assign(count, {0, 0, 0});
    EXPECT_EQ(median(volume), 1);
}

/// A cube of n³ cells with `waves` of a field along each axis.
RbfVolume waves_in_cube(int n, double waves) {
    HexMesh mesh = test::box(n);
    mesh.attributes = {{"f", 1, {}}};
    for (const Vec3& p : mesh.points) {
        const Vec3 angle = 2 * std::numbers::pi * waves * p;
        mesh.attributes[0].values.push_back(std::sin(angle.x) + std::sin(angle.y) * std::cos(angle.z));
    }
    return sample_rbf_points(mesh).volume;
}

TEST(SheetCount, MoreKernelsOfASmoothFieldNeedNoMoreSheets) {
    const RbfVolume few = waves_in_cube(24, 1), many = waves_in_cube(56, 1), rough = waves_in_cube(56, 7);
    const int sheets = draw(few, 0, 1e-4).report.sheets;
    const SplatResult smooth = draw(many, 0, 1e-4);
    EXPECT_LT(smooth.report.sheets, 1.25 * sheets);
    EXPECT_GT(draw(rough, 0, 1e-4).report.sheets, 1.8 * sheets) << "kernels are needed for its waves";
    const Image exact = draw(many, 8000, 1).image;
    EXPECT_LT(rmse(smooth.image, exact), 1e-4);
    EXPECT_LT(largest_difference(smooth.image, exact), 3e-4F);
    EXPECT_LT(largest_difference(draw(rough, 0, 1e-4).image, draw(rough, 8000, 1).image), 3e-4F);
}

TEST(SheetCount, WhatDoesNotFollowFromTheFieldHasItsSheets) {
    RbfVolume many = waves_in_cube(40, .2);
    const auto sheets = [&](const SplatOptions& options) {
        SplatOptions all = options;
        all.method = SplatMethod::Cpu;
        return sheets_of_picture(many, kAlongX, all);
    };
    const int few = sheets({});
    const int by_kernels = sheets({.shadows = true});
    EXPECT_GT(by_kernels, 1.5 * few);
    EXPECT_EQ(sheets({.ambient_occlusion = .1}), by_kernels);
    EXPECT_EQ(sheets({.normalized = false}), by_kernels);
    many.boundary = {};  // ends where its weights do
    EXPECT_GE(sheets({}), by_kernels);
}

const View kOnLayer({.eye = {-3, .9, 1.1}, .target = {0, .5, .5}, .up = {0, 0, 1}}, 96, 96);

Optics steep() {
    return {{.color = {{0, {.1, .2, .9}}, {1, {.9, .8, .1}}}, .opacity = {{0, 0}, {1, .5}}}, .05};
}

SplatResult draw_layer(const RbfVolume& volume, int sheets, double tolerance = 1e-3) {
    return render_splats(volume, kOnLayer, steep(),
                         {.method = SplatMethod::Cpu, .sheets = sheets, .image_tolerance = tolerance});
}

TEST(SheetCount, NoPixelOfAFineLayerIsOffByMoreThanIsAskedFor) {
    const RbfVolume volume = sample_rbf_points(cube_with_layer()).volume;
    const Image exact = draw_layer(volume, 20000).image;
    const SplatResult drawn = draw_layer(volume, 0);
    EXPECT_LT(largest_difference(drawn.image, exact), 1e-3f);
    EXPECT_GT(largest_difference(draw_layer(volume, drawn.report.sheets).image, exact), 5e-3f) << "these sheets alone";
    EXPECT_GT(drawn.report.sheets_finest, 2 * drawn.report.sheets);
    const SplatResult better = draw_layer(volume, 0, 1e-4);
    EXPECT_LT(largest_difference(better.image, exact), 2e-4f);
    EXPECT_GT(better.report.sheets_finest, drawn.report.sheets_finest);
}

TEST(SheetCount, WhereNoKernelIsThinThePictureIsThatOfTheNumber) {
    const RbfVolume volume = cube(false);
    const SplatResult drawn = draw(volume, 0, 1e-3), same = draw(volume, drawn.report.sheets, 1e-3);
    EXPECT_EQ(drawn.report.sheets_finest, drawn.report.sheets);
    EXPECT_EQ(drawn.image.rgba, same.image.rgba);
}

TEST(SheetCount, PartsOfAPictureHaveTheSheetsOfTheWholeInAFineLayer) {
    const RbfVolume volume = sample_rbf_points(cube_with_layer()).volume;
    SplatOptions options{.method = SplatMethod::Cpu};
    const Image whole = render_splats(volume, kOnLayer, steep(), options).image;
    options.needed_sheets = sheets_of_picture(volume, kOnLayer, options);
    const std::vector<PixelRows> touched = rows_of_kernels(volume, kOnLayer, steep(), options);
    for (int first = 0; first < kOnLayer.height(); first += kRowsOfTile) {
        const PixelRows rows{first, std::min(first + kRowsOfTile, kOnLayer.height())};
        RbfVolume some = detail::chosen_kernels(volume, touching(touched, rows));
        some.boundary = volume.boundary;
        const Image part = render_splats(some, kOnLayer, steep(), options).image;
        const auto row = [&](const Image& image, int y) {
            const auto begin = image.rgba.begin() + static_cast<std::ptrdiff_t>(4) * y * image.width;
            return std::vector<float>(begin, begin + static_cast<std::ptrdiff_t>(4) * image.width);
        };
        for (int y = rows.first; y < rows.end; ++y) EXPECT_EQ(row(part, y), row(whole, y)) << y;
    }
}

}  // namespace sheet_count_test
}  // namespace subvol::test
