// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>

#include "render/constant_optics.h"
#include "render/hex_meshes.h"
#include "render/image_differences.h"
#include "subvol/error.h"
#include "subvol/render_tets.h"

namespace subvol {
namespace render_tets_test {

using test::largest_difference;

using test::constant_alpha;
using test::constant_optics;
using test::evaluate;
using test::valued;

// Images are in single precision, all before in double.
constexpr double kFloatTol = 1e-6;

// Colour and opacity change with the value in [0,1], with kinks.
Optics ramp_optics() {
    return {{{{0, {1, 0, 0}}, {0.5, {0, 1, 0.2}}, {1, {0.1, 0.3, 1}}}, {{0, 0}, {0.3, 0.1}, {0.35, 0.6}, {1, 0.8}}}, 1.0};
}

View straight_view(int size, double height = 1) {
    return {{.eye = {0.5, 0.5, 5}, .target = {0.5, 0.5, 0}, .up = {0, 1, 0}, .ortho_height = height}, size, size};
}

View slanted_view(int size) {
    return {{.eye = {2.1, 1.7, 2.9}, .target = {0.5, 0.5, 0.5}, .up = {0, 1, 0}, .fovy_deg = 35}, size, size};
}

// Length of the ray in the box [0,1]³, in front of its origin, and its ends.
struct Chord {
    double begin = 0, end = 0;
    [[nodiscard]] double length(const Ray& ray) const { return std::max(0.0, end - begin) * glm::length(ray.direction); }
};
Chord chord_in_box(const Ray& ray) {
    Chord chord{0, 1e300};
    for (int k = 0; k < 3; ++k) {
        const double a = -ray.origin[k] / ray.direction[k], b = (1 - ray.origin[k]) / ray.direction[k];
        chord = {std::max(chord.begin, std::min(a, b)), std::min(chord.end, std::max(a, b))};
    }
    return chord;
}

Ray pixel_ray(const View& view, int x, int y) {
    return view.ray(x + 0.5, y + 0.5);
}

void expect_constant_box(const TetsResult& result, const View& view) {
    EXPECT_EQ(result.report.lost_rays, 0u);
    for (int y = 0; y < view.height(); ++y) {
        for (int x = 0; x < view.width(); ++x) {
            const Ray ray = pixel_ray(view, x, y);
            const double alpha = constant_alpha(chord_in_box(ray).length(ray));
            ASSERT_NEAR(result.image.pixel(x, y)[3], alpha, kFloatTol) << x << ' ' << y;
            ASSERT_NEAR(result.image.pixel(x, y)[1], alpha, kFloatTol) << x << ' ' << y;
        }
    }
}

void expect_ramp_box(const Image& image, const View& view, const Vec3& gradient) {
    const Optics optics = ramp_optics();
    for (int y = 0; y < view.height(); ++y) {
        for (int x = 0; x < view.width(); ++x) {
            const Ray ray = pixel_ray(view, x, y);
            const Chord chord = chord_in_box(ray);
            Segment expected;
            if (chord.begin < chord.end) {
                const double front = dot(gradient, ray.origin + chord.begin * ray.direction);
                const double back = dot(gradient, ray.origin + chord.end * ray.direction);
                expected = optics.integrate(front, back, chord.length(ray));
            }
            ASSERT_NEAR(image.pixel(x, y)[3], 1 - expected.transmittance, kFloatTol) << x << ' ' << y;
            for (int c = 0; c < 3; ++c) {
                ASSERT_NEAR(image.pixel(x, y)[static_cast<std::size_t>(c)], expected.color[c], kFloatTol) << x << ' ' << y;
            }
        }
    }
}

TEST(RenderTets, ConstantSlabIsBeerLambert) {
    const HexMesh mesh = test::box(5);
    const View view = straight_view(33);
    const auto result = render_tets(valued(mesh, 1.0), {}, view, constant_optics());
    EXPECT_EQ(result.report.tets, 6u * 125);
    EXPECT_EQ(result.report.degenerate_tets, 0u);
    EXPECT_EQ(result.report.inverted_tets, 0u);
    EXPECT_EQ(result.report.rays, 33u * 33);
    expect_constant_box(result, view);
}

TEST(RenderTets, ConstantBoxInPerspectiveHasAnalyticChords) {
    for (const HexMesh& mesh : {test::box(1), test::box(6), test::jittered_box(7, 0.3, 11)}) {
        const View view = slanted_view(64);
        expect_constant_box(render_tets(valued(mesh, 1.0), {}, view, constant_optics()), view);
    }
}

TEST(RenderTets, RaysThroughLatticePointsAndEdgesAreExact) {
    // 4 cells under 4, 8 or 16 pixels shifted by half a pixel: centres lie on lattice points, edges and face diagonals.
    const HexMesh mesh = test::box(4);
    const std::vector<double> ones(mesh.points.size(), 1.0);
    for (const int size : {5, 9, 17}) {
        // The outermost pixel centres lie on the box's sides, where inside and outside are equally right: they are left out
        // below.
        const View view = straight_view(size, double(size) / (size - 1));
        const auto result = render_tets(valued(mesh, ones), {}, view, constant_optics());
        EXPECT_EQ(result.report.lost_rays, 0u);
        for (int y = 1; y + 1 < size; ++y) {
            for (int x = 1; x + 1 < size; ++x) {
                ASSERT_NEAR(result.image.pixel(x, y)[3], constant_alpha(1), kFloatTol) << size << ": " << x << ' ' << y;
            }
        }
    }
}

TEST(RenderTets, RaysAlongDiagonalsAreExact) {
    // Along (1,1,1) and (1,1,0) rays run in faces and along diagonals of the split.
    for (const Vec3& direction : {Vec3(1, 1, 1), Vec3(1, 1, 0), Vec3(-1, 1, 1)}) {
        const HexMesh mesh = test::box(4);
        const View view({.eye = Vec3(0.5) + 4.0 * direction, .target = Vec3(0.5), .up = {0, 0, 1}, .ortho_height = 1.0}, 41,
                        41);
        const auto result = render_tets(valued(mesh, 1.0), {}, view, constant_optics());
        EXPECT_EQ(result.report.lost_rays, 0u);
        const double chord = glm::length(direction);
        EXPECT_NEAR(result.image.pixel(20, 20)[3], constant_alpha(chord), kFloatTol);
    }
}

TEST(RenderTets, LinearFieldIsOneSegment) {
    const Vec3 gradient(0.5, 0.2, 0.3);
    const auto ramp = [&](const Vec3& p) { return dot(gradient, p); };
    for (const HexMesh& mesh : {test::box(4), test::jittered_box(6, 0.3, 5)}) {
        for (const View& view : {straight_view(32), slanted_view(48)}) {
            const auto result = render_tets(valued(mesh, ramp), {}, view, ramp_optics());
            EXPECT_EQ(result.report.lost_rays, 0u);
            EXPECT_GT(result.report.segments, result.report.rays);
            expect_ramp_box(result.image, view, gradient);
        }
    }
}

TEST(RenderTets, BallHasItsOpticalDepth) {
    const HexMesh mesh = test::ball(40);
    const View view({.eye = {0.3, 1, 5}, .target = {0, 0, 0}, .up = {0, 1, 0}, .ortho_height = 2.2}, 64, 64);
    const auto result = render_tets(valued(mesh, 1.0), {}, view, constant_optics());
    EXPECT_EQ(result.report.lost_rays, 0u);
    // Facets are at most 2/40 wide (in the middle of the cube's faces), their corners 0.05/√2 from their centre, so they lie up
    // to half the square of that below the sphere: the depth is between those of two spheres.
    const double inner_radius = 1 - 0.5 * (0.05 * 0.05 / 2);
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            const Ray ray = pixel_ray(view, x, y);
            const Vec3 d = glm::normalize(ray.direction);
            const double b2 = dot(ray.origin, ray.origin) - std::pow(dot(ray.origin, d), 2);
            const auto alpha_within = [&](double radius) {
                return constant_alpha(2 * std::sqrt(std::max(0.0, radius * radius - b2)));
            };
            ASSERT_GE(result.image.pixel(x, y)[3], alpha_within(inner_radius) - kFloatTol) << x << ' ' << y;
            ASSERT_LE(result.image.pixel(x, y)[3], alpha_within(1) + kFloatTol) << x << ' ' << y;
        }
    }
}

