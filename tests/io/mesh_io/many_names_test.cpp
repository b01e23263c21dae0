// SPDX-License-Identifier: Apache-2.0
// Many arrays, of one name and of many, and many blocks: time in proportion, few warnings.

#include <gmock/gmock.h>

#include <ctime>

#include "io/mesh_io/mesh_texts.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/mesh_report.h"
#include "subvol/mesh_series.h"

namespace subvol::test {

namespace many_names_test {

using testing::ElementsAre;
using testing::HasSubstr;

class ManyNames : public TempFolder {
protected:
    // Quadratic times are minutes here, and cubic ones hours.
    ~ManyNames() override { EXPECT_LT((std::clock() - begin_) / CLOCKS_PER_SEC, 60) << "CPU seconds"; }

    // Legacy VTK of a cube at a place on the x axis, each array with its number at all points.
    [[nodiscard]] static std::string vtk(const std::vector<std::string>& names) {
        std::string text = vtk_text(make_box(1, 1, 1)) + "POINT_DATA 8\nFIELD f " + std::to_string(names.size()) + "\n";
        for (std::size_t k = 0; k < names.size(); ++k) {
            text += names[k] + " 1 8 double\n";
            for (int p = 0; p < 8; ++p) text += std::to_string(k) + " ";
            text += "\n";
        }
        return text;
    }

    [[nodiscard]] static std::vector<std::string> numbered(int count) {
        std::vector<std::string> names;
        for (int k = 0; k < count; ++k) names.push_back("a" + std::to_string(k));
        return names;
    }

private:
    std::clock_t begin_ = std::clock();
};

TEST_F(ManyNames, ArraysOfOneNameAreNumberedWithOneWarning) {
    const ReadResult result = read_mesh(write("a.vtk", vtk(std::vector<std::string>(5000, "f"))));
    ASSERT_EQ(result.mesh.attributes.size(), 5000u);
    EXPECT_EQ(result.mesh.attributes[0].name, "f");
    EXPECT_EQ(result.mesh.attributes[1].name, "f_2");
    EXPECT_EQ(result.mesh.attributes[4999].name, "f_5000");
    EXPECT_EQ(result.mesh.attributes[4999].values[0], 4999);
    EXPECT_THAT(result.warnings,
                ElementsAre("there is more than one array \"f\": 4999 others are called \"f_2\" to \"f_5000\""));
}

TEST_F(ManyNames, NumbersOfRepeatedNamesAreThoseOfNoOtherArray) {
    const ReadResult result = read_mesh(write("a.vtk", vtk({"f_2", "f", "f", "f_2", "f", "g", "g"})));
    std::vector<std::string> names;
    for (const Attribute& attribute : result.mesh.attributes) names.push_back(attribute.name);
    EXPECT_THAT(names, ElementsAre("f_2", "f", "f_3", "f_2_2", "f_4", "g", "g_2"));
    EXPECT_THAT(result.warnings, ElementsAre("there is more than one array \"f\": 2 others are called \"f_3\" to \"f_4\"",
                                             "there is more than one array \"f_2\": another is called \"f_2_2\"",
                                             "there is more than one array \"g\": another is called \"g_2\""));
}

TEST_F(ManyNames, ManyArraysInOneFileAndInPieces) {
    constexpr int kArrays = 10000;
    const ReadResult whole = read_mesh(write("a.vtk", vtk(numbered(kArrays))));
    ASSERT_EQ(whole.mesh.attributes.size(), std::size_t{kArrays});
    EXPECT_EQ(whole.mesh.attributes[9999].values[7], 9999);
    HexMesh mesh = whole.mesh;
    static_cast<void>(write_mesh(path("0.vtu"), mesh));
    for (Vec3& x : mesh.points) x.x += 1;
    std::ranges::reverse(mesh.attributes);
    mesh.attributes.pop_back();
    static_cast<void>(write_mesh(path("1.vtu"), mesh));
    write("a.pvtu",
          "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid><Piece Source=\"0.vtu\"/><Piece Source=\"1.vtu\"/>"
          "</PUnstructuredGrid></VTKFile>");
    const ReadResult joined = read_mesh(path("a.pvtu"));
    EXPECT_EQ(joined.mesh.cells.size(), 2u);
    ASSERT_EQ(joined.mesh.attributes.size(), std::size_t{kArrays - 1});
    EXPECT_EQ(joined.mesh.attributes[9998].name, "a9999");
    EXPECT_EQ(joined.mesh.attributes[9998].values[11], 9999);
    EXPECT_THAT(joined.warnings, testing::Contains(HasSubstr("field \"a0\" has no value at 4 of 12 points")));
}

TEST_F(ManyNames, ManyBlocks) {
    constexpr int kBlocks = 1000;
    HexMesh mesh = make_box(1, 1, 1);
    std::string list = "<VTKFile type=\"vtkMultiBlockDataSet\"><vtkMultiBlockDataSet>";
    for (int k = 0; k < kBlocks; ++k) {
        static_cast<void>(write_mesh(path(std::to_string(k) + ".vtu"), mesh));
        for (Vec3& x : mesh.points) x.x += 1;
        list += "<DataSet name=\"b" + std::to_string(k / 2) + "\" file=\"" + std::to_string(k) + ".vtu\"/>\n";
    }
    const ReadResult result = read_mesh(write("a.vtm", list + "</vtkMultiBlockDataSet></VTKFile>"));
    ASSERT_EQ(result.blocks.size(), std::size_t{kBlocks / 2});
    EXPECT_EQ(result.blocks.back().name, "b499");
    EXPECT_EQ(result.blocks.back().cells, 2u);
    EXPECT_NEAR(inspect(result.mesh).volume, kBlocks, 1e-9);
}

}  // namespace many_names_test

}  // namespace subvol::test
