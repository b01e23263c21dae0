// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/vtkhdf_writer.h"

#include <gmock/gmock.h>

#include "lib/temp_folder.h"

namespace subvol::detail {
namespace vtkhdf_writer_test {

using testing::ElementsAre;

using VtkHdfWriters = test::TempFolder;

// Two tetrahedra, and arrays whose names HDF5 does not have or which are the same.
TEST_F(VtkHdfWriters, WriteAGridOfOneTypeOfCells) {
    const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
    const std::vector<std::int64_t> corners{0, 1, 2, 3, 1, 2, 3, 4};
    const std::vector<double> values{1, 2, 3, 4, 5}, at_cells{1, 2, 3, 4, 5, 6};
    std::vector<std::string> names;
    VtkHdfWriter writer(path("a.vtkhdf"));
    writer.grid(points, corners, 10, 4);
    for (const std::string name : {"a/b", "a_b", "", ".", "a_b"}) names.push_back(writer.array<double>(name, values, 1));
    EXPECT_EQ(writer.cell_array<double>("a/b", at_cells, 3), "a_b") << "names of cells are others";
    EXPECT_EQ(writer.field("ids", corners), "ids");
    writer.commit();
    EXPECT_THAT(names, ElementsAre("a_b", "a_b_", "field", "field_", "a_b__"));
    const Hdf5File file(open_hdf5(path("a.vtkhdf")), "a.vtkhdf");
    EXPECT_EQ(file.text("/VTKHDF", "Type"), "UnstructuredGrid");
    EXPECT_THAT(file.numbers("/VTKHDF", "Version"), ElementsAre(1, 0));
    EXPECT_THAT(file.integers("/VTKHDF/NumberOfPoints"), ElementsAre(5));
    EXPECT_THAT(file.integers("/VTKHDF/NumberOfCells"), ElementsAre(2));
    EXPECT_THAT(file.integers("/VTKHDF/NumberOfConnectivityIds"), ElementsAre(8));
    EXPECT_THAT(file.integers("/VTKHDF/Offsets"), ElementsAre(0, 4, 8));
    EXPECT_THAT(file.integers("/VTKHDF/Types"), ElementsAre(10, 10));
    EXPECT_EQ(file.integers("/VTKHDF/Connectivity"), corners);
    EXPECT_EQ(file.columns("/VTKHDF/Points"), 3U);
    EXPECT_THAT(file.reals("/VTKHDF/Points", 4, 1), ElementsAre(1, 1, 1));
    EXPECT_EQ(file.names("/VTKHDF/PointData").size(), names.size());
    for (const std::string& name : names) EXPECT_EQ(file.reals("/VTKHDF/PointData/" + name), values) << name;
    EXPECT_EQ(file.columns("/VTKHDF/CellData/a_b"), 3U);
    EXPECT_EQ(file.reals("/VTKHDF/CellData/a_b"), at_cells);
    EXPECT_EQ(file.integers("/VTKHDF/FieldData/ids"), corners);
}

}  // namespace vtkhdf_writer_test
}  // namespace subvol::detail
