// SPDX-License-Identifier: Apache-2.0
// A linear field gives the same picture with every renderer, from many cameras, and after the mesh is split into other cells.
#include <gtest/gtest.h>

#include <cmath>

#include "reference_methods.h"
#include "subvol/mixed_cells.h"
#include "subvol/refine.h"
#include "subvol/render_field.h"

namespace subvol {
namespace reference_agreement_test {

using test::evaluate;
using test::largest_difference;
using test::valued;

constexpr double kFloatTol = 1e-6;  // images are in single precision, all before in double
constexpr double kAgreeTol = 1e-4;  // the requirement; single precision on the device

double linear(const Vec3& p) {
    return dot(Vec3(0.5, 0.2, 0.3), p);
}

// Colour and opacity change with the value in [0,1], with kinks and an invisible part.
Optics kinked_optics() {
    return {{{{0, {1, 0, 0}}, {0.5, {0, 1, 0.2}}, {1, {0.1, 0.3, 1}}},
             {{0, 0}, {0.3, 0.1}, {0.35, 0.6}, {0.6, 0}, {0.65, 0}, {1, 0.8}}},
            0.3};
}

struct Place {
    const char* name;
    Camera camera;
};
void PrintTo(const Place& place, std::ostream* out) {
    *out << place.name;
}

const std::vector<Place> kPlaces{
    {"Slanted", {.eye = {2.1, 1.7, 2.9}, .target = Vec3(0.5), .fovy_deg = 35}},
    {"FromBelow", {.eye = {0.3, -2.2, -1.4}, .target = Vec3(0.5), .up = {0, 0, 1}, .fovy_deg = 30}},
    {"AlongAnAxis", {.eye = {0.5, 0.5, 4}, .target = Vec3(0.5), .fovy_deg = 20}},
    {"AlongAFaceDiagonal", {.eye = {3.5, 0.5, 3.5}, .target = Vec3(0.5), .ortho_height = 1.3}},
    {"AlongADiagonal", {.eye = Vec3(3.5), .target = Vec3(0.5), .ortho_height = 1.9}},
    {"WideAndNear", {.eye = {1.1, 1.2, 1.3}, .target = {0.4, 0.5, 0.45}, .fovy_deg = 100}},
    {"FarAway", {.eye = {210, -170, 290}, .target = Vec3(0.5), .fovy_deg = 0.3}},
    {"Inside", {.eye = {0.43, 0.37, 0.52}, .target = {0.9, 0.8, 0.3}, .up = {0, 0, 1}, .fovy_deg = 80}},
};

class FromEverywhere : public testing::TestWithParam<Place> {
protected:
    [[nodiscard]] static View view() { return {GetParam().camera, 61, 53}; }
};

TEST_P(FromEverywhere, LinearFieldsLookTheSameByRaysProjectedAndByLists) {
    if (gl_devices().empty()) GTEST_SKIP() << "no OpenGL 4.5 through EGL";
    const HexMesh mesh = test::jittered_box(5, 0.25, 5);
    const auto values = evaluate(mesh, linear);
    const Image rays = render_tets(valued(mesh, values), {}, view(), kinked_optics()).image;
    const auto projected = render_projected(valued(mesh, values), {}, view(), kinked_optics());
    const auto lists = render_projected(valued(mesh, values), {}, view(), kinked_optics(), {.order = ProjectedOrder::Lists});
    EXPECT_EQ(projected.report.cycles, 0u);
    EXPECT_LT(largest_difference(projected.image, rays), kAgreeTol);
    EXPECT_LT(largest_difference(lists.image, rays), kAgreeTol);
    EXPECT_LT(largest_difference(lists.image, projected.image), kAgreeTol);
}

TEST_P(FromEverywhere, LinearFieldsLookTheSameByRaysDenseAndMarched) {
    const HexMesh mesh = test::jittered_box(3, 0.25, 5);
    const auto values = evaluate(mesh, linear);
    const Image rays = render_tets(valued(mesh, values), {}, view(), kinked_optics()).image;
    EXPECT_LT(largest_difference(render_dense(valued(mesh, values), {}, view(), kinked_optics(), {.levels = 2}).image, rays),
              kFloatTol);
    const auto field = [](const Vec3& p) {
        return glm::all(glm::greaterThanEqual(p, Vec3(0))) && glm::all(glm::lessThanEqual(p, Vec3(1)))
                   ? std::optional(linear(p))
                   : std::nullopt;
    };
    constexpr double kStep = 2e-3;
    const Image marched = render_field(field, {Vec3(0), Vec3(1)}, view(), kinked_optics(), {.step_world = kStep});
    // A corner thinner than a step may be missed: τ is 5.4 at most.
    EXPECT_LT(largest_difference(marched, rays), 5.4 * kStep);
}

TEST_P(FromEverywhere, RefinementDoesNotChangeALinearField) {
    const HexMesh mesh = test::jittered_box(2, 0.25, 5);
    const Image control = render_tets(valued(mesh, linear), {}, view(), kinked_optics()).image;
    for (const Scheme scheme : {Scheme::Linear, Scheme::Mcq}) {
        for (const int levels : {1, 2, 3}) {
            // Each level divides the faces in another way: only a field that is linear in space stays the same.
            const HexMesh fine = refine(mesh, {.scheme = {scheme}, .levels = levels});
            EXPECT_LT(largest_difference(render_tets(valued(fine, linear), {}, view(), kinked_optics()).image, control),
                      kFloatTol)
                << static_cast<int>(scheme) << " level " << levels;
        }
    }
}

/// The cube [0,1]³ split into tetrahedra, each of them into four hexahedra.
HexMesh cube_of(const std::vector<std::array<Index, 4>>& tets) {
    HexMesh corners;
    for (int k = 0; k < 8; ++k) corners.points.emplace_back(k & 1, k >> 1 & 1, k >> 2);
    return split_into_hexes(corners, {.tets = tets, .prisms = {}, .pyramids = {}});
}

TEST_P(FromEverywhere, FiveOrSixTetrahedraShowTheSameLinearField) {
    const HexMesh five = cube_of({{0, 1, 2, 4}, {3, 2, 1, 7}, {5, 4, 7, 1}, {6, 7, 4, 2}, {1, 2, 4, 7}});
    const HexMesh six = cube_of({{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}});
    const HexMesh whole = test::box(1);
    const auto draw = [](const HexMesh& mesh) { return render_tets(valued(mesh, linear), {}, view(), kinked_optics()); };
    const auto expected = draw(whole);
    EXPECT_EQ(expected.report.tets, 6u);
    // Along the diagonal a row of rays lies in faces between the six tetrahedra, up to rounding.
    for (const HexMesh* mesh : {&five, &six}) {
        const auto result = draw(*mesh);
        EXPECT_EQ(result.report.tets, 6 * mesh->cells.size());
        EXPECT_EQ(result.report.lost_rays, 0u);
        EXPECT_LT(largest_difference(result.image, expected.image), kFloatTol);
    }
}

INSTANTIATE_TEST_SUITE_P(Cameras, FromEverywhere, testing::ValuesIn(kPlaces),
                         [](const auto& place) { return std::string(place.param.name); });

}  // namespace reference_agreement_test
}  // namespace subvol
