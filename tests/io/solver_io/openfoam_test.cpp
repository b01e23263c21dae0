// SPDX-License-Identifier: Apache-2.0
// OpenFOAM cases, written as text and in binary of all widths.

#include <gmock/gmock.h>
#include <zlib.h>

#include <cstring>

#include "foam_texts.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/mesh_report.h"
#include "subvol/mesh_series.h"
#include "subvol/surface.h"

namespace subvol::test {

namespace openfoam_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using namespace foam;

class OpenFoam : public TempFolder {
protected:
    void put(const std::string& name, const std::string& text, const Form& form) const {
        std::filesystem::create_directories(path(name).parent_path());
        if (!form.gzipped) {
            write(name, text);
            return;
        }
        const gzFile file = gzopen((path(name).string() + ".gz").c_str(), "wb");
        gzwrite(file, text.data(), static_cast<unsigned>(text.size()));
        gzclose(file);
    }

    void put_mesh(const std::string& folder, const Polyhedra& mesh, const Form& form) const {
        for (const auto& [name, text] : mesh_texts(mesh, form)) put(folder + "/" + name, text, form);
    }

    void put_points(const std::string& folder, const std::vector<Vec3>& points, const Form& form) const {
        put(folder + "/points", points_text(points, form), form);
    }

    [[nodiscard]] std::string error() const {
        return error_of([&] { static_cast<void>(read_mesh(path("a.foam"))); });
    }
};

double boundary_area(const HexMesh& mesh) {
    const Surface surface = boundary_surface(mesh);
    double area = 0;
    for (const auto& t : surface.triangles) {
        const auto x = [&](std::size_t k) { return Vec3(surface.points[t[k]]); };
        area += glm::length(glm::cross(x(1) - x(0), x(2) - x(0))) / 2;
    }
    return area;
}

Polyhedra box(Index n) {
    const HexMesh mesh = make_box(n, 2, 1);
    std::vector<std::vector<std::vector<int>>> cells;
    for (const auto& cell : mesh.cells) cells.push_back(faces_of_hex(cell));
    return polyhedra(mesh.points, cells);
}

TEST_F(OpenFoam, HexahedraAndTheirFieldsInEveryForm) {
    const Polyhedra mesh = box(3);
    const std::vector<double> p{1, 2, 3, 4, 5, 6};
    write("a.foam", "");
    for (const Form form :
         {Form{}, Form{.binary = true}, Form{.binary = true, .wide_labels = true}, Form{.binary = true, .wide_reals = false},
          Form{.gzipped = true}, Form{.binary = true, .gzipped = true}}) {
        for (const std::string part : {"constant", "0", "0.5"}) std::filesystem::remove_all(path(part));
        put_mesh("constant/polyMesh", mesh, form);
        put("0/p", header("volScalarField", form) + "dimensions [0 2 -2 0 0 0 0];\ninternalField uniform 7;\nboundaryField{}",
            form);
        put("0.5/p",
            header("volScalarField", form) + "dimensions [0 2 -2 0 0 0 0];\ninternalField nonuniform List<scalar> " +
                reals(p, 1, form) + ";\nboundaryField { a { value uniform 0; } }",
            form);
        put("0.5/U", header("volVectorField", form) + "internalField uniform (1 2 3);", form);
        put("0.5/phi", header("surfaceScalarField", form) + "internalField nonuniform List<scalar> 0();", form);
        for (const auto& input : {path("a.foam"), path("")}) {
            EXPECT_THAT(open_series(input).times, ElementsAre(0, .5));
            const ReadResult result = read_mesh(input);
            const MeshReport report = inspect(result.mesh);
            EXPECT_EQ(report.cells, 6u);
            EXPECT_EQ(report.inverted_cells, 0u);
            EXPECT_NEAR(report.volume, 6, 1e-6);
            EXPECT_THAT(result.warnings, Contains("the file has 2 steps; the last one is read"));
            ASSERT_EQ(result.fields.size(), 2u);
            EXPECT_EQ(result.fields[1].name, "p");
            EXPECT_EQ(result.fields[1].max, 6);
            EXPECT_EQ(result.mesh.find_attribute("U")->values[5], 3);
            EXPECT_EQ(read_mesh(input, {.step = 0}).fields[0].max, 7);
        }
    }
}

TEST_F(OpenFoam, NamesStandForTheirEntriesAndOneBadFieldStopsNoOther) {
    write("a.foam", "");
    put_mesh("constant/polyMesh", box(2), {});
    const std::string scalar = header("volScalarField", {}), vector = header("volVectorField", {});
    put("0/values", "energy 0.24; // a comment\nflow (1 $speed 3);\nspeed 5;\nloop $loop;\ninner { energy 9; }\n", {});
    put("0/k", scalar + "#include \"values\"\ninternalField uniform $energy;\nboundaryField { a { value $internalField; } }",
        {});
    put("0/U", vector + "#include \"values\"\ndimensions [0 1 -1 0 0 0 0];\ninternalField uniform ${flow};", {});
    put("0/V", vector + "#include \"values\"\ninternalField uniform (0 $speed 0);", {});
    put("0/w", scalar + "start uniform 4;\ninternalField $start;", {});
    put("0/bad", scalar + "internalField uniform #calc \"1 + 1\";", {});
    put("0/worse", scalar + "#include \"values\"\ninternalField uniform $loop;", {});
    put("0/none", scalar + "#includeIfPresent \"nothing\"\ninternalField uniform $nothing;", {});
    std::string bomb = scalar + "e14 ;\n";  // 20¹⁴ times nothing
    for (int k = 13; k >= 0; --k) {
        bomb += "e" + std::to_string(k);
        for (int i = 0; i < 20; ++i) bomb += " $e" + std::to_string(k + 1);
        bomb += ";\n";
    }
    put("0/bomb", bomb + "internalField uniform $e0;", {});
    const ReadResult result = read_mesh(path("a.foam"));
    const auto value = [&](const std::string& name, std::size_t c) { return result.mesh.find_attribute(name)->values[c]; };
    EXPECT_NEAR(value("k", 0), .24, 1e-12);
    EXPECT_NEAR(value("U", 1), 5, 1e-12);
    EXPECT_NEAR(value("U", 2), 3, 1e-12);
    EXPECT_NEAR(value("V", 1), 5, 1e-12);
    EXPECT_NEAR(value("w", 0), 4, 1e-12);
    std::vector<std::string> unread;
    for (const UnreadField& field : result.unread) unread.push_back(field.name);
    EXPECT_THAT(unread, ElementsAre("bad", "bomb", "none", "worse"));
    EXPECT_THAT(result.warnings, Contains(HasSubstr("4 fields left out (\"bad\", \"bomb\", \"none\", \"worse\"): ")));
}

TEST_F(OpenFoam, FilesOfSeveralProcessorsAreTakenApart) {
    write("a.foam", "");
    // Two processors have a half each, which meet at two faces; ranges of processors are in folders of their own.
    const Polyhedra half = box(2);
    Polyhedra other = half;
    for (Vec3& x : other.points) x.x += 2;
    const auto block = [](const std::string& text) { return std::to_string(text.size()) + "\n(" + text + ")\n"; };
    const auto without_header = [](const std::string& text) { return text.substr(text.find("// * * //")); };
    for (const Form form : {Form{}, Form{.binary = true}}) {
        const std::string all = header("decomposedBlockData", {.binary = true});
        for (const std::vector<std::string>& folders :
             {std::vector<std::string>{"processors"}, std::vector<std::string>{"processors2_0-0", "processors2_1-1"}}) {
            for (const std::string folder : {"one", "two", "processors", "processors2_0-0", "processors2_1-1"}) {
                std::filesystem::remove_all(path(folder));
            }
            put_mesh("one/constant/polyMesh", half, form);
            put_mesh("two/constant/polyMesh", other, form);
            put("one/1/p",
                header("volScalarField", form) + "internalField nonuniform List<scalar> " + reals({1, 2, 3, 4}, 1, form) + ";",
                form);
            put("two/1/p", header("volScalarField", form) + "internalField uniform 7;", form);
            for (const std::string name : {"constant/polyMesh/points", "constant/polyMesh/faces", "constant/polyMesh/owner",
                                           "constant/polyMesh/neighbour", "1/p"}) {
                const std::string first = read_bytes(path("one/" + name)), second = read_bytes(path("two/" + name));
                if (folders.size() == 1) {
                    put(folders[0] + "/" + name, all + block(first) + block(without_header(second)), {});
                } else {
                    put(folders[0] + "/" + name, all + block(first), {});
                    put(folders[1] + "/" + name, all + block(second), {});
                }
            }
            const ReadResult result = read_mesh(path("a.foam"));
            EXPECT_NEAR(inspect(result.mesh).volume, 8, 1e-6);
            ASSERT_EQ(result.fields.size(), 1u);
            EXPECT_EQ(result.fields[0].max, 7);
            EXPECT_THAT(open_series(path("a.foam")).times, ElementsAre(1));
        }
        std::filesystem::rename(path("processors2_1-1"), path("aside"));
        EXPECT_THAT(error(), HasSubstr("there is no folder with the files of processor 1"));
        std::filesystem::rename(path("aside"), path("processors3_1-2"));
        EXPECT_THAT(error(), HasSubstr("processors3_1-2: 1 block in the files of a folder for 2 processors"));
        std::filesystem::rename(path("processors3_1-2"), path("processors2_0-1"));
        EXPECT_THAT(error(), HasSubstr("processor 0 is in \"processors2_0-1\" and in another folder"));
        std::filesystem::remove_all(path("processors2_0-0"));
        std::filesystem::rename(path("processors2_0-1"), path("processors2_1-1"));
        EXPECT_THAT(error(), HasSubstr("there is no folder with the files of processor 0"));
    }
    put("processors/constant/polyMesh/faces", "", {});
    put("processors/constant/polyMesh/owner", header("decomposedBlockData", {}) + "9999\n(", {});
    std::filesystem::remove_all(path("processors2_1-1"));
    EXPECT_THAT(error(), HasSubstr("owner, line"));
}

TEST_F(OpenFoam, PointsThatMoveAreThoseOfTheirTime) {
    write("a.foam", "");
    const Polyhedra mesh = box(1);
    put_mesh("constant/polyMesh", mesh, {});
    std::vector<Vec3> moved = mesh.points;
    for (Vec3& x : moved) x *= 2;
    put_points("2/polyMesh", moved, {});
    for (const std::string time : {"1", "2", "10"}) std::filesystem::create_directories(path(time));
    EXPECT_THAT(open_series(path("a.foam")).times, ElementsAre(1, 2, 10));
    for (const auto& [step, volume] : std::vector<std::pair<std::size_t, double>>{{0, 2}, {1, 16}, {2, 16}}) {
        EXPECT_NEAR(inspect(read_mesh(path("a.foam"), {.step = step}).mesh).volume, volume, 1e-12);
    }
}

// A cube with a prism, a pyramid and a tetrahedron on it, and a cube one of whose faces is in four parts, beside small cubes.
TEST_F(OpenFoam, CellsAreTakenByTheirShapes) {
    write("a.foam", "");
    const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1},   {1, 0, 1},
                                   {1, 1, 1}, {0, 1, 1}, {2, 0, 0}, {2, 0, 1}, {.5, .5, 2}, {.5, -1, 1.5}};
    const auto cube = faces_of_hex({0, 1, 2, 3, 4, 5, 6, 7});
    const std::vector<std::vector<int>> prism{{1, 2, 8}, {5, 9, 6}, {1, 5, 6, 2}, {1, 8, 9, 5}, {2, 6, 9, 8}};
    const std::vector<std::vector<int>> pyramid{{4, 7, 6, 5}, {4, 5, 10}, {5, 6, 10}, {6, 7, 10}, {7, 4, 10}};
    const std::vector<std::vector<int>> tet{{4, 10, 5}, {4, 5, 11}, {5, 10, 11}, {10, 4, 11}};
    put_mesh("constant/polyMesh", polyhedra(points, {cube, prism, pyramid, tet}), {});
    const ReadResult result = read_mesh(path("a.foam"));
    EXPECT_THAT(result.warnings[0], HasSubstr("1 hexahedron, 1 tetrahedron, 1 prism and 1 pyramid"));
    const MeshReport report = inspect(result.mesh);
    EXPECT_EQ(report.inverted_cells, 0u);
    const double of_tet =
        std::abs(glm::dot(points[5] - points[4], glm::cross(points[10] - points[4], points[11] - points[4]))) / 6;
    EXPECT_NEAR(report.volume, 1 + .5 + 1. / 3 + of_tet, 1e-12);
    EXPECT_EQ(read_mesh(path("a.foam"), {.other_cells = OtherCells::Ignore}).mesh.cells.size(), 1u);
}

