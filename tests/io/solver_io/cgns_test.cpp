// SPDX-License-Identifier: Apache-2.0
// CGNS files, whose nodes are groups of HDF5.

#include <gmock/gmock.h>

#include <functional>
#include <map>
#include <numbers>

#include "io/mesh_io/hdf5_texts.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/cell.h"
#include "subvol/mesh_report.h"
#include "subvol/mesh_series.h"

namespace subvol::test {

namespace cgns_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

using Numbers = std::vector<std::int64_t>;
using Reals = std::vector<double>;

class CgnsWriter {
public:
    explicit CgnsWriter(const std::filesystem::path& path) : file_(path) {
        node("/Base", "CGNSBase_t", std::vector<std::int32_t>{3, 3});
    }

    void node(const std::string& path, const std::string& label) {
        file_.group(path);
        file_.attribute(path, "label", label);
    }
    template <class T>
    void node(const std::string& path, const std::string& label, const std::vector<T>& values) {
        node(path, label);
        file_.put(path + "/ data", values);
    }
    void node(const std::string& path, const std::string& label, const std::string& text) {
        node(path, label, std::vector<std::uint8_t>(text.begin(), text.end()));
    }

    void coordinates(const std::string& path, const std::vector<Vec3>& points) {
        node(path, "GridCoordinates_t");
        for (int a = 0; a < 3; ++a) {
            Reals axis;
            for (const Vec3& x : points) axis.push_back(x[a]);
            node(path + "/Coordinate" + "XYZ"[a], "DataArray_t", axis);
        }
    }
    // A block of 3 × 2 × 1 cells.
    void block(const std::string& name, double first_x) {
        HexMesh mesh = make_box(3, 2, 1);
        for (Vec3& x : mesh.points) x.x += first_x;
        node("/Base/" + name, "Zone_t", Numbers{4, 3, 2, 3, 2, 1, 0, 0, 0});
        node("/Base/" + name + "/ZoneType", "ZoneType_t", "Structured");
        coordinates("/Base/" + name + "/GridCoordinates", mesh.points);
    }
    void link(const std::string& object, const std::string& name) { file_.link(object, name); }
    void zone(const std::vector<Vec3>& points, std::int64_t cells) {
        node("/Base/Zone", "Zone_t", Numbers{static_cast<std::int64_t>(points.size()), cells, 0});
        node("/Base/Zone/ZoneType", "ZoneType_t", "Unstructured");
        coordinates("/Base/Zone/GridCoordinates", points);
    }
    void section(const std::string& name, std::int32_t type, const Numbers& range, const Numbers& nodes) {
        node("/Base/Zone/" + name, "Elements_t", std::vector<std::int32_t>{type, 0});
        node("/Base/Zone/" + name + "/ElementRange", "IndexRange_t", range);
        node("/Base/Zone/" + name + "/ElementConnectivity", "DataArray_t", nodes);
    }

private:
    Hdf5Writer file_;
};

class Cgns : public TempFolder {
protected:
    [[nodiscard]] std::string error(const std::function<void(CgnsWriter&)>& write) const {
        {
            CgnsWriter file(path("bad.cgns"));
            write(file);
        }
        return error_of([&] { static_cast<void>(read_mesh(path("bad.cgns"))); });
    }
};

TEST_F(Cgns, OneZoneByManyNamesIsRefused) {
    EXPECT_THAT(error([](CgnsWriter& file) {
                    HexMesh mesh = make_box(40, 40, 40);
                    file.node("/Base/Zone", "Zone_t", Numbers{41, 41, 41, 40, 40, 40, 0, 0, 0});
                    file.node("/Base/Zone/ZoneType", "ZoneType_t", "Structured");
                    file.coordinates("/Base/Zone/GridCoordinates", mesh.points);
                    for (int k = 0; k < 200; ++k) file.link("/Base/Zone", "/Base/Zone" + std::to_string(k));
                }),
                HasSubstr("bad.cgns: what it names again and again is too much"));
}

TEST_F(Cgns, StructuredZonesAreBlocksThatAreJoined) {
    {
        CgnsWriter file(path("a.cgns"));
        file.block("left", 0);
        file.block("right", 3);
        for (const std::string zone : {"left", "right"}) {
            const std::string solution = "/Base/" + zone + "/Cells";
            file.node(solution, "FlowSolution_t");
            file.node(solution + "/Location", "GridLocation_t", "CellCenter");
            file.node(solution + "/Rind", "Rind_t", std::vector<std::int32_t>{1, 1, 0, 0, 0, 0});
            file.node(solution + "/Density", "DataArray_t", Reals{9, 1, 2, 3, 9, 9, 4, 5, 6, 9});
            file.node("/Base/" + zone + "/Points", "FlowSolution_t");
            for (const std::string axis : {"X", "Y", "Z"}) {
                file.node("/Base/" + zone + "/Points/Velocity" + axis, "DataArray_t", Reals(24, axis == "Y" ? 2 : 1));
            }
        }
    }
    const ReadResult result = read_mesh(path("a.cgns"));
    EXPECT_EQ(inspect(result.mesh).points_used, 42u);
    EXPECT_NEAR(inspect(result.mesh).volume, 12, 1e-12);
    EXPECT_THAT(result.warnings, Contains("2 zones put together; 6 points joined with those of another, by their places"));
    const auto density = std::ranges::find(result.fields, "Density", &FieldInfo::name);
    ASSERT_NE(density, result.fields.end());
    EXPECT_EQ(density->max, 6);  // without the layers about the zone
    EXPECT_EQ(result.mesh.find_attribute("Velocity")->values[1], 2);
    const ReadResult right = read_mesh(path("a.cgns"), {.blocks = {"right"}});
    EXPECT_EQ(right.mesh.cells.size(), 6u);
    EXPECT_EQ(right.mesh.points[0].x, 3);
}

std::map<std::string, std::size_t> faces_of_patches(const ReadResult& result) {
    std::map<std::string, std::size_t> faces;
    for (const Patch& patch : result.sets.patches) faces[patch.name] = patch.sides.size();
    return faces;
}

using Faces = std::map<std::string, std::size_t>;

TEST_F(Cgns, BoundaryConditionsOfStructuredZonesArePatches) {
    {
        CgnsWriter file(path("a.cgns"));
        file.block("left", 0);
        file.block("right", 3);
        const std::string left = "/Base/left/ZoneBC", right = "/Base/right/ZoneBC";
        file.node(left, "ZoneBC_t");
        file.node(right, "ZoneBC_t");
        file.node(left + "/in", "BC_t", "BCInflow");
        file.node(left + "/in/PointRange", "IndexRange_t", Numbers{1, 1, 1, 1, 3, 2});
        file.node(left + "/bottom", "BC_t", "BCWall");
        file.node(left + "/bottom/Location", "GridLocation_t", "KFaceCenter");
        file.node(left + "/bottom/PointList", "IndexArray_t", Numbers{1, 1, 1, 3, 2, 1});
        file.node(left + "/bottom/Family", "FamilyName_t", "Walls");
        file.node(right + "/top", "BC_t", "BCWall");
        file.node(right + "/top/Location", "GridLocation_t", "FaceCenter");
        file.node(right + "/top/PointRange", "IndexRange_t", Numbers{1, 1, 2, 3, 2, 2});
        file.node(right + "/top/Family", "FamilyName_t", "Walls");
        file.node(right + "/far", "BC_t", "BCOutflow");
        file.node(right + "/far/PointRange", "IndexRange_t", Numbers{9, 1, 1, 9, 3, 2});
        file.node(right + "/cells", "BC_t", "BCOutflow");
        file.node(right + "/cells/Location", "GridLocation_t", "CellCenter");
    }
    const ReadResult result = read_mesh(path("a.cgns"));
    EXPECT_EQ(faces_of_patches(result), (Faces{{"in", 2}, {"Walls", 8}}));
    EXPECT_THAT(result.warnings, Contains(HasSubstr("2 boundary conditions left out (\"cells\", \"far\")")));
    for (const CellSide& side : find_patch(result.sets, "in").sides) {
        for (const std::size_t k : kCellFaces[side.side]) EXPECT_EQ(result.mesh.points[result.mesh.cells[side.cell][k]].x, 0);
    }
}

TEST_F(Cgns, BoundaryConditionsOfUnstructuredZonesArePatches) {
    const HexMesh mesh = make_box(2, 1, 1);
    {
        CgnsWriter file(path("a.cgns"));
        file.zone(mesh.points, 2);
        Numbers hexes, quads;
        for (const auto& cell : mesh.cells) {
            for (const Index p : cell) hexes.push_back(p + 1);
        }
        for (const std::size_t k : kCellFaces[0]) quads.push_back(mesh.cells[0][k] + 1);
        for (const std::size_t k : kCellFaces[1]) quads.push_back(mesh.cells[1][k] + 1);
        file.section("Hexes", 17, {1, 2}, hexes);
        file.section("Quads", 7, {3, 4}, quads);
        const std::string all = "/Base/Zone/ZoneBC";
        file.node(all, "ZoneBC_t");
        file.node(all + "/in", "BC_t", "BCInflow");
        file.node(all + "/in/Location", "GridLocation_t", "FaceCenter");
        file.node(all + "/in/PointRange", "IndexRange_t", Numbers{3, 3});
        file.node(all + "/out", "BC_t", "BCOutflow");
        file.node(all + "/out/ElementList", "IndexArray_t", Numbers{4});
        Numbers bottom;
        for (std::size_t p = 0; p < mesh.points.size(); ++p) {
            if (mesh.points[p].z == 0) bottom.push_back(static_cast<std::int64_t>(p) + 1);
        }
        file.node(all + "/bottom", "BC_t", "BCWall");
        file.node(all + "/bottom/PointList", "IndexArray_t", bottom);
        file.node(all + "/wrong", "BC_t", "BCWall");
        file.node(all + "/wrong/ElementList", "IndexArray_t", Numbers{2});
        file.node(all + "/long", "BC_t", "BCWall");
        file.node(all + "/long/ElementRange", "IndexRange_t", Numbers{1, std::int64_t{1} << 39});
    }
    const ReadResult result = read_mesh(path("a.cgns"));
    EXPECT_EQ(faces_of_patches(result), (Faces{{"in", 1}, {"out", 1}, {"bottom", 2}}));
    EXPECT_THAT(result.warnings, Contains(HasSubstr("2 boundary conditions left out")));
    for (const std::size_t k : kCellFaces[find_patch(result.sets, "out").sides[0].side])
        EXPECT_EQ(result.mesh.points[result.mesh.cells[1][k]].x, 2);
}

TEST_F(Cgns, StepsNameTheirSolutions) {
    {
        CgnsWriter file(path("a.cgns"));
        file.block("zone", 0);
        file.node("/Base/Steps", "BaseIterativeData_t", std::vector<std::int32_t>{2});
        file.node("/Base/Steps/TimeValues", "DataArray_t", Reals{.25, .75});
        file.node("/Base/zone/Steps", "ZoneIterativeData_t");
        std::string names = "S1";
        names.resize(32, ' ');
        names += "S2";
        names.resize(64, ' ');
        file.node("/Base/zone/Steps/FlowSolutionPointers", "DataArray_t", names);
        for (const int k : {1, 2}) {
            file.node("/Base/zone/S" + std::to_string(k), "FlowSolution_t");
            file.node("/Base/zone/S" + std::to_string(k) + "/p", "DataArray_t", Reals(24, k));
        }
    }
    EXPECT_THAT(open_series(path("a.cgns")).times, ElementsAre(.25, .75));
    for (std::size_t k = 0; k < 2; ++k) {
        const ReadResult result = read_mesh(path("a.cgns"), {.step = k});
        EXPECT_EQ(result.mesh.find_attribute("p")->values[0], static_cast<double>(k + 1));
        EXPECT_EQ(result.fields.size(), 1u);
    }
}

// A cube, and beside it a prism, by their faces.
TEST_F(Cgns, PolyhedraAreTakenByTheirFaces) {
    HexMesh mesh = make_box(1, 1, 1);
    mesh.points.insert(mesh.points.end(), {{2, 0, 0}, {2, 0, 1}});
    const std::vector<std::vector<std::int64_t>> faces{{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5}, {3, 7, 8, 4},  {1, 5, 7, 3},
                                                       {2, 4, 8, 6}, {2, 4, 9},    {6, 10, 8},   {2, 9, 10, 6}, {4, 8, 10, 9}};
    const std::vector<std::vector<std::int64_t>> cells{{1, 2, 3, 4, 5, 6}, {-6, 7, 8, 9, 10}};
    for (const bool starts : {true, false}) {
        {
            CgnsWriter file(path("a.cgns"));
            file.zone(mesh.points, 2);
            const auto put = [&](const std::string& name, std::int32_t type, const Numbers& range, const auto& lists) {
                Numbers numbers, begins{0};
                for (const auto& list : lists) {
                    if (!starts) numbers.push_back(static_cast<std::int64_t>(list.size()));
                    numbers.insert(numbers.end(), list.begin(), list.end());
                    begins.push_back(static_cast<std::int64_t>(numbers.size()));
                }
                file.section(name, type, range, numbers);
                if (starts) file.node("/Base/Zone/" + name + "/ElementStartOffset", "DataArray_t", begins);
            };
            put("Faces", 22, {1, 10}, faces);
            put("Cells", 23, {11, 12}, cells);
            file.node("/Base/Zone/S", "FlowSolution_t");
            file.node("/Base/Zone/S/Location", "GridLocation_t", "CellCenter");
            file.node("/Base/Zone/S/c", "DataArray_t", Reals{1, 2});
        }
        const ReadResult result = read_mesh(path("a.cgns"));
        EXPECT_NEAR(inspect(result.mesh).volume, 1.5, 1e-12);
        EXPECT_EQ(result.fields[0].max, 2);
    }
}

TEST_F(Cgns, StepsNameWhatTheirSolutionsEndWith) {
    {
        CgnsWriter file(path("a.cgns"));
        file.block("zone", 0);
        file.node("/Base/Steps", "BaseIterativeData_t", std::vector<std::int32_t>{2});
        file.node("/Base/zone/Steps", "ZoneIterativeData_t");
        file.node("/Base/zone/Steps/VertexPrefix", "Descriptor_t", "Vertex");
        std::string names = "S1";
        names.resize(32, ' ');
        names += "S2";
        names.resize(64, ' ');
        file.node("/Base/zone/Steps/FlowSolutionPointers", "DataArray_t", names);
        std::string others = "gone";
        others.resize(32, ' ');
        file.node("/Base/zone/Steps/FlowSolutionCellPointers", "DataArray_t", others + others);
        for (const int k : {1, 2}) {
            file.node("/Base/zone/VertexS" + std::to_string(k), "FlowSolution_t");
            file.node("/Base/zone/VertexS" + std::to_string(k) + "/p", "DataArray_t", Reals(24, k));
        }
    }
    for (std::size_t k = 0; k < 2; ++k) {
        const ReadResult result = read_mesh(path("a.cgns"), {.step = k});
        ASSERT_EQ(result.fields.size(), 1u);
        EXPECT_EQ(result.fields[0].max, static_cast<double>(k + 1));
        EXPECT_THAT(result.warnings, Contains("field \"gone\" left out: zone \"zone\" has no such node"));
    }
}

TEST_F(Cgns, MixedElementsAndTheirValues) {
    HexMesh mesh = make_box(1, 1, 1);
    mesh.points.insert(mesh.points.end(), {{.5, .5, 2}, {2, 0, 0}, {2, 0, 1}});
    {
        CgnsWriter file(path("a.cgns"));
        file.zone(mesh.points, 3);
        file.section("Faces", 7, {4, 4}, {1, 2, 4, 3});
        file.section("Cells", 20, {1, 3}, {17, 1, 2, 4, 3, 5, 6, 8, 7, 12, 5, 6, 8, 7, 9, 14, 2, 10, 4, 6, 11, 8});
        file.node("/Base/Zone/S", "FlowSolution_t");
        file.node("/Base/Zone/S/Location", "GridLocation_t", "CellCenter");
        file.node("/Base/Zone/S/c", "DataArray_t", Reals{1, 2, 3});
    }
    const ReadResult result = read_mesh(path("a.cgns"));
    EXPECT_NEAR(inspect(result.mesh).volume, 1 + 1. / 3 + .5, 1e-12);
    EXPECT_EQ(result.fields[0].max, 3);
    EXPECT_THAT(result.warnings, Contains("1 element of type QUAD_4 ignored"));
}

// A part of a ring, of one element of 27 nodes in CGNS's order.
TEST_F(Cgns, CurvedElementsAreFollowed) {
    constexpr std::array<std::array<int, 3>, 27> kAt{
        {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2}, {0, 2, 2}, {1, 0, 0},
         {2, 1, 0}, {1, 2, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 2},
         {1, 2, 2}, {0, 1, 2}, {1, 1, 0}, {1, 0, 1}, {2, 1, 1}, {1, 2, 1}, {0, 1, 1}, {1, 1, 2}, {1, 1, 1}}};
    std::vector<Vec3> points;
    Numbers nodes;
    for (const auto& at : kAt) {
        const double r = 1 + at[0] / 2., angle = at[1] / 2. * std::numbers::pi / 8;
        points.emplace_back(r * std::cos(angle), r * std::sin(angle), at[2] / 2.);
        nodes.push_back(static_cast<std::int64_t>(points.size()));
    }
    {
        CgnsWriter file(path("a.cgns"));
        file.zone(points, 1);
        file.section("Cells", 19, {1, 1}, nodes);
    }
    // Half the difference of the squared radii, times the angle; parabolas follow the circles to 1e-5.
    EXPECT_NEAR(inspect(read_mesh(path("a.cgns")).mesh).volume, 1.5 * std::numbers::pi / 8, 2e-4);
}

