// SPDX-License-Identifier: Apache-2.0
// EnSight cases of Gold and of version 6, as text and in C's binary files of both byte orders.

#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <random>
#include <span>

#include "io/mesh_io/mesh_damage.h"
#include "io/mesh_io/mesh_texts.h"
#include "lib/test_meshes.h"
#include "subvol/mesh_report.h"
#include "subvol/mesh_series.h"

namespace subvol::test {

namespace ensight_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

enum class Form { Text, Little, Big, Fortran };

// Writes lines and numbers in one of the forms.
class GoldText {
public:
    explicit GoldText(Form form, bool geometry = true) : form_(form) {
        if (form != Form::Text && geometry) line(form == Form::Fortran ? "Fortran Binary" : "c binary");
    }
    GoldText& line(std::string text) {
        if (form_ == Form::Text) {
            text_ += text + "\n";
        } else {
            text.resize(80, ' ');
            mark(text.size());
            text_ += text;
            mark(text.size());
        }
        return *this;
    }
    template <class Values>
    GoldText& integers(const Values& values) {
        mark(4 * values.size());
        for (const auto value : values) put(static_cast<std::int32_t>(value), "%10d\n");
        mark(4 * values.size());
        return *this;
    }
    template <class Values>
    GoldText& reals(const Values& values) {
        mark(4 * values.size());
        for (const auto value : values) put(static_cast<float>(value), "%12.5e\n");
        mark(4 * values.size());
        return *this;
    }
    GoldText& add(const std::string& text) {
        text_ += text;
        return *this;
    }
    [[nodiscard]] const std::string& text() const { return text_; }

private:
    // The length of a record.
    void mark(std::size_t bytes) {
        if (form_ == Form::Fortran) put(static_cast<std::int32_t>(bytes), "");
    }
    template <class Number>
    void put(Number value, const char* format) {
        if (form_ == Form::Text) {
            std::array<char, 40> word{};
            std::snprintf(word.data(), word.size(), format, value);
            text_ += word.data();
            return;
        }
        std::array<char, 4> bytes{};
        std::memcpy(bytes.data(), &value, 4);
        if (form_ == Form::Big) std::ranges::reverse(bytes);
        text_.append(bytes.data(), 4);
    }
    Form form_;
    std::string text_;
};

void put_points(GoldText& out, const std::vector<Vec3>& points, double scale = 1) {
    for (int a = 0; a < 3; ++a) {
        std::vector<double> axis;
        for (const Vec3& x : points) axis.push_back(scale * x[a]);
        out.reals(axis);
    }
}

// Two rows of cubes that meet, as two parts, and a part of surfaces.
std::string geometry(Form form, double scale = 1) {
    GoldText out(form);
    out.line("made by a test").line("two parts").line("node id given").line("element id assign");
    int number = 0;
    for (const auto& [name, first] : std::vector<std::pair<std::string, double>>{{"left", 0}, {"right", 2}}) {
        HexMesh mesh = make_box(2, 1, 1);
        for (Vec3& x : mesh.points) x.x += first;
        out.line("part").integers(std::vector{++number}).line(name).line("coordinates").integers(std::vector{12});
        out.integers(std::vector<int>(12, 7));
        put_points(out, mesh.points, scale);
        out.line("hexa8").integers(std::vector{2});
        for (const auto& cell : mesh.cells) {
            std::vector<Index> corners(cell.begin(), cell.end());
            for (Index& p : corners) ++p;
            out.integers(corners);
        }
        out.line("quad4").integers(std::vector{1}).integers(std::vector{1, 2, 5, 4});
    }
    return out.text();
}

std::string at_nodes(Form form, int components, double value) {
    GoldText out(form, false);
    out.line("values");
    for (const int part : {1, 2}) {
        out.line("part").integers(std::vector{part}).line("coordinates");
        for (int c = 0; c < components; ++c) out.reals(std::vector<double>(12, value + c));
    }
    return out.text();
}

std::string at_elements(Form form) {
    GoldText out(form, false);
    out.line("values");
    for (const int part : {1, 2}) {
        out.line("part").integers(std::vector{part}).line("hexa8").reals(std::vector<double>{10. * part, 10. * part});
        out.line("quad4").reals(std::vector<double>{-1});
    }
    return out.text();
}

const std::string kCase =
    "FORMAT\ntype: ensight gold\n\nGEOMETRY\nmodel: 1 a.geo**\n\nVARIABLE\nscalar per node: 1 T a.T**\n"
    "vector per node: 1 \"U\" a.U**\nscalar per element: c a.c\n\nTIME\ntime set: 1\nnumber of steps: 3\n"
    "filename start number: 0\nfilename increment: 5\ntime values: 0.0 0.5\n1.5\n";

class Ensight : public TempFolder {
protected:
    void put(Form form) const {
        write("a.case", kCase);
        int step = 0;
        for (const std::string number : {"00", "05", "10"}) {
            ++step;
            write("a.geo" + number, geometry(form, step));
            write("a.T" + number, at_nodes(form, 1, step));
            write("a.U" + number, at_nodes(form, 3, step));
        }
        write("a.c", at_elements(form));
    }
    [[nodiscard]] std::string error() const {
        return error_of([&] { static_cast<void>(read_mesh(path("a.case"))); });
    }
};

TEST_F(Ensight, PartsAndVariablesOfEachStepInEveryForm) {
    for (const Form form : {Form::Text, Form::Little, Form::Big, Form::Fortran}) {
        put(form);
        EXPECT_THAT(open_series(path("a.case")).times, ElementsAre(0, .5, 1.5));
        for (std::size_t k = 0; k < 3; ++k) {
            const ReadResult result = read_mesh(path("a.case"), {.step = k});
            const double scale = static_cast<double>(k + 1);
            EXPECT_EQ(inspect(result.mesh).points_used, 20u);
            EXPECT_NEAR(inspect(result.mesh).volume, 4 * scale * scale * scale, 1e-5);
            EXPECT_EQ(result.mesh.find_attribute("T")->values[5], scale);
            EXPECT_EQ(result.mesh.find_attribute("U")->values[5], scale + 2);
            EXPECT_EQ(result.mesh.find_attribute("c")->values[0], 10);
            EXPECT_THAT(result.warnings, Contains("2 elements of type quad4 ignored"));
        }
        const ReadResult right = read_mesh(path("a.case"), {.blocks = {"right"}});
        EXPECT_EQ(right.mesh.cells.size(), 2u);
        EXPECT_EQ(right.mesh.find_attribute("c")->values[0], 20);
        ASSERT_EQ(right.blocks.size(), 1u);
        EXPECT_EQ(right.blocks[0].name, "right");
    }
}

TEST_F(Ensight, BlocksOfGrids) {
    write("a.case", "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: a.geo\nVARIABLE\nscalar per node: T a.T\n");
    for (const std::string kind : {"block", "block rectilinear", "block uniform", "block iblanked"}) {
        GoldText out(Form::Text);
        out.line("a").line("b").line("node id off").line("element id off").line("extents").reals(std::vector<double>(6, 0));
        out.line("part").integers(std::vector{1}).line("grid").line(kind).integers(std::vector{3, 2, 2});
        if (kind == "block rectilinear") {
            out.reals(std::vector{0, 1, 2, 0, 1, 0, 1});
        } else if (kind == "block uniform") {
            out.reals(std::vector{0, 0, 0, 1, 1, 1});
        } else {
            put_points(out, make_box(2, 1, 1).points);
        }
        if (kind == "block iblanked") out.integers(std::vector{1, 1, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1});
        write("a.geo", out.text());
        write("a.T", GoldText(Form::Text)
                         .line("T")
                         .line("part")
                         .integers(std::vector{1})
                         .line("block")
                         .reals(std::vector<int>(12, 4))
                         .text());
        const ReadResult result = read_mesh(path("a.case"));
        EXPECT_NEAR(inspect(result.mesh).volume, kind == "block iblanked" ? 1 : 2, 1e-6) << kind;
        EXPECT_EQ(result.mesh.find_attribute("T")->values[0], 4);
    }
}

TEST_F(Ensight, WrongFilesGetASentenceWithTheLine) {
    put(Form::Text);
    std::filesystem::remove(path("a.T10"));
    EXPECT_THAT(read_mesh(path("a.case")).warnings, Contains(HasSubstr("field \"T\" left out: ")));
    EXPECT_EQ(read_mesh(path("a.case")).unread[0].name, "T");
    put(Form::Text);
    std::string bad = geometry(Form::Text);
    write("a.geo10", bad.replace(bad.find("hexa8\n"), 6, "hexa9\n"));
    EXPECT_THAT(error(), HasSubstr("elements of type \"hexa9\" are not known"));
    bad = geometry(Form::Text);
    const std::size_t at = bad.find("hexa8\n") + 6 + 11;
    write("a.geo10", bad.replace(at, 10, "        13"));
    EXPECT_THAT(error(), HasSubstr("hexa8 1 of part \"left\": there is no node 13 (nodes are 1 to 12)"));
    write("a.geo10", geometry(Form::Little).substr(0, 900));
    EXPECT_THAT(error(), HasSubstr("a.geo10, byte "));
    std::string records = geometry(Form::Fortran);
    write("a.geo10", records.replace(84, 1, "?"));
    EXPECT_THAT(error(), HasSubstr("a.geo10, byte 0: a record of Fortran's binary files is expected"));
    write("a.case", "FORMAT\ntype: ensight 5\n");
    EXPECT_THAT(error(), HasSubstr("a.case, line 2: the format is \"ensight 5\""));
    write("a.case", "GEOMETRY\nmodel: a.geo\nTIME\ntime set: 1\nnumber of steps: 1000000000\n");
    EXPECT_THAT(error(), HasSubstr("line 5: there cannot be 1000000000 steps"));
    write("a.case", "GEOMETRY\nmodel: a.geo*\n");
    EXPECT_THAT(error(), HasSubstr("line 2: there is no time set 0"));
    write("a.case", "");
    EXPECT_THAT(error(), HasSubstr("not an EnSight case"));
}

TEST_F(Ensight, PlacesWithoutValuesHaveNone) {
    for (const Form form : {Form::Text, Form::Little, Form::Fortran}) {
        put(form);
        // The first part has 12 nodes, of which one has the mark; the second one names those that have values.
        std::vector<double> values(12, 3);
        values[4] = -999;
        const auto variable = [&](const std::string& of_first) {
            GoldText out(form, false);
            out.line("T").line("part").integers(std::vector{1}).line("Coordinates " + of_first);
            if (of_first == "UNDEF") out.reals(std::vector<double>{-999});
            out.reals(values).line("part").integers(std::vector{2}).line("coordinates partial");
            out.integers(std::vector{2}).integers(std::vector{12, 1}).reals(std::vector<double>{7, 8});
            return out.text();
        };
        write("a.T10", variable("UNDEF"));
        const ReadResult all = read_mesh(path("a.case"));
        EXPECT_EQ(all.mesh.find_attribute("T"), nullptr);
        EXPECT_THAT(all.warnings, Contains(HasSubstr("field \"T\" has no value at ")));
        EXPECT_TRUE(std::isnan(all.incomplete.at(0).values[4]));
        EXPECT_EQ(all.incomplete.at(0).values[5], 3);
        EXPECT_NE(all.mesh.find_attribute("U"), nullptr);
        write("a.T10", variable(""));
        EXPECT_EQ(read_mesh(path("a.case"), {.blocks = {"left"}}).mesh.find_attribute("T")->values[4], -999);
        EXPECT_EQ(read_mesh(path("a.case"), {.blocks = {"right"}}).incomplete.at(0).name, "T");
    }
}

TEST_F(Ensight, StepsInOneFileAndInSeveral) {
    for (const Form form : {Form::Text, Form::Big, Form::Fortran}) {
        const auto step = [&](const std::string& text) {
            GoldText out(form, false);
            return out.line("BEGIN TIME STEP").add(text).line("END TIME STEP").text();
        };
        put(form);
        // What says how numbers are written comes once, before the first step.
        const std::string start = GoldText(form).text();
        const auto moving = [&](double scale) { return step(geometry(form, scale).substr(start.size())); };
        write("a.geo", start + moving(1) + moving(2) + moving(3));
        write("a.T001", step(at_nodes(form, 1, 1)) + step(at_nodes(form, 1, 2)));
        write("a.T002", step(at_nodes(form, 1, 3)));
        const std::string files =
            "FILE\nfile set: 1\nnumber of steps: 3\nfile set: 2\nfilename index: 1\nnumber of steps: 2\n"
            "filename index: 2\nnumber of steps: 1\n";
        write("a.case",
              "format\nTYPE: EnSight Gold\ngeometry\nMODEL: 1 1 a.geo\nVariable\nScalar per Node: 1 2 T a.T***\n"
              "time\nTIME SET: 1\nNumber of Steps: 3\ntime values: 0 1 2\n" +
                  files);
        for (std::size_t k = 0; k < 3; ++k) {
            const ReadResult result = read_mesh(path("a.case"), {.step = k});
            const double scale = static_cast<double>(k + 1);
            EXPECT_NEAR(inspect(result.mesh).volume, 4 * scale * scale * scale, 1e-4);
            EXPECT_EQ(result.mesh.find_attribute("T")->values[5], scale);
        }
        write("a.T002", "");
        EXPECT_THAT(read_mesh(path("a.case")).warnings, Contains(HasSubstr("field \"T\" left out")));
        write("a.geo", start + moving(1));
        EXPECT_THAT(error(), HasSubstr("there is no step 2 in the file (it has 1)"));
    }
}

// A cube one of whose faces is two triangles.
TEST_F(Ensight, PolyhedraAreSplit) {
    write("a.case", "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: a.geo\nVARIABLE\nscalar per node: T a.T\n");
    for (const Form form : {Form::Text, Form::Little, Form::Fortran}) {
        const HexMesh mesh = make_box(1, 1, 1);
        const auto geometry_with = [&](int last) {
            GoldText out(form);
            out.line("a").line("b").line("node id off").line("element id off").line("part").integers(std::vector{1}).line("p");
            out.line("coordinates").integers(std::vector{8});
            put_points(out, mesh.points);
            out.line("nfaced").integers(std::vector{1}).integers(std::vector{7}).integers(std::vector{4, 4, 4, 4, 4, 3, 3});
            out.integers(std::vector{1, 3, 4, 2, 5, 6, 8, 7, 1, 2, 6, 5, 3, 7, 8, 4, 1, 5, 7, 3, 2, 4, 8, 2, 8, last});
            return out.text();
        };
        write("a.geo", geometry_with(6));
        std::vector<double> x;
        for (const Vec3& point : mesh.points) x.push_back(point.x);
        write("a.T", GoldText(form, false).line("T").line("part").integers(std::vector{1}).line("coordinates").reals(x).text());
        const ReadResult result = read_mesh(path("a.case"));
        EXPECT_NEAR(inspect(result.mesh).volume, 1, 1e-6);
        const Attribute& t = *result.mesh.find_attribute("T");
        for (std::size_t p = 0; p < t.values.size(); ++p) EXPECT_NEAR(t.values[p], result.mesh.points[p].x, 1e-6);
        write("a.geo", geometry_with(9));
        EXPECT_THAT(error(), HasSubstr("nfaced 1 of part \"p\": there is no node 9"));
    }
}

TEST_F(Ensight, CoordinatesMayChangeAlone) {
    put(Form::Text);
    std::string changing = kCase;
    changing.replace(changing.find("a.geo**"), 7, "a.geo** change_coords_only 0");
    write("a.case", changing);
    GoldText out(Form::Text);
    out.line("later").line("").line("node id off").line("element id off");
    for (const int part : {1, 2}) {
        HexMesh mesh = make_box(2, 1, 1);
        for (Vec3& x : mesh.points) x = 2. * (x + Vec3(part == 1 ? 0 : 2, 0, 0));
        out.line("part").integers(std::vector{part}).line("p").line("coordinates").integers(std::vector{12});
        put_points(out, mesh.points);
    }
    write("a.geo10", out.text());
    EXPECT_NEAR(inspect(read_mesh(path("a.case")).mesh).volume, 4 * 8, 1e-4);
    EXPECT_NEAR(inspect(read_mesh(path("a.case"), {.step = 0}).mesh).volume, 4, 1e-4);
}

// Version 6: two cubes that share a face as two parts of one list of nodes, with numbers from 100 on, and a block beside them.
std::string geometry_six(Form form) {
    GoldText out(form);
    out.line("made by a test").line("version 6").line("node id given").line("element id given");
    const HexMesh mesh = make_box(2, 1, 1);
    out.line("coordinates").integers(std::vector{12});
    std::vector<int> numbers;
    for (int p = 0; p < 12; ++p) numbers.push_back(100 + 2 * p);
    std::vector<double> all;
    for (const Vec3& x : mesh.points) all.insert(all.end(), {x.x, x.y, x.z});
    if (form == Form::Text) {
        for (std::size_t p = 0; p < 12; ++p) {
            out.integers(std::vector{numbers[p]}).reals(std::span(all).subspan(3 * p, 3));
        }
    } else {
        out.integers(numbers).reals(all);
    }
    for (std::size_t c = 0; c < 2; ++c) {
        out.line("part " + std::to_string(c + 1)).line(c == 0 ? "left" : "right");
        out.line("hexa8").integers(std::vector{1}).integers(std::vector{7});
        std::vector<int> corners;
        for (const Index p : mesh.cells[c]) corners.push_back(numbers[p]);
        out.integers(corners);
    }
    out.line("part 3").line("beside").line("block").integers(std::vector{2, 2, 2});
    out.reals(std::vector<double>{2, 3, 2, 3, 2, 3, 2, 3, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 1, 1});
    return out.text();
}

TEST_F(Ensight, Version6HasOneListOfNodes) {
    std::string text_case = kCase.substr(0, kCase.find("TIME"));
    for (const auto& [from, to] : {std::array{"ensight gold", "ensight"}, std::array{"1 a.geo**", "a.geo"},
                                   std::array{"1 T a.T**", "T a.T"}, std::array{"1 \"U\" a.U**", "U a.U"}}) {
        text_case.replace(text_case.find(from), std::strlen(from), to);
    }
    const HexMesh mesh = make_box(2, 1, 1);
    for (const Form form : {Form::Text, Form::Little, Form::Big, Form::Fortran}) {
        GoldText t(form, false), u(form, false), c(form, false);
        std::vector<double> at_nodes, vectors;
        for (const Vec3& x : mesh.points) {
            at_nodes.push_back(x.x);
            vectors.insert(vectors.end(), {x.x, 10 * x.y, 100 * x.z});
        }
        t.line("T").reals(at_nodes).line("part 3").line("block").reals(std::vector<double>{2, 3, 2, 3, 2, 3, 2, 3});
        u.line("U").reals(vectors).line("part 3").line("block");
        if (form == Form::Text) {
            u.reals(std::vector<double>{2, 3, 2, 3, 2, 3, 2, 3, 0, 0, 10, 10, 0, 0, 10, 10, 0, 0, 0, 0, 100, 100, 100, 100});
        } else {
            u.reals(std::vector<double>{2, 0, 0, 3, 0, 0, 2, 10, 0, 3, 10, 0, 2, 0, 100, 3, 0, 100, 2, 10, 100, 3, 10, 100});
        }
        c.line("c");
        for (const int part : {1, 2})
            c.line("part " + std::to_string(part)).line("hexa8").reals(std::vector<double>{1. * part});
        c.line("part 3").line("block").reals(std::vector<double>{3});
        write("a.case", text_case);
        write("a.geo", geometry_six(form));
        write("a.T", t.text());
        write("a.U", u.text());
        write("a.c", c.text());
        const ReadResult result = read_mesh(path("a.case"));
        EXPECT_EQ(result.mesh.cells.size(), 3u);
        EXPECT_NEAR(inspect(result.mesh).volume, 3, 1e-6);
        EXPECT_EQ(inspect(result.mesh).points_used, 16u);  // the parts are joined
        ASSERT_EQ(result.blocks.size(), 3u);
        EXPECT_EQ(result.blocks[1].name, "right");
        for (std::size_t p = 0; p < result.mesh.points.size(); ++p) {
            const Vec3& x = result.mesh.points[p];
            EXPECT_NEAR(result.mesh.find_attribute("T")->values[p], x.x, 1e-6);
            EXPECT_NEAR(result.mesh.find_attribute("U")->values[3 * p + 2], 100 * x.z, 1e-6);
        }
        EXPECT_EQ(read_mesh(path("a.case"), {.blocks = {"right"}}).mesh.find_attribute("c")->values[0], 2);
    }
}

// A file of blocks alone has no nodes, and a 0 shows no order of bytes.
TEST_F(Ensight, BlocksOfVersion6) {
    write("a.case", "FORMAT\ntype: ensight\nGEOMETRY\nmodel: a.geo\n");
    for (const Form form : {Form::Text, Form::Little, Form::Big, Form::Fortran}) {
        GoldText out(form);
        out.line("a").line("b").line("node id off").line("element id off").line("coordinates").integers(std::vector{0});
        out.line("part 1").line("p").line("block").integers(std::vector{2, 2, 2});
        out.reals(std::vector<double>{0, 3, 0, 3, 0, 3, 0, 3, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 1, 1});
        write("a.geo", out.text());
        EXPECT_NEAR(inspect(read_mesh(path("a.case")).mesh).volume, 3, 1e-6);
    }
}

// Numbers fill their columns of 12 and 8, and Fortran leaves out the letter of long exponents.
TEST_F(Ensight, NumbersOfVersion6MayTouch) {
    const std::string begin = "a\nb\nnode id assign\nelement id off\ncoordinates\n       8\n",
                      end = "part 1\np\nhexa8\n       1\n       1       2       3       4       5       6       7       8\n";
    std::string points;
    for (const Vec3& x : make_box(1, 1, 1).points) {
        for (int k = 0; k < 3; ++k) points += x[k] == 0 ? "-1.00000e+00" : "1.0000000+00";
        points += "\n";
    }
    write("a.case", "FORMAT\ntype: ensight\nGEOMETRY\nmodel: a.geo\n");
    std::string hex = end;
    const auto corners = make_box(1, 1, 1).cells[0];
    hex.erase(hex.find("       1       2"));
    for (const Index p : corners) hex += "       " + std::to_string(p + 1);
    write("a.geo", begin + points + hex + "\n");
    EXPECT_NEAR(inspect(read_mesh(path("a.case")).mesh).volume, 8, 1e-6);
    write("a.geo", begin + points + end.substr(0, end.size() - 2) + "9\n");
    const auto read = [&] { static_cast<void>(read_mesh(path("a.case"))); };
    EXPECT_THAT(error_of(read), HasSubstr("a.geo, line 19: hexa8 1: there is no node 9"));
    // With a blank in front of numbers that are not negative, a column begins with it; and in none the numbers are as wide.
    for (const auto& [zero, one, between] :
         {std::array<std::string, 3>{"-1.00000e+00", " 1.00000e+00", ""}, std::array<std::string, 3>{"-1", "1", " "},
          std::array<std::string, 3>{"-1.00000000000000e+00", "1.0000000000000000", "  "}}) {
        points.clear();
        for (const Vec3& x : make_box(1, 1, 1).points) {
            for (int k = 0; k < 3; ++k) points += (k > 0 ? between : "") + (x[k] == 0 ? zero : one);
            points += "\n";
        }
        write("a.geo", begin + points + hex + "\n");
        EXPECT_NEAR(inspect(read_mesh(path("a.case")).mesh).volume, 8, 1e-6) << one;
    }
}

// 8 digits of a node touch the 7 of the one before.
TEST_F(Ensight, LongNumbersOfNodesTouch) {
    std::string text = "a\nb\nnode id given\nelement id off\ncoordinates\n       8\n", nodes;
    const HexMesh box = make_box(1, 1, 1);
    const auto number_of = [](std::size_t p) { return std::to_string(p % 2 == 0 ? 1234560 + p : 12345670 + p); };
    const auto in_column = [](const std::string& number) { return std::string(8 - number.size(), ' ') + number; };
    for (std::size_t p = 0; p < 8; ++p) {
        text += in_column(number_of(p));
        for (int k = 0; k < 3; ++k) text += box.points[p][k] == 0 ? " 0.00000e+00" : " 2.00000e+00";
        text += "\n";
    }
    for (const Index p : box.cells[0]) nodes += in_column(number_of(p));
    write("a.case", "FORMAT\ntype: ensight\nGEOMETRY\nmodel: a.geo\n");
    write("a.geo", text + "part 1\np\nhexa8\n       1\n" + nodes + "\n");
    EXPECT_NEAR(inspect(read_mesh(path("a.case")).mesh).volume, 8, 1e-6);
}

class EnsightFuzz : public MeshFuzz {};

// The case is as it should be, its files are damaged.
TEST_F(EnsightFuzz, Version6) {
    write("a.case", "FORMAT\ntype: ensight\nGEOMETRY\nmodel: a.geo\nVARIABLE\nscalar per node: T a.T\n");
    std::mt19937 random(42);
    int refused = 0;
    for (int run = 0; run < run_count(); ++run) {
        const Form form = run % 2 == 0 ? Form::Text : Form::Little;
        GoldText t(form, false);
        t.line("T").reals(std::vector<double>(12, 1)).line("part 3").line("block").reals(std::vector<double>(8, 2));
        write("a.geo", run % 3 == 0 ? geometry_six(form) : damaged(geometry_six(form), random));
        write("a.T", damaged(t.text(), random));
        try {
            validate(read_mesh(path("a.case")).mesh);
        } catch (const Error& error) {
            expect_printable(error.what());
            ++refused;
        }
    }
    EXPECT_GT(refused, run_count() / 10);
}

TEST_F(EnsightFuzz, Cases) {
    write("a.geo00", geometry(Form::Text));
    write("a.T00", at_nodes(Form::Text, 1, 2));
    write("a.U00", at_nodes(Form::Text, 3, 2));
    write("a.c", at_elements(Form::Text));
    std::string one = kCase;
    one.replace(one.find("0.0 0.5\n1.5"), 11, "0.0").replace(one.find("steps: 3"), 8, "steps: 1");
    expect_sound_or_refused(".case", one, 41);
}

}  // namespace ensight_test

}  // namespace subvol::test