TEST(RenderTets, LShapeIsLeftAndEnteredAgain) {
    // Looking along x over a U: cells with the middle third of the top missing, so that rays leave and come back.
    const HexMesh mesh = test::lattice({3, 2, 2}, [](Index i, Index, Index k) { return k == 0 || i != 1; });
    const View view({.eye = {-3, 0.5, 0.5}, .target = {0, 0.5, 0.5}, .up = {0, 0, 1}, .ortho_height = 1}, 32, 32);
    const auto result = render_tets(valued(mesh, 1.0), {}, view, constant_optics());
    EXPECT_EQ(result.report.lost_rays, 0u);
    for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 32; ++x) {
            ASSERT_NEAR(result.image.pixel(x, y)[3], constant_alpha(y < 16 ? 2.0 / 3 : 1.0), kFloatTol) << x << ' ' << y;
        }
    }
    const HexMesh l = test::l_shape(4);
    const View oblique({.eye = {4, 0.9, 1.8}, .target = {0.5, 0.5, 0.5}, .up = {0, 0, 1}, .fovy_deg = 25}, 48, 48);
    const auto constant = render_tets(valued(l, 1.0), {}, oblique, constant_optics());
    EXPECT_EQ(constant.report.lost_rays, 0u);
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 48; ++x) {
            const Ray ray = pixel_ray(oblique, x, y);
            const Ray missing{2.0 * (ray.origin - Vec3(0.5, 0, 0.5)) * Vec3(1, 0.5, 1), 2.0 * ray.direction * Vec3(1, 0.5, 1)};
            const Chord gone = chord_in_box(missing);
            const double length = chord_in_box(ray).length(ray) - gone.length(ray);
            ASSERT_NEAR(constant.image.pixel(x, y)[3], constant_alpha(length), kFloatTol) << x << ' ' << y;
        }
    }
}

