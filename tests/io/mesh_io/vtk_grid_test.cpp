// SPDX-License-Identifier: Apache-2.0
#include "subvol/vtk_grid.h"

#include <gmock/gmock.h>

#include <string>
#include <string_view>

#include "lib/expect_error.h"
#include "lib/temp_folder.h"
#include "subvol/mesh_io.h"

namespace subvol::test {

namespace vtk_grid_test {

class VtkGridInMemory : public TempFolder {};

/// A hexahedron, a polyhedron of the same shape on it and a prism beside it, with a value at points and one at cells.
VtkUnstructuredGrid three_cells() {
    VtkUnstructuredGrid grid;
    grid.types = {12, 42, 13};
    grid.ends = {8, 16, 22};
    for (int z = 0; z < 3; ++z) {
        for (const Vec2 p : {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)}) grid.points.emplace_back(p.x, p.y, z);
    }
    grid.points.insert(grid.points.end(), {{2, 0.5, 0}, {2, 0.5, 1}});
    grid.connectivity = {0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 7, 8, 9, 10, 11, 1, 12, 2, 5, 13, 6};
    grid.faces = {6, 4, 4, 7, 6, 5, 4, 8, 9, 10, 11, 4, 4, 5, 9, 8, 4, 5, 6, 10, 9, 4, 6, 7, 11, 10, 4, 7, 4, 8, 11};
    grid.face_ends = {0, 31, 31};
    grid.arrays = {{"f", 1, false, {}}, {"c", 2, true, {1, 2, 3, 4, 5, 6}}};
    for (const Vec3& p : grid.points) grid.arrays[0].values.push_back(p.x + 2 * p.z);
    return grid;
}

template <class Numbers>
std::string text_of(const Numbers& numbers) {
    std::string text;
    for (const auto number : numbers) text += std::to_string(number) + " ";
    return text;
}

std::string vtu_of(const VtkUnstructuredGrid& grid) {
    const auto array = [](const std::string& about, const std::string& numbers) {
        return "<DataArray format=\"ascii\" " + about + ">" + numbers + "</DataArray>\n";
    };
    std::string points, of_points, of_cells;
    for (const Vec3& p : grid.points) points += text_of(std::array{p.x, p.y, p.z});
    for (const VtkGridArray& a : grid.arrays) {
        (a.at_cells ? of_cells : of_points) +=
            array("type=\"Float64\" Name=\"" + a.name + "\" NumberOfComponents=\"" + std::to_string(a.components) + "\"",
                  text_of(a.values));
    }
    return "<VTKFile type=\"UnstructuredGrid\" version=\"2.2\"><UnstructuredGrid><Piece NumberOfPoints=\"" +
           std::to_string(grid.points.size()) + "\" NumberOfCells=\"" + std::to_string(grid.types.size()) + "\"><Points>" +
           array("type=\"Float64\" NumberOfComponents=\"3\"", points) + "</Points><Cells>" +
           array("type=\"Int64\" Name=\"connectivity\"", text_of(grid.connectivity)) +
           array("type=\"Int64\" Name=\"offsets\"", text_of(grid.ends)) +
           array("type=\"UInt8\" Name=\"types\"", text_of(grid.types)) +
           array("type=\"Int64\" Name=\"faces\"", text_of(grid.faces)) +
           array("type=\"Int64\" Name=\"faceoffsets\"", text_of(grid.face_ends)) + "</Cells><PointData>" + of_points +
           "</PointData><CellData>" + of_cells + "</CellData></Piece></UnstructuredGrid></VTKFile>";
}

TEST_F(VtkGridInMemory, IsTheMeshOfItsFile) {
    const VtkUnstructuredGrid grid = three_cells();
    const ReadResult in_memory = mesh_of_vtk(grid), read = read_mesh(write("a.vtu", vtu_of(grid)));
    EXPECT_GT(in_memory.mesh.cells.size(), 2u + 6u);  // all were split, as there is a prism
    EXPECT_EQ(in_memory.mesh.points, read.mesh.points);
    EXPECT_EQ(in_memory.mesh.cells, read.mesh.cells);
    EXPECT_EQ(in_memory.warnings, read.warnings);
    ASSERT_EQ(in_memory.mesh.attributes.size(), 2u);
    for (std::size_t a = 0; a < 2; ++a) {
        EXPECT_EQ(in_memory.mesh.attributes[a].name, read.mesh.attributes[a].name);
        EXPECT_EQ(in_memory.mesh.attributes[a].values, read.mesh.attributes[a].values);
    }
}

VtkUnstructuredGrid one_cell(double x, const std::string& field) {
    VtkUnstructuredGrid grid;
    for (const Vec3& p : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)}) grid.points.push_back(p + Vec3(x, 0, 0));
    for (int k = 0; k < 4; ++k) grid.points.push_back(grid.points[static_cast<std::size_t>(k)] + Vec3(0, 0, 1));
    grid.types = {12};
    grid.ends = {8};
    grid.connectivity = {0, 1, 2, 3, 4, 5, 6, 7};
    grid.arrays = {{"f", 1, false, std::vector<double>(8, x)}, {field, 1, false, std::vector<double>(8, 1)}};
    return grid;
}

