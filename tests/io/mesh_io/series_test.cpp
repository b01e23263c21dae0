// SPDX-License-Identifier: Apache-2.0
// Files that list others: steps, pieces and blocks.

#include <gmock/gmock.h>

#include "lib/temp_folder.h"
#include "mesh_texts.h"
#include "subvol/mesh_report.h"
#include "subvol/mesh_series.h"

namespace subvol::test {

namespace series_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

double field(const Vec3& x) {
    return 2 * x.x - x.y + x.z / 2;
}

// A row of unit cubes from `first` on, with the field at the points. more: further arrays at the points and at the cells
std::string row(int first, int count, const std::string& at_points = "", const std::string& at_cells = "", double shift = 0) {
    HexMesh mesh;
    std::string values;
    for (int i = 0; i <= count; ++i) {
        for (const Vec3 x : {Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0, 1, 1)}) {
            mesh.points.push_back(x + Vec3(first + i, 0, 0));
            values += number(field(mesh.points.back()) + shift) + " ";
        }
    }
    for (int i = 0; i < count; ++i) {
        const auto p = static_cast<Index>(4 * i);
        mesh.cells.push_back({p, p + 4, p + 5, p + 1, p + 2, p + 6, p + 7, p + 3});
    }
    std::string offsets, types;
    for (int i = 1; i <= count; ++i) {
        offsets += std::to_string(8 * i) + " ";
        types += "12 ";
    }
    const auto array = [](const std::string& type, const std::string& name, const std::string& numbers) {
        return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" format=\"ascii\">" + numbers + "</DataArray>\n";
    };
    return "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\"><UnstructuredGrid><Piece NumberOfPoints=\"" +
           std::to_string(mesh.points.size()) + "\" NumberOfCells=\"" + std::to_string(count) +
           "\">\n<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">" + point_lines(mesh) +
           "</DataArray></Points>\n<Cells>" + array("Int64", "connectivity", cell_lines(mesh, 0)) +
           array("Int64", "offsets", offsets) + array("UInt8", "types", types) + "</Cells>\n<PointData>" +
           array("Float64", "f", values) + at_points + "</PointData><CellData>" + at_cells +
           "</CellData></Piece></UnstructuredGrid></VTKFile>";
}

std::string integers(const std::string& name, const std::string& numbers) {
    return "<DataArray type=\"Int64\" Name=\"" + name + "\" format=\"ascii\">" + numbers + "</DataArray>";
}

std::string list(const std::string& type, const std::string& inside) {
    return "<VTKFile type=\"" + type + "\" version=\"0.1\">\n<" + type + ">\n" + inside + "</" + type + "></VTKFile>";
}

std::string pieces(const std::vector<std::string>& files) {
    std::string text;
    for (const std::string& file : files) text += "<Piece Source=\"" + file + "\"/>\n";
    return list("PUnstructuredGrid", text);
}

class Series : public TempFolder {
protected:
    [[nodiscard]] std::string error(const std::string& name, const ReadOptions& options = {}) const {
        return error_of([&] { static_cast<void>(read_mesh(path(name), options)); });
    }

    // A row of so many cubes without seams, and its field.
    static void expect_row(const ReadResult& result, std::size_t cells) {
        const MeshReport report = inspect(result.mesh);
        EXPECT_EQ(report.cells, cells);
        EXPECT_EQ(report.points_used, 4 * (cells + 1));
        EXPECT_EQ(report.boundary_faces, 4 * cells + 2);
        EXPECT_NEAR(report.volume, static_cast<double>(cells), 1e-12);
        const Attribute* f = result.mesh.find_attribute("f");
        ASSERT_NE(f, nullptr);
        for (std::size_t p = 0; p < f->values.size(); ++p) EXPECT_EQ(f->values[p], field(result.mesh.points[p]));
    }
};

