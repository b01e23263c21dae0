// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "render/hex_meshes.h"
#include "render/image_differences.h"
#include "subvol/error.h"
#include "subvol/refine_mixed.h"
#include "subvol/render_tets.h"

namespace subvol {
namespace mixed_tets_test {

using test::largest_difference;

Optics ramp_optics() {
    return {{{{0, {1, 0, 0}}, {0.5, {0, 1, 0.2}}, {1, {0.1, 0.3, 1}}}, {{0, 0}, {0.3, 0.1}, {0.35, 0.6}, {1, 0.8}}}, 1.0};
}

View slanted_view(int size) {
    return {{.eye = {2.1, 1.7, 2.9}, .target = {0.5, 0.5, 0.5}, .up = {0, 1, 0}, .fovy_deg = 35}, size, size};
}

TEST(MixedTets, TetrahedraAsTheyAreGiveThePictureOfTheirHexahedra) {
    MixedMesh control = in_tetrahedra(make_mixed_mesh(test::jittered_box(2, 0.2, 5), {}));
    Attribute field{"f", 1, {}};
    for (const Vec3& p : control.points) field.values.push_back(std::sin(3 * p.x) * std::cos(2 * p.y) + p.z);
    control.attributes = {field};
    const MixedMesh mesh = refine(control, {.scheme = TetScheme::Tetoct, .levels = 1});  // with octahedra
    const View view = slanted_view(48);
    const TetsResult direct = TetsRenderer(mesh).draw(view, ramp_optics());
    const TetsResult split = TetsRenderer(in_hexahedra(mesh)).draw(view, ramp_optics());
    EXPECT_EQ(direct.report.tets, mesh.tets.size() + 4 * mesh.octahedra.size());
    EXPECT_EQ(split.report.tets, 24 * direct.report.tets);
    EXPECT_EQ(direct.report.lost_rays, 0u);
    EXPECT_EQ(direct.report.inverted_tets, 0u);
    EXPECT_LT(largest_difference(direct.image, split.image), 1e-5);  // rounding at kinks of the transfer function
}

TEST(MixedTets, AMixedMeshNeedsAFieldOfOneChannel) {
    MixedMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.tets = {{0, 1, 2, 3}};
    EXPECT_THROW(TetsRenderer{mesh}, Error);
    mesh.attributes = {{"v", 3, std::vector<double>(12)}};
    EXPECT_THROW(TetsRenderer{mesh}, Error);
    mesh.attributes.push_back({"f", 1, {1, 1, 1, 1}});
    EXPECT_THROW(TetsRenderer(mesh, "g"), Error);
    EXPECT_EQ(TetsRenderer(mesh, "f").draw(slanted_view(8), ramp_optics()).report.tets, 1u);
}

}  // namespace mixed_tets_test
}  // namespace subvol
