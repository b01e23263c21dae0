// SPDX-License-Identifier: Apache-2.0
// VTKHDF files, written by HDF5's library.

#include <gmock/gmock.h>
#include <zlib.h>

#include <functional>

#include "hdf5_texts.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/detail/read_file.h"
#include "subvol/limit_surface.h"
#include "subvol/mesh_report.h"
#include "subvol/mesh_series.h"

namespace subvol::test {

namespace vtkhdf_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

using Numbers = std::vector<std::int64_t>;

// A row of cubes along x.
struct Row {
    std::vector<double> points;
    Numbers connectivity, offsets{0};
    std::vector<std::uint8_t> types;
    std::int64_t cells = 0;
};

Row row(Index cells, double first_x = 0) {
    const HexMesh mesh = make_box(cells, 1, 1);
    Row row;
    for (const Vec3& x : mesh.points) row.points.insert(row.points.end(), {first_x + x.x, x.y, x.z});
    for (const auto& cell : mesh.cells) {
        row.connectivity.insert(row.connectivity.end(), cell.begin(), cell.end());
        row.offsets.push_back(static_cast<std::int64_t>(row.connectivity.size()));
        row.types.push_back(12);
    }
    row.cells = cells;
    return row;
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
    to.insert(to.end(), from.begin(), from.end());
}

class VtkHdf : public TempFolder {
protected:
    // parts: one after the other in the arrays
    void start(Hdf5Writer& file, const std::vector<Row>& parts, bool deflated = false, bool typed = true) const {
        Row all{{}, {}, {}, {}, 0};
        Numbers points, cells, corners;
        for (const Row& part : parts) {
            append(all.points, part.points);
            append(all.connectivity, part.connectivity);
            append(all.offsets, part.offsets);
            append(all.types, part.types);
            points.push_back(static_cast<std::int64_t>(part.points.size() / 3));
            cells.push_back(part.cells);
            corners.push_back(static_cast<std::int64_t>(part.connectivity.size()));
        }
        file.group("/VTKHDF");
        file.attribute("/VTKHDF", "Version", Numbers{2, 0});
        if (typed) file.attribute("/VTKHDF", "Type", "UnstructuredGrid");
        file.put("/VTKHDF/NumberOfPoints", points);
        file.put("/VTKHDF/NumberOfCells", cells);
        file.put("/VTKHDF/NumberOfConnectivityIds", corners);
        file.put("/VTKHDF/Points", all.points, {all.points.size() / 3, 3}, deflated);
        file.put("/VTKHDF/Connectivity", all.connectivity, {}, deflated);
        file.put("/VTKHDF/Offsets", all.offsets);
        file.put("/VTKHDF/Types", all.types);
    }
    [[nodiscard]] std::string error(const std::function<void(Hdf5Writer&)>& write) const {
        {
            Hdf5Writer file(path("bad.vtkhdf"));
            write(file);
        }
        return error_of([&] { static_cast<void>(read_mesh(path("bad.vtkhdf"))); });
    }
};

TEST_F(VtkHdf, CellsAndFieldsOfAGrid) {
    for (const bool deflated : {false, true}) {
        {
            Hdf5Writer file(path("a.vtkhdf"));
            start(file, {row(2)}, deflated);
            file.put("/VTKHDF/PointData/T", std::vector<float>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, {}, deflated);
            file.put("/VTKHDF/PointData/U", std::vector<double>(36, 1), {12, 3});
            file.put("/VTKHDF/CellData/c", std::vector<std::int32_t>{4, 4});
        }
        const ReadResult result = read_mesh(path("a.vtkhdf"));
        EXPECT_EQ(result.mesh.points, make_box(2, 1, 1).points);
        EXPECT_EQ(result.mesh.cells, make_box(2, 1, 1).cells);
        ASSERT_EQ(result.fields.size(), 3u);
        EXPECT_EQ(result.mesh.find_attribute("T")->values[7], 7);
        EXPECT_EQ(result.mesh.find_attribute("U")->channels, 3);
        EXPECT_EQ(result.mesh.find_attribute("c")->values[0], 4);
        EXPECT_EQ(open_series(path("a.vtkhdf")).size(), 1u);
    }
}

TEST_F(VtkHdf, PartitionsAreJoined) {
    {
        Hdf5Writer file(path("a.hdf"));
        start(file, {row(2), row(1, 2)});
        file.put("/VTKHDF/CellData/part", Numbers{1, 1, 2});
    }
    const ReadResult result = read_mesh(path("a.hdf"));
    EXPECT_EQ(inspect(result.mesh).points_used, 16u);
    EXPECT_NEAR(inspect(result.mesh).volume, 3, 1e-12);
    EXPECT_THAT(result.warnings, Contains("2 parts put together; 4 points joined with those of another, by their places"));
    EXPECT_EQ(result.mesh.find_attribute("part")->values.back(), 2);
}

// The mesh of the first two steps is the same, the third one has two other partitions.
TEST_F(VtkHdf, StepsHaveTheirOffsets) {
    {
        Hdf5Writer file(path("a.vtkhdf"));
        start(file, {row(1), row(1), row(2, 1)});
        std::vector<double> t(8 + 8 + 20);
        for (std::size_t i = 0; i < t.size(); ++i) t[i] = static_cast<double>(i);
        file.put("/VTKHDF/PointData/T", t);
        file.group("/VTKHDF/Steps");
        file.attribute("/VTKHDF/Steps", "NSteps", Numbers{3});
        file.put("/VTKHDF/Steps/Values", std::vector<double>{0, .5, 2});
        file.put("/VTKHDF/Steps/PartOffsets", Numbers{0, 0, 1});
        file.put("/VTKHDF/Steps/NumberOfParts", Numbers{1, 1, 2});
        file.put("/VTKHDF/Steps/PointOffsets", Numbers{0, 0, 8});
        file.put("/VTKHDF/Steps/CellOffsets", Numbers{0, 0, 1}, {3, 1});
        file.put("/VTKHDF/Steps/ConnectivityIdOffsets", Numbers{0, 0, 8}, {3, 1});
        file.put("/VTKHDF/Steps/PointDataOffsets/T", Numbers{0, 8, 16});
    }
    EXPECT_THAT(open_series(path("a.vtkhdf")).times, ElementsAre(0, .5, 2));
    const std::vector<double> first{0, 8, 16}, volume{1, 1, 3};
    for (std::size_t k = 0; k < 3; ++k) {
        const ReadResult result = read_mesh(path("a.vtkhdf"), {.step = k});
        EXPECT_EQ(result.mesh.find_attribute("T")->values[0], first[k]);
        EXPECT_NEAR(inspect(result.mesh).volume, volume[k], 1e-12);
    }
    EXPECT_THAT(read_mesh(path("a.vtkhdf")).warnings, Contains("the file has 3 steps; the last one is read"));
}

// The points of all faces; ends: of each of them
Numbers faces_of(const std::vector<Numbers>& faces, Numbers& ends) {
    Numbers points;
    for (const Numbers& face : faces) {
        append(points, face);
        ends.push_back(static_cast<std::int64_t>(points.size()));
    }
    return points;
}

// A cube and a cube whose roof is two triangles, in two partitions: faces are numbered in each partition from 0.
TEST_F(VtkHdf, PolyhedraOfEachPartitionAreSplit) {
    const Row cubes = row(2);
    const Numbers& second = cubes.connectivity;
    const auto at = [&](std::initializer_list<std::size_t> corners) {
        Numbers face;
        for (const std::size_t k : corners) face.push_back(second[8 + k]);
        return face;
    };
    Numbers ends{0};
    const Numbers points = faces_of({at({0, 3, 2, 1}), at({4, 5, 6}), at({4, 6, 7}), at({0, 1, 5, 4}), at({1, 2, 6, 5}),
                                     at({2, 3, 7, 6}), at({3, 0, 4, 7})},
                                    ends);
    const auto twice = [](Numbers numbers) {
        append(numbers, Numbers(numbers));
        return numbers;
    };
    for (const bool damaged : {false, true}) {
        {
            Row one = cubes, other = row(2, 5);
            one.types[1] = other.types[1] = 42;
            Hdf5Writer file(path("a.vtkhdf"));
            start(file, {one, other});
            file.put("/VTKHDF/NumberOfFaces", Numbers{7, 7});
            file.put("/VTKHDF/NumberOfFaceConnectivityIds", Numbers{26, 26});
            file.put("/VTKHDF/NumberOfPolyhedronToFaceIds", Numbers{7, 7});
            file.put("/VTKHDF/FaceConnectivity", twice(points));
            file.put("/VTKHDF/FaceOffsets", twice(ends));
            file.put("/VTKHDF/PolyhedronToFaces", twice({0, 1, 2, 3, 4, 5, damaged ? 7 : 6}));
            file.put("/VTKHDF/PolyhedronOffsets", twice({0, 0, 7}));
            file.put("/VTKHDF/PointData/x", std::vector<double>(24, 2));
        }
        if (damaged) {
            EXPECT_THROW((void)read_mesh(path("a.vtkhdf")), Error);
            continue;
        }
        const ReadResult result = read_mesh(path("a.vtkhdf"));
        EXPECT_NEAR(inspect(result.mesh).volume, 4, 1e-12);
        EXPECT_EQ(inspect(result.mesh).inverted_cells, 0u);
        EXPECT_EQ(inspect(result.mesh).nonmanifold_faces, 0u);
        EXPECT_THAT(result.warnings, Contains("1 polyhedron split from the middle into 12 tetrahedra"));
        for (const double x : result.mesh.find_attribute("x")->values) EXPECT_NEAR(x, 2, 1e-12);
    }
}

// The first writers gave no type.
TEST_F(VtkHdf, AGridWithoutATypeIsUnstructured) {
    {
        Hdf5Writer file(path("a.hdf"));
        start(file, {row(2)}, false, false);
    }
    EXPECT_EQ(read_mesh(path("a.hdf")).mesh.cells.size(), 2u);
}

TEST_F(VtkHdf, WhatIsWrittenIsReadToTheBit) {
    HexMesh mesh = make_box(2, 2, 2);
    for (Vec3& x : mesh.points) x = {x.x / 3 + 1e-17, x.y * 1e6 / 7, x.z / 7e9 - 4.9406564584124654e-324};
    mesh.attributes.push_back({"a/b", 1, std::vector<double>(27, .1)});
    mesh.attributes.push_back({"velocity", 3, std::vector<double>(81, 1.0 / 3)});
    mesh.creases.push_back({0, 1});
    EXPECT_THAT(write_mesh(path("a.vtkhdf"), mesh), ElementsAre("field \"a/b\" is called \"a_b\""));
    const ReadResult back = read_mesh(path("a.vtkhdf"));
    EXPECT_EQ(back.mesh.points, mesh.points);
    EXPECT_EQ(back.mesh.cells, mesh.cells);
    EXPECT_TRUE(back.warnings.empty());
    EXPECT_EQ(back.mesh.creases, mesh.creases);
    EXPECT_EQ(back.mesh.find_attribute("a_b")->values, mesh.attributes[0].values);
    EXPECT_EQ(back.mesh.find_attribute("velocity")->values, mesh.attributes[1].values);
    const std::string first = detail::read_regular(path("a.vtkhdf"));
    write_mesh(path("a.vtkhdf"), mesh);
    EXPECT_EQ(detail::read_regular(path("a.vtkhdf")), first);
}

TEST_F(VtkHdf, PatchesAndSetsAreReadAsTheyWereWritten) {
    const HexMesh mesh = make_box(3, 1, 1);
    const MeshSets sets{{{"in", {{0, 0}}}, {"a/b", {{2, 1}, {2, 3}}}}, {{"ends", {0, 2}}, {"a/b", {1}}}};
    EXPECT_THAT(write_mesh(path("a.vtkhdf"), mesh, {}, sets),
                ElementsAre("array \"set:a/b\" is called \"set:a_b\"", "array \"patch:a/b\" is called \"patch:a_b\""));
    const ReadResult read = read_mesh(path("a.vtkhdf"));
    EXPECT_TRUE(read.warnings.empty() && read.fields.empty());
    EXPECT_EQ(find_patch(read.sets, "in").sides, sets.patches[0].sides);
    EXPECT_EQ(find_patch(read.sets, "a_b").sides, sets.patches[1].sides);
    EXPECT_EQ(find_set(read.sets, "ends").cells, sets.sets[0].cells);
    EXPECT_EQ(find_set(read.sets, "a_b").cells, sets.sets[1].cells);
    EXPECT_THAT(error_of([&] { write_mesh(path("b.vtkhdf"), mesh, {}, {{{"p", {{3, 0}}}}, {}}); }), HasSubstr("cell 3"));
}

// An array of a patch that is not what it should be is left out, with a sentence; the mesh is read.
TEST_F(VtkHdf, FieldDataThatIsWrongIsIgnored) {
    const auto said = [&](const auto& numbers) {
        {
            Hdf5Writer file(path("a.vtkhdf"));
            start(file, {row(2)});
            file.put("/VTKHDF/FieldData/patch:p", numbers);
            file.put("/VTKHDF/FieldData/TimeValue", std::vector<double>{1.5});
            file.put("/VTKHDF/CellData/set:second", std::vector<double>{0, 1});
        }
        const ReadResult read = read_mesh(path("a.vtkhdf"));
        EXPECT_EQ(read.mesh.cells.size(), 2u);
        EXPECT_TRUE(read.sets.patches.empty());
        EXPECT_EQ(find_set(read.sets, "second").cells, std::vector<Index>{1});
        EXPECT_EQ(read.warnings.size(), 1u);
        return read.warnings.at(0);
    };
    EXPECT_EQ(said(std::vector<double>{1, 2}), "array \"patch:p\" left out: its numbers are not integers");
    EXPECT_EQ(said(Numbers{1, 2}), "patch \"p\" left out: it is of another mesh");
    EXPECT_EQ(said(Numbers{12, 2, 0, 0, 1, 2, 3}), "patch \"p\" left out: it is of another mesh");
    EXPECT_EQ(said(Numbers{}), "patch \"p\" left out: it is of another mesh");
}

TEST_F(VtkHdf, SurfacesAreGridsOfTriangles) {
    LimitSurface surface;
    surface.surface = {.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}}};
    surface.normals = std::vector<Vec3>(3, Vec3(0, 0, 1));
    surface.fields = {{.name = "T", .channels = 1, .values = {1, 2, 3}, .gradients = {}}};
    write_limit_surface(path("a.vtkhdf"), surface);
    const auto read = [&] { static_cast<void>(read_mesh(path("a.vtkhdf"))); };
    EXPECT_THAT(error_of(read), HasSubstr("no hexahedra, but 1 triangle (VTK type 5)"));
}

