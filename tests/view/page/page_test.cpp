// SPDX-License-Identifier: Apache-2.0
#include "subvol/page.h"

#include <gtest/gtest.h>

#include <cmath>

#include "page_arrays.h"
#include "page_kernels.h"
#include "subvol/error.h"
#include "subvol/rbf_field.h"

namespace subvol::test {

namespace page_test {

using namespace detail;

double quadratic(const Vec3& x) {
    return 1 + x.x - 2 * x.y + 0.3 * x.z + 0.4 * x.x * x.x - 0.2 * x.y * x.y + 0.5 * x.x * x.z;
}

/// Kernels of a quadratic field on a grid of n³ places in [0,1]³.
RbfVolume grid(int n) {
    RbfVolume volume;
    const double h = 1.0 / (n - 1), radius = support_radius(volume.kernel);
    RbfChannel channel{.name = "f"};
    for (int k = 0; k < n * n * n; ++k) {
        const Vec3 x = h * Vec3(k % n, k / n % n, k / (n * n));
        volume.centers.push_back(x);
        const double s = radius * radius * h * h;
        volume.frames.push_back(symmetric3(Mat3(s)));
        channel.values.push_back(static_cast<float>(quadratic(x)));
        const Vec3 g(1 + 0.8 * x.x + 0.5 * x.z, -2 - 0.4 * x.y, 0.3 + 0.5 * x.x);
        channel.gradients.push_back({static_cast<float>(g.x), static_cast<float>(g.y), static_cast<float>(g.z)});
        channel.moments.push_back(static_cast<float>(s * (0.8 - 0.4) / 6));
        volume.bounds.add(x);
    }
    volume.channels.push_back(channel);
    return volume;
}

double rmse(const RbfVolume& volume) {
    const RbfField field(volume);
    double sum = 0;
    int count = 0;
    for (double x = 0.22; x < 0.8; x += 0.07) {
        for (double y = 0.21; y < 0.8; y += 0.083) {
            for (double z = 0.2; z < 0.8; z += 0.091) {
                const auto value = field.value({x, y, z});
                EXPECT_TRUE(value);
                sum += std::pow(value.value_or(99) - quadratic({x, y, z}), 2);
                ++count;
            }
        }
    }
    return std::sqrt(sum / count);
}

TEST(Page, MergedKernelsKeepAQuadraticField) {
    const RbfVolume all = grid(16);
    const RbfVolume eighth = merged_kernels(all, all.size() / 8);
    EXPECT_EQ(eighth.size(), all.size() / 8);
    // As kernels that were sampled at twice the distance: second-order kernels leave a ripple of the mixed derivative alone.
    EXPECT_LT(rmse(eighth), 2 * rmse(grid(8)) + 1e-4);
    EXPECT_LT(rmse(eighth), 0.01);
    const RbfVolume same = merged_kernels(all, all.size());
    EXPECT_NEAR(rmse(same), rmse(all), 1e-6);
}

TEST(Page, KernelsComeBackFromTheirNumbers) {
    const RbfVolume all = grid(5);
    const RbfVolume back = kernels_of_numbers(place_numbers(all), value_numbers(all, all.channels.front()), all.kernel);
    for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_NEAR(back.frames[i][0], all.frames[i][0], 1e-6F);
        for (std::size_t a = 0; a < 3; ++a) {
            EXPECT_NEAR(back.channels[0].gradients[i][a], all.channels[0].gradients[i][a], 1e-5F);
        }
    }
}

TEST(Page, RoundingIsHalfAStepAtMost) {
    std::vector<double> values;
    for (int i = 0; i < 999; ++i) values.push_back(std::sin(0.1 * i));
    std::vector<double> rounded = values;
    PageArrays arrays;
    EXPECT_EQ(arrays.add(rounded, 1, 12), 0);
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(rounded[i], values[i], 0.5 * 2 / 4095 + 1e-12);
    std::vector<double> fine = values;
    EXPECT_EQ(arrays.add(fine, 1, 21), 1);
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(fine[i], values[i], 0.5 * 2 / 2097151 + 1e-12);
    std::vector<double> constant(7, 3.5);
    EXPECT_EQ(arrays.add(constant, 1, 16), 2);
    EXPECT_EQ(constant[6], 3.5);
}

TEST(Page, RefusesWhatItCannotDraw) {
    PageStep step{.volume = grid(3)};
    const PageField field{.name = "f", .function = transfer_function_preset("viridis", 0, 1)};
    const auto refused = [&](const char* words, const PageOptions& options) {
        try {
            (void)make_page(std::span(&step, 1), options);
            ADD_FAILURE() << words;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::InvalidInput);
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
        }
    };
    refused("no field", {});
    refused("1 channels", {.fields = {field, field}});
    step.boundary.values.resize(1);
    refused("no boundary", {.fields = {field}});
    refused("fog has no look Solid", {.fields = {field}, .solid = false});
}

}  // namespace page_test

}  // namespace subvol::test
