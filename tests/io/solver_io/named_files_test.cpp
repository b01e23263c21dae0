// SPDX-License-Identifier: Apache-2.0
// Files that name others: in a circle, again and again, by names of what is no file.

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <ctime>

#include "io/mesh_io/mesh_texts.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/detail/read_file.h"
#include "subvol/mesh_report.h"
#include "subvol/mesh_series.h"

namespace subvol::test {

namespace named_files_test {

using testing::HasSubstr;

std::string list(const std::string& type, const std::string& inside) {
    return "<VTKFile type=\"" + type + "\" version=\"0.1\">\n<" + type + ">\n" + inside + "</" + type + "></VTKFile>";
}

std::string repeated(const std::string& text, int times) {
    std::string all;
    for (int k = 0; k < times; ++k) all += text;
    return all;
}

const std::string kElement =
    "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n"
    "*ELEMENT, TYPE=C3D8\n1,1,2,3,4,5,6,7,8\n";

class NamedFiles : public TempFolder {
protected:
    [[nodiscard]] std::string error(const std::string& name) const {
        return error_of([&] { static_cast<void>(read_mesh(path(name))); });
    }
    [[nodiscard]] std::string error(const std::string& name, const std::string& text) const {
        write(name, text);
        return error(name);
    }
    // A .vtu of n³ cells, which begin at a place on the x axis.
    void write_cubes(const std::string& name, Index n = 1, double at = 0) const {
        HexMesh mesh = make_box(n, n, n);
        for (Vec3& x : mesh.points) x.x += at;
        static_cast<void>(write_mesh(path(name), mesh));
    }
};

TEST_F(NamedFiles, CirclesAreNamed) {
    EXPECT_THAT(error("a.pvd", list("Collection", "<DataSet timestep=\"0\" file=\"a.pvd\"/>")),
                HasSubstr("a.pvd, line 3: names itself, by a.pvd > a.pvd"));
    EXPECT_THAT(error("a.vtk.series", R"({"files": [{"name": "a.vtk.series", "time": 0}]})"),
                HasSubstr("names itself, by a.vtk.series > a.vtk.series"));
    write("b.vtu.series", R"({"files": [{"name": "a.pvd", "time": 0}]})");
    EXPECT_THAT(error("a.pvd", list("Collection", "<DataSet timestep=\"0\" file=\"b.vtu.series\"/>")),
                HasSubstr("b.vtu.series, entry 0 of \"files\": names itself, by a.pvd > b.vtu.series > a.pvd"));
    write("c.pvtu", list("PUnstructuredGrid", "<Piece Source=\"d.vtm\"/>"));
    EXPECT_THAT(error("d.vtm", list("vtkMultiBlockDataSet", "<DataSet index=\"0\" file=\"./../" +
                                                                path("").parent_path().filename().string() + "/c.pvtu\"/>")),
                HasSubstr("names itself, by d.vtm > c.pvtu > d.vtm"));
    write("f.inp", "*INCLUDE, INPUT=e.inp\n");
    EXPECT_THAT(error("e.inp", kElement + "*INCLUDE, INPUT=f.inp\n"),
                HasSubstr("f.inp, line 1: names itself, by e.inp > f.inp > e.inp"));
    std::filesystem::create_symlink("g.pvd", path("h.pvd"));
    EXPECT_THAT(error("g.pvd", list("Collection", "<DataSet timestep=\"0\" file=\"h.pvd\"/>")),
                HasSubstr("names itself, by g.pvd > h.pvd"));
}

TEST_F(NamedFiles, AListOfAListIsItsLastStep) {
    write_cubes("t0.vtu", 1);
    write_cubes("t1.vtu", 2);
    write("b.vtu.series", R"({"files": [{"name": "t0.vtu", "time": 0}, {"name": "t1.vtu", "time": 1}]})");
    write("a.pvd", list("Collection", "<DataSet timestep=\"0\" file=\"b.vtu.series\"/>"));
    EXPECT_EQ(read_mesh(path("a.pvd")).mesh.cells.size(), 8u);
}

TEST_F(NamedFiles, DepthAndNumberAreBounded) {
    write_cubes("a.vtu");
    for (int k = 0; k < 20; ++k) {
        const std::string next = k == 19 ? "a.vtu" : "l" + std::to_string(k + 1) + ".vtm";
        write("l" + std::to_string(k) + ".vtm", list("vtkMultiBlockDataSet", "<DataSet index=\"0\" file=\"" + next + "\"/>"));
    }
    EXPECT_THAT(error("l0.vtm"), HasSubstr("files name each other, more than 16 deep"));
    EXPECT_EQ(read_mesh(path("l8.vtm")).mesh.cells.size(), 1u);
    // 30⁵ names of a surface, by lists of 30.
    write("s.vtp", "");
    for (int k = 0; k < 5; ++k) {
        const std::string next = k == 4 ? "s.vtp" : "m" + std::to_string(k + 1) + ".vtm";
        write("m" + std::to_string(k) + ".vtm", list("vtkMultiBlockDataSet", repeated("<DataSet file=\"" + next + "\"/>", 30)));
    }
    EXPECT_THAT(error("m0.vtm"), HasSubstr("more than 100000 files are named"));
    // 8⁶ files of a deck.
    for (int k = 0; k < 6; ++k) {
        const std::string next = k == 5 ? "end.inp" : "i" + std::to_string(k + 1) + ".inp";
        write("i" + std::to_string(k) + ".inp", repeated("*INCLUDE, INPUT=" + next + "\n", 8));
    }
    write("end.inp", "** nothing\n");
    EXPECT_THAT(error("i0.inp"), HasSubstr("more than 10000 files are named"));
}

TEST_F(NamedFiles, TheSameBytesAgainAndAgainAreRefused) {
    write_cubes("big.vtu", 16);
    EXPECT_THAT(error("a.vtm", list("vtkMultiBlockDataSet", repeated("<DataSet file=\"big.vtu\"/>\n", 5000))),
                HasSubstr("what is named again and again is too much"));
    // A file of an EnSight case for each of many variables.
    const std::string numbers = repeated("1\n", 8);
    write("g.geo",
          "d\nd\nnode id off\nelement id off\npart\n1\np\ncoordinates\n8\n0\n1\n1\n0\n0\n1\n1\n0\n0\n0\n1\n1\n0\n0\n1\n1\n" +
              repeated("0\n", 4) + repeated("1\n", 4) + "hexa8\n1\n1 2 3 4 5 6 7 8\n");
    write("v", "d\npart\n1\ncoordinates\n" + numbers + repeated(" \n", 1 << 20));
    std::string variables;
    for (int k = 0; k < 100; ++k) variables += "scalar per node: v" + std::to_string(k) + " v\n";
    const ReadResult some =
        read_mesh(write("a.case", "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: g.geo\nVARIABLE\n" + variables));
    ASSERT_FALSE(some.unread.empty());
    EXPECT_THAT(some.unread.back().why, HasSubstr("what is named again and again is too much"));
    // An item of XDMF for each of many attributes.
    const std::string item = "<DataItem Name=\"x\" Dimensions=\"8\">" + numbers + "</DataItem>";
    const std::string again = "<Attribute Name=\"a\"><DataItem Reference=\"/Xdmf/Domain/DataItem\"/></Attribute>";
    const auto xdmf = [&](int attributes) {
        return "<Xdmf><Domain>" + item +
               "<Grid><Topology TopologyType=\"Hexahedron\"><DataItem Dimensions=\"8\">0 1 2 3 4 5 6 7</DataItem></Topology>"
               "<Geometry><DataItem Dimensions=\"24\">0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1</DataItem></Geometry>" +
               repeated(again, attributes) + "</Grid></Domain></Xdmf>";
    };
    write("a.xdmf", xdmf(100));
    EXPECT_EQ(read_mesh(path("a.xdmf")).mesh.attributes.size(), 100u);
    EXPECT_THAT(error("a.xdmf", xdmf(300000)), HasSubstr("what is named again and again is too much"));
}

// A small file whose arrays are all at the same place in it.
TEST_F(NamedFiles, ArraysThatShareAppendedDataAreRefused) {
    const HexMesh mesh = make_box(29, 29, 29);
    const std::uint64_t size = mesh.points.size() * sizeof(Vec3);
    std::string data(reinterpret_cast<const char*>(&size), sizeof size);
    data.append(reinterpret_cast<const char*>(mesh.points.data()), size);
    const auto text = [&](int arrays) {
        const std::string extent = "Extent=\"0 29 0 29 0 29\">";
        const std::string here = "type=\"Float64\" NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/>";
        return "<VTKFile type=\"StructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">"
               "<StructuredGrid Whole" +
               extent + "<Piece " + extent + "<Points><DataArray " + here + "</Points><PointData>" +
               repeated("<DataArray Name=\"a\" " + here, arrays) +
               "</PointData></Piece></StructuredGrid><AppendedData encoding=\"raw\">_" + data + "</AppendedData></VTKFile>";
    };
    write("a.vts", text(3));
    EXPECT_EQ(read_mesh(path("a.vts")).mesh.attributes.size(), 3u);
    EXPECT_THAT(error("a.vts", text(200)), HasSubstr("a.vts, line 1: what is named again and again is too much"));
}

TEST_F(NamedFiles, CopiesOfADeckAreInProportionToIt) {
    const std::string part = "*PART, NAME=P\n" + kElement + "*END PART\n";
    const std::string instance = "*INSTANCE, NAME=i, PART=P\n*END INSTANCE\n";
    const std::string moved = "*INSTANCE, NAME=i, PART=P\n3,0,0\n*END INSTANCE\n";
    write("a.inp", part + instance + moved);
    EXPECT_NEAR(inspect(read_mesh(path("a.inp")).mesh).volume, 2, 1e-12);
    const std::string many = "*PART, NAME=P\n" + kElement + "*ELGEN\n1,900000,0,1\n*END PART\n";
    EXPECT_THAT(error("a.inp", many + repeated(instance, 5)),
                HasSubstr("a.inp, line 18: its instances have too many nodes, elements and members of sets (at most 1048576"));
    EXPECT_THAT(error("a.inp", kElement + "*ELGEN\n1,3000000000,1,1,3000000000,1,1,3000000000,1,1\n"),
                HasSubstr("too many nodes or elements are generated"));
    EXPECT_THAT(error("a.inp", kElement + "*ELGEN\n1,1099511627776,1099511627776\n"), HasSubstr("out of range"));
    EXPECT_THAT(error("a.inp", kElement + "*ELSET, ELSET=A\n1,1,1,1\n" + repeated("A,A,A\n", 40)),
                HasSubstr("its sets have too many members"));
}

TEST_F(NamedFiles, OnlyRegularFilesAreReadBehindANameAndNamesEndNowhere) {
    ASSERT_EQ(::mkfifo(path("pipe.vtu").c_str(), 0600), 0);
    std::filesystem::create_directory(path("folder.vtu"));
    std::filesystem::create_symlink("/dev/zero", path("zero.vtu"));
    std::filesystem::create_symlink("/proc/self/pagemap", path("pages.vtu"));
    for (const std::string name : {"pipe.vtu", "folder.vtu", "zero.vtu", "pages.vtu"}) {
        const std::string wrong = "\"" + name + "\" is not a regular file";
        EXPECT_THAT(error("a.pvd", list("Collection", "<DataSet timestep=\"0\" file=\"" + name + "\"/>")), HasSubstr(wrong));
        EXPECT_THAT(error("a.vtm", list("vtkMultiBlockDataSet", "<DataSet file=\"" + name + "\"/>")), HasSubstr(wrong));
        EXPECT_THAT(error("a.pvtu", list("PUnstructuredGrid", "<Piece Source=\"" + name + "\"/>")), HasSubstr(wrong));
        EXPECT_THAT(error("a.vtu.series", R"({"files": [{"name": ")" + name + "\"}]}"), HasSubstr(wrong));
        EXPECT_THAT(error("a.inp", "*INCLUDE, INPUT=" + name + "\n"), HasSubstr(wrong));
        EXPECT_THAT(error("a.case", "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: " + name + "\n"), HasSubstr(wrong));
        EXPECT_THAT(error("a.xdmf",
                          "<Xdmf><Domain><Grid><Topology TopologyType=\"Hexahedron\"><DataItem Format=\"Binary\" "
                          "Dimensions=\"8\">" +
                              name +
                              "</DataItem></Topology><Geometry><DataItem>0 0 0</DataItem>"
                              "</Geometry></Grid></Domain></Xdmf>"),
                    HasSubstr(wrong));
        EXPECT_THAT(error_of([&] { static_cast<void>(detail::read_regular(path(name))); }), HasSubstr("not a regular file"));
    }
    // Files that lie beside another, or in its folder.
    const HexMesh cube = make_box(1, 1, 1);
    std::string grid = "2 2 2\n";
    for (int a = 0; a < 3; ++a) {
        for (const Vec3& x : cube.points) grid += number(x[a]) + " ";
    }
    ASSERT_EQ(::mkfifo(path("a.q").c_str(), 0600), 0);
    EXPECT_THAT(error("a.xyz", grid), HasSubstr("\"a.q\" is not a regular file"));
    std::filesystem::create_directories(path("constant/polyMesh"));
    for (const char* name : {"faces", "points"}) write(std::string("constant/polyMesh/") + name, "");
    ASSERT_EQ(::mkfifo(path("constant/polyMesh/owner").c_str(), 0600), 0);
    EXPECT_THAT(error("a.foam", ""), HasSubstr("\"owner\" is not a regular file"));
    write_cubes("b.vtu");
    EXPECT_THAT(error("a.vtu.series", R"({"files": [{"name": "b.vtu\u0000../../etc/passwd"}]})"),
                HasSubstr("entry 0 of \"files\": the name \"b.vtu\\x00../../etc/passwd\" has a zero byte"));
    // What the user names may have no size, but has to end.
    std::filesystem::create_symlink("/dev/zero", path("zero.vtk"));
    EXPECT_THAT(error("zero.vtk"), HasSubstr("does not end within 200 MB"));
    std::ofstream(path("holes.vtk")).put('#');
    std::filesystem::resize_file(path("holes.vtk"), std::uintmax_t{1} << 43);
    EXPECT_THAT(error("holes.vtk"), HasSubstr("has 8.8e+03 GB (this machine's memory has"));
}

// Quadratic in the number of entries, these take minutes.
TEST_F(NamedFiles, LongListsTakeTimeInProportion) {
    write_cubes("a.vtu");
    constexpr int kEntries = 100000;
    const std::clock_t begin = std::clock();
    std::string entries;
    for (int k = 0; k < kEntries; ++k) {
        entries += "<DataSet timestep=\"" + std::to_string(k) + ".5\" file=\"a.vtu\"/>\n" + std::string(100, ' ') + "\n";
    }
    write("a.pvd", list("Collection", entries));
    const MeshSeries series = open_series(path("a.pvd"));
    ASSERT_EQ(series.size(), std::size_t{kEntries});
    EXPECT_EQ(series.times.back(), kEntries - .5);
    EXPECT_EQ(read_mesh(path("a.pvd"), {.step = 7}).mesh.cells.size(), 1u);
    // A list that is named often is read once, and where a block is named is counted once.
    write("b.vtm", list("vtkMultiBlockDataSet", repeated("<DataSet file=\"s.vtp\"/>\n", 900)));
    write("s.vtp", "");
    write("c.vtm", list("vtkMultiBlockDataSet", "<DataSet file=\"a.vtu\"/>" + repeated("<DataSet file=\"b.vtm\"/>\n", 100)));
    EXPECT_EQ(read_mesh(path("c.vtm")).mesh.cells.size(), 1u);
    EXPECT_LT((std::clock() - begin) / CLOCKS_PER_SEC, 60) << "CPU seconds";
}

}  // namespace named_files_test

}  // namespace subvol::test