TEST_F(VtkHdf, WrongFilesGetASentence) {
    EXPECT_THAT(error([](Hdf5Writer&) {}), HasSubstr("bad.vtkhdf: not a VTKHDF file"));
    EXPECT_THAT(error([](Hdf5Writer& file) {
                    file.group("/VTKHDF");
                    file.attribute("/VTKHDF", "Version", Numbers{1, 0});
                    file.attribute("/VTKHDF", "Type", "ImageData");
                }),
                HasSubstr("\"ImageData\" is not an UnstructuredGrid"));
    EXPECT_THAT(error([&](Hdf5Writer& file) {
                    Row bad = row(1);
                    bad.connectivity[3] = 8;
                    start(file, {bad});
                }),
                HasSubstr("cell 0: there is no point with index 8 (there are 8 points, counted from 0)"));
    EXPECT_THAT(error([&](Hdf5Writer& file) {
                    Row bad = row(1);
                    bad.offsets[1] = 9;
                    start(file, {bad});
                }),
                HasSubstr("cell 0 ends at 9"));
    EXPECT_THAT(error([&](Hdf5Writer& file) {
                    Row bad = row(1);
                    bad.cells = 1000000000;
                    start(file, {bad});
                }),
                HasSubstr("\"/VTKHDF/Types\" has 1 row; 1000000000 from row 0 on are needed"));
    EXPECT_THAT(error([&](Hdf5Writer& file) {
                    start(file, {row(1)});
                    file.put("/VTKHDF/PointData/T", std::vector<double>{1, 2, 3});
                }),
                HasSubstr("\"/VTKHDF/PointData/T\" has 3 rows; 8 from row 0 on are needed"));
    write("no.vtkhdf", "\x89HDF\r\n\x1a\nand nothing more");
    EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(path("no.vtkhdf"))); }), HasSubstr("damaged or not complete"));
    write("no.vtkhdf", "text");
    EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(path("no.vtkhdf"))); }), HasSubstr("not an HDF5 file"));
}

