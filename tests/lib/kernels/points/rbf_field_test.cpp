// SPDX-License-Identifier: Apache-2.0
#include "subvol/rbf_field.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <random>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/model.h"
#include "subvol/sample.h"

namespace subvol {
namespace rbf_field_test {

class Random {
public:
    double operator()(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
    Vec3 in_box(double low, double high) { return {(*this)(low, high), (*this)(low, high), (*this)(low, high)}; }
    Vec3 in(const Box& box) {
        return {(*this)(box.lower.x, box.upper.x), (*this)(box.lower.y, box.upper.y), (*this)(box.lower.z, box.upper.z)};
    }

private:
    std::mt19937 random_{5};
};

void add_kernel(RbfVolume& volume, const Vec3& center, const Mat3& axes, double value, const Vec3& gradient, double moment) {
    const Mat3 s = axes * glm::transpose(axes);
    volume.centers.push_back(center);
    volume.frames.push_back({float(s[0][0]), float(s[1][0]), float(s[2][0]), float(s[1][1]), float(s[2][1]), float(s[2][2])});
    if (volume.channels.empty()) volume.channels.resize(1);
    auto& c = volume.channels[0];
    c.values.push_back(float(value));
    c.gradients.push_back({float(gradient.x), float(gradient.y), float(gradient.z)});
    c.moments.push_back(float(moment));
}

/// Kernels in [-1,1]³ whose axes differ by up to 1:10, sizes by 1:100.
RbfVolume random_volume(std::size_t count, double scale = 1) {
    Random random;
    RbfVolume volume;
    for (std::size_t i = 0; i < count; ++i) {
        const double size = scale * .02 * std::pow(100, random(0, 1));
        const Mat3 axes(random.in_box(-1, 1), random.in_box(-1, 1), random.in_box(-1, 1));
        add_kernel(volume, random.in_box(-1, 1), size * (axes + Mat3(.3)), random(-1, 1), random.in_box(-2, 2), random(-1, 1));
    }
    return volume;
}

/// The documented formula, kernel by kernel.
std::optional<double> direct_value(const RbfVolume& volume, const Vec3& x) {
    double sum = 0, weighted = 0;
    const auto& c = volume.channels[0];
    for (std::size_t i = 0; i < volume.size(); ++i) {
        const Mat3 s = matrix(volume.frames[i]);
        const Vec3 d = x - volume.centers[i];
        const double e = glm::dot(d, glm::inverse(s) * d);
        if (!(e < 1)) continue;
        const double w = radial_value(volume.kernel, support_radius(volume.kernel) * std::sqrt(e));
        const auto& g = c.gradients[i];
        sum += w;
        weighted += w * (double(c.values[i]) + g[0] * d.x + g[1] * d.y + g[2] * d.z + double(c.moments[i]) * e);
    }
    return sum > .02 ? std::optional(weighted / sum) : std::nullopt;
}

TEST(RbfField, IsTheSumOverAllKernels) {
    for (const std::size_t count : {1U, 7U, 9U, 64U, 1000U}) {
        const RbfVolume volume = random_volume(count);
        const RbfField field(volume);
        Random random;
        std::size_t inside = 0;
        for (int i = 0; i < 2000; ++i) {
            const Vec3 x = random.in_box(-1.5, 1.5);
            const auto expected = direct_value(volume, x), actual = field.value(x);
            ASSERT_EQ(actual.has_value(), expected.has_value());
            if (!expected) continue;
            ++inside;
            EXPECT_NEAR(*actual, *expected, 1e-9 * (1 + std::abs(*expected)));  // doubles, frames of condition 1e4
        }
        if (count >= 64) {
            EXPECT_GT(inside, 100u);
        }
    }
}

TEST(RbfField, HasNoValueWithoutKernels) {
    RbfVolume volume;
    volume.channels.resize(1);
    EXPECT_FALSE(RbfField(volume).value(Vec3(0)).has_value());
    EXPECT_FALSE(RbfField(random_volume(100)).value(Vec3(9)).has_value());
    EXPECT_TRUE(std::isnan(RbfField(random_volume(100)).evaluate(std::vector{Vec3(9)})[0]));
}

/// Overlapping kernels on a lattice with the values and derivatives of a quadratic.
RbfVolume lattice(double v, const Vec3& g, double q) {
    RbfVolume volume;
    for (int i = 0; i < 216; ++i) {
        const Vec3 x(i % 6, i / 6 % 6, i / 36);
        const double r = 1.5;
        add_kernel(volume, x, Mat3(r), v + glm::dot(g, x) + q * glm::dot(x, x), g + 2 * q * x, q * r * r);
    }
    return volume;
}

TEST(RbfField, ReproducesTheQuadraticOfEachKernel) {
    constexpr double kFloat = 2e-6;  // values up to 30, stored as floats
    struct Case {
        double v;
        Vec3 g;
        double q;
    };
    for (const auto& [v, g, q] : {Case{.7, Vec3(0), 0}, Case{.7, Vec3(.5, -1, .3), 0}, Case{-.2, Vec3(.5, -1, .3), .2}}) {
        const RbfField field(lattice(v, g, q));
        Random random;
        for (int i = 0; i < 500; ++i) {
            const Vec3 x = random.in_box(0, 5);
            const double expected = v + glm::dot(g, x) + q * glm::dot(x, x);
            EXPECT_NEAR(field.value(x).value(), expected, kFloat * (1 + std::abs(expected)));
            const Vec3 slope = field.value_and_gradient(x).value().gradient;
            EXPECT_LT(glm::length(slope - (g + 2 * q * x)), 2e-5);  // floats again, over a distance of .3
        }
    }
}

TEST(RbfField, GradientsAreThoseOfTheValue) {
    for (const Kernel& kernel : {Kernel{CompactKernel{}}}) {
        RbfVolume volume = random_volume(300, 3);
        volume.kernel = kernel;
        const RbfField field(volume);
        Random random;
        for (int i = 0; i < 300; ++i) {
            const Vec3 x = random.in_box(-1, 1);
            const auto jet = field.value_and_gradient(x);
            ASSERT_EQ(jet.has_value(), field.value(x).has_value());
            if (!jet) continue;
            EXPECT_EQ(jet->value, *field.value(x));
            constexpr double kStep = 1e-6;
            for (int a = 0; a < 3; ++a) {
                Vec3 h(0);
                h[a] = kStep;
                const auto high = field.value(x + h), low = field.value(x - h);
                if (!high || !low) continue;
                // Differences: rounding 1e-16/h, and the third derivative of kernels down to .01 thick times h².
                EXPECT_NEAR(jet->gradient[a], (*high - *low) / (2 * kStep), 1e-5 * (1 + glm::length(jet->gradient)));
            }
        }
    }
}

TEST(RbfField, FollowsItsMeshAtAnySizeOfCells) {
    // A mesh whose edges differ by 1:1000 along x: kernels of very different sizes overlap.
    HexMesh mesh = test::make_box(12, 3, 3);
    for (auto& p : mesh.points) p = Vec3(.001 * std::pow(1.8, p.x), p.y, p.z);
    test::add_field(mesh, "f", [](const Vec3& p) { return .5 + .2 * p.x - p.y + .3 * p.z; });
    const auto volume = sample_rbf_points(mesh).volume;
    const RbfField field(volume);
    Random random;
    for (int i = 0; i < 500; ++i) {
        const Vec3 x = random.in(volume.bounds);
        EXPECT_NEAR(field.value(x).value(), .5 + .2 * x.x - x.y + .3 * x.z, 1e-5);  // linear fields are exact, in floats
    }
}

TEST(RbfField, AnyNumberOfThreadsGivesTheSameBits) {
    const RbfVolume volume = sample_rbf_points(make_model("ball", 8)).volume;
    Random random;
    std::vector<Vec3> points(20000);
    for (auto& x : points) x = random.in(volume.bounds);
    const auto many = RbfField(volume).evaluate(points);
    tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const auto single = RbfField(volume).evaluate(points);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (std::isnan(single[i]))
            EXPECT_TRUE(std::isnan(many[i]));
        else
            EXPECT_EQ(single[i], many[i]);
    }
}

TEST(RbfField, RefusesInvalidVolumes) {
    const auto refuse = [](const std::string& part, const RbfVolume& volume, const RbfFieldOptions& options = {}) {
        test::expect_error(ErrorCode::InvalidInput, part, [&] { RbfField field(volume, options); });
    };
    const RbfVolume good = random_volume(5);
    refuse("no channel 1", good, {.channel = 1});
    refuse("least weight", good, {.least_weight = -1});
    RbfVolume bad = good;
    bad.frames.pop_back();
    refuse("number of frames", bad);
    bad = good;
    bad.channels[0].values[3] = NAN;
    refuse("point 3", bad);
    bad = good;
    bad.channels[0].hessians.resize(4);
    refuse("does not have one Hessian per point", bad);
    for (const Symmetric3& frame :
         {Symmetric3{1, 2, 0, 1, 0, 1}, Symmetric3{1, 0, 0, 1, 1.001f, 1}, Symmetric3{1, -.6f, -.6f, 1, -.6f, 1},
          Symmetric3{1e-8f, 0, 2, 1, 0, 1e8f}, Symmetric3{1, 0, 0, -1, 0, 1}, Symmetric3{0, 0, 0, 0, 0, 0}}) {
        bad = good;
        bad.frames[2] = frame;
        refuse("point 2: the frame is not positive definite", bad);
    }
    bad = good;
    bad.kernel = CubicConvolutionKernel{};
    refuse("not radial", bad);
}

TEST(RbfField, TakesFlatFramesThatRoundingMadeIndefinite) {
    // Discs and needles without any thickness, in all directions and of any size: floats cannot tell them from indefinite ones.
    Random random;
    const Box directions{Vec3(-1), Vec3(1)};
    std::size_t indefinite = 0;
    RbfVolume volume = random_volume(200);
    for (std::size_t i = 0; i < volume.size(); ++i) {
        const double size = std::pow(10, double(i % 17) - 8);
        const Vec3 u = random.in(directions), v = i % 2 == 0 ? random.in(directions) : Vec3(0.0);
        volume.frames[i] = symmetric3(size * (glm::outerProduct(u, u) + glm::outerProduct(v, v)));
        indefinite += glm::determinant(matrix(volume.frames[i])) < 0 ? 1 : 0;
    }
    EXPECT_GT(indefinite, 50u);
    EXPECT_NO_THROW(validate(volume));
}

}  // namespace rbf_field_test
}  // namespace subvol