TEST_F(OpenFoam, PolyhedraWithHangingNodesFitToTheirNeighbours) {
    write("a.foam", "");
    // A cube of edge 2, beside four of edge 1 on its face x = 2.
    std::vector<Vec3> points{{0, 0, 0}, {0, 2, 0}, {0, 0, 2}, {0, 2, 2}};
    for (int i = 0; i < 2; ++i) {
        for (int k = 0; k < 3; ++k) {
            for (int j = 0; j < 3; ++j) points.push_back({2 + i, j, k});
        }
    }
    const auto at = [](int i, int j, int k) { return 4 + 9 * i + 3 * k + j; };
    std::vector<std::vector<std::vector<int>>> cells;
    std::vector<std::vector<int>> large{{0, 2, 3, 1}};
    large.push_back({0, at(0, 0, 0), at(0, 0, 1), at(0, 0, 2), 2});
    large.push_back({1, 3, at(0, 2, 2), at(0, 2, 1), at(0, 2, 0)});
    large.push_back({0, 1, at(0, 2, 0), at(0, 1, 0), at(0, 0, 0)});
    large.push_back({2, at(0, 0, 2), at(0, 1, 2), at(0, 2, 2), 3});
    for (int j = 0; j < 2; ++j) {
        for (int k = 0; k < 2; ++k) {
            large.push_back({at(0, j, k), at(0, j + 1, k), at(0, j + 1, k + 1), at(0, j, k + 1)});
            const auto p = [&](int i, int dj, int dk) { return static_cast<Index>(at(i, j + dj, k + dk)); };
            cells.push_back(
                faces_of_hex({p(0, 0, 0), p(1, 0, 0), p(1, 1, 0), p(0, 1, 0), p(0, 0, 1), p(1, 0, 1), p(1, 1, 1), p(0, 1, 1)}));
        }
    }
    cells.insert(cells.begin(), large);
    put_mesh("constant/polyMesh", polyhedra(points, cells), {});
    const ReadResult result = read_mesh(path("a.foam"));
    EXPECT_EQ(result.warnings[0], "1 polyhedron split from the middle into 22 tetrahedra");
    const MeshReport report = inspect(result.mesh);
    EXPECT_NEAR(report.volume, 8 + 4, 1e-12);
    EXPECT_EQ(report.inverted_cells, 0u);
    EXPECT_EQ(report.nonmanifold_faces, 0u);
    // No gap: the boundary is that of the solid, whose faces are cut into triangles of three quads each.
    EXPECT_NEAR(boundary_area(result.mesh), 4 + 4 * 4 + 4 + 4 * 2, 1e-12);
}

