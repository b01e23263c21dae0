// SPDX-License-Identifier: Apache-2.0
#include "subvol/render_grid.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <optional>
#include <vector>

#include "subvol/error.h"
#include "subvol/render_field.h"

namespace subvol {
namespace render_grid_test {

// Images are in single precision, all before in double.
constexpr double kFloatTol = 1e-6;

using Place = std::function<std::optional<double>(const Vec3&)>;

/// n³ voxels around the origin, in blocks of 8³ that are empty, constant or mixed, and the field that they represent.
class TestGrid : public Voxels {
public:
    TestGrid(int n, const Mat3& to_world, const Vec3& origin, const Place& field)
        : n_(n), to_world_(to_world), origin_(origin) {
        for (int k = 0; k < n; ++k) {
            for (int j = 0; j < n; ++j) {
                for (int i = 0; i < n; ++i) voxels_.push_back(field(to_world * Vec3(first() + Vec3(i, j, k)) + origin));
            }
        }
    }
    Mat3 to_world() const override { return to_world_; }
    Vec3 origin() const override { return origin_; }
    std::array<Voxel, 2> range() const override {
        const int lower = -n_ / 2, upper = lower + n_ - 1;
        return {Voxel{lower, lower, lower}, Voxel{upper, upper, upper}};
    }
    std::unique_ptr<VoxelCursor> cursor() const override { return std::make_unique<Cursor>(*this); }

    std::optional<double> at(const Voxel& v) const {
        const Voxel c{v[0] + n_ / 2, v[1] + n_ / 2, v[2] + n_ / 2};
        for (const int x : c) {
            if (x < 0 || x >= n_) return std::nullopt;
        }
        return voxels_[static_cast<std::size_t>(c[0] + n_ * (c[1] + n_ * c[2]))];
    }
    /// An independent implementation of the rules in the header.
    std::optional<double> value(const Vec3& world) const {
        const Vec3 x = glm::inverse(to_world_) * (world - origin_);
        const auto voxel = [](const Vec3& v) { return Voxel{int(v.x), int(v.y), int(v.z)}; };
        if (!at(voxel(glm::floor(x + 0.5)))) return std::nullopt;
        double sum = 0, weights = 0;
        for (int k = 0; k < 8; ++k) {
            const Vec3 corner = glm::floor(x) + Vec3(k & 1, k >> 1 & 1, k >> 2);
            const auto v = at(voxel(corner));
            const Vec3 w = 1.0 - glm::abs(x - corner);
            if (v) sum += w.x * w.y * w.z * *v;
            if (v) weights += w.x * w.y * w.z;
        }
        return sum / weights;
    }

private:
    class Cursor : public VoxelCursor {
    public:
        explicit Cursor(const TestGrid& grid) : grid_(grid) {}
        VoxelBlock block(const Voxel& voxel) override {
            const Voxel lower{voxel[0] & ~7, voxel[1] & ~7, voxel[2] & ~7};
            const auto one = grid_.at(lower);
            for (int k = 0; k < 512; ++k) {
                if (grid_.at({lower[0] + k % 8, lower[1] + k / 8 % 8, lower[2] + k / 64}) != one) return {};
            }
            return {one ? VoxelBlock::Kind::Constant : VoxelBlock::Kind::Nothing, lower, 8, one.value_or(0)};
        }
        VoxelCorners corners(const Voxel& lower) override {
            VoxelCorners corners;
            for (int k = 0; k < 8; ++k) {
                const auto v = grid_.at({lower[0] + (k & 1), lower[1] + (k >> 1 & 1), lower[2] + (k >> 2)});
                if (v) corners.active |= 1u << k;
                corners.values[static_cast<std::size_t>(k)] = v.value_or(1e9);
            }
            return corners;
        }

    private:
        const TestGrid& grid_;
    };
    Vec3 first() const { return Vec3(-n_ / 2); }