TEST_F(Cgns, NodesThatNobodyReadsAreListed) {
    {
        CgnsWriter file(path("a.cgns"));
        file.block("A", 0);
        file.block("B", 3);
        file.node("/Base/Steel", "Family_t");
        file.node("/Base/B/Rough", "DiscreteData_t");
    }
    std::vector<std::string> listed;
    for (const IgnoredPart& part : read_mesh(path("a.cgns")).ignored) listed.push_back(part.kind + " " + part.name);
    EXPECT_THAT(listed, ElementsAre("Family_t /Base/Steel", "DiscreteData_t /Base/B/Rough"));
}

TEST_F(Cgns, WrongFilesGetASentence) {
    EXPECT_THAT(error([](CgnsWriter&) {}), HasSubstr("no hexahedra"));
    EXPECT_THAT(error([](CgnsWriter& file) {
                    file.node("/Base/Zone", "Zone_t", Numbers{1000000000000, 1, 0});
                }),
                HasSubstr("node \"/Base/Zone\": size out of range: 1000000000000"));
    EXPECT_THAT(error([](CgnsWriter& file) {
                    file.zone(make_box(1, 1, 1).points, 1);
                    file.section("Cells", 17, {1, 1}, {1, 2, 4, 3, 5, 6, 8, 9});
                }),
                HasSubstr("element 1: there is no vertex 9 (vertices are 1 to 8)"));
    EXPECT_THAT(error([](CgnsWriter& file) {
                    file.zone(make_box(1, 1, 1).points, 1);
                    file.section("Cells", 17, {1, 2000000000}, {1, 2, 4, 3, 5, 6, 8, 7});
                }),
                HasSubstr("ends before its elements do"));
    EXPECT_EQ(error([](CgnsWriter& file) {
                  file.block("b", 0);
                  file.node("/Base/b/S", "FlowSolution_t");
                  file.node("/Base/b/S/p", "DataArray_t", Reals{1, 2});
              }),
              "no error");
    ASSERT_EQ(read_mesh(path("bad.cgns")).unread.size(), 1u);
    EXPECT_THAT(read_mesh(path("bad.cgns")).unread[0].why, HasSubstr("node \"/Base/b/S/p\" has 2 values (24 are needed)"));
    write("old.cgns", "@(#)ADF Database Version A02011>");
    EXPECT_THAT(
        error_of([&] { static_cast<void>(read_mesh(path("old.cgns"))); }),
        HasSubstr(
            "old.cgns: the CGNS file is of the older kind ADF (cgnsconvert -h, of Debian's cgns-convert, makes it HDF5)"));
}

}  // namespace cgns_test

}  // namespace subvol::test