TEST_F(OpenFoam, DecomposedCasesAreJoined) {
    write("a.foam", "");
    const HexMesh whole = make_box(4, 2, 1);
    const auto put_case = [&](int count) {
        for (const auto& [name, text] : case_of_processors(whole, count)) put(name, text, {});
    };
    put_case(2);
    const ReadResult result = read_mesh(path("a.foam"));
    EXPECT_EQ(result.warnings[0], "2 processors put together; 6 points joined with those of another, by \"GlobalNodeId\"");
    EXPECT_EQ(result.mesh.points, whole.points);
    EXPECT_EQ(inspect(result.mesh).boundary_faces, inspect(whole).boundary_faces);
    EXPECT_EQ(result.fields.size(), 1u);
    EXPECT_EQ(result.fields[0].max, 1);
    // A processor that is not there is missed, whichever it is.
    put_case(4);
    const auto rename = [&](const char* from, const char* to) { std::filesystem::rename(path(from), path(to)); };
    EXPECT_EQ(inspect(read_mesh(path("a.foam")).mesh).cells, 8u);
    for (const char* gone : {"processor0", "processor2"}) {
        rename(gone, "aside");
        EXPECT_THAT(error(), HasSubstr("there is no mesh in the folder " + std::string(gone))) << gone;
        std::filesystem::create_directory_symlink(gone, path(gone));  // a loop
        EXPECT_THAT(error(), HasSubstr("there is no mesh in the folder " + std::string(gone))) << gone;
        std::filesystem::remove(path(gone));
        std::filesystem::create_directory_symlink("processor1", path(gone));
        EXPECT_THAT(error(), HasSubstr("is the same folder as processor")) << gone;
        std::filesystem::remove(path(gone));
        rename("aside", gone);
    }
    rename("processor3", "aside");
    EXPECT_THAT(error(), HasSubstr("processor 3, a neighbour, is not there (there are 3 processors)"));
    rename("aside", "processor3");
    const std::string numbers = "processor1/constant/polyMesh/pointProcAddressing";
    const std::string good = read_bytes(path(numbers));
    put(numbers, replaced(good, " 1", " -1"), {});
    EXPECT_THAT(error(), HasSubstr("point 0 has the number -1"));
    put(numbers, header("labelList", {}) + labels({1, 2, 3}, {}), {});
    EXPECT_THAT(error(), HasSubstr("3 numbers of points (12 are needed)"));
}