TEST_F(VtkGridInMemory, HasTheCreasesAndSharpFacesOfItsFile) {
    HexMesh mesh = mesh_of_vtk(std::vector<VtkUnstructuredGrid>{one_cell(0, "a"), one_cell(1, "b")}).mesh;
    EXPECT_TRUE(vtk_field_arrays(mesh).empty());
    mesh.creases = {{mesh.cells[0][0], mesh.cells[0][3]}};
    mesh.sharp_faces = {{mesh.cells[0][1], mesh.cells[0][2], mesh.cells[0][6], mesh.cells[0][5]}};
    VtkUnstructuredGrid grid;
    grid.points = mesh.points;
    grid.types = {12, 12};
    grid.ends = {8, 16};
    for (const auto& cell : mesh.cells) grid.connectivity.insert(grid.connectivity.end(), cell.begin(), cell.end());
    grid.field_arrays = vtk_field_arrays(mesh);
    write_mesh(path("sharp.vtu"), mesh);
    const ReadResult in_memory = mesh_of_vtk(grid), read = read_mesh(path("sharp.vtu"));
    EXPECT_EQ(in_memory.mesh.creases.size(), 1u);
    EXPECT_EQ(in_memory.mesh.sharp_faces.size(), 1u);
    EXPECT_EQ(in_memory.mesh.creases, read.mesh.creases);
    EXPECT_EQ(in_memory.mesh.sharp_faces, read.mesh.sharp_faces);
    EXPECT_TRUE(in_memory.warnings.empty());
    VtkUnstructuredGrid kept = one_cell(0, "a");  // programs that change a mesh keep the array
    kept.field_arrays = grid.field_arrays;
    const ReadResult ignored = mesh_of_vtk(kept);
    EXPECT_TRUE(ignored.mesh.creases.empty());
    ASSERT_EQ(ignored.warnings.size(), 1u);
    EXPECT_THAT(ignored.warnings[0], testing::HasSubstr("another mesh"));
}

TEST_F(VtkGridInMemory, BlocksAreTheMeshOfAListOfTheirFiles) {
    const std::vector<VtkUnstructuredGrid> blocks{one_cell(0, "a"), {}, one_cell(1, "b")};
    write("a.vtu", vtu_of(blocks[0]));
    write("b.vtu", vtu_of(blocks[2]));
    const auto list = write("all.vtm",
                            "<VTKFile type=\"vtkMultiBlockDataSet\"><vtkMultiBlockDataSet><DataSet index=\"0\" file=\"a.vtu\"/>"
                            "<DataSet index=\"1\" file=\"b.vtu\"/></vtkMultiBlockDataSet></VTKFile>");
    const ReadResult joined = mesh_of_vtk(blocks), read = read_mesh(list);
    EXPECT_EQ(joined.mesh.points.size(), 12u);  // the four between both cells once
    EXPECT_EQ(joined.mesh.points, read.mesh.points);
    EXPECT_EQ(joined.mesh.cells, read.mesh.cells);
    ASSERT_EQ(joined.mesh.attributes.size(), 1u);  // the others are not in both
    EXPECT_EQ(joined.mesh.attributes[0].values, read.mesh.attributes[0].values);
    EXPECT_EQ(joined.warnings, read.warnings);
    std::vector<VtkUnstructuredGrid> none(2), quad{one_cell(0, "a")};
    quad[0].types = {9};
    quad[0].ends = {4};
    quad[0].connectivity.resize(4);
    expect_error(ErrorCode::InvalidInput, "no block has points", [&] { (void)mesh_of_vtk(none); });
    expect_error(ErrorCode::InvalidInput, "no block has cells", [&] { (void)mesh_of_vtk(quad); });
}

TEST_F(VtkGridInMemory, RefusesArraysThatContradictEachOther) {
    const auto refused = [](const std::string& part, const auto& spoil) {
        VtkUnstructuredGrid grid = three_cells();
        spoil(grid);
        expect_error(ErrorCode::InvalidInput, part, [&] { (void)mesh_of_vtk(grid); });
    };
    refused("2 ends of cells for 3 cells", [](auto& grid) { grid.ends.pop_back(); });
    refused("do not divide", [](auto& grid) { grid.ends = {8, 7, 22}; });
    refused("do not divide", [](auto& grid) { grid.ends = {-8, 16, 22}; });
    refused("do not divide", [](auto& grid) { grid.ends = {8, 16, 23}; });
    refused("cell 2: there is no point with index 14", [](auto& grid) { grid.connectivity.back() = 14; });
    refused("cell 0: there is no point with index -1", [](auto& grid) { grid.connectivity.front() = -1; });
    refused("cell 1: its faces", [](auto& grid) { grid.faces[1] = 5; });
    refused("cell 1: its faces", [](auto& grid) { grid.face_ends.clear(); });
    refused("array 'c' has 5 values", [](auto& grid) { grid.arrays[1].values.pop_back(); });
    refused("array 'f' has", [](auto& grid) { grid.arrays[0].components = 0; });
    refused("VTK grid", [](auto& grid) { grid = {}; });
}

}  // namespace vtk_grid_test

}  // namespace subvol::test