TEST_F(Series, PiecesAreJoinedWhereTheirPointsAreAtTheSamePlace) {
    std::string a = row(0, 2);
    a.replace(a.find("NumberOfPoints=\""), 16, "NumberOfPoints=\"+");  // as some programs write it
    write("a.vtu", a);
    write("b.vtu", row(2, 3));
    const ReadResult result = read_mesh(write("all.pvtu", pieces({"a.vtu", "b.vtu"})));
    expect_row(result, 5);
    EXPECT_THAT(result.warnings, ElementsAre("2 pieces put together; 4 points joined with those of another, by their places"));
}

TEST_F(Series, PiecesAreJoinedByTheNumbersOfTheirPoints) {
    // A crack: the numbers differ, so the points at one place stay apart.
    write("a.vtu", row(0, 1, integers("GlobalNodeId", "0 1 2 3 4 5 6 7")));
    write("b.vtu", row(1, 1, integers("GlobalNodeId", "4 5 16 17 8 9 10 11")));
    ReadResult result = read_mesh(write("all.pvtu", pieces({"a.vtu", "b.vtu"})));
    EXPECT_EQ(result.mesh.points.size(), 14u);
    EXPECT_EQ(result.warnings[0], "2 pieces put together; 2 points joined with those of another, by \"GlobalNodeId\"");
    // Numbers that are the same at different places are no numbers of points.
    write("b.vtu", row(1, 1, integers("GlobalNodeId", "0 1 2 3 4 5 6 7")));
    result = read_mesh(path("all.pvtu"));
    expect_row(result, 2);
    EXPECT_EQ(result.warnings[0], "array \"GlobalNodeId\" does not number the points: not used");
}

// How near is near does not depend on a piece that is far away: it is a part of the cells.
TEST_F(Series, PointsThatACellLiesBetweenAreNotJoined) {
    write("a.vtu", row(0, 1, integers("GlobalNodeId", "0 1 2 3 4 5 6 7")));
    write("b.vtu", row(2, 1, integers("GlobalNodeId", "4 5 6 7 8 9 10 11")));
    write("c.vtu", row(2'000'000, 1, integers("GlobalNodeId", "12 13 14 15 16 17 18 19")));
    const ReadResult result = read_mesh(write("all.pvtu", pieces({"a.vtu", "b.vtu", "c.vtu"})));
    EXPECT_EQ(result.mesh.points.size(), 24u);
    EXPECT_NEAR(inspect(result.mesh).volume, 3, 1e-9);
    EXPECT_EQ(result.warnings[0], "array \"GlobalNodeId\" does not number the points: not used");
}

TEST_F(Series, GhostCellsOfPiecesAreDropped) {
    write("a.vtu", row(0, 3, "", integers("vtkGhostType", "0 0 1") + integers("part", "1 1 2")));
    write("b.vtu", row(2, 2, "", integers("part", "2 2")));
    const ReadResult result = read_mesh(write("all.pvtu", pieces({"a.vtu", "b.vtu"})));
    expect_row(result, 4);
    EXPECT_THAT(result.warnings, Contains("1 ghost cell (duplicate or hidden) left out"));
    EXPECT_EQ(result.mesh.find_attribute("part")->values.back(), 2);
}

TEST_F(Series, ArraysThatAPieceLacksHaveGaps) {
    write("a.vtu", row(0, 1, integers("extra", "0 1 2 3 4 5 6 7")));
    write("b.vtu", row(1, 1));
    const ReadResult result = read_mesh(write("all.pvtu", pieces({"a.vtu", "b.vtu"})));
    expect_row(result, 2);
    EXPECT_THAT(result.warnings, Contains(HasSubstr("field \"extra\" has no value at 4 of 12 points")));
    EXPECT_EQ(result.mesh.attributes.size(), 1u);
    ASSERT_EQ(result.incomplete.size(), 1u);
    EXPECT_EQ(result.incomplete[0].values[7], 7);
}

