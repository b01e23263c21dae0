// SPDX-License-Identifier: Apache-2.0
#include "subvol/field_metrics.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <functional>
#include <limits>

#include "subvol/error.h"
#include "subvol/field_places.h"
#include "subvol/mesh_field.h"
#include "subvol/model.h"
#include "subvol/sample.h"
#include "vdb/test_meshes.h"

namespace subvol {
namespace field_metrics_test {

using Formula = std::function<double(const Vec3&)>;

const Box kUnit{Vec3(0.0), Vec3(1.0)};

/// A formula inside a box.
FieldView in_box(const Formula& f, const Box& box = kUnit) {
    return {.value =
                [=](const Vec3& x) {
                    const bool inside =
                        glm::all(glm::lessThanEqual(box.lower, x)) && glm::all(glm::lessThanEqual(x, box.upper));
                    return inside ? std::optional(f(x)) : std::nullopt;
                },
            .box = box};
}

TEST(CompareFields, AConstantDifference) {
    const auto wave = [](const Vec3& x) { return std::sin(3 * x.x) + x.y * x.z; };
    const FieldDifference errors = compare_fields(in_box([&](const Vec3& x) { return wave(x) + .5; }), in_box(wave));
    EXPECT_NEAR(errors.l1, .5, 1e-12);
    EXPECT_NEAR(errors.l2, .5, 1e-12);
    EXPECT_NEAR(errors.linf, .5, 1e-12);
    EXPECT_NEAR(errors.gradient_rmse, 0, 1e-9);  // differences over 2e-3 of values rounded to 1e-16
    EXPECT_EQ(errors.samples, 100000u);
    EXPECT_EQ(errors.uncovered, 0u);
    EXPECT_EQ(errors.gradients, 100000u);
}

TEST(CompareFields, ALinearDifference) {
    // |x| has the mean 1/2, x² the mean 1/3, with standard deviations of .29 and .30 a sample: four of them over √100000.
    const FieldDifference errors =
        compare_fields(in_box([](const Vec3& x) { return 3 * x.y + x.x; }), in_box([](const Vec3& x) { return 3 * x.y; }));
    EXPECT_NEAR(errors.l1, .5, 4 * .29 / std::sqrt(1e5));
    EXPECT_NEAR(errors.l2 * errors.l2, 1. / 3, 4 * .30 / std::sqrt(1e5));
    EXPECT_GT(errors.linf, .999);
    EXPECT_LE(errors.linf, 1);
    EXPECT_NEAR(errors.gradient_rmse, 1, 1e-9);
}

TEST(CompareFields, OnlyWhereBothAre) {
    const Box half{Vec3(0.0), Vec3(.25, 1, 1)};
    const auto zero = [](const Vec3&) { return 0.0; };
    const FieldDifference errors =
        compare_fields(in_box(zero, half), in_box([](const Vec3&) { return 2.0; }), {.samples = 40000});
    EXPECT_EQ(errors.samples + errors.uncovered, 40000u);
    EXPECT_NEAR(static_cast<double>(errors.samples), 10000, 4 * std::sqrt(7500));  // binomial
    EXPECT_EQ(errors.l2, 2);
    const FieldDifference none = compare_fields(in_box(zero, {Vec3(2.0), Vec3(3.0)}), in_box(zero));
    EXPECT_NEAR(errors.coverage(), .25, 4 * std::sqrt(7500) / 40000);
    EXPECT_EQ(none.samples, 0u);
    EXPECT_EQ(none.coverage(), 0);
    EXPECT_TRUE(std::isnan(none.l1) && std::isnan(none.l2) && std::isnan(none.linf) && std::isnan(none.gradient_rmse));
    EXPECT_THROW(
        (void)compare_fields(in_box(zero), {.value = [](const Vec3&) { return std::nullopt; }, .box = kUnit}, {.samples = 10}),
        Error);
}

TEST(CompareFields, NotANumberShows) {
    const FieldDifference errors = compare_fields(in_box([](const Vec3& x) { return x.x < .5 ? NAN : 0.0; }),
                                                  in_box([](const Vec3&) { return 0.0; }), {.samples = 100});
    EXPECT_TRUE(std::isnan(errors.l1) && std::isnan(errors.l2) && std::isnan(errors.linf));
}

TEST(CompareFields, TrilinearCellsHaveTheErrorOfLinearInterpolation) {
    // The error of x² between points h apart is h² t (1−t): h²/4 at most, root mean square h²/√30; that of the slope is h/√3.
    const double h = 1.0 / 8;
    const HexMesh mesh = test::with_field(test::box_mesh(8), "f", [](const Vec3& x) { return x.x * x.x; });
    const MeshField field(mesh, "f");
    FieldView exact = in_box([](const Vec3& x) { return x.x * x.x; });
    exact.gradient = [](const Vec3& x) { return std::optional(Vec3(2 * x.x, 0, 0)); };
    const FieldDifference errors = compare_fields(field.view(), exact);
    EXPECT_NEAR(errors.l1, h * h / 6, 4 * .075 * h * h / std::sqrt(1e5));  // .075: the deviation of t (1−t)
    EXPECT_NEAR(errors.l2, h * h / std::sqrt(30), 2e-3 * h * h);           // 1 % at 100000 places
    EXPECT_NEAR(errors.linf, h * h / 4, 1e-4 * h * h);                     // some place lies within .01 h of a cell's middle
    EXPECT_LE(errors.linf, h * h / 4 * (1 + 1e-12));
    EXPECT_NEAR(errors.gradient_rmse, h / std::sqrt(3), 5e-3 * h);
}

TEST(CompareFields, SameForAnyNumberOfThreadsAndOtherSeedsDiffer) {
    const auto a = in_box([](const Vec3& x) { return std::sin(7 * x.x * x.y); });
    const auto b = in_box([](const Vec3& x) { return std::sin(7 * x.x * x.z); });
    const auto measured = [&](std::size_t threads, std::uint64_t seed) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        const FieldDifference errors = compare_fields(a, b, {.samples = 20000, .seed = seed});
        return std::array{errors.l1,
                          errors.l2,
                          errors.linf,
                          errors.gradient_rmse,
                          integrate_field(a, kUnit, 40),
                          isosurface_distance(a, b, .3, 24).distance};
    };
    EXPECT_EQ(measured(1, 5), measured(3, 5));
    EXPECT_NE(measured(1, 5)[1], measured(1, 6)[1]);
}

TEST(GradientAt, ExactCentralAndOneSided) {
    FieldView field = in_box([](const Vec3& x) { return x.x * x.x + 2 * x.y - x.z; });
    field.step = .01;
    const Vec3 inside = *gradient_at(field, Vec3(.5));
    EXPECT_NEAR(glm::length(inside - Vec3(1, 2, -1)), 0, 1e-12);  // central differences are exact for squares
    const Vec3 at_side = *gradient_at(field, Vec3(1, .5, .5));
    EXPECT_NEAR(at_side.x, 2 - .01, 1e-12);  // (1 − .99²) / .01
    EXPECT_FALSE(gradient_at(field, Vec3(1.1, .5, .5)));
    field.gradient = [](const Vec3&) { return std::optional(Vec3(7.0)); };
    EXPECT_EQ(*gradient_at(field, Vec3(.5)), Vec3(7.0));
}

TEST(CompareField, AtGivenPlacesWithTheirWeights) {
    const FieldSamples places{{Vec3(.1), Vec3(.5), Vec3(.9), Vec3(5.0)}, {0, 0, 0, 0}, {1, 2, 1, 9}};
    const FieldDifference errors = compare_field(in_box([](const Vec3& x) { return x.x > .8 ? 3.0 : 1.0; }), places);
    EXPECT_EQ(errors.samples, 3u);
    EXPECT_EQ(errors.uncovered, 1u);
    EXPECT_DOUBLE_EQ(errors.l1, (1 + 2 + 3) / 4.);
    EXPECT_DOUBLE_EQ(errors.l2, std::sqrt((1 + 2 + 9) / 4.));
    EXPECT_EQ(errors.linf, 3);
    EXPECT_THROW((void)compare_field(in_box([](const Vec3&) { return 0.0; }), {}), Error);
}

TEST(NewVertices, AreThoseThatOneRefinementAdds) {
    HexMesh mesh = test::with_field(test::ball_mesh(2), "f", [](const Vec3& x) { return std::sin(3 * x.x) + x.y * x.z; });
    const FieldSamples places = new_vertices(mesh, "f");
    EXPECT_EQ(places.values, values_at_new_points(mesh, "f", ValueRule::Scheme, Kernel{}));
    const HexMesh fine = refine(mesh);
    EXPECT_EQ(places.size(), fine.points.size() - mesh.points.size());
    EXPECT_EQ(new_vertices(mesh, "f", 1).size(), refine(fine).points.size() - fine.points.size());
    // The refined mesh has the scheme's values, so the paper's error measure is 0 for it.
    EXPECT_LT(compare_field(MeshField(fine, "f").view(), places).l2, 1e-7);  // places are found to 1e-8 of a cell's size
    EXPECT_THROW((void)new_vertices(mesh, "g"), Error);
}

// Those of some cells: each is one of all, and edges, sides and middles count as often as in the whole.
TEST(NewVertices, OfSomeCellsStandForAll) {
    const HexMesh mesh =
        test::with_field(make_model("twist", 12), "f", [](const Vec3& x) { return std::sin(x.x) + x.y * x.z; });
    const FieldSamples all = new_vertices(mesh, "f"), some = new_vertices(mesh, "f", 0, Scheme::Mcq, 3000);
    EXPECT_LT(some.size(), 3 * 3000u);  // 19 of each cell instead of 7
    EXPECT_GT(some.size(), 3000u / 2);
    const auto square_of = [](const FieldSamples& places) {
        double weights = 0, squares = 0;
        for (std::size_t i = 0; i < places.size(); ++i) {
            weights += places.weights[i];
            squares += places.weights[i] * places.values[i] * places.values[i];
        }
        return squares / weights;
    };
    EXPECT_NEAR(square_of(some) / square_of(all), 1, .05);  // a sixth of the cells
    const HexMesh fine =
        test::with_field(make_model("twist", 23), "f", [](const Vec3& x) { return std::sin(x.x) + x.y * x.z; });
    const FieldSamples most = new_vertices(fine, "f", 0, Scheme::Mcq, 40000);  // more cells than are refined at once
    EXPECT_GT(most.size(), 19 * 2048u);
    EXPECT_NEAR(square_of(most) / square_of(new_vertices(fine, "f")), 1, .01);
    EXPECT_LT(compare_field(MeshField(refine(mesh), "f").view(), some).l2, 1e-7);
}

TEST(IntegrateField, LinearFieldsInBoxesAreExact) {
    const Box box{Vec3(-1, 2, 0), Vec3(1, 3, .3)};
    const auto f = in_box([](const Vec3& x) { return 1 + 2 * x.x + 3 * x.y - x.z; }, box);
    const double expected = .6 * (1 + 0 + 7.5 - .15);  // the volume × the value in the middle
    for (const int resolution : {2, 7, 64}) EXPECT_NEAR(integrate_field(f, box, resolution), expected, 1e-12);
    EXPECT_THROW((void)integrate_field(f, box, 1), Error);
    EXPECT_THROW((void)integrate_field(f, box, 5000), Error);
    EXPECT_THROW((void)integrate_field(f, {}, 10), Error);
}

TEST(IntegrateField, SmoothFieldsToSecondOrder) {
    const auto f = in_box([](const Vec3& x) { return std::exp(x.x) * x.y * x.y; });
    const double exact = (std::exp(1) - 1) / 3;
    const double coarse = std::abs(integrate_field(f, kUnit, 10) - exact),
                 fine = std::abs(integrate_field(f, kUnit, 20) - exact);
    EXPECT_NEAR(coarse / fine, 4, .05);
}

TEST(IntegrateField, VolumeOfABall) {
    const FieldView ball{.value = [](const Vec3& x) { return glm::length(x) <= 1 ? std::optional(1.0) : std::nullopt; },
                         .box = {Vec3(-1.0), Vec3(1.0)}};
    // Some 19000 cubes are cut (1.5 times the surface over h²); each has a random error of about .29 of its volume, together
    // √19000 · .29 h³ = 1.2e-3. The tolerance is four of these.
    EXPECT_NEAR(integrate_field(ball, ball.box, 64), 4. / 3 * std::acos(-1.0), 5e-3);
}

TEST(MassError, IsRelative) {
    const auto f = [](const Vec3& x) { return 1 + x.x; };
    const MassError error = mass_error(in_box([&](const Vec3& x) { return 1.1 * f(x); }), in_box(f), 16);
    EXPECT_NEAR(error.reference, 1.5, 1e-12);
    EXPECT_NEAR(error.test, 1.65, 1e-12);
    EXPECT_NEAR(error.relative, .1, 1e-12);
    const auto zero = in_box([](const Vec3&) { return 0.0; });
    EXPECT_EQ(mass_error(zero, zero, 4).relative, 0);
    EXPECT_EQ(mass_error(in_box(f), zero, 4).relative, std::numeric_limits<double>::infinity());
    // A field with a larger domain counts there too.
    EXPECT_NEAR(mass_error(in_box([](const Vec3&) { return 1.0; }, {Vec3(0.0), Vec3(2, 1, 1)}),
                           in_box([](const Vec3&) { return 1.0; }), 32)
                    .relative,
                1, 1e-12);
}

TEST(FieldMetrics, TheMassTakesAsManyCubesAsItNeeds) {
    const auto f = [](const Vec3& x) { return 1 + x.x; };
    const FieldView field = in_box(f);
    EXPECT_EQ(mass_error(field, field).resolution, 64);  // the second grid says the same as the first
    const FieldView rough = in_box([](const Vec3& x) { return 1 + std::sin(90 * x.x) * std::sin(1000 * x.y * x.z); });
    EXPECT_EQ(mass_error(rough, field).relative, mass_error(rough, field, mass_error(rough, field).resolution).relative);
    EXPECT_EQ(mass_error(field, field, 16).resolution, 16);
}

}  // namespace field_metrics_test
}  // namespace subvol
