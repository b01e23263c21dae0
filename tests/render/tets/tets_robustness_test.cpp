// SPDX-License-Identifier: Apache-2.0
// Rays through points, edges and other places, along axes and diagonals, through many meshes: no ray is lost, and the length
// inside equals that between the crossings of the boundary, found without any adjacency. SUBVOL_SWEEP=n takes n times as many
// rays.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>

#include "boundary_scene.h"
#include "render/boundary_length.h"
#include "render/hex_meshes.h"
#include "subvol/mesh_io.h"
#include "subvol/model.h"
#include "tet_tracer.h"

namespace subvol {

using namespace detail;
namespace tets_robustness_test {

const detail::RayClip kNoClip;

constexpr double kLengthTol = 1e-4;  // of the diagonal: the requirement; offsets of 10⁶ diagonals round by 1e-10 of it
constexpr std::size_t kRays = 3;     // of each kind and direction

std::size_t sweep() {
    const char* text = std::getenv("SUBVOL_SWEEP");
    return text ? std::max<std::size_t>(1, std::strtoul(text, nullptr, 10)) : 1;
}

class Swept {
public:
    Swept(const HexMesh& mesh, std::string name)
        : name_(std::move(name)),
          box_(bounds(mesh)),
          tets_(build_tet_mesh(mesh, std::vector<double>(mesh.points.size(), 1.0))),
          scene_(tets_, box_),
          optics_({{{0, {1, 1, 1}}}, {{0, 0.5}}}, box_.diagonal()),
          tracer_(tets_, scene_, optics_, kNoClip) {}

    void all_directions() {
        for (const Vec3& d : test::directions()) {
            for (std::size_t i = 0; i < kRays * sweep(); ++i) {
                follow(point(), d);
                follow(0.5 * (corner(0) + corner(1)), d);
                follow(box_.lower + Vec3(part(), part(), part()) * box_.size(), d);
            }
        }
        testing::Test::RecordProperty(name_ + ": rays", std::to_string(tracer_.counts().rays));
        testing::Test::RecordProperty(name_ + ": lost", std::to_string(tracer_.counts().lost_rays));
        testing::Test::RecordProperty(name_ + ": off", std::to_string(missed_));
        testing::Test::RecordProperty(name_ + ": worst length, 1e-9 diagonals", std::to_string(1e9 * worst_));
        EXPECT_EQ(tracer_.counts().lost_rays, 0u) << name_ << ": of " << tracer_.counts().rays;
        // Where a crushed mesh folds over itself, two walks may share a stretch that is outside by the boundary's winding
        // number.
        EXPECT_LE(missed_, traced_ / 1000) << name_ << ": lengths off, of " << traced_ << " rays, by up to " << worst_
                                           << " of the diagonal";
    }

private:
    double part() { return std::uniform_real_distribution<double>(0, 1)(random_); }
    /// A corner of the last tetrahedron that was chosen; corner 0 chooses another one.
    Vec3 corner(std::size_t k) {
        if (k == 0) tet_ = std::uniform_int_distribution<std::size_t>(0, tets_.tets.size() - 1)(random_);
        return tets_.points[tets_.tets[tet_].corner[k]].position;
    }
    Vec3 point() { return corner(0); }

    void follow(const Vec3& through, const Vec3& direction) {
        const Ray ray{through - 2 * box_.diagonal() * direction, direction};
        const Segment seen = tracer_.trace(ray);
        ASSERT_TRUE(std::isfinite(seen.transmittance) && std::isfinite(seen.color.x)) << name_;
        const double length = -std::log2(seen.transmittance);  // in diagonals, as is the opacity's unit
        const double error = test::length_error(tets_, ray, length, box_.diagonal(), kLengthTol);
        ++traced_;
        worst_ = std::max(worst_, error);
        if (error > kLengthTol) ++missed_;
    }

    std::string name_;
    Box box_;
    TetMesh tets_;
    BoundaryScene scene_;
    Optics optics_;
    TetTracer tracer_;
    std::mt19937 random_{7};
    std::size_t tet_ = 0, traced_ = 0, missed_ = 0;
    double worst_ = 0;
};

void expect_robust(HexMesh mesh, const std::string& name) {
    Swept(mesh, name).all_directions();
    const Vec3 far = 1e6 * bounds(mesh).diagonal() * Vec3(1, -0.7, 0.3);
    for (Vec3& p : mesh.points) p += far;
    Swept(mesh, name + ", far away").all_directions();
}

TEST(TetsRobustness, GeneratedMeshes) {
    expect_robust(test::box(4), "box");
    expect_robust(test::box(1), "cell");
    expect_robust(test::l_shape(4), "L");
    expect_robust(test::ball(8), "ball");
    expect_robust(test::jittered_box(6, 0.9, 99), "tangled box");
    for (const char* name : {"pawn", "twist", "nozzle", "fan"}) expect_robust(make_model(name, 12), name);
}

TEST(TetsRobustness, FlatAndInvertedCells) {
    HexMesh flat = test::box(4);
    for (Vec3& p : flat.points) {
        if (p.z == 0.5) p.z = 0.25;
    }
    expect_robust(flat, "a layer without thickness");
    HexMesh inverted = test::box(4);
    for (std::size_t c = 0; c < inverted.cells.size(); c += 7) {
        std::swap_ranges(inverted.cells[c].begin(), inverted.cells[c].begin() + 4, inverted.cells[c].begin() + 4);
    }
    expect_robust(inverted, "left-handed cells");
}

class RealTets : public testing::TestWithParam<const char*> {};

TEST_P(RealTets, RaysAreFollowed) {
    const char* folder = std::getenv("SUBVOL_DATA");
    if (!folder) GTEST_SKIP() << "SUBVOL_DATA does not name the folder of real meshes";
    expect_robust(read_mesh(std::filesystem::path(folder) / GetParam()).mesh, GetParam());
}

INSTANTIATE_TEST_SUITE_P(Collection, RealTets,
                         testing::Values("amanzi_hexes_192.mesh", "sofa_cylinder_hexa.msh", "vtkdata_can.vtu",
                                         "ansys_td28_fig14.vtk", "amanzi_sphere_5800.mesh", "hexdom_igea_improve.vtk",
                                         "trame_disk_out_ref.vtu", "sibl_bunny_conforming.mesh",
                                         "geos_crackInPlane_benchmark.vtu", "lox_post_103k.vtu", "vtkdata_post_tet.vtk"),
                         [](const auto& file) {
                             const std::string name = file.param;
                             return name.substr(0, name.find('.'));
                         });

}  // namespace tets_robustness_test
}  // namespace subvol
