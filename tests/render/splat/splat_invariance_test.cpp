// SPDX-License-Identifier: Apache-2.0
// A picture of splats does not depend on threads, on the order of points or on batches that are passed over.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <random>

#include "splat_cpu.h"
#include "splat_scenes.h"
#include "subvol/splat.h"

namespace subvol::test {
namespace splat_invariance_test {

constexpr int kWidth_px = 100, kHeight_px = 70;

View view() {
    return {perspective_camera(), kWidth_px, kHeight_px};
}

RbfVolume waves(Correction correction = Correction::Second) {
    return sample_rbf_points(with_waves(nested_ball(4)), {.correction = correction}).volume;
}

/// Opaque for some values, invisible over most of the range.
Optics one_peak(double value) {
    return Optics({.color = {{0, {.1, .2, .9}}, {1, {.9, .2, .1}}},
                   .opacity = {{0, 0}, {value - .03, 0}, {value, .9}, {value + .03, 0}, {1, 0}}},
                  .2);
}

/// A frame and all that it refers to.
struct Frame {
    detail::SplatScene scene;
    detail::Classification classification;
    View view;
    detail::SplatFrame frame;

    Frame(const RbfVolume& volume, const Optics& optics, const SplatOptions& options,
          const View& seen = splat_invariance_test::view())
        : scene(detail::make_scene(volume, options)), classification(classify(scene, optics)), view(seen) {
        prepare_frame(frame, scene, view, classification, options.sheets, nullptr);
        find_interval_ends(frame);
    }
    [[nodiscard]] detail::Drawn draw() const { return draw_splats_cpu(frame, nullptr); }
};

/// The volume's points in another order.
RbfVolume reordered(const RbfVolume& volume, const std::vector<std::size_t>& order) {
    const auto pick = [&](auto& values) {
        const auto before = values;
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = before[order[i]];
    };
    RbfVolume result = volume;
    pick(result.centers);
    pick(result.frames);
    for (RbfChannel& channel : result.channels) {
        pick(channel.values);
        pick(channel.gradients);
        pick(channel.moments);
        pick(channel.hessians);
    }
    return result;
}

std::vector<SplatOptions> all_kinds() {
    return {{.method = SplatMethod::Cpu, .sheets = 75},
            {.method = SplatMethod::Cpu, .sheets = 75, .color_channel = 1},
            {.method = SplatMethod::Cpu, .sheets = 75, .shading = Shading{}},
            {.method = SplatMethod::Cpu, .sheets = 75, .normalized = false},
            {.method = SplatMethod::Cpu, .sheets = 75, .color_channel = 1, .shading = Shading{}}};
}

TEST(SplatInvariance, PictureAndDepthAreBitwiseThatOfOneThread) {
    for (const Correction correction : {Correction::Second, Correction::Full}) {
        const RbfVolume volume = waves(correction);
        for (const SplatOptions& options : all_kinds()) {
            const auto draw = [&](std::size_t threads) {
                const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
                return render_splats(volume, view(), smooth_optics(), options);
            };
            const auto one = draw(1), four = draw(4);
            EXPECT_EQ(one.image.rgba, four.image.rgba);
            EXPECT_EQ(one.depth, four.depth);
        }
    }
}

TEST(SplatInvariance, TilesListTheirPointsInTheirOrder) {
    // Points in reverse order are the same as the list of each tile in reverse order.
    const RbfVolume volume = waves();
    std::vector<std::size_t> backwards(volume.size());
    for (std::size_t i = 0; i < backwards.size(); ++i) backwards[i] = volume.size() - 1 - i;
    const RbfVolume turned = reordered(volume, backwards);
    Frame lists(volume, smooth_optics(), {});
    const auto& offsets = lists.frame.tile_offsets;
    auto& splats = lists.frame.tile_splats;
    for (std::size_t tile = 0; tile + 1 < offsets.size(); ++tile) {
        const auto at = [&](std::size_t i) { return splats.begin() + static_cast<std::ptrdiff_t>(offsets[tile + i]); };
        EXPECT_TRUE(std::is_sorted(at(0), at(1)));
        std::reverse(at(0), at(1));
    }
    find_interval_ends(lists.frame);
    EXPECT_EQ(lists.draw().image.rgba, Frame(turned, smooth_optics(), {}).draw().image.rgba);
}

TEST(SplatInvariance, TheOrderOfPointsIsSeenInRoundingOnly) {
    const RbfVolume volume = waves(Correction::Full);
    std::vector<std::size_t> order(volume.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), std::mt19937(5));
    const RbfVolume shuffled = reordered(volume, order);
    for (const SplatOptions& options : all_kinds()) {
        // Sums of some ten floats are right to 1e-6 of the range; slopes are 1 to 2, and some times steeper for sums that are
        // not normalised.
        EXPECT_LT(largest_difference(render_splats(volume, view(), smooth_optics(), options).image,
                                     render_splats(shuffled, view(), smooth_optics(), options).image),
                  options.normalized ? 1e-5 : 4e-5);
    }
}

TEST(SplatInvariance, BatchesThatArePassedOverAreNotMissed) {
    // Values rise with the depth: visible values are in few of the batches, and most other kernels do not reach these.
    HexMesh mesh = nested_ball(6);
    const Vec3 forward = view().axes()[2];
    add_field(mesh, "f", [&](const Vec3& p) { return .5 + .4 * glm::dot(p, forward) + .03 * std::sin(5 * p.z); });
    add_field(mesh, "g", [](const Vec3& p) { return .5 + .4 * std::sin(p.x); });
    for (const bool boundary : {true, false}) {
        RbfVolume volume = sample_rbf_points(mesh, {.correction = boundary ? Correction::Second : Correction::Full}).volume;
        if (!boundary) volume.boundary = {};
        for (const double peak : {.15, .3, .5, .7, .85}) {
            for (SplatOptions options : all_kinds()) {
                Frame frame(volume, one_peak(peak), options);
                const auto passed_over = frame.draw();
                frame.frame.kernels.ranges.clear();
                const auto all = frame.draw();
                EXPECT_EQ(passed_over.image.rgba, all.image.rgba) << peak;
                EXPECT_EQ(passed_over.depth, all.depth) << peak;
            }
        }
    }
}

TEST(SplatInvariance, WhatLiesBetweenBatchesIsNotMissed) {
    // Layers of kernels 1/17 apart that reach .084 to either side, and ten sheets, of which the first batch has those up to a
    // depth of 7/9 = .778. Kernels with a value of .9 end at .706 + .084, behind that sheet but far before the next one. There
    // and further on nothing is visible, but between the two sheets something is.
    HexMesh mesh = test::box(17);
    add_field(mesh, "f", [](const Vec3& p) { return p.y < .73 ? .9 : .1; });
    const RbfVolume volume = sample_rbf_points(mesh, {.correction = Correction::None}).volume;
    const View along_y({.eye = {.5, -2, .5}, .target = {.5, 0, .5}, .up = {0, 0, 1}, .ortho_height = 1.2}, 40, 40);
    const Optics optics({.color = {{0, {1, 1, 1}}}, .opacity = {{0, 0}, {.102, 0}, {.106, .9}, {.12, 0}, {1, 0}}}, .001);
    Frame frame(volume, optics, {.method = SplatMethod::Cpu, .sheets = 10}, along_y);
    const auto passed_over = frame.draw();
    frame.frame.kernels.ranges.clear();
    EXPECT_EQ(passed_over.image.rgba, frame.draw().image.rgba);
    EXPECT_GT(passed_over.image.pixel(20, 20)[3], .1);
}

TEST(SplatInvariance, WhereNothingCanBeSeenNothingIsDrawn) {
    const auto result = render_splats(waves(), view(), Optics({.color = {{0, {1, 1, 1}}}, .opacity = {{0, 0}, {1, 0}}}, 1),
                                      {.method = SplatMethod::Cpu});
    EXPECT_TRUE(std::all_of(result.image.rgba.begin(), result.image.rgba.end(), [](float v) { return v == 0; }));
}

}  // namespace splat_invariance_test
}  // namespace subvol::test
