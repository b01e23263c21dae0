// SPDX-License-Identifier: Apache-2.0
// Rays through the dense grids of real meshes from 26 directions, one ray of each picture through a point of the grids: no ray
// is lost, and the length inside equals that between the crossings of the limit's boundary, found without any adjacency.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "lib/test_meshes.h"
#include "render/boundary_length.h"
#include "render/hex_meshes.h"
#include "subvol/limit.h"
#include "subvol/mesh_io.h"
#include "subvol/render_dense.h"

namespace subvol {

using namespace detail;
namespace dense_robustness_test {

constexpr double kLengthTol = 1e-4;  // of the diagonal: the requirement; pictures are floats, 2e-7 of it
constexpr int kSize = 9;             // odd: there is a ray in the middle
constexpr int kLevel = 1;

void expect_robust(const HexMesh& mesh, const std::string& name) {
    const std::vector<double> ones(mesh.points.size(), 1.0);
    const HexMesh fine = test::numbered_by_position(on_limit(refine(mesh, {.levels = kLevel}), Scheme::Mcq));
    const TetMesh tets = build_tet_mesh(fine, std::vector<double>(fine.points.size(), 1.0));
    const double diagonal = bounds(mesh).diagonal();
    const Optics optics({{{0, {1, 1, 1}}}, {{0, 0.5}}}, diagonal);
    std::mt19937 random(3);
    std::uniform_int_distribution<std::size_t> any(0, fine.points.size() - 1);
    std::size_t rays = 0, off = 0;
    double worst = 0;
    for (const Vec3& d : test::directions()) {
        const Vec3 through = fine.points[any(random)];
        const View view({.eye = through - 2 * diagonal * normalize(d),
                         .target = through,
                         .up = {0.1, 0.2, 1},
                         .ortho_height = 1.5 * diagonal},
                        kSize, kSize);
        const auto result = render_dense(test::valued(mesh, ones), {}, view, optics, {.levels = kLevel});
        EXPECT_EQ(result.report.lost_rays, 0u) << name;
        for (int y = 0; y < kSize; ++y) {
            for (int x = 0; x < kSize; ++x) {
                const double alpha = result.image.pixel(x, y)[3];
                ASSERT_TRUE(std::isfinite(alpha)) << name;
                const double error =
                    test::length_error(tets, view.ray(x + 0.5, y + 0.5), -std::log2(1 - alpha), diagonal, kLengthTol);
                worst = std::max(worst, error);
                ++rays;
                if (error > kLengthTol) ++off;
            }
        }
    }
    testing::Test::RecordProperty(name + ": rays", std::to_string(rays));
    testing::Test::RecordProperty(name + ": off", std::to_string(off));
    testing::Test::RecordProperty(name + ": worst length, 1e-9 diagonals", std::to_string(1e9 * worst));
    EXPECT_LE(off, rays / 1000) << name << ": by up to " << worst << " of the diagonal";
}

class RealDense : public testing::TestWithParam<const char*> {};

TEST_P(RealDense, RaysAreFollowed) {
    const auto data = test::data_folder();
    if (!data) GTEST_SKIP() << "SUBVOL_DATA does not name the folder of real meshes";
    HexMesh mesh = read_mesh(*data / GetParam()).mesh;
    expect_robust(mesh, GetParam());
    const Vec3 far = 1e6 * bounds(mesh).diagonal() * Vec3(1, -0.7, 0.3);
    for (Vec3& p : mesh.points) p += far;
    expect_robust(mesh, GetParam() + std::string(", far away"));
}

INSTANTIATE_TEST_SUITE_P(Collection, RealDense,
                         testing::Values("amanzi_hexes_192.mesh", "sofa_cylinder_hexa.msh", "amanzi_sphere_5800.mesh",
                                         "hexdom_igea_improve.vtk", "trame_disk_out_ref.vtu"),
                         [](const auto& file) {
                             const std::string name = file.param;
                             return name.substr(0, name.find('.'));
                         });

}  // namespace dense_robustness_test
}  // namespace subvol
