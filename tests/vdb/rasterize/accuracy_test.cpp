// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "subvol/detail/solid_field.h"
#include "subvol/limit_level.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"
#include "subvol/model.h"
#include "subvol/rasterize.h"
#include "subvol/refine.h"
#include "subvol/vdb_grid.h"
#include "vdb/each_voxel.h"
#include "vdb/solid_columns.h"
#include "vdb/test_meshes.h"

namespace subvol {
namespace accuracy_test {

using namespace test;

const std::vector<std::string> kField{"f"};

struct Errors {
    double max = 0, rms = 0;
    std::size_t voxels = 0;
};

/// Compares a grid with a field at the voxel centres, where the field has a value.
template <class Exact>
Errors errors_of(const VdbGrid& grid, const Exact& exact) {
    Errors errors;
    const double h = grid.report().voxel_size_world;
    for_each_voxel(grid, [&](const Voxel& voxel, double stored) {
        const std::optional<double> value = exact(h * Vec3(voxel[0], voxel[1], voxel[2]));
        if (!value) return;  // the mesh reaches beyond the curved solid
        const double error = std::abs(stored - *value);
        errors.max = std::max(errors.max, error);
        errors.rms += error * error;
        ++errors.voxels;
    });
    errors.rms = std::sqrt(errors.rms / static_cast<double>(std::max<std::size_t>(errors.voxels, 1)));
    return errors;
}

/// Counts voxels inside the solid that are not active, and active ones outside it.
struct Mismatch {
    std::size_t inside = 0, missing = 0, leaked = 0;
};

Mismatch mismatch(const VdbGrid& grid, const HexMesh& mesh) {
    Mismatch result;
    const auto voxels = grid.voxels();
    const auto cursor = voxels->cursor();
    std::size_t agreed = 0;
    SolidColumns(mesh, grid.report().voxel_size_world).for_each([&](int i, int j, int k, int winding) {
        const bool active = cursor->corners({i, j, k}).active & 1;
        result.inside += winding != 0;
        result.missing += winding != 0 && !active;
        agreed += winding != 0 && active;
    });
    result.leaked = grid.report().active_voxels - agreed;
    return result;
}

HexMesh with_linear_field(HexMesh mesh) {
    const Box box = bounds(mesh);
    const double scale = 1 / box.diagonal();
    mesh.attributes.clear();
    return with_field(std::move(mesh), "f",
                      [=](const Vec3& p) { return glm::dot(Vec3(1.0, 2.0, -1.5), (p - box.center()) * scale); });
}

/// The active voxels are those inside the boundary, none missing and none twice. As every trilinear map reproduces linear
/// fields, the values are exact up to the rounding of a float at 1.2 and Newton's tolerance, if each centre was found in its
/// cell.
void expect_exact(const HexMesh& given, int resolution) {
    const HexMesh mesh = with_linear_field(without_unused_points(given));
    const VdbGrid grid = std::move(rasterize(mesh, kField, {.resolution = resolution}).front());
    const Mismatch off = mismatch(grid, mesh);
    EXPECT_GT(off.inside, 10000u);
    EXPECT_EQ(off.missing, 0u);
    EXPECT_EQ(off.leaked, 0u);
    const Box box = bounds(mesh);
    const Errors errors = errors_of(grid, [&](const Vec3& p) -> std::optional<double> {
        return glm::dot(Vec3(1.0, 2.0, -1.5), (p - box.center()) / box.diagonal());
    });
    EXPECT_LT(errors.max, 1.5e-7);
    ::testing::Test::RecordProperty("largest_error", std::to_string(errors.max));
}

TEST(VdbAccuracy, ModelsAreExactToTheVoxel) {
    for (const char* model : {"pawn", "ball", "twist", "nozzle"}) {
        SCOPED_TRACE(model);
        expect_exact(make_model(model), 90);
    }
}

class VdbAccuracyOfFile : public ::testing::TestWithParam<const char*> {};

TEST_P(VdbAccuracyOfFile, IsExactToTheVoxel) {
    const char* folder = std::getenv("SUBVOL_DATA");
    if (!folder) GTEST_SKIP() << "SUBVOL_DATA does not name the folder of meshes";
    expect_exact(read_mesh(std::filesystem::path(folder) / GetParam()).mesh, 110);
}

INSTANTIATE_TEST_SUITE_P(Files, VdbAccuracyOfFile,
                         ::testing::Values("amanzi_hexes_192.mesh", "amanzi_sphere_5800.mesh", "hexdom_igea_improve.vtk",
                                           "trame_disk_out_ref.vtu", "sibl_bunny_conforming.mesh"),
                         [](const auto& file) {
                             std::string name = file.param;
                             std::replace(name.begin(), name.end(), '.', '_');
                             return name;
                         });

/// A crash simulation with 51 inverted cells. Their tetrahedra reach beyond the boundary, but the voxels do not.
TEST(VdbAccuracyOfFiles, InvertedCellsLeakNothing) {
    const char* folder = std::getenv("SUBVOL_DATA");
    if (!folder) GTEST_SKIP() << "SUBVOL_DATA does not name the folder of meshes";
    const HexMesh mesh = with_linear_field(read_mesh(std::filesystem::path(folder) / "vtkdata_can.vtu").mesh);
    const VdbGrid grid = std::move(rasterize(mesh, kField, {.resolution = 300}).front());
    const Mismatch off = mismatch(grid, mesh);
    EXPECT_GT(off.inside, 100000u);
    EXPECT_EQ(off.leaked, 0u);
    EXPECT_EQ(off.missing, 0u);
}

/// A corner pushed through the opposite side: the cells about it are folded, and so are those of the refined mesh.
TEST(VdbAccuracy, FoldedCellsLeakNothing) {
    HexMesh mesh = with_field(box_mesh(3), "f", [](const Vec3&) { return 1.0; });
    for (Vec3& p : mesh.points) {
        if (glm::length(p - Vec3(1.0, 1.0, 1.0)) < 1e-9) p = Vec3(0.45, 0.52, 0.56);
        if (glm::length(p - Vec3(0.0, 1.0, 2.0 / 3.0)) < 1e-9) p = Vec3(0.5, 0.4, 1.2);
    }
    EXPECT_GT(measure_cells(mesh).inverted_cells, 0u);
    for (const int levels : {0, 1}) {
        const HexMesh refined = refine(mesh, {.scheme = {Scheme::Linear}, .levels = levels});
        const Mismatch off = mismatch(rasterize(refined, kField, {.resolution = 120}).front(), refined);
        EXPECT_GT(off.inside, 100000u);
        EXPECT_EQ(off.missing, 0u);
        EXPECT_EQ(off.leaked, 0u);
        const VdbGrid streamed = std::move(
            rasterize(mesh, kField, {.resolution = 120, .refine = {.scheme = {Scheme::Linear}, .levels = levels}}).front());
        // Bent faces are cut differently; this changes at most a layer of half a voxel here.
        EXPECT_NEAR(static_cast<double>(streamed.report().active_voxels), static_cast<double>(off.inside),
                    0.005 * static_cast<double>(off.inside));
    }
}

/// Errors of the limit of a mesh, and of its trilinear cells, whose error is known: an eighth of the squared cell size times
/// the field's second derivatives.
struct LimitErrors {
    Errors limit, trilinear;
};

/// Compares both with the analytic densities that the points of the mesh have.
template <class Density>
LimitErrors limit_errors(HexMesh mesh, int resolution, const Density& density) {
    mesh.attributes.resize(1);
    mesh.attributes.front().name = "f";
    const Box box = bounds(mesh);
    const double h = std::max({box.size().x, box.size().y, box.size().z}) / resolution;
    const LimitCells limit = limit_for_voxels(mesh, {}, h);
    const LimitErrors errors{
        errors_of(rasterize(mesh, kField, {.voxel_size_world = h, .limit = &limit}).front(), density),
        errors_of(rasterize(mesh, kField, {.voxel_size_world = h}).front(), density),
    };
    ::testing::Test::RecordProperty("level", limit.level);
    for (const auto& [name, of] : {std::pair{"", &errors.limit}, {"trilinear_", &errors.trilinear}}) {
        ::testing::Test::RecordProperty(name + std::string("max"), std::to_string(of->max));
        ::testing::Test::RecordProperty(name + std::string("rms"), std::to_string(of->rms));
    }
    return errors;
}

// The field is clipped at ±1: at that kink and at the boundary MCQ is of second order, so that half the cell size leaves about
// a quarter of the error. The range is 2.
TEST(VdbAccuracy, LimitOfTheTwistedBlock) {
    const auto density = [](const Vec3& x) { return TwistField().value(x); };
    const LimitErrors coarse = limit_errors(make_model("twist", 8), 60, density);
    const LimitErrors fine = limit_errors(make_model("twist", 16), 60, density);
    EXPECT_LT(fine.limit.rms, coarse.limit.rms / 3);
    // At kinks and sides it is a few times better than trilinear cells, which are of second order everywhere.
    EXPECT_LT(fine.limit.rms, fine.trilinear.rms / 2);
    EXPECT_LT(fine.limit.max, fine.trilinear.max);
}

// Away from both it reproduces cubics: the order is above three.
TEST(VdbAccuracy, LimitWithinTheTwistedBlock) {
    const auto density = [](const Vec3& x) -> std::optional<double> {
        const Vec3 p = TwistField::parameter(x);
        const auto value = TwistField().value(x);
        if (!value || std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > 0.6 || std::abs(*value) > 0.6) return {};
        return value;
    };
    const LimitErrors coarse = limit_errors(make_model("twist", 12), 60, density);
    const LimitErrors fine = limit_errors(make_model("twist", 24), 60, density);
    EXPECT_LT(fine.limit.rms, coarse.limit.rms / 8);
    // The error of trilinear cells, 1/200 here, is a small number squared, that of the limit its fourth power.
    EXPECT_LT(fine.limit.rms, fine.trilinear.rms / 10);
}

TEST(VdbAccuracy, LimitOfTheBall) {
    const auto density = [](const Vec3& x) { return BallField().value(x); };
    const LimitErrors errors = limit_errors(make_model("ball", 12), 80, density);
    // Smooth inside, with the sphere as the only place where it is of second order.
    EXPECT_LT(errors.limit.rms, errors.trilinear.rms / 5);
    EXPECT_LT(errors.limit.max, errors.trilinear.max / 2);
}

TEST(VdbAccuracy, LimitOfThePawn) {
    const auto density = [](const Vec3& x) { return detail::PawnField().value(x); };
    const LimitErrors errors = limit_errors(make_model("pawn"), 60, density);
    // Its density changes from -1 to 1 within four cells of the surface and is constant elsewhere: two kinks, as above.
    EXPECT_LT(errors.limit.rms, errors.trilinear.rms / 2);
    EXPECT_LT(errors.limit.max, errors.trilinear.max);
}

// Centres fall at random across the boundary, so that the error is below surface × h; its mean over shifted meshes falls with
// at least the first power of h.
TEST(VdbAccuracy, ActiveVolumeIsTheMeshsToFirstOrder) {
    const HexMesh mesh = with_field(make_model("ball", 8), "f", [](const Vec3&) { return 1.0; });
    const double volume = measure_cells(mesh).volume, surface = 4 * kPi;
    std::vector<double> means;
    for (const double h : {0.08, 0.04, 0.02}) {
        double sum = 0;
        constexpr int kShifts = 6;
        for (int s = 0; s < kShifts; ++s) {
            HexMesh shifted = mesh;
            for (Vec3& p : shifted.points) p += h * Vec3(0.17, 0.29, 0.41) * double(s);
            const auto grids = rasterize(shifted, kField, {.voxel_size_world = h});
            const double error = std::abs(static_cast<double>(grids.front().report().active_voxels) * h * h * h - volume);
            EXPECT_LT(error, surface * h);
            sum += error / kShifts;
        }
        means.push_back(sum);
    }
    const double order = std::log2(means[0] / means[2]) / 2;
    RecordProperty("order", std::to_string(order));
    EXPECT_GT(order, 1.0);
}

}  // namespace accuracy_test
}  // namespace subvol