TEST_F(Series, NamesOfBlocksHaveNoControlCharacters) {
    write("a.vtu", row(0, 1));
    const std::string csi = "\xC2\x9B";  // terminals obey what follows it
    write("all.vtm", list("vtkMultiBlockDataSet", "<DataSet index=\"0\" name=\"a" + csi + "31m\" file=\"a.vtu\"/>"));
    const ReadResult all = read_mesh(path("all.vtm"));
    ASSERT_EQ(all.blocks.size(), 1u);
    EXPECT_EQ(all.blocks[0].name, "a\\xc2\\x9b31m");
    EXPECT_EQ(read_mesh(path("all.vtm"), {.blocks = {all.blocks[0].name}}).mesh.cells.size(), 1u);
}

TEST_F(Series, BlocksAreListedAndChosen) {
    write("a.vtu", row(0, 1));
    write("b.vtu", row(1, 2));
    write("c.vtu", row(3, 1));
    write("wall.vtp", "");
    write("all.vtm", list("vtkMultiBlockDataSet",
                          "<Block index=\"0\" name=\"solid\"><DataSet index=\"0\" name=\"left\" file=\"a.vtu\"/>\n"
                          "<DataSet index=\"1\" name=\"right\" file=\"b.vtu\"/></Block>\n"
                          "<DataSet index=\"1\" file=\"c.vtu\"/><DataSet index=\"2\" name=\"none\"/>\n"
                          "<DataSet index=\"3\" name=\"wall\" file=\"wall.vtp\"/>"));
    const ReadResult all = read_mesh(path("all.vtm"));
    expect_row(all, 4);
    ASSERT_EQ(all.blocks.size(), 3u);
    EXPECT_EQ(all.blocks[1].name, "solid/right");
    EXPECT_EQ(all.blocks[1].cells, 2u);
    EXPECT_EQ(all.blocks[2].name, "1");
    ASSERT_EQ(all.sets.sets.size(), 3u) << "blocks are sets of cells, too";
    EXPECT_EQ(find_set(all.sets, "solid/right").cells, (std::vector<Index>{1, 2}));
    EXPECT_THAT(all.warnings, Contains("1 file of surfaces (.vtp) ignored"));
    expect_row(read_mesh(path("all.vtm"), {.blocks = {"solid/right", "1"}}), 3);
    EXPECT_THAT(error("all.vtm", {.blocks = {"fluid"}}),
                HasSubstr("all.vtm: there is no block \"fluid\" (it has: solid/left, solid/right, 1, wall)"));
    EXPECT_THAT(error("all.vtm", {.blocks = {"wall"}}), HasSubstr("all.vtm: no hexahedra in any of its files"));
    EXPECT_THAT(error("a.vtu", {.blocks = {"wall"}}), HasSubstr("a.vtu: such files have no named blocks"));
}

TEST_F(Series, StepsAreInTheOrderOfTheirTimes) {
    for (const int k : {0, 1, 2}) write("t" + std::to_string(k) + ".vtu", row(0, 1, "", "", k));
    write("run.pvd", list("Collection",
                          "<DataSet timestep=\"0.5\" part=\"0\" file=\"t2.vtu\"/>\n<DataSet timestep=\"0\" file=\"t0.vtu\"/>\n"
                          "<DataSet timestep=\"2.5e-1\" file=\"t1.vtu\"/>"));
    write("run.vtu.series", R"({"file-series-version": "1.0", "files": [{"name": "t0.vtu", "time": 0},
                               {"name": "t1.vtu", "time": 0.25}, {"name": "t2.vtu", "time": 0.5}]})");
    for (const std::string name : {"run.pvd", "run.vtu.series"}) {
        const MeshSeries series = open_series(path(name));
        EXPECT_THAT(series.times, ElementsAre(0, .25, .5));
        EXPECT_EQ(nearest_step(series, .3), 1u);
        EXPECT_EQ(nearest_step(series, 99), 2u);
        for (std::size_t k = 0; k < 3; ++k) {
            const ReadResult result = read_mesh(path(name), {.step = k});
            EXPECT_EQ(result.mesh.attributes[0].values[0], static_cast<double>(k));
            EXPECT_TRUE(result.warnings.empty());
        }
        const ReadResult last = read_mesh(path(name));
        EXPECT_EQ(last.mesh.attributes[0].values[0], 2);
        EXPECT_THAT(last.warnings, ElementsAre("the file has 3 steps; the last one is read"));
        EXPECT_THAT(error(name, {.step = 3}), HasSubstr(name + ": there is no step 3 (steps are 0 to 2)"));
    }
    EXPECT_EQ(open_series(path("t1.vtu")).size(), 1u);
    EXPECT_THAT(error("t1.vtu", {.step = 1}), HasSubstr("t1.vtu: there is no step 1 (it has one step, number 0)"));
}

