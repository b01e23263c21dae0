// SPDX-License-Identifier: Apache-2.0
// Sums in fixed point: the picture has the same bits for any order of the kernels, however they are divided, and is that of
// floats.
#include "fixed_sums.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <barrier>
#include <numeric>
#include <random>
#include <thread>

#include "splat_scenes.h"
#include "subvol/detail/points_range.h"
#include "subvol/error.h"
#include "subvol/splat.h"
#include "subvol/splat_shares.h"

namespace subvol::test {
namespace fixed_sums_test {

View view() {
    return {perspective_camera(), 100, 130};
}

RbfVolume waves(Correction correction = Correction::Second) {
    return sample_rbf_points(with_waves(nested_ball(4)), {.correction = correction}).volume;
}

std::vector<SplatOptions> kinds() {
    return {{.method = SplatMethod::Cpu, .sheets = 75},
            {.method = SplatMethod::Cpu, .samples = 2, .sheets = 75, .color_channel = 1, .shading = Shading{}},
            {.method = SplatMethod::Cpu, .sheets = 75, .normalized = false, .clip = {.planes = {{{}, {1, 0, 0}}}}}};
}

SplatResult draw(const RbfVolume& volume, const SplatOptions& options, const FixedSums& sums = {}) {
    Splatter splatter(volume, options);
    splatter.set_fixed_sums(sums);
    return splatter.draw(view(), smooth_optics());
}

/// Processes as threads that give each other what they send.
struct Post {
    explicit Post(std::size_t count) : all(count), bounds(count), meet(static_cast<std::ptrdiff_t>(count)) {}
    std::vector<std::vector<std::string>> all;
    std::vector<SumBounds> bounds;
    std::barrier<> meet;

    SumBounds join(std::size_t own, const SumBounds& of) {
        bounds[own] = of;
        meet.arrive_and_wait();
        SumBounds sum;
        for (const SumBounds& more : bounds) sum.add(more);
        meet.arrive_and_wait();
        return sum;
    }
    std::vector<std::string> exchange(std::size_t own, std::vector<std::string> to) {
        all[own] = std::move(to);
        meet.arrive_and_wait();
        std::vector<std::string> got;
        for (const auto& from : all) got.push_back(from[own]);
        meet.arrive_and_wait();
        return got;
    }
};

TEST(FixedSums, BitsDoNotDependOnTheOrderOfKernelsAndThreads) {
    for (const Correction correction : {Correction::Second, Correction::Full}) {
        const RbfVolume volume = waves(correction);
        std::vector<std::size_t> order(volume.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::shuffle(order.begin(), order.end(), std::mt19937(7));
        RbfVolume shuffled = detail::chosen_kernels(volume, order);
        shuffled.boundary = volume.boundary;
        for (const SplatOptions& options : kinds()) {
            const SplatResult one = draw(volume, options);
            const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
            const SplatResult other = draw(shuffled, options);
            EXPECT_EQ(one.image.rgba, other.image.rgba);
            EXPECT_EQ(one.depth, other.depth);
        }
    }
}

TEST(FixedSums, ThePictureIsThatOfFloats) {
    // Floats round each sum to 6e-8 of it, sums in fixed point to much less: what differs is the rounding of floats.
    constexpr float kRounding = 1e-4f;
    const RbfVolume volume = waves();
    for (const SplatOptions& options : kinds()) {
        const SplatResult fixed = draw(volume, options), floats = render_splats(volume, view(), smooth_optics(), options);
        float most = 0, seen = 0;
        for (std::size_t i = 0; i < fixed.image.rgba.size(); ++i) {
            most = std::max(most, std::abs(fixed.image.rgba[i] - floats.image.rgba[i]));
            seen = std::max(seen, floats.image.rgba[i]);
        }
        EXPECT_LT(most, kRounding);
        EXPECT_GT(seen, 0.1f);
    }
}

TEST(FixedSums, ProcessesDrawTheBitsOfOne) {
    const RbfVolume volume = waves();
    for (const SplatOptions& options : kinds()) {
        const SplatResult one = draw(volume, options);
        for (const std::size_t count : {2U, 3U, 7U}) {
            Post post(count);
            std::vector<SplatResult> drawn(count);
            std::vector<int> splits;
            for (std::size_t i = 0; i < count; ++i) splits.push_back(std::min(static_cast<int>(i) * kBandRows, 130));
            splits.push_back(130);
            std::vector<std::thread> processes;
            for (std::size_t own = 0; own < count; ++own) {
                processes.emplace_back([&, own] {
                    std::vector<std::size_t> some;  // every count-th kernel; the last process has none
                    for (std::size_t i = own; i < volume.size() && own + 1 < count; i += count - 1) some.push_back(i);
                    RbfVolume part = detail::chosen_kernels(volume, some);
                    part.boundary = volume.boundary;
                    drawn[own] = draw(part, options,
                                      {.splits = splits,
                                       .own = own,
                                       .join = [&](const SumBounds& of) { return post.join(own, of); },
                                       .exchange = [&](auto to) { return post.exchange(own, std::move(to)); }});
                });
            }
            for (std::thread& process : processes) process.join();
            for (std::size_t own = 0; own < count; ++own) {
                for (int y = splits[own]; y < splits[own + 1]; ++y) {
                    for (int x = 0; x < 100; ++x) {
                        ASSERT_TRUE(std::ranges::equal(drawn[own].image.pixel(x, y), one.image.pixel(x, y)))
                            << count << ": " << x << "," << y;
                    }
                }
            }
        }
    }
}

TEST(FixedSums, RefusesWhatItCannotHold) {
    RbfVolume volume = waves();
    EXPECT_THROW((void)draw(volume, {.method = SplatMethod::Cpu, .shadows = true}), Error);
    EXPECT_THROW((void)draw(volume, {.method = SplatMethod::Cpu, .sheets = 5000}), Error);
    EXPECT_THROW((void)draw(volume, kinds()[0], {.join = [](SumBounds all) { return all.value = 1e17, all; }}), Error);
    volume.boundary = {};
    EXPECT_THROW((void)draw(volume, {.method = SplatMethod::Cpu}), Error);
}

TEST(FixedSums, NoSumOfAllKernelsOverflows) {
    const RbfVolume volume = waves();
    const detail::SplatScene scene = detail::make_scene(volume, kinds()[0]);
    for (const std::uint64_t kernels : {std::uint64_t{1}, std::uint64_t{1000}, std::uint64_t{1} << 30}) {
        const detail::FixedScale scale = detail::scale_of_sums(scene, {.kernels = kernels, .value = 5000});
        for (const std::size_t kind : {0U, 1U}) {
            const double term = static_cast<double>(scale.most[kind]) * scale.per_unit[kind];
            EXPECT_LE(term, 0x1p51);
            EXPECT_LE(term * static_cast<double>(kernels), 0x1p62);
        }
    }
}

}  // namespace fixed_sums_test
}  // namespace subvol::test