    int n_;
    Mat3 to_world_;
    Vec3 origin_;
    std::vector<std::optional<double>> voxels_;
};

Optics constant_optics() {
    return {{{{0, {1, 0.5, 0.25}}}, {{0, 0.5}}}, 1.0};
}
Optics ramp_optics() {
    return {{{{0, {1, 0, 0}}, {0.5, {0, 1, 0.2}}, {1, {0.1, 0.3, 1}}}, {{0, 0}, {0.3, 0.1}, {0.35, 0.6}, {1, 0.8}}}, 1.0};
}
Optics smooth_optics() {
    return {{{{0, {0, 0, 0}}, {1, {1, 1, 1}}}, {{0, 0}, {1, 0.9}}}, 1.0};
}

/// Rotated, sheared and translated voxels.
const Mat3 kAxes(Vec3(0.08, 0.03, 0), Vec3(-0.02, 0.09, 0.01), Vec3(0.01, 0, 0.07));
const Vec3 kOrigin(3, -2, 5);

View view_of(int size) {
    return {{.eye = kOrigin + Vec3(2.1, 1.7, 2.9), .target = kOrigin, .up = {0, 1, 0}, .fovy_deg = 35}, size, size};
}

struct Chord {
    double begin = 0, end = 1e300;
};
/// The box of the n³ voxels, which extend half a voxel beyond their centres.
Chord chord_of(const Ray& ray, int n) {
    const Mat3 to_index = glm::inverse(kAxes);
    const Vec3 o = to_index * (ray.origin - kOrigin) + double(n / 2) + 0.5, d = to_index * ray.direction;
    Chord chord;
    for (int k = 0; k < 3; ++k) {
        const double a = -o[k] / d[k], b = (n - o[k]) / d[k];
        chord = {std::max(chord.begin, std::min(a, b)), std::min(chord.end, std::max(a, b))};
    }
    chord.end = std::max(chord.begin, chord.end);
    return chord;
}

void expect_pixel(const Image& image, int x, int y, const Segment& expected, double tolerance) {
    ASSERT_NEAR(image.pixel(x, y)[3], 1 - expected.transmittance, tolerance) << x << ' ' << y;
    for (int c = 0; c < 3; ++c) {
        ASSERT_NEAR(image.pixel(x, y)[static_cast<std::size_t>(c)], expected.color[c], tolerance) << x << ' ' << y;
    }
}

TEST(RenderGrid, ConstantBoxIsBeerLambert) {
    for (const int n : {1, 5, 24}) {  // 24: with blocks of one value
        const TestGrid grid(n, kAxes, kOrigin, [](const Vec3&) { return 1.0; });
        const View view = view_of(48);
        const auto result = render_grid(grid, view, constant_optics());
        for (int y = 0; y < 48; ++y) {
            for (int x = 0; x < 48; ++x) {
                const Ray ray = view.ray(x + 0.5, y + 0.5);
                const Chord chord = chord_of(ray, n);
                const double length = (chord.end - chord.begin) * glm::length(ray.direction);
                expect_pixel(result.image, x, y, constant_optics().integrate(1, 1, length), kFloatTol);
            }
        }
        EXPECT_EQ(result.report.blocks > 0, n == 24);
    }
}

TEST(RenderGrid, LinearFieldIsOneSegment) {
    constexpr int kSize = 10;
    const Vec3 gradient(0.5, 0.3, 0.4);
    const auto linear = [&](const Vec3& p) { return 0.5 + dot(gradient, p - kOrigin); };
    const TestGrid grid(kSize, kAxes, kOrigin, linear);
    const View view = view_of(48);
    const auto result = render_grid(grid, view, ramp_optics());
    const Mat3 to_index = glm::inverse(kAxes);
    int seen = 0;
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 48; ++x) {
            const Ray ray = view.ray(x + 0.5, y + 0.5);
            const Chord chord = chord_of(ray, kSize);
            const auto at = [&](double t) { return ray.origin + t * ray.direction; };
            if (!(chord.begin < chord.end)) continue;
            Chord inner = chord;
            const Vec3 d = to_index * ray.direction, o = to_index * (ray.origin - kOrigin);
            for (int k = 0; k < 3; ++k) {
                const double s = (-kSize / 2 - o[k]) / d[k], e = (kSize - 1 - kSize / 2 - o[k]) / d[k];
                inner = {std::max(inner.begin, std::min(s, e)), std::min(inner.end, std::max(s, e))};
            }
            if (!(inner.begin < inner.end)) continue;
            ++seen;
            // In the rims normalised weights clamp a linear field to the box of centres.
            const auto clamped = [&](double t) {
                const Vec3 c = glm::clamp(to_index * (at(t) - kOrigin), -kSize / 2.0, kSize - 1 - kSize / 2.0);
                return linear(kAxes * c + kOrigin);
            };
            Segment expected;
            std::vector<double> ends{chord.begin, chord.end};
            for (int k = 0; k < 3; ++k) {
                for (const double plane : {-kSize / 2.0, kSize - 1 - kSize / 2.0}) {
                    const double t = (plane - o[k]) / d[k];
                    if (t > chord.begin && t < chord.end) ends.push_back(t);
                }
            }
            std::sort(ends.begin(), ends.end());
            for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
                composite(expected, ramp_optics().integrate(clamped(ends[i]), clamped(ends[i + 1]),
                                                            (ends[i + 1] - ends[i]) * glm::length(ray.direction)));
            }
            expect_pixel(result.image, x, y, expected, kFloatTol);
        }
    }
    EXPECT_GT(seen, 200);
}