TEST_F(Series, PartsOfAStepAndListsInListsAreJoined) {
    write("a.vtu", row(0, 1));
    write("b.vtu", row(1, 1));
    write("c.vtu", row(2, 1));
    write("bc.pvtu", pieces({"b.vtu", "c.vtu"}));
    write("run.pvd", list("Collection",
                          "<DataSet timestep=\"1\" part=\"0\" file=\"a.vtu\"/>"
                          "<DataSet timestep=\"1\" part=\"1\" file=\"bc.pvtu\"/>"));
    expect_row(read_mesh(path("run.pvd")), 3);
}

TEST_F(Series, WrongListsGetASentenceWithTheLine) {
    write("a.vtu", row(0, 1));
    write("no.pvtu", pieces({"a.vtu", "b.vtu"}));
    EXPECT_THAT(error("no.pvtu"), HasSubstr("no.pvtu, line 4: there is no file \"b.vtu\""));
    write("no.pvtu", pieces({}));
    EXPECT_THAT(error("no.pvtu"), HasSubstr("no.pvtu, line 2: it lists no pieces"));
    write("no.pvtu", list("PUnstructuredGrid", "<Piece/>"));
    EXPECT_THAT(error("no.pvtu"), HasSubstr("no file is named"));
    write("no.pvtu", list("PPolyData", ""));
    EXPECT_THAT(error("no.pvtu"), HasSubstr("\"PPolyData\" is not a PUnstructuredGrid"));
    write("no.pvtu", pieces({"no.pvtu"}));
    EXPECT_THAT(error("no.pvtu"), HasSubstr("no.pvtu, line 3: names itself, by no.pvtu > no.pvtu"));
    write("x.vtk", "");
    write("no.pvtu", pieces({"a.vtu", "x.vtk"}));
    EXPECT_THAT(error("no.pvtu"), HasSubstr("\"x.vtk\" cannot be read as a part of a mesh"));
    write("b.vtu", "<VTKFile");
    write("no.pvtu", pieces({"a.vtu", "b.vtu"}));
    EXPECT_THAT(error("no.pvtu"), HasSubstr("b.vtu, line 1: not well-formed XML"));
    write("no.pvd", list("Collection", "<DataSet timestep=\"nan\" file=\"a.vtu\"/>"));
    EXPECT_THAT(error("no.pvd"), HasSubstr("no.pvd, line 3: its timestep is not a number"));
    write("no.pvd", list("Collection", ""));
    EXPECT_THAT(error("no.pvd"), HasSubstr("it lists no files"));
    write("no.vtm", list("vtkMultiBlockDataSet", ""));
    EXPECT_THAT(error("no.vtm"), HasSubstr("it lists no blocks"));
    const auto of_json = [&](const std::string& text) {
        write("no.vtu.series", text);
        return error("no.vtu.series");
    };
    EXPECT_THAT(of_json("{"), HasSubstr("no.vtu.series: not well-formed JSON"));
    EXPECT_THAT(of_json("[]"), HasSubstr("it has no list \"files\""));
    EXPECT_THAT(of_json(R"({"files": [{"name": "a.vtu", "time": "now"}]})"), HasSubstr("entry 0 of \"files\" has no name, or"));
    EXPECT_THAT(of_json(R"({"files": []})"), HasSubstr("it lists no files"));
    EXPECT_THAT(of_json(R"({"files": [{"name": "c.vtu"}]})"), HasSubstr("entry 0 of \"files\": there is no file \"c.vtu\""));
}

}  // namespace series_test

}  // namespace subvol::test