// What HDF5's library would decompress to its end: a hundred megabytes for eight numbers.
TEST_F(VtkHdf, AChunkDoesNotBecomeMoreThanItsNumbers) {
    const std::string zeros(std::size_t{100} << 20, '\0');
    std::string packed(compressBound(zeros.size()), '\0');
    uLongf size = packed.size();
    ASSERT_EQ(compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(zeros.data()),
                        zeros.size(), 9),
              Z_OK);
    packed.resize(size);
    const auto said = [&](std::vector<hsize_t> chunk) {
        return error([&](Hdf5Writer& file) {
            start(file, {row(1)});
            file.put_packed("/VTKHDF/PointData/T", {8}, chunk, packed);
        });
    };
    EXPECT_THAT(said({1 << 11}), HasSubstr("\"/VTKHDF/PointData/T\" cannot be read: the file is damaged"));
    EXPECT_THAT(said({1 << 14}), HasSubstr("\"/VTKHDF/PointData/T\" cannot be read: the file is damaged"));
    EXPECT_THAT(said({zeros.size() / 8}), HasSubstr("has chunks of 104857600 bytes, of which 64 are needed"));
}

// Programs make the datasets of steps when they open a file, and add to them as they write.
TEST_F(VtkHdf, StepsOfWhichNoneIsWritten) {
    {
        Hdf5Writer file(path("a.vtkhdf"));
        start(file, {row(2), row(1, 2)});
        for (const char* name :
             {"Values", "PartOffsets", "NumberOfParts", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets"})
            file.put("/VTKHDF/Steps/" + std::string(name), Numbers{}, {0}, false);
    }
    const ReadResult result = read_mesh(path("a.vtkhdf"));
    EXPECT_NEAR(inspect(result.mesh).volume, 3, 1e-12);
}

// Two levels of adaptive refinement: 2 x 2 x 2 cells, of which a step divides some. The values are the levels' numbers, with
// the step's. ends: of the names of the datasets for steps, which version 2.2 has without an s
void write_amr(Hdf5Writer& file, const std::vector<std::vector<std::array<int, 6>>>& fine,
               const std::array<std::string, 2>& ends, bool steps) {
    file.group("/VTKHDF");
    file.attribute("/VTKHDF", "Version", Numbers{2, 2});
    file.attribute("/VTKHDF", "Type", "OverlappingAMR");
    file.attribute("/VTKHDF", "GridDescription", "XYZ");
    file.reals("/VTKHDF", "Origin", {-1, 0, .5});
    const auto level = [](int l) { return "/VTKHDF/Level" + std::to_string(l); };
    for (const int l : {0, 1}) {
        file.group(level(l));
        file.reals(level(l), "Spacing", std::vector<double>(3, l == 0 ? 1 : .5));
    }
    Numbers boxes, offsets, counts, values, value_offsets, points, point_offsets, coarse, coarse_offsets;
    for (std::size_t s = 0; s < fine.size(); ++s) {
        const auto step = static_cast<std::int64_t>(s);
        offsets.push_back(static_cast<std::int64_t>(boxes.size() / 6));
        counts.push_back(static_cast<std::int64_t>(fine[s].size()));
        value_offsets.push_back(static_cast<std::int64_t>(values.size()));
        point_offsets.push_back(static_cast<std::int64_t>(points.size()));
        coarse_offsets.push_back(static_cast<std::int64_t>(coarse.size()));
        coarse.insert(coarse.end(), 8, 10 * step);
        for (const auto& box : fine[s]) {
            boxes.insert(boxes.end(), box.begin(), box.end());
            const auto along = [&](std::size_t a) { return static_cast<std::size_t>(box[2 * a + 1] - box[2 * a] + 1); };
            values.insert(values.end(), along(0) * along(1) * along(2), 10 * step + 1);
            points.insert(points.end(), (along(0) + 1) * (along(1) + 1) * (along(2) + 1), 10 * step + 1);
        }
    }
    file.put("/VTKHDF/Level0/AMRBox", Numbers{0, 1, 0, 1, 0, 1}, {1, 6});
    file.put("/VTKHDF/Level1/AMRBox", boxes, {boxes.size() / 6, 6});
    file.put("/VTKHDF/Level0/CellData/c", coarse);
    file.put("/VTKHDF/Level1/CellData/c", values);
    file.put("/VTKHDF/Level0/PointData/p", Numbers(27, 0));
    file.put("/VTKHDF/Level1/PointData/p", points);
    if (!steps) return;
    std::vector<double> times;
    for (std::size_t s = 0; s < fine.size(); ++s) times.push_back(.5 * static_cast<double>(s));
    file.put("/VTKHDF/Steps/Values", times);
    const std::string zero = "/VTKHDF/Steps/Level0/", one = "/VTKHDF/Steps/Level1/";
    file.put(zero + "AMRBoxOffset" + ends[0], Numbers(fine.size(), 0));
    file.put(zero + "NumberOfAMRBox" + ends[1], Numbers(fine.size(), 1));
    file.put(zero + "CellDataOffset" + ends[0] + "/c", coarse_offsets);
    file.put(zero + "PointDataOffset" + ends[0] + "/p", Numbers(fine.size(), 0));
    file.put(one + "AMRBoxOffset" + ends[0], offsets);
    file.put(one + "NumberOfAMRBox" + ends[1], counts);
    file.put(one + "PointDataOffset" + ends[0] + "/p", point_offsets);
    // Those of the cells are where the boxes of the steps before end.
}

TEST_F(VtkHdf, TheFinestCellsOfAdaptiveRefinement) {
    {
        Hdf5Writer file(path("a.vtkhdf"));
        write_amr(file, {{{0, 1, 0, 1, 0, 3}}}, {}, false);
    }
    const ReadResult result = read_mesh(path("a.vtkhdf"), {.cell_values = CellValues::Constant});
    EXPECT_EQ(result.mesh.cells.size(), 8u - 2 + 16);
    EXPECT_EQ(result.mesh.points.size(), 27u + 45 - 12);  // the corners of the two divided cells are points of both levels
    EXPECT_NEAR(inspect(result.mesh).volume, 8, 1e-12);
    EXPECT_EQ(result.mesh.find_attribute("c")->cells.front(), 0);
    EXPECT_EQ(result.mesh.find_attribute("c")->cells.back(), 1);
    for (std::size_t p = 0; p < result.mesh.points.size(); ++p) {
        const Vec3 x = result.mesh.points[p];
        EXPECT_EQ(result.mesh.find_attribute("p")->values[p], x.x <= 0 && x.y <= 1 ? 1 : 0);
    }
    EXPECT_THAT(result.warnings, Contains("2 levels of refinement put together; 2 cells that finer ones cover left out"));
}

TEST_F(VtkHdf, StepsOfAdaptiveRefinement) {
    for (const auto& ends : {std::array<std::string, 2>{"", ""}, std::array<std::string, 2>{"s", "es"}}) {
        {
            Hdf5Writer file(path("a.vtkhdf"));
            write_amr(file, {{{0, 1, 0, 1, 0, 3}, {2, 3, 2, 3, 0, 1}}, {}, {{0, 3, 0, 3, 0, 3}}}, ends, true);
        }
        EXPECT_EQ(open_series(path("a.vtkhdf")).size(), 3u);
        const std::array<std::size_t, 3> cells{8 - 3 + 24, 8, 64};
        for (std::size_t s = 0; s < 3; ++s) {
            const ReadResult result = read_mesh(path("a.vtkhdf"), {.step = s, .cell_values = CellValues::Constant});
            EXPECT_EQ(result.mesh.cells.size(), cells[s]);
            EXPECT_NEAR(inspect(result.mesh).volume, 8, 1e-12);
            const auto& values = result.mesh.find_attribute("c")->cells;
            for (std::size_t c = 0; c < values.size(); ++c) {
                const bool coarse = std::abs(result.mesh.points[result.mesh.cells[c][1]].x -
                                             result.mesh.points[result.mesh.cells[c][0]].x) > .7;
                EXPECT_EQ(values[c], 10 * static_cast<double>(s) + (coarse ? 0 : 1));
            }
        }
    }
}

TEST_F(VtkHdf, AdaptiveRefinementThatIsWrong) {
    const auto said = [&](const std::vector<std::array<int, 6>>& boxes, const std::function<void(Hdf5Writer&)>& more = {}) {
        return error([&](Hdf5Writer& file) {
            write_amr(file, {boxes}, {}, false);
            if (more) more(file);
        });
    };
    EXPECT_THAT(said({{0, 1, 0, 1, 0, 4}}),
                HasSubstr("block 0 of level 1: its box 0 1 0 1 0 4 divides cells of level 0 along z in part"));
    EXPECT_THAT(said({{0, 1, 0, 1, 2, 5}}), HasSubstr("block 0 of level 1 lies outside of the blocks of level 0"));
    EXPECT_THAT(said({{0, 1, 0, 1, 0, 1}, {0, 3, 0, 1, 0, 1}}), HasSubstr("block 1 of level 1 overlaps block 0 of level 1"));
    EXPECT_THAT(said({{0, 1, 0, 1, 0, 1}},
                     [](Hdf5Writer& file) {
                         file.put("/VTKHDF/Level1/CellData/short", Numbers{1, 2});
                     }),
                HasSubstr("\"/VTKHDF/Level1/CellData/short\" has 2 rows; 8 from row 0 on are needed"));
    EXPECT_THAT(said({{0, 1, 0, 1, 0, 1}},
                     [](Hdf5Writer& file) {
                         file.put("/VTKHDF/Level2/AMRBox", Numbers{0, 1, 0, 1, 0, 1}, {1, 6});
                     }),
                HasSubstr("the attribute \"Spacing\" of \"/VTKHDF/Level2\" is not three numbers"));
    EXPECT_THAT(error([](Hdf5Writer& file) {
                    file.group("/VTKHDF");
                    file.attribute("/VTKHDF", "Version", Numbers{2, 2});
                    file.attribute("/VTKHDF", "Type", "OverlappingAMR");
                    file.reals("/VTKHDF", "Origin", {0, 0, 0});
                    file.group("/VTKHDF/Level0");
                    file.reals("/VTKHDF/Level0", "Spacing", {1, 1, 1});
                    file.put("/VTKHDF/Level0/AMRBox", Numbers{0, 999, 0, 999, 0, 999}, {1, 6});
                }),
                HasSubstr("its boxes have 1003003001 points, and 0 values"));
}

TEST_F(VtkHdf, RealFile) {
    const auto file = beside_data("series/can.vtkhdf");
    if (!file) GTEST_SKIP() << "no series/can.vtkhdf beside the folder that SUBVOL_DATA names";
    const ReadResult result = read_mesh(*file);
    EXPECT_EQ(result.mesh.points.size(), 6724u);
    EXPECT_EQ(result.mesh.cells.size(), 4800u);
    for (const std::string name : {"ACCL", "DISPL", "VEL"}) EXPECT_EQ(result.mesh.find_attribute(name)->channels, 3) << name;
    EXPECT_NE(result.mesh.find_attribute("EQPS"), nullptr);
}

}  // namespace vtkhdf_test

}  // namespace subvol::test
