// SPDX-License-Identifier: Apache-2.0
#include "subvol/kernel_hierarchy.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

#include "lib/expect_error.h"
#include "lib/rbf_volumes.h"
#include "merge_kernels.h"
#include "subvol/model.h"
#include "subvol/rbf_field.h"

namespace subvol {
namespace kernel_hierarchy_test {

constexpr double kFloatTol = 1e-5;  // sums of 32-bit floats over some tens of levels, each rounded to 6e-8

RbfVolume ball(int per_edge = 2, Correction correction = Correction::Second) {
    return sample_rbf_points(make_model("ball", 4), {.per_edge = per_edge, .correction = correction}).volume;
}

View distant_view(const RbfVolume& volume, double distance, int size = 64) {
    const Vec3 center = volume.bounds.center();
    const Vec3 eye = center + distance * volume.bounds.diagonal() * glm::normalize(Vec3(1, -2, .5));
    return View({.eye = eye, .target = center, .up = {0, 0, 1}, .fovy_deg = 30}, size, size);
}

std::vector<Index> kernels_below(const KernelHierarchy& h, std::size_t node) {
    const auto [first, last] = h.slots(node);
    return {h.order.begin() + static_cast<std::ptrdiff_t>(first), h.order.begin() + static_cast<std::ptrdiff_t>(last)};
}

double mass_of(const Symmetric3& frame) {
    return std::sqrt(glm::determinant(matrix(frame)));
}

TEST(KernelHierarchy, EveryNodeHasTheMomentsOfItsKernels) {
    const RbfVolume volume = ball();
    const KernelHierarchy h = build_kernel_hierarchy(volume);
    const double spread = 1 / (12 * 1.43 * 1.43);  // of a unit cube, with S = R² J Jᵀ
    for (std::size_t node = 0; node < h.nodes.size(); ++node) {
        double mass = 0;
        Vec3 mean(0.0);
        for (const Index i : kernels_below(h, node)) {
            mass += mass_of(volume.frames[i]);
            mean += mass_of(volume.frames[i]) * volume.centers[i];
        }
        mean /= mass;
        Mat3 covariance(0.0);
        for (const Index i : kernels_below(h, node)) {
            const Vec3 d = volume.centers[i] - mean;
            covariance += mass_of(volume.frames[i]) / mass * (spread * matrix(volume.frames[i]) + glm::outerProduct(d, d));
        }
        const double size = std::sqrt(covariance[0][0] + covariance[1][1] + covariance[2][2]);
        EXPECT_NEAR(h.masses[node], mass, kFloatTol * mass);
        EXPECT_NEAR(mass_of(h.nodes.frames[node]), mass, kFloatTol * mass) << "the node's kernel has the mass, too";
        EXPECT_LT(glm::length(h.nodes.centers[node] - mean), kFloatTol * size);
        for (int k = 0; k < 3; ++k) {
            const Vec3 off = matrix(h.covariances[node])[k] - covariance[k];
            EXPECT_LT(glm::length(off), kFloatTol * size * size);
        }
    }
}

TEST(KernelHierarchy, TheMeanOfTheFieldIsKept) {
    for (const Correction correction : {Correction::None, Correction::Gradient, Correction::Second, Correction::Full}) {
        const RbfVolume volume = ball(2, correction);
        const KernelHierarchy h = build_kernel_hierarchy(volume);
        // The mean of a quadratic over a distribution: its value at the mean and half the trace of bend · covariance.
        const auto mean_of = [](const detail::Quadratic& q, const Mat3& covariance) {
            double mean = q.value;
            for (int k = 0; k < 3; ++k) mean += .5 * glm::dot(q.bend[k], covariance[k]);
            return mean;
        };
        double sum = 0, mass = 0;
        for (std::size_t i = 0; i < volume.size(); ++i) {
            const double own = mass_of(volume.frames[i]);
            sum += own *
                   mean_of(detail::quadratic_of(volume, volume.channels[0], i), matrix(volume.frames[i]) / (12 * 1.43 * 1.43));
            mass += own;
        }
        const auto root = detail::quadratic_of(h.nodes, h.nodes.channels[0], 0);
        EXPECT_NEAR(mean_of(root, matrix(h.covariances[0])), sum / mass, kFloatTol) << "values are up to 1";
    }
}

/// Kernels on a sheared grid that have a quadratic field exactly.
RbfVolume quadratic_volume(const detail::Quadratic& field, bool full) {
    RbfVolume volume;
    volume.channels.push_back({.name = "f"});
    const Mat3 j = full ? Mat3(1, .2, 0, 0, .8, .3, -.1, 0, 1.3) : Mat3(1.0);
    for (int i = 0; i < 1000; ++i) {
        volume.centers.push_back(j * Vec3(i % 10, i / 10 % 10, i / 100));
        volume.frames.push_back(symmetric3(1.43 * 1.43 * j * glm::transpose(j)));
    }
    auto& channel = volume.channels[0];
    channel.values.resize(1000);
    channel.gradients.resize(1000);
    channel.moments.resize(1000);
    if (full) channel.hessians.resize(1000);
    for (std::size_t i = 0; i < 1000; ++i) {
        const Vec3& x = volume.centers[i];
        detail::store({field.at(x), field.gradient_at(x), field.bend}, volume, channel, i);
    }
    volume.bounds = box_of(volume);
    return volume;
}

TEST(KernelHierarchy, QuadraticFieldsStayWhatTheyAre) {
    // Without Hessians: those whose second derivatives are along S⁻¹, which on a cubic grid is |x|². Nodes are not cubic.
    const Mat3 bend(.02, .01, -.03, .01, -.05, .02, -.03, .02, .04);
    for (const bool full : {true, false}) {
        const detail::Quadratic field{.5, {.3, -.2, .1}, full ? bend : Mat3(0.0)};
        const RbfVolume volume = quadratic_volume(field, full);
        const KernelHierarchy h = build_kernel_hierarchy(volume);
        for (std::size_t node = 0; node < h.nodes.size(); ++node) {
            const auto q = detail::quadratic_of(h.nodes, h.nodes.channels[0], node);
            const Vec3& x = h.nodes.centers[node];
            EXPECT_NEAR(q.value, field.at(x), 10 * kFloatTol);  // values are up to 10
            EXPECT_LT(glm::length(q.gradient - field.gradient_at(x)), kFloatTol);
            for (int k = 0; k < 3; ++k) EXPECT_LT(glm::length(q.bend[k] - field.bend[k]), kFloatTol);
        }
        const RbfVolume few = choose_level(h, volume, distant_view(volume, 4), {.pixels = 24});
        EXPECT_LT(few.size(), volume.size() / 4);
        const RbfField drawn(few);
        for (const Vec3& x : {Vec3(2, 2, 2), Vec3(3, 4, 5), Vec3(4, 3, 6.5)}) {
            ASSERT_TRUE(drawn.value(x).has_value());
            EXPECT_NEAR(*drawn.value(x), field.at(x), 10 * kFloatTol);
        }
    }
}

TEST(KernelHierarchy, ACutHoldsEachKernelOnce) {
    const RbfVolume volume = ball(3);
    const KernelHierarchy h = build_kernel_hierarchy(volume);
    for (const double distance : {.2, .6, 1.5, 5.0, 40.0}) {
        for (const double pixels : {.3, 1.0, 3.0, 10.0, 1e9}) {
            const View view = distant_view(volume, distance);
            const KernelCut cut = choose_cut(h, view, {.pixels = pixels});
            std::vector<int> times(volume.size());
            for (const Index i : cut.kernels) ++times[i];
            for (const Index node : cut.nodes) {
                for (const Index i : kernels_below(h, node)) ++times[i];
                if (pixels < 1e9) {
                    EXPECT_LT(double(h.widths[node]) / (view.to_eye(h.nodes.centers[node]).z * view.pixel()), pixels);
                }
            }
            EXPECT_TRUE(std::ranges::all_of(times, [](int n) { return n == 1; })) << distance << ' ' << pixels;
            EXPECT_TRUE(std::ranges::is_sorted(cut.kernels));
            // So the mass of what is drawn is the mass of all.
            double mass = 0;
            for (const Symmetric3& frame : kernels_of_cut(h, volume, cut).frames) mass += mass_of(frame);
            EXPECT_NEAR(mass, h.masses[0], kFloatTol * mass);
        }
    }
}

TEST(KernelHierarchy, DistantViewsDrawFewerAndOneAtTheEnd) {
    const RbfVolume volume = ball(3);
    const KernelHierarchy h = build_kernel_hierarchy(volume);
    std::size_t last = volume.size();
    for (const double distance : {1.0, 3.0, 9.0, 27.0, 81.0, 243.0}) {
        const std::size_t now = choose_cut(h, distant_view(volume, distance), {.pixels = 2}).size();
        EXPECT_LE(now, last);
        last = now;
    }
    EXPECT_EQ(last, 1U) << "the whole ball is narrower than two pixels";
}

TEST(KernelHierarchy, AtZeroPixelsAndCloseUpTheVolumeStays) {
    const RbfVolume volume = ball(2, Correction::Full);
    const KernelHierarchy h = build_kernel_hierarchy(volume);
    for (const auto& [distance, pixels] : {std::pair{50.0, 0.0}, std::pair{.01, 1.0}, std::pair{1.5, .01}}) {
        const RbfVolume same = choose_level(h, volume, distant_view(volume, distance), {.pixels = pixels});
        EXPECT_EQ(same.centers, volume.centers);
        test::expect_same_but_centers(same, volume);
    }
}

TEST(KernelHierarchy, ErrorsAreBounds) {
    const RbfVolume volume = ball(2);
    const KernelHierarchy h = build_kernel_hierarchy(volume);
    double largest = 0;
    for (std::size_t node = 0; node < h.nodes.size(); ++node) {
        const auto merged = detail::quadratic_of(h.nodes, h.nodes.channels[0], node);
        for (const Index i : kernels_below(h, node)) {
            const double value = double(volume.channels[0].values[i]);
            const double off = std::abs(value - merged.at(volume.centers[i] - h.nodes.centers[node]));
            EXPECT_LE(off, double(h.errors[0][node]) + kFloatTol);
            largest = std::max(largest, off);
        }
    }
    EXPECT_GT(largest, 0);
    const double half = .5 * double(h.errors[0][0]);
    const KernelCut cut = choose_cut(h, distant_view(volume, 1000), {.pixels = 100, .error = half});
    EXPECT_LE(cut.error, half);
    EXPECT_GT(cut.size(), 1U);
    EXPECT_EQ(choose_cut(h, distant_view(volume, 1000), {.pixels = 100}).size(), 1U);
}

TEST(KernelHierarchy, WithoutAViewTheErrorAloneDecides) {
    const RbfVolume volume = ball(3);
    const KernelHierarchy h = build_kernel_hierarchy(volume);
    std::size_t last = volume.size();
    for (const double error : {.001, .01, .1, 1.0, double(h.errors[0][0])}) {
        const KernelCut cut = choose_cut(h, error);
        EXPECT_LE(cut.error, error);
        EXPECT_LE(cut.size(), last);
        last = cut.size();
        // The bound is one: at each kernel's centre the node above it has nearly the kernel's value.
        for (const Index node : cut.nodes) {
            const auto merged = detail::quadratic_of(h.nodes, h.nodes.channels[0], node);
            for (const Index i : kernels_below(h, node)) {
                const double value = merged.at(volume.centers[i] - h.nodes.centers[node]);
                EXPECT_NEAR(value, double(volume.channels[0].values[i]), error + kFloatTol);
            }
        }
    }
    EXPECT_EQ(last, 1U);
    test::expect_error(ErrorCode::InvalidInput, "error", [&] { (void)choose_cut(h, -1.0); });
}

TEST(KernelHierarchy, DoesNotDependOnTheNumberOfThreads) {
    const RbfVolume volume = ball(4);
    const auto chosen = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return choose_level(build_kernel_hierarchy(volume), volume, distant_view(volume, 3), {.pixels = 6});
    };
    const RbfVolume one = chosen(1), three = chosen(3);
    EXPECT_LT(one.size(), volume.size());
    EXPECT_EQ(one.centers, three.centers);
    test::expect_same_but_centers(one, three);
}

TEST(KernelHierarchy, AnyPointsAreMerged) {
    for (const std::size_t count : {1u, 2u, 7u, 8u, 9u, 65u, 500u}) {
        const RbfVolume volume = test::random_points(count, 3);  // frames of all shapes, derivatives of any size
        const KernelHierarchy h = build_kernel_hierarchy(volume);
        const RbfVolume few = choose_level(h, volume, distant_view(volume, 300), {.pixels = 30});
        EXPECT_EQ(few.size(), 1U);
        EXPECT_NO_THROW(validate(few));
        EXPECT_NO_THROW(validate(choose_level(h, volume, distant_view(volume, 4), {.pixels = 10})));
    }
    // All kernels in one place, and flat ones.
    RbfVolume flat = test::random_points(40, 1);
    std::ranges::fill(flat.centers, Vec3(1, 2, 3));
    std::ranges::fill(flat.frames, Symmetric3{1, 0, 0, 1, 0, 1e-12f});
    EXPECT_NO_THROW(validate(build_kernel_hierarchy(flat).nodes));
    RbfVolume none;
    none.channels.push_back({.name = "f"});
    EXPECT_EQ(choose_level(build_kernel_hierarchy(none), none, View({}, 8, 8)).size(), 0U);
}

TEST(KernelHierarchy, ALevelHasEachKernelOnce) {
    const RbfVolume volume = ball();
    const KernelHierarchy h = build_kernel_hierarchy(volume);
    std::size_t before = 0;
    for (const std::size_t most : {1u, 2u, 3u, 100u, 1000u, 1'000'000u}) {
        const KernelCut cut = level_cut(h, most);
        EXPECT_LE(cut.size(), most);
        EXPECT_GE(cut.size(), before);
        before = cut.size();
        std::vector<int> counts(volume.size());
        for (const Index node : cut.nodes)
            for (const Index kernel : kernels_below(h, node)) ++counts[kernel];
        EXPECT_EQ(counts, std::vector<int>(volume.size(), 1));
        EXPECT_NO_THROW(validate(kernels_of_cut(h, volume, cut)));
    }
    EXPECT_GE(8 * before, volume.size()) << "the last level has at most eight kernels a node";
    EXPECT_EQ(level_cut(h, 0).size(), 1U);
    EXPECT_EQ(level_cut({}, 5).size(), 0U);
}

TEST(KernelHierarchy, MistakesHaveASentence) {
    const RbfVolume volume = ball(1);
    const KernelHierarchy h = build_kernel_hierarchy(volume);
    const View view = distant_view(volume, 2);
    const auto refused = [&](const std::string& part, const LevelOptions& options) {
        test::expect_error(ErrorCode::InvalidInput, part, [&] { (void)choose_cut(h, view, options); });
    };
    refused("pixels", {.pixels = -1});
    refused("pixels", {.pixels = std::nan("")});
    refused("error", {.error = -1});
    refused("channel 1", {.channel = 1});
    test::expect_error(ErrorCode::InvalidInput, "other kernels", [&] { (void)choose_level(h, ball(2), view, {.pixels = 5}); });
    RbfVolume wrong = volume;
    wrong.channels[0].values[3] = std::nanf("");
    test::expect_error(ErrorCode::InvalidInput, "point 3", [&] { (void)build_kernel_hierarchy(wrong); });
}

}  // namespace kernel_hierarchy_test
}  // namespace subvol
