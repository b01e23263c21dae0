// SPDX-License-Identifier: Apache-2.0
// Slab, ramp, ball and Gaussian: every reference renderer against the closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lib/test_meshes.h"
#include "reference_methods.h"
#include "render/boundary_length.h"
#include "subvol/limit.h"

namespace subvol {

using namespace detail;
namespace reference_closed_form_test {

using test::Reference;

// The requirement, in linear light. All but the image and projected tetrahedra is in double precision.
constexpr double kTol = 1e-5;
const Vec3 kFront(0.9, 0.5, 0.1), kBack(0.2, 0.4, 0.8);

/// Extinction `most` · value on [0,1], up to the error of a linear α between knots, D·most²/(8·knots²) = 3e-7; colours from
/// kFront at 0 to kBack at 1.
Optics linear_extinction(double most) {
    constexpr double kUnit = 0.005;
    constexpr int kKnots = 200;
    TransferFunction function{.color = {{0, kFront}, {1, kBack}}, .opacity = {}};
    for (int i = 0; i <= kKnots; ++i) {
        const double value = double(i) / kKnots;
        function.opacity.push_back({value, -std::expm1(-kUnit * most * value)});
    }
    return {function, kUnit};
}

Optics white_linear_extinction() {
    const Optics colored = linear_extinction(1);
    return {{.color = {{0, {1, 1, 1}}}, .opacity = colored.function().opacity}, colored.opacity_unit()};
}

/// Extinction ln 2, whatever the value.
Optics constant_optics() {
    return {{.color = {{0, kFront}}, .opacity = {{0, 0.5}}}, 1.0};
}

Segment constant_light(double length) {
    return {-std::expm1(-length * std::numbers::ln2) * kFront, std::pow(0.5, length)};
}

/// ∫₀ˣ exp(t²) dt, by its power series.
double exp_square_integral(double x) {
    double sum = 0, power = x;
    for (int n = 0; n < 200; ++n) {
        sum += power / (2 * n + 1);
        power *= x * x / (n + 1);
    }
    return sum;
}

/// A stretch on which extinction and colour are linear from front to back [wms1998].
Segment linear_stretch(double front, double back, const Vec3& front_color, const Vec3& back_color, double length) {
    if (!(length > 0)) return {};
    const double zeta = std::exp(-length * (front + back) / 2), k = (back - front) / length;
    double psi;
    if (std::abs(k) * length * length < 1e-9) {
        const double depth = length * (front + back) / 2;
        psi = depth > 1e-9 ? -std::expm1(-depth) / depth : 1;
    } else if (k > 0) {
        const double s = std::sqrt(2 * k);
        psi = std::sqrt(std::numbers::pi) / (s * length) * std::exp(front * front / (s * s)) *
              (std::erf(back / s) - std::erf(front / s));
    } else {
        const double s = std::sqrt(-2 * k);
        psi = 2 / (s * length) * std::exp(-front * front / (s * s)) *
              (exp_square_integral(front / s) - exp_square_integral(back / s));
    }
    return {front_color * (1 - psi) + back_color * (psi - zeta), zeta};
}

/// The expected light of each pixel's ray.
template <class Expected>
Image picture(const View& view, const Expected& expected) {
    Image image(view.width(), view.height());
    for (int y = 0; y < view.height(); ++y) {
        for (int x = 0; x < view.width(); ++x) {
            const Segment light = expected(view.ray(x + 0.5, y + 0.5));
            const Vec3 c = light.color;
            const double rgba[]{c.r, c.g, c.b, 1 - light.transmittance};
            for (std::size_t k = 0; k < 4; ++k) image.pixel(x, y)[k] = static_cast<float>(rgba[k]);
        }
    }
    return image;
}

class ClosedForm : public testing::TestWithParam<Reference> {
protected:
    void SetUp() override {
        if (test::needs_gl(GetParam()) && gl_devices().empty()) GTEST_SKIP() << "no OpenGL 4.5 through EGL";
    }
    template <class Expected>
    void expect_light(const Image& image, const View& view, const Expected& expected) {
        const double error = test::largest_difference(image, picture(view, expected));
        largest_ = std::max(largest_, error);
        RecordProperty("largest_1e9", std::to_string(1e9 * largest_));
        EXPECT_LT(error, kTol);
    }
    [[nodiscard]] static Image draw(const Box& box, int cells, const std::function<double(const Vec3&)>& field,
                                    const View& view, const Optics& optics, double jitter = 0.25, int levels = 1) {
        return test::draw(GetParam(), box, cells, jitter, field, view, optics, levels);
    }

private:
    double largest_ = 0;
};

// So wide that no ray of these views leaves it through a side.
constexpr int kSlabCells = 6;
Box slab() {
    return {Vec3(-4, -4, 0), Vec3(4, 4, 1)};
}
std::vector<View> slab_views() {
    return {{{.eye = {0.5, -2, 3}, .target = {0.3, 0.2, 0.5}, .up = {0, 0, 1}, .fovy_deg = 25}, 40, 32},
            {{.eye = {0.2, -1, -2.5}, .target = {0.4, 0.1, 0.5}, .up = {0, 0, 1}, .fovy_deg = 40}, 31, 33},
            {{.eye = {1, 1, 4}, .target = {-0.1, 0.3, 0}, .up = {0, 1, 0}, .ortho_height = 1.5}, 32, 32}};
}

Segment slab_light(const Ray& ray) {
    return constant_light(glm::length(ray.direction) / std::abs(ray.direction.z));
}

/// The value is z, except in a rim on either side, where it is constant.
Segment ramp_light(const Ray& ray, double most, double rim) {
    const double slant = glm::length(ray.direction) / std::abs(ray.direction.z);
    const double front = ray.direction.z > 0 ? rim : 1 - rim, back = 1 - front;
    const auto stretch = [&](double a, double b, double length) {
        return linear_stretch(most * a, most * b, glm::mix(kFront, kBack, a), glm::mix(kFront, kBack, b), length * slant);
    };
    Segment light = stretch(front, front, rim);
    composite(light, stretch(front, back, 1 - 2 * rim));
    composite(light, stretch(back, back, rim));
    return light;
}

TEST_P(ClosedForm, SlabHasTheLengthOfItsSlant) {
    for (const View& view : slab_views()) {
        const Image image = draw(
            slab(), kSlabCells, [](const Vec3&) { return 1.0; }, view, constant_optics());
        expect_light(image, view, slab_light);
    }
}

TEST_P(ClosedForm, RampIsPsi) {
    constexpr double kMost = 3;
    const Optics optics = linear_extinction(kMost);
    // Beyond the centres of the outermost voxels the value is constant.
    const double rim = GetParam() == Reference::Voxels ? 0.5 / kSlabCells : 0;
    for (const View& view : slab_views()) {
        const Image image = draw(
            slab(), kSlabCells, [](const Vec3& p) { return p.z; }, view, optics);
        expect_light(image, view, [&](const Ray& ray) { return ramp_light(ray, kMost, rim); });
    }
}

/// Light of a Gaussian with a peak extinction of 1 in the cube [-1,1]³, white, seen by a ray from outside.
Segment gaussian_light(const Ray& ray, double sigma) {
    double begin = -1e300, end = 1e300;
    const Vec3 d = glm::normalize(ray.direction);
    for (int k = 0; k < 3; ++k) {
        const double a = (-1 - ray.origin[k]) / d[k], b = (1 - ray.origin[k]) / d[k];
        begin = std::max(begin, std::min(a, b));
        end = std::min(end, std::max(a, b));
    }
    if (!(begin < end)) return {};
    const double nearest = -dot(ray.origin, d), b2 = dot(ray.origin, ray.origin) - nearest * nearest;
    const auto part = [&](double t) { return std::erf((t - nearest) / (sigma * std::numbers::sqrt2)); };
    const double depth =
        std::exp(-b2 / (2 * sigma * sigma)) * sigma * std::sqrt(std::numbers::pi / 2) * (part(end) - part(begin));
    return {Vec3(-std::expm1(-depth)), std::exp(-depth)};
}

std::function<double(const Vec3&)> gaussian(double sigma) {
    return [sigma](const Vec3& p) { return std::exp(-dot(p, p) / (2 * sigma * sigma)); };
}

TEST_P(ClosedForm, GaussianAlongLatticeLinesIsTheTrapezoidalRule) {
    // The sum over a lattice is exact to exp(−2π²σ²/h²) for a Gaussian, so a ray through lattice points sees the closed form.
    // The part of the tails outside is 6e-7.
    constexpr double kSigma = 0.2;
    constexpr int kCells = 16, kSize = 15;
    const Optics optics = white_linear_extinction();
    const View view({.eye = {0, 0, 5}, .target = {0, 0, 0}, .up = {0, 1, 0}, .ortho_height = 2.0 * kSize / kCells}, kSize,
                    kSize);
    const bool voxels = GetParam() == Reference::Voxels;  // their centres are the lattice
    const Box box{Vec3(voxels ? -1 - 1.0 / kCells : -1), Vec3(voxels ? 1 + 1.0 / kCells : 1)};
    const Image image = draw(box, voxels ? kCells + 1 : kCells, gaussian(kSigma), view, optics, 0);
    expect_light(image, view, [&](const Ray& ray) { return gaussian_light(ray, kSigma); });
}

TEST_P(ClosedForm, GaussianIsOfSecondOrderAndExtrapolatesToTheClosedForm) {
    // Beyond the outermost centres voxels have no value: there the field has fallen to e⁻⁹.
    const bool voxels = GetParam() == Reference::Voxels;
    const double sigma = voxels ? 0.25 : 1;
    const int coarsest = voxels ? 32 : 10;
    const View view({.eye = {2.1, 1.7, 2.9}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fovy_deg = 25}, 48, 48);
    const auto drawn = [&](int cells) {
        return draw({Vec3(-1), Vec3(1)}, cells, gaussian(sigma), view, white_linear_extinction(), 0);
    };
    const Image coarse = drawn(coarsest), middle = drawn(2 * coarsest), fine = drawn(4 * coarsest);
    const Image exact = picture(view, [&](const Ray& ray) { return gaussian_light(ray, sigma); });
    Image extrapolated = fine;
    for (std::size_t i = 0; i < extrapolated.rgba.size(); ++i) {
        extrapolated.rgba[i] += (fine.rgba[i] - middle.rgba[i]) / 3;
    }
    RecordProperty("rms_coarse_1e9", std::to_string(1e9 * test::rmse(coarse, exact)));
    RecordProperty("rms_fine_1e9", std::to_string(1e9 * test::rmse(fine, exact)));
    RecordProperty("rms_extrapolated_1e9", std::to_string(1e9 * test::rmse(extrapolated, exact)));
    EXPECT_NEAR(std::log2(test::rmse(coarse, exact) / test::rmse(fine, exact)) / 2, 2, 0.2);
    EXPECT_LT(test::rmse(extrapolated, exact), kTol);
}

constexpr int kBallLevel = 1;  // of dense grids

test::VoxelBox voxel_ball(int n) {
    return {{Vec3(-1), Vec3(1)}, n, [](const Vec3& p) { return dot(p, p) <= 1 ? std::optional(1.0) : std::nullopt; }};
}

/// The ball made of n³ cells or voxels.
Image draw_ball(Reference reference, int n, const View& view, const Optics& optics) {
    if (reference == Reference::Voxels) return render_grid(voxel_ball(n), view, optics).image;
    const HexMesh mesh = test::ball(static_cast<Index>(n));
    return test::draw(reference, mesh, std::vector<double>(mesh.points.size(), 1.0), view, optics, kBallLevel);
}

/// The length of a ray in active voxels, summed from plane to plane.
double length_in_voxels(const test::VoxelBox& grid, const Ray& ray) {
    std::vector<double> cuts;
    for (int k = 0; k < 3; ++k) {
        for (int i = 0; i <= grid.count(); ++i) {
            cuts.push_back((grid.lower()[k] + i * grid.step()[k] - ray.origin[k]) / ray.direction[k]);
        }
    }
    std::sort(cuts.begin(), cuts.end());
    double length = 0;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        const double middle = (cuts[i] + cuts[i + 1]) / 2;
        if (grid.at(grid.voxel_at(ray.origin + middle * ray.direction))) length += cuts[i + 1] - cuts[i];
    }
    return length * glm::length(ray.direction);
}

View ball_view() {
    return {{.eye = {0.3, 1.1, 5}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fovy_deg = 26}, 48, 48};
}

TEST_P(ClosedForm, BallHasTheChordsOfItsOwnFaces) {
    constexpr int kCells = 8;
    const Image image = draw_ball(GetParam(), kCells, ball_view(), constant_optics());
    std::function<double(const Ray&)> length;
    if (GetParam() == Reference::Voxels) {
        length = [grid = voxel_ball(kCells)](const Ray& ray) { return length_in_voxels(grid, ray); };
    } else {
        HexMesh mesh = test::ball(kCells);
        if (GetParam() == Reference::Dense) {
            mesh = test::numbered_by_position(on_limit(refine(mesh, {.levels = kBallLevel}), Scheme::Mcq));
        }
        length = [tets = build_tet_mesh(mesh, std::vector<double>(mesh.points.size(), 1.0))](const Ray& ray) {
            return test::length_inside(tets, ray);
        };
    }
    expect_light(image, ball_view(), [&](const Ray& ray) { return constant_light(length(ray)); });
}

/// RMS of the opacity's error for rays that pass the centre at less than .9, as silhouettes are of lower order.
double ball_error(Reference reference, int n) {
    const View view = ball_view();
    const Image image = draw_ball(reference, n, view, constant_optics());
    double sum = 0;
    int count = 0;
    for (int y = 0; y < view.height(); ++y) {
        for (int x = 0; x < view.width(); ++x) {
            const Ray ray = view.ray(x + 0.5, y + 0.5);
            const double b = glm::length(cross(ray.origin, normalize(ray.direction)));
            if (b > 0.9) continue;
            const double alpha = 1 - constant_light(2 * std::sqrt(1 - b * b)).transmittance;
            sum += std::pow(image.pixel(x, y)[3] - alpha, 2);
            ++count;
        }
    }
    return std::sqrt(sum / count);
}

TEST_P(ClosedForm, BallIsReachedWithItsOrder) {
    const double coarse = ball_error(GetParam(), 8), fine = ball_error(GetParam(), 32);
    RecordProperty("rms_8_32", std::to_string(coarse) + " " + std::to_string(fine));
    // Facets differ from the sphere by the square of their size. Voxels are stairs, and which of them a ray meets is a matter
    // of chance.
    const bool voxels = GetParam() == Reference::Voxels;
    EXPECT_NEAR(std::log2(coarse / fine) / 2, voxels ? 1 : 2, voxels ? 0.3 : 0.15);
}

INSTANTIATE_TEST_SUITE_P(References, ClosedForm, testing::ValuesIn(test::kReferences),
                         [](const auto& reference) { return test::name_of(reference.param); });

}  // namespace reference_closed_form_test
}  // namespace subvol