TEST_F(OpenFoam, WrongFilesGetASentence) {
    write("a.foam", "");
    EXPECT_THAT(error(), HasSubstr("a.foam: there is no mesh of OpenFOAM (constant/polyMesh/faces is needed"));
    const Polyhedra mesh = box(1);
    const auto good = [&] { put_mesh("constant/polyMesh", mesh, {}); };
    const auto with = [&](const std::string& name, const std::string& text) {
        good();
        put("constant/polyMesh/" + name, text, {});
        return error();
    };
    EXPECT_THAT(with("points", ""), HasSubstr("points, line 1: the file is empty"));
    EXPECT_THAT(with("points", "solid"), HasSubstr("it does not begin with FoamFile"));
    EXPECT_THAT(with("points", "FoamFile {"), HasSubstr("the header does not end"));
    EXPECT_THAT(with("points", header("vectorField", {}) + "99999999(("), HasSubstr("count out of range: 99999999"));
    EXPECT_THAT(with("points", header("vectorField", {}) + "1\n((0 0 a))"), HasSubstr("a number is expected, not \"a\""));
    EXPECT_THAT(with("points", header("vectorField", {}) + "1\n((0 0 1))"), HasSubstr("faces: face 0: there is no point"));
    EXPECT_THAT(with("owner", header("labelList", {}) + labels({0, 0}, {})), HasSubstr("there are 2 owners for 11 faces"));
    EXPECT_THAT(with("owner", header("labelList", {}) + labels(std::vector<int>(11, 1000), {})),
                HasSubstr("face 0 belongs to cell 1000"));
    EXPECT_THAT(with("faces", header("faceList", {}) + "1\n(2(0 1))"), HasSubstr("owners for 1 face"));
    EXPECT_THAT(with("faces", header("faceCompactList", {}) + "2(0 9) 3(0 1 2)"), HasSubstr("the start of face 1 is 9"));
    std::vector<Vec3> points = mesh.points;
    points[2].y = std::numeric_limits<double>::quiet_NaN();
    good();
    put_points("constant/polyMesh", points, {});
    EXPECT_THAT(error(), HasSubstr("points: non-finite coordinate at point 2"));
    good();
    put("1/p", header("volScalarField", {}) + "internalField nonuniform List<scalar> 3(1 2 3);", {});
    const auto why = [&] {
        const ReadResult result = read_mesh(path("a.foam"));
        return result.unread.empty() ? std::string("all fields are read") : result.unread[0].why;
    };
    EXPECT_THAT(why(), HasSubstr("p, line 12: the internalField has 3 values (the mesh has 2 cells)"));
    put("1/p", header("volScalarField", {}) + "dimensions [];", {});
    EXPECT_THAT(why(), HasSubstr("there is no internalField"));
    put("1/p", "notes", {});
    EXPECT_EQ(why(), "all fields are read");
    write("1/q.gz", "no gzip");
    EXPECT_THAT(why(), HasSubstr("q.gz: not a whole gzip file"));
}

// Seventy kilobytes that are seventy megabytes of blanks after a list of two points.
TEST_F(OpenFoam, ALittleFileDoesNotBecomeALargeText) {
    const Form form{.gzipped = true};
    write("a.foam", "");
    put_mesh("constant/polyMesh", box(1), {});
    std::filesystem::remove(path("constant/polyMesh/points"));
    put("constant/polyMesh/points",
        header("vectorField", form) + "2\n((0 0 0)" + std::string(std::size_t{70} << 20, ' ') + "(1 1 1))", form);
    const auto refused = AllOf(HasSubstr("points.gz"), HasSubstr("decompress to more than what it says is in it needs"));
    EXPECT_THAT(error(), refused);
    // As many points as it says, of which the faces name twelve.
    std::string many;
    for (int i = 0; i < 9'000'000; ++i) many += "(0 0 0)\n";
    put("constant/polyMesh/points", header("vectorField", form) + "9000000\n(" + many + ")", form);
    EXPECT_THAT(error(), refused);
}

}  // namespace openfoam_test

}  // namespace subvol::test
