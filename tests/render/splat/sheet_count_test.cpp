// SPDX-License-Identifier: Apache-2.0
// How many sheets kernels need.
#include "sheet_count.h"

#include <gtest/gtest.h>

#include <array>
#include <barrier>
#include <cmath>
#include <random>
#include <thread>
#include <vector>

#include "splat_scenes.h"
#include "subvol/error.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

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

}  // namespace sheet_count_test
}  // namespace subvol::test