TEST(RenderTets, ComponentsThatTouchAreBothSeen) {
    HexMesh mesh = test::box(3);  // and a copy with its own points at x in 1..2
    const HexMesh other = mesh;
    const auto offset = static_cast<Index>(mesh.points.size());
    for (const Vec3& p : other.points) mesh.points.push_back(p + Vec3(1, 0, 0));
    for (auto cell : other.cells) {
        for (Index& p : cell) p += offset;
        mesh.cells.push_back(cell);
    }
    const View view({.eye = {-3, 0.5, 0.5}, .target = {0, 0.5, 0.5}, .up = {0, 0, 1}, .ortho_height = 0.97}, 24, 24);
    const auto result = render_tets(valued(mesh, 1.0), {}, view, constant_optics());
    EXPECT_EQ(result.report.lost_rays, 0u);
    for (const auto x : {0, 7, 12, 23}) EXPECT_NEAR(result.image.pixel(x, x)[3], constant_alpha(2), kFloatTol);
}

TEST(RenderTets, EyeInsideSeesWhatIsInFront) {
    const HexMesh mesh = test::jittered_box(5, 0.3, 23);
    const View view({.eye = {0.3, 0.45, 0.62}, .target = {1, 0.5, 0.2}, .up = {0, 1, 0}, .fovy_deg = 100}, 48, 48);
    const auto ones = render_tets(valued(mesh, 1.0), {}, view, constant_optics());
    EXPECT_EQ(ones.report.rays, 48u * 48);
    expect_constant_box(ones, view);
    const Vec3 gradient(0.1, 0.6, 0.3);
    const auto ramp = render_tets(valued(mesh, [&](const Vec3& p) { return dot(gradient, p); }), {}, view, ramp_optics());
    expect_ramp_box(ramp.image, view, gradient);
}

TEST(RenderTets, EyeOnAPointOfTheMesh) {
    const HexMesh mesh = test::box(4);
    for (const Vec3& eye : {Vec3(0.5), Vec3(0.25, 0.5, 0.75), Vec3(0, 0, 0), Vec3(0.5, 0.5, 0), Vec3(0.5, 0.3, 0.4)}) {
        const View view({.eye = eye, .target = {0.8, 0.8, 0.8}, .up = {0, 1, 0}, .fovy_deg = 80}, 33, 33);
        expect_constant_box(render_tets(valued(mesh, 1.0), {}, view, constant_optics()), view);
    }
}

