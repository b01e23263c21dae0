// SPDX-License-Identifier: Apache-2.0
// Every hexahedral mesh of the collection of real meshes is compared with its published figures.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "lib/test_meshes.h"
#include "subvol/error.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"

namespace subvol::test {

namespace real_meshes_test {

struct Field {
    std::string name, location;
    int components;
    double min, max;
};

// The figures of the collection's README.
struct RealMesh {
    std::string file;
    std::size_t points_used, cells, edges, faces, interior_edges, irregular_edges, boundary_faces, inverted_cells;
    double min_scaled_jacobian, volume;
    std::vector<Field> fields;
};

void PrintTo(const RealMesh& mesh, std::ostream* out) {
    *out << mesh.file;
}

const std::vector<RealMesh> kMeshes{
    {"amanzi_hexes_192.mesh", 293, 192, 748, 648, 460, 208, 144, 0, 0.1787, 1, {}},
    {"sofa_cylinder_hexa.msh", 5740, 4920, 16342, 15523, 13290, 400, 1526, 0, 0.7655, 0.0002005806834, {}},
    {"vtkdata_can.vtu",
     6724,
     4800,
     18163,
     16240,
     10803,
     0,
     3680,
     51,
     -0.4890,
     48.01932989,
     {{"DISPL", "point", 3, 2.461, 18.59},
      {"VEL", "point", 3, 2006, 5221},
      {"ACCL", "point", 3, 2.404e+05, 2.019e+08},
      {"EQPS", "cell", 1, 0.02158, 2.894}}},
    {"ansys_td28_fig14.vtk",
     7878,
     5214,
     20801,
     18140,
     10809,
     110,
     4996,
     0,
     0.8376,
     1.814923736e-05,
     {{"values", "cell", 1, 25, 895.6}}},
    {"amanzi_sphere_5800.mesh", 6147, 5800, 18046, 17700, 16846, 184, 600, 0, 0.5774, 4.14402479, {}},
    {"hexdom_igea_improve.vtk", 7043, 6016, 20034, 19008, 16194, 284, 1920, 0, 0.2074, 254166586.5, {}},
    {"trame_disk_out_ref.vtu",
     8499,
     7472,
     24436,
     23410,
     20460,
     224,
     1988,
     0,
     0.4813,
     1629.65723,
     {{"Temp", "point", 1, 293.1, 913.2},
      {"V", "point", 3, 0, 22.42},
      {"Pres", "point", 1, 0.006786, 0.02882},
      {"AsH3", "point", 1, 0.08048, 0.1848},
      {"GaMe3", "point", 1, 0.0002228, 0.007214},
      {"CH4", "point", 1, 0, 0.00117},
      {"H2", "point", 1, 0.8076, 0.9177}}},
    {"sibl_bunny_conforming.mesh", 28056, 26253, 82160, 80358, 75764, 17723, 3198, 0, 0.0926, 7.990835502, {}},
    {"geos_crackInPlane_benchmark.vtu",
     40172,
     29976,
     110265,
     100070,
     69697,
     8412,
     20284,
     0,
     0.5542,
     320,
     {{"attribute", "cell", 1, 0, 1}}},
    {"lox_post_103k.vtu",
     109744,
     102675,
     322012,
     314944,
     294336,
     0,
     13838,
     0,
     0.9991,
     3399.662205,
     {{"IBlank", "point", 1, -1, 1},
      {"Density", "point", 1, 1, 1},
      {"Momentum", "point", 3, 0, 1.391},
      {"StagnationEnergy", "point", 1, -0.5415, 4.396}}},
};

class RealMeshes : public testing::TestWithParam<RealMesh> {
protected:
    void SetUp() override {
        if (!data_folder()) GTEST_SKIP() << "SUBVOL_DATA does not name the folder of real meshes";
    }
};

void expect_field(const ReadResult& read, const Field& field) {
    const auto is_it = [&](const FieldInfo& info) { return info.name == field.name; };
    const auto info = std::find_if(read.fields.begin(), read.fields.end(), is_it);
    ASSERT_NE(info, read.fields.end()) << field.name;
    EXPECT_EQ(info->location, field.location);
    EXPECT_EQ(info->components, field.components);
    // The README gives four digits.
    const auto four_digits = [](double value) { return 5e-4 * std::abs(value) + 1e-12; };
    EXPECT_NEAR(info->min, field.min, four_digits(field.min)) << field.name;
    EXPECT_NEAR(info->max, field.max, four_digits(field.max)) << field.name;
    const Attribute* attribute = read.mesh.find_attribute(field.name);
    ASSERT_NE(attribute, nullptr);
    EXPECT_EQ(attribute->values.size(), read.mesh.points.size() * static_cast<std::size_t>(field.components));
}

TEST_P(RealMeshes, IsReadForWhatItIs) {
    const RealMesh& expected = GetParam();
    const ReadResult read = read_mesh(*data_folder() / expected.file);
    const MeshReport report = inspect(read.mesh);
    EXPECT_EQ(report.points_used, expected.points_used);
    EXPECT_EQ(report.cells, expected.cells);
    EXPECT_EQ(report.edges, expected.edges);
    EXPECT_EQ(report.faces, expected.faces);
    EXPECT_EQ(report.interior_edges, expected.interior_edges);
    std::size_t irregular = 0;
    for (const auto& [valence, count] : report.interior_edge_valence) irregular += valence == 4 ? 0 : count;
    EXPECT_EQ(irregular, expected.irregular_edges);
    EXPECT_EQ(report.boundary_faces, expected.boundary_faces);
    EXPECT_EQ(report.inverted_cells, expected.inverted_cells);
    EXPECT_EQ(report.nonmanifold_edges, 0u);
    EXPECT_NEAR(report.min_scaled_jacobian, expected.min_scaled_jacobian, 5e-5);  // four decimals are given
    // Ten digits are given; for files with `float` they refer to coordinates rounded to float.
    EXPECT_NEAR(report.volume, expected.volume, 5e-9 * expected.volume);
    for (const Field& field : expected.fields) expect_field(read, field);
}

INSTANTIATE_TEST_SUITE_P(Collection, RealMeshes, testing::ValuesIn(kMeshes),
                         [](const auto& mesh) { return mesh.param.file.substr(0, mesh.param.file.find('.')); });

TEST(RealTetrahedra, AreSplitIntoHexahedra) {
    if (!data_folder()) GTEST_SKIP() << "SUBVOL_DATA does not name the folder of real meshes";
    const ReadResult read = read_mesh(*data_folder() / "vtkdata_post_tet.vtk");
    EXPECT_THAT(read.warnings, testing::ElementsAre("8750 tetrahedra split into 35000 hexahedra"));
    const MeshReport report = inspect(read.mesh);
    EXPECT_EQ(report.cells, 35000u);
    EXPECT_EQ(report.nonmanifold_edges, 0u);  // two faces meet at every edge of a closed boundary
    EXPECT_EQ(report.boundary_faces % 3, 0u);
    double volume = 0;  // of the tetrahedra: the first corners of its four children are the corners of a tetrahedron
    for (std::size_t c = 0; c < read.mesh.cells.size(); c += 4) {
        const auto corner = [&](std::size_t k) { return read.mesh.points[read.mesh.cells[c + k][0]]; };
        volume += glm::dot(corner(1) - corner(0), glm::cross(corner(2) - corner(0), corner(3) - corner(0))) / 6;
    }
    EXPECT_NEAR(report.volume, volume, 1e-12 * volume);  // rounding
    expect_field(read, {"Pressure", "point", 1, 0.3554, 1.641});

    // The same cells left out: nothing remains.
    const auto without = [] {
        static_cast<void>(read_mesh(*data_folder() / "vtkdata_post_tet.vtk", {.other_cells = OtherCells::Ignore}));
    };
    EXPECT_THROW(without(), Error);
}

}  // namespace real_meshes_test

}  // namespace subvol::test