/// A ball with a hole, so that there are inactive voxels, with a wavy value.
std::optional<double> shell(const Vec3& p) {
    const double r = glm::length(p - kOrigin);
    if (r > 0.8 || r < 0.3) return std::nullopt;
    return 0.5 + 0.4 * std::sin(5 * p.x + 1) * std::cos(4 * p.y + p.z);
}

TEST(RenderGrid, IsItsOwnFieldMarched) {
    const TestGrid grid(26, kAxes, kOrigin, shell);
    const View view = view_of(24);
    const auto drawn = render_grid(grid, view, smooth_optics(), {.tolerance = 1e-6});
    const auto marched = render_field([&](const Vec3& x) { return grid.value(x); }, {kOrigin - 1.5, kOrigin + 1.5}, view,
                                      smooth_optics(), {.step_world = 2e-4});
    // Marching misses what is thinner than a step at the corners of voxels: 2e-4 · τ of 2.3 at each, of which a ray has
    // several.
    for (std::size_t i = 0; i < drawn.image.rgba.size(); ++i) {
        ASSERT_NEAR(drawn.image.rgba[i], marched.rgba[i], 1e-3) << i / 4;
    }
    EXPECT_GT(drawn.report.rays, 100u);
}

TEST(RenderGrid, SmoothFieldConvergesWithOrderTwo) {
    // The faces of the cube are faces of voxels at every resolution.
    const auto field = [](const Vec3& p) { return 0.5 + 0.4 * std::sin(5 * p.x + 1) * std::cos(4 * p.y + p.z); };
    const View view({.eye = {2.1, 1.7, 2.9}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fovy_deg = 22}, 16, 16);
    const auto in_cube = [&](const Vec3& p) {
        const Vec3 a = glm::abs(p);
        return std::max({a.x, a.y, a.z}) <= 0.5 ? std::optional(field(p)) : std::nullopt;
    };
    const Image exact = render_field(in_cube, {Vec3(-0.5), Vec3(0.5)}, view, smooth_optics(), {.step_world = 1e-3});
    const auto error = [&](int n) {
        const double h = 1.0 / n;
        const TestGrid grid(n, Mat3(h), Vec3(0.5 * h), field);
        const Image image = render_grid(grid, view, smooth_optics(), {.tolerance = 1e-7}).image;
        double sum = 0;
        for (std::size_t i = 0; i < image.rgba.size(); ++i) sum += std::pow(double{image.rgba[i]} - double{exact.rgba[i]}, 2);
        return std::sqrt(sum / static_cast<double>(image.rgba.size()));
    };
    const double coarse = error(8), middle = error(16), fine = error(32);
    EXPECT_NEAR(std::log2(coarse / middle), 2, 0.3);  // the outer half voxels are of a higher order
    EXPECT_NEAR(std::log2(middle / fine), 2, 0.3);
}

TEST(RenderGrid, EyeInsideAndRaysAlongPlanesOfVoxels) {
    const TestGrid grid(9, Mat3(0.1), Vec3(0), [](const Vec3&) { return 1.0; });  // from -.45 to .45
    const View straight({.eye = {0, 0, 3}, .target = {0, 0, 0}, .up = {0, 1, 0}, .ortho_height = 0.85}, 17, 17);  // every .05
    const auto through = render_grid(grid, straight, constant_optics());
    for (int y = 0; y < 17; ++y) {
        for (int x = 0; x < 17; ++x) expect_pixel(through.image, x, y, constant_optics().integrate(1, 1, 0.9), kFloatTol);
    }
    const View within({.eye = {0.1, 0.05, 0}, .target = {1, 0.05, 0}, .up = {0, 0, 1}, .fovy_deg = 10}, 1, 1);
    expect_pixel(render_grid(grid, within, constant_optics()).image, 0, 0, constant_optics().integrate(1, 1, 0.35), kFloatTol);
}

TEST(RenderGrid, ThreadsChangeNoBit) {
    const TestGrid grid(26, kAxes, kOrigin, shell);
    const auto draw = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return render_grid(grid, view_of(50), ramp_optics(), {.samples = 2}).image;
    };
    const Image one = draw(1), two = draw(2);
    EXPECT_EQ(std::memcmp(one.rgba.data(), two.rgba.data(), one.rgba.size() * sizeof(float)), 0);
}

TEST(RenderGrid, RefusesWrongInput) {
    const TestGrid grid(2, kAxes, kOrigin, shell), flat(2, Mat3(0), kOrigin, shell);
    EXPECT_THROW((void)render_grid(grid, view_of(2), constant_optics(), {.samples = 0}), Error);
    EXPECT_THROW((void)render_grid(grid, view_of(2), constant_optics(), {.tolerance = 0}), Error);
    EXPECT_THROW((void)render_grid(flat, view_of(2), constant_optics()), Error);
}

}  // namespace render_grid_test
}  // namespace subvol