TEST(RenderTets, ThreadsChangeNoBit) {
    const HexMesh mesh = test::jittered_box(9, 0.35, 3);
    const auto field = evaluate(mesh, [](const Vec3& p) { return 0.5 + 0.5 * std::sin(9 * p.x) * std::cos(7 * p.y + p.z); });
    const auto draw = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return render_tets(valued(mesh, field), {}, slanted_view(70), ramp_optics(), {.samples = 2});
    };
    const auto one = draw(1), two = draw(2);
    EXPECT_EQ(std::memcmp(one.image.rgba.data(), two.image.rgba.data(), one.image.rgba.size() * sizeof(float)), 0);
    EXPECT_EQ(one.report.segments, two.report.segments);
    EXPECT_EQ(one.report.lost_rays + two.report.lost_rays, 0u);
}

TEST(RenderTets, PlaceAndSizeDoNotMatter) {
    const HexMesh mesh = test::jittered_box(6, 0.3, 8);
    const auto field = evaluate(mesh, [](const Vec3& p) { return 0.5 + 0.5 * std::sin(5 * p.x + 3 * p.y) * p.z; });
    const auto draw = [&](double scale, const Vec3& move) {
        HexMesh moved = mesh;
        for (Vec3& p : moved.points) p = scale * p + move;
        const Camera camera{.eye = scale * Vec3(2.1, 1.7, 2.9) + move, .target = scale * Vec3(0.5) + move, .fovy_deg = 35};
        const auto result =
            render_tets(valued(moved, field), {}, View(camera, 64, 64), Optics(ramp_optics().function(), scale));
        EXPECT_EQ(result.report.lost_rays, 0u);
        return result.image;
    };
    const Image here = draw(1, Vec3(0));
    // At 1e6 a coordinate is rounded by 1e-10; the steepest silhouette and field make less than 1e-7 of it.
    EXPECT_LT(largest_difference(here, draw(1, Vec3(1e6, -1e6, 1e6))), 1e-6);
    EXPECT_LT(largest_difference(here, draw(1e-2, Vec3(0))), 1e-6);
    EXPECT_LT(largest_difference(here, draw(1e6, Vec3(0))), 1e-6);
}

TEST(RenderTets, TangledInnerPointsAreFollowed) {
    // Points moved by more than a cell: many inverted tetrahedra, yet the mesh still fills the box, each depth counted once.
    const HexMesh mesh = test::jittered_box(6, 0.9, 99);
    const View view = slanted_view(64);
    const auto result = render_tets(valued(mesh, 1.0), {}, view, constant_optics());
    EXPECT_GT(result.report.inverted_tets, 0u);
    expect_constant_box(result, view);
}

TEST(RenderTets, InvertedAndFlatCellsDoNotStopRays) {
    HexMesh mesh = test::box(4);
    for (std::size_t c = 0; c < mesh.cells.size(); c += 7) {  // left-handed corner order
        std::swap_ranges(mesh.cells[c].begin(), mesh.cells[c].begin() + 4, mesh.cells[c].begin() + 4);
    }
    const View view = slanted_view(48);
    const std::vector<double> ones(mesh.points.size(), 1.0);
    const auto inverted = render_tets(valued(mesh, ones), {}, view, constant_optics());
    EXPECT_EQ(inverted.report.inverted_tets, 6u * 10);
    expect_constant_box(inverted, view);

    HexMesh flat = test::box(4);
    for (Vec3& p : flat.points) {
        if (p.z == 0.5) p.z = 0.25;  // a layer of cells without thickness
    }
    const auto collapsed = render_tets(valued(flat, ones), {}, view, constant_optics());
    EXPECT_EQ(collapsed.report.degenerate_tets, 6u * 16);
    expect_constant_box(collapsed, view);

    HexMesh inside_out = test::box(3);
    inside_out.points[inside_out.cells.back()[6]] = Vec3(-0.3, -0.2, -0.4);  // a corner pulled through the whole mesh
    const auto folded = render_tets(valued(inside_out, 1.0), {}, view, constant_optics());
    EXPECT_GT(folded.report.inverted_tets, 0u);
    for (const float value : folded.image.rgba) ASSERT_TRUE(std::isfinite(value) && value >= 0 && value <= 1 + kFloatTol);
}

