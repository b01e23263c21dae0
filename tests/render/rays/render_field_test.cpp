// SPDX-License-Identifier: Apache-2.0
#include "subvol/render_field.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>

#include "subvol/error.h"

namespace subvol {
namespace render_field_test {

Optics constant_optics() {
    return {{{{0, {1, 0.5, 0.25}}}, {{0, 0.5}}}, 1.0};
}

// Opacity rises with the value, without a kink inside [0,1], so that the order of convergence can be measured.
Optics smooth_optics() {
    return {{{{0, {0, 0, 0}}, {1, {1, 1, 1}}}, {{0, 0}, {1, 0.9}}}, 1.0};
}

Box unit_ball_box() {
    return {Vec3(-1), Vec3(1)};
}

std::optional<double> ball(const Vec3& p) {
    return dot(p, p) <= 1 ? std::optional(1.0) : std::nullopt;
}

View perspective(int size) {
    return {{.eye = {1.5, 2, 3}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fovy_deg = 35}, size, size};
}

// Half the chord of a ray in the unit ball; 0 if it misses.
double half_chord(const Ray& ray) {
    const Vec3 d = glm::normalize(ray.direction);
    return std::sqrt(std::max(0.0, 1 - dot(ray.origin, ray.origin) + std::pow(dot(ray.origin, d), 2)));
}

TEST(RenderField, ConstantBallIsClosedForm) {
    constexpr double kStep = 0.03;
    const View view = perspective(48);
    const Image image = render_field(ball, unit_ball_box(), view, constant_optics(), {.step_world = kStep});
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 48; ++x) {
            const double chord = 2 * half_chord(view.ray(x + 0.5, y + 0.5));
            if (chord > 0 && chord < kStep) continue;  // thinner than a step: may be missed
            const double alpha = -std::expm1(-std::log(2.0) * chord);
            ASSERT_NEAR(image.pixel(x, y)[3], alpha, 1e-6) << x << ' ' << y;  // single precision
            ASSERT_NEAR(image.pixel(x, y)[1], 0.5 * alpha, 1e-6);
        }
    }
}

TEST(RenderField, EyeInsideSeesWhatIsInFront) {
    const View view({.eye = {0.2, 0.1, 0}, .target = {1, 0.1, 0}, .up = {0, 0, 1}, .fovy_deg = 60}, 3, 3);
    const Image image = render_field(ball, unit_ball_box(), view, constant_optics(), {.step_world = 0.01});
    const double chord = std::sqrt(1 - 0.01) - 0.2;
    EXPECT_NEAR(image.pixel(1, 1)[3], -std::expm1(-std::log(2.0) * chord), 1e-6);
}

TEST(RenderField, SmoothFieldConvergesWithOrderTwo) {
    const auto smooth = [](const Vec3& p) {
        return std::optional(0.5 + 0.4 * std::sin(3 * p.x + 1) * std::cos(2 * p.y + p.z));
    };
    const View view = perspective(12);
    const auto draw = [&](double step) {
        return render_field(smooth, unit_ball_box(), view, smooth_optics(), {.step_world = step});
    };
    const Image exact = draw(0.002);
    const auto error = [&](double step) {
        const Image image = draw(step);
        double sum = 0;
        for (std::size_t i = 0; i < image.rgba.size(); ++i) sum += std::abs(double{image.rgba[i]} - double{exact.rgba[i]});
        return sum;
    };
    const double coarse = error(0.4), middle = error(0.2), fine = error(0.1);
    EXPECT_NEAR(std::log2(coarse / middle), 2, 0.3);  // the number of steps is rounded up, by up to a sixth here
    EXPECT_NEAR(std::log2(middle / fine), 2, 0.3);
}

TEST(RenderField, LinearFieldNeedsNoSteps) {
    const Vec3 gradient(0.1, 0.2, 0.15);
    const auto linear = [&](const Vec3& p) { return std::optional(0.5 + dot(gradient, p)); };
    const View view = perspective(16);
    const Image one = render_field(linear, unit_ball_box(), view, smooth_optics(), {.step_world = 100});
    const Image many = render_field(linear, unit_ball_box(), view, smooth_optics(), {.step_world = 0.01});
    for (std::size_t i = 0; i < one.rgba.size(); ++i) ASSERT_NEAR(one.rgba[i], many.rgba[i], 1e-6);
}

TEST(RenderField, ShellIsLeftAndEnteredAgain) {
    const auto shell = [](const Vec3& p) {
        const double r = glm::length(p);
        return r <= 1 && r >= 0.6 ? std::optional(1.0) : std::nullopt;
    };
    const View view({.eye = {0, 0, 4}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fovy_deg = 40}, 1, 1);
    const Image image = render_field(shell, unit_ball_box(), view, constant_optics(), {.step_world = 0.05});
    EXPECT_NEAR(image.pixel(0, 0)[3], -std::expm1(-std::log(2.0) * 0.8), 1e-6);
}

TEST(RenderField, ThreadsChangeNoBit) {
    const auto draw = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return render_field(ball, unit_ball_box(), perspective(50), constant_optics(), {.step_world = 0.1, .samples = 2});
    };
    const Image one = draw(1), two = draw(2);
    EXPECT_EQ(std::memcmp(one.rgba.data(), two.rgba.data(), one.rgba.size() * sizeof(float)), 0);
}

TEST(RenderField, NothingInAnEmptyBox) {
    const Image image = render_field(ball, Box{}, perspective(8), constant_optics());
    for (const float value : image.rgba) ASSERT_EQ(value, 0.0f);
}

TEST(RenderField, RefusesWrongOptions) {
    EXPECT_THROW((void)render_field(ball, unit_ball_box(), perspective(2), constant_optics(), {.step_world = 0}), Error);
    EXPECT_THROW((void)render_field(ball, unit_ball_box(), perspective(2), constant_optics(), {.step_world = std::nan("")}),
                 Error);
    EXPECT_THROW((void)render_field(ball, unit_ball_box(), perspective(2), constant_optics(), {.samples = 0}), Error);
}

}  // namespace render_field_test
}  // namespace subvol
