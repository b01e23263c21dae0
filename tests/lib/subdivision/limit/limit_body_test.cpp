// SPDX-License-Identifier: Apache-2.0
#include "subvol/limit_body.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/test_meshes.h"
#include "lib/volume_of.h"
#include "subvol/measure.h"
#include "subvol/model.h"

namespace subvol {
namespace limit_body_test {

/// The position as a field, so that its extremes are the limit's box.
LimitMeasure measured(HexMesh mesh, const SchemeOptions& scheme) {
    mesh.attributes = {{"x", 3, {}}};
    for (const Vec3& x : mesh.points) mesh.attributes[0].values.insert(mesh.attributes[0].values.end(), {x.x, x.y, x.z});
    return measure_limit(mesh, {.scheme = scheme});
}

TEST(LimitBody, IsThatOfTheIntegratedLimit) {
    for (const char* model : {"ball", "nozzle"}) {
        for (const Scheme kind : {Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw}) {
            const HexMesh mesh = make_model(model, 2);
            const PartMeasure whole = measured(mesh, {.kind = kind}).whole;
            const LimitBody body = limit_body(mesh, {.kind = kind});
            SCOPED_TRACE(std::string(model) + " " + std::to_string(static_cast<int>(kind)));
            EXPECT_NEAR(body.volume, whole.volume, 2e-3 * whole.volume);
            const LimitBody rough = limit_body(mesh, {.kind = kind}, 1);
            const double difference = std::abs(whole.volume - body.given_volume);
            EXPECT_NEAR(rough.volume, whole.volume, .2 * difference + .01 * whole.volume) << "enough to see another body";
            EXPECT_NEAR(body.given_volume, test::volume_of(mesh), 1e-12 * body.given_volume);
            const Vec3 size = body.given_bounds.size();
            for (int axis = 0; axis < 3; ++axis) {
                const FieldMeasure& x = whole.fields[static_cast<std::size_t>(axis)];
                EXPECT_NEAR(body.bounds.lower[axis], x.min.value, 5e-3 * size[axis]);
                EXPECT_NEAR(body.bounds.upper[axis], x.max.value, 5e-3 * size[axis]);
                EXPECT_EQ(body.given_bounds.lower[axis], bounds(mesh).lower[axis]);
            }
        }
    }
}

TEST(LimitBody, OfTheTrilinearSchemeIsTheCells) {
    const LimitBody ball = limit_body(make_model("ball", 3), {.kind = Scheme::Linear});
    EXPECT_LT(ball.difference(), 1e-3) << "as triangles have other volumes than bilinear sides";
    const LimitBody box = limit_body(test::make_box(3, 2, 1));
    EXPECT_NEAR(box.volume, 6, 1e-12);
    EXPECT_LT(box.difference(), 1e-12);
}

/// Balls apart from each other, whose points are numbered through all balls first, so that each part of the numbers has some of
/// every ball.
HexMesh balls(std::size_t count) {
    const HexMesh one = make_model("ball", 2);
    HexMesh all;
    for (const Vec3& point : one.points) {
        for (std::size_t b = 0; b < count; ++b) all.points.push_back(point + Vec3(3. * static_cast<double>(b % 100), 0, 0));
    }
    for (std::size_t b = 0; b < count; ++b) {
        for (auto cell : one.cells) {
            for (Index& p : cell) p = static_cast<Index>(p * count + b);
            all.cells.push_back(cell);
        }
    }
    return all;
}

TEST(LimitBody, OfALargeMeshComesInPartsThatMakeTheWhole) {
    const std::size_t cells = make_model("ball", 2).cells.size(), count = 1 + 500'000 / cells;  // two parts
    const double one = static_cast<double>(count) * measured(make_model("ball", 2), {}).whole.volume;
    const LimitBody body = limit_body(balls(count), {}, 1);
    // One level of so few cells leaves a few per cent, as above; a face left out or twice would be 1/24 or more of a ball.
    EXPECT_NEAR(body.volume, limit_body(make_model("ball", 2), {}, 1).volume * static_cast<double>(count), 1e-9 * one);
    EXPECT_NEAR(body.volume, one, .03 * one);
}

TEST(LimitBody, SaysHowMuchItDiffers) {
    LimitBody body;
    body.volume = .95, body.given_volume = 1;
    body.bounds = body.given_bounds = {{0, 0, 0}, {1, 1, 2}};
    EXPECT_NEAR(body.difference(), .05, 1e-12);
    body.bounds.upper.z = 2.2;
    EXPECT_NEAR(body.difference(), .1, 1e-12);
}

}  // namespace limit_body_test
}  // namespace subvol