TEST(RenderTets, EveryCornerInOnePointDrawsNothing) {
    HexMesh mesh = test::box(2);
    for (Vec3& p : mesh.points) p = Vec3(0.5);
    const auto result = render_tets(valued(mesh, 1.0), {}, slanted_view(16), constant_optics());
    EXPECT_EQ(result.report.degenerate_tets, result.report.tets);
    for (const float value : result.image.rgba) ASSERT_EQ(value, 0.0f);
}

TEST(RenderTets, SamplesAreMeansOverThePixel) {
    const HexMesh mesh = test::box(2);
    const std::vector<double> ones(mesh.points.size(), 1.0);
    const auto fine = render_tets(valued(mesh, ones), {}, slanted_view(48), constant_optics());
    const auto coarse = render_tets(valued(mesh, ones), {}, slanted_view(16), constant_optics(), {.samples = 3});
    EXPECT_EQ(coarse.report.rays, fine.report.rays);
    for (int y = 0; y < 16; ++y) {
        for (int x = 0; x < 16; ++x) {
            double mean = 0;
            for (int k = 0; k < 9; ++k) mean += fine.image.pixel(3 * x + k % 3, 3 * y + k / 3)[3] / 9.0;
            ASSERT_NEAR(coarse.image.pixel(x, y)[3], mean, kFloatTol);
        }
    }
}

TEST(RenderTets, ShowsTheNamedFieldOrTheFirstScalar) {
    HexMesh mesh = test::box(2);
    const auto rising = evaluate(mesh, [](const Vec3& p) { return p.x; });
    mesh.attributes = {{"velocity", 3, std::vector<double>(3 * mesh.points.size())},
                       {"constant", 1, std::vector<double>(mesh.points.size(), 0.2)},
                       {"rising", 1, rising}};
    const auto draw = [](const HexMesh& of, std::string_view field) {
        return render_tets(of, field, slanted_view(12), ramp_optics()).image.rgba;
    };
    EXPECT_EQ(draw(mesh, ""), draw(valued(mesh, 0.2), ""));
    EXPECT_EQ(draw(mesh, "rising"), draw(valued(mesh, rising), ""));
    EXPECT_THROW((void)draw(mesh, "velocity"), Error);
    EXPECT_THROW((void)draw(mesh, "pressure"), Error);
    EXPECT_THROW((void)draw(test::box(1), ""), Error);
}

TEST(RenderTets, RefusesWrongInput) {
    const HexMesh mesh = test::box(1);
    const std::vector<double> ones(8, 1.0);
    EXPECT_THROW((void)render_tets(valued(mesh, std::vector<double>(7)), {}, slanted_view(4), constant_optics()), Error);
    EXPECT_THROW((void)render_tets(valued(mesh, ones), {}, slanted_view(4), constant_optics(), {.samples = 0}), Error);
    EXPECT_THROW((void)render_tets(valued(mesh, ones), {}, slanted_view(4), constant_optics(), {.samples = 17}), Error);
    EXPECT_THROW((void)render_tets(valued(mesh, std::nan("")), {}, slanted_view(4), constant_optics()), Error);
    HexMesh broken = mesh;
    broken.cells[0][3] = 99;
    EXPECT_THROW((void)render_tets(valued(broken, ones), {}, slanted_view(4), constant_optics()), Error);
}

class Stopper : public Progress {
public:
    void report(std::string_view, double fraction) override { last = fraction; }
    [[nodiscard]] bool cancelled() const override { return stop; }
    double last = -1;
    bool stop = false;
};

TEST(RenderTets, ReportsProgressAndStops) {
    const HexMesh mesh = test::box(1);
    const std::vector<double> ones(8, 1.0);
    Stopper progress;
    (void)render_tets(valued(mesh, ones), {}, slanted_view(40), constant_optics(), {.progress = &progress});
    EXPECT_EQ(progress.last, 1.0);
    progress.stop = true;
    try {
        (void)render_tets(valued(mesh, ones), {}, slanted_view(40), constant_optics(), {.progress = &progress});
        FAIL() << "not stopped";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::Cancelled);
    }
}

}  // namespace render_tets_test
}  // namespace subvol
