// SPDX-License-Identifier: Apache-2.0
// A field that is affine in the positions stays so under every scheme, whatever the mesh: weights sum to 1, to the last bits.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/test_meshes.h"
#include "subvol/mesh_io.h"
#include "subvol/refine.h"

namespace subvol {
namespace affine_test {

class AffineFields : public testing::TestWithParam<const char*> {};

TEST_P(AffineFields, StayAffine) {
    const auto data = test::data_folder();
    if (!data) GTEST_SKIP() << "SUBVOL_DATA does not name the folder of real meshes";
    HexMesh mesh = read_mesh(*data / GetParam()).mesh;
    mesh.attributes.clear();
    const Box box = bounds(mesh);
    const auto affine = [&](const Vec3& p) {  // of values to about 1
        return glm::dot(Vec3(.6, -.3, .4), (p - box.center()) / box.diagonal()) + .1;
    };
    test::add_field(mesh, "affine", affine);
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw, Scheme::Linear}) {
        const HexMesh fine = refine(mesh, {.scheme = {scheme}, .levels = mesh.cells.size() < 10000 ? 2 : 1});
        double worst = 0;
        for (std::size_t p = 0; p < fine.points.size(); ++p) {
            worst = std::max(worst, std::abs(fine.attributes[0].values[p] - affine(fine.points[p])));
        }
        // Coordinates far from the origin are rounded themselves: by this much relative to the box.
        const double rounding = glm::length(box.center()) / box.diagonal();
        EXPECT_LT(worst, 1e-13 * std::max(1.0, rounding)) << "scheme " << static_cast<int>(scheme);
    }
}

INSTANTIATE_TEST_SUITE_P(Meshes, AffineFields,
                         testing::Values("amanzi_hexes_192.mesh", "sofa_cylinder_hexa.msh", "vtkdata_can.vtu",
                                         "ansys_td28_fig14.vtk", "amanzi_sphere_5800.mesh", "hexdom_igea_improve.vtk",
                                         "trame_disk_out_ref.vtu", "sibl_bunny_conforming.mesh",
                                         "geos_crackInPlane_benchmark.vtu", "lox_post_103k.vtu", "vtkdata_post_tet.vtk"));

}  // namespace affine_test
}  // namespace subvol
