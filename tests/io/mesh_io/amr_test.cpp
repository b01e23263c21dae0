// SPDX-License-Identifier: Apache-2.0
// Adaptive mesh refinement in blocks, of VTK XML. Volumes, integrals of linear fields and numbers of points have closed forms.

#include <gmock/gmock.h>

#include <cmath>
#include <set>

#include "mesh_files.h"
#include "mesh_texts.h"
#include "subvol/cell.h"
#include "subvol/mesh_report.h"

namespace subvol::test {

namespace amr_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using Box = std::array<int, 6>;  // the first and the last cell along each axis

double linear(const Vec3& x) {
    return 2 * x.x - x.y + 3 * x.z + 1;
}

std::string array_text(const std::string& name, const std::string& numbers, const std::string& type = "Float64") {
    return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" format=\"ascii\">" + numbers + "</DataArray>";
}

struct Level {
    double spacing = 1;
    std::vector<Box> boxes;
    double added = 0;  // to the values at its points
};

class Amr : public MeshFiles {
protected:
    Vec3 origin_{0, 0, 0};
    std::string ghosts_;          // an array of ghosts of the first block
    std::vector<Box> low_sides_;  // the box whose points on its low side along x are a set of nodes

    // The image of a box, as VTK writes it: from its own origin. The field is at points and, at the centres, at cells.
    [[nodiscard]] std::string image(const Level& level, const Box& box, const std::string& more = "") const {
        std::string text = "<VTKFile type=\"ImageData\" version=\"0.1\"><ImageData WholeExtent=\"E\" Origin=\"", extent;
        for (std::size_t a = 0; a < 3; ++a) {
            text += number(origin_[static_cast<int>(a)] + level.spacing * box[2 * a]) + " ";
            extent += "0 " + std::to_string(box[2 * a + 1] - box[2 * a] + 1) + " ";
        }
        const std::string h = number(level.spacing) + " ";
        text += "\" Spacing=\"" + h + h + h + "\"><Piece Extent=\"" + extent + "\">";
        const auto values = [&](double shift, int end) {
            std::string numbers;
            for (int k = box[4]; k <= box[5] + end; ++k) {
                for (int j = box[2]; j <= box[3] + end; ++j) {
                    for (int i = box[0]; i <= box[1] + end; ++i) {
                        const Vec3 x = origin_ + level.spacing * Vec3(i + shift, j + shift, k + shift);
                        numbers += number(linear(x) + (end == 1 ? level.added : 0)) + " ";
                    }
                }
            }
            return numbers;
        };
        std::string low_side;
        for (int k = 0; k < (box[3] - box[2] + 2) * (box[5] - box[4] + 2); ++k) {
            for (int i = box[0]; i <= box[1] + 1; ++i) low_side += i == box[0] ? "1 " : "0 ";
        }
        const bool marked = !low_sides_.empty() && box == low_sides_[0];
        return text + "<PointData>" + array_text("p", values(0, 1)) + (marked ? array_text("nodes:low", low_side) : "") +
               "</PointData><CellData>" + array_text("c", values(.5, 0)) + more + "</CellData></Piece></ImageData></VTKFile>";
    }

    [[nodiscard]] static std::string box_text(const Box& box) {
        std::string text;
        for (const int end : box) text += (text.empty() ? "" : " ") + std::to_string(end);
        return text;
    }

    // Writes the images, and returns the list of them.
    [[nodiscard]] std::string list(const std::vector<Level>& levels, const std::string& type = "vtkOverlappingAMR") const {
        std::string text = "<VTKFile type=\"" + type + "\" version=\"1.1\">\n<" + type + " origin=\"";
        text += number(origin_.x) + " " + number(origin_.y) + " " + number(origin_.z) + "\" grid_description=\"XYZ\">\n";
        for (std::size_t l = 0; l < levels.size(); ++l) {
            const std::string h = number(levels[l].spacing);
            text += "<Block level=\"" + std::to_string(l) + "\" spacing=\"" + h + " " + h + " " + h + "\">\n";
            for (std::size_t b = 0; b < levels[l].boxes.size(); ++b) {
                const std::string name = std::to_string(l) + "_" + std::to_string(b) + ".vti";
                write(name, image(levels[l], levels[l].boxes[b], l + b == 0 ? ghosts_ : ""));
                text += "<DataSet index=\"" + std::to_string(b) + "\" amr_box=\"" + box_text(levels[l].boxes[b]) +
                        "\" file=\"" + name + "\"/>\n";
            }
            text += "</Block>\n";
        }
        return text + "</" + type + "></VTKFile>";
    }
    [[nodiscard]] ReadResult amr(const std::vector<Level>& levels, const ReadOptions& options = {}) const {
        return read("a.vth", list(levels), options);
    }
    [[nodiscard]] std::string error(const std::vector<Level>& levels) const { return read_error("a.vth", list(levels)); }

    // The list of two levels, with a part of it replaced.
    [[nodiscard]] std::string error(const std::string& from, const std::string& to) const {
        std::string text = list(two_levels());
        EXPECT_NE(text.find(from), std::string::npos);
        text.replace(text.find(from), from.size(), to);
        return read_error("a.vth", text);
    }

    // Eight cells of 4 x 4 x 4 are divided: those between 1 and 3.
    static std::vector<Level> two_levels() {
        return {{1, {{0, 1, 0, 3, 0, 3}, {2, 3, 0, 3, 0, 3}}}, {.5, {{2, 5, 2, 5, 2, 5}}}};
    }

    // Values at points and cells are those of the linear field, and its integral is that over the box.
    static void expect_linear(const ReadResult& result, const Vec3& low, const Vec3& high) {
        const HexMesh& mesh = result.mesh;
        const Attribute *points = mesh.find_attribute("p"), *cells = mesh.find_attribute("c");
        ASSERT_TRUE(points && cells);
        constexpr double kRounding = 1e-12;
        double volume = 0, integral = 0;
        for (std::size_t p = 0; p < mesh.points.size(); ++p) EXPECT_NEAR(points->values[p], linear(mesh.points[p]), kRounding);
        for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
            const Vec3 middle = .5 * (mesh.points[mesh.cells[c][0]] + mesh.points[mesh.cells[c][6]]);
            EXPECT_NEAR(cells->cells[c], linear(middle), kRounding);
            std::array<Vec3, 8> corners;
            for (std::size_t k = 0; k < 8; ++k) corners[k] = mesh.points[mesh.cells[c][k]];
            volume += cell_volume(corners);
            integral += cell_volume(corners) * cells->cells[c];
        }
        const Vec3 size = high - low;
        EXPECT_NEAR(volume, size.x * size.y * size.z, 1e-12 * volume);
        EXPECT_NEAR(integral, volume * linear(.5 * (low + high)), 1e-10 * volume);  // of a linear field: that at the middle
    }
};

TEST_F(Amr, ASetOfNodesOfSomeBlocksIsOneOfTheMesh) {
    // Of the 5² points of the coarse side, the one in its middle is within the divided cells.
    const Box coarse{2, 3, 0, 3, 0, 3}, fine{2, 5, 2, 5, 2, 5};
    for (const Box& box : {coarse, fine}) {
        low_sides_ = {box};
        const ReadResult result = amr(two_levels());
        ASSERT_EQ(result.sets.nodes.size(), 1U);
        EXPECT_EQ(result.sets.nodes[0].name, "low");
        std::set<Index> points;
        for (const auto& [cell, corners] : result.sets.nodes[0].cells) {
            for (std::size_t k = 0; k < 8; ++k) {
                if ((corners >> k & 1) != 0) points.insert(result.mesh.cells[cell][k]);
            }
        }
        EXPECT_EQ(points.size(), box == coarse ? 25U - 1 : 25U);
        for (const Index p : points) EXPECT_EQ(result.mesh.points[p].x, box == coarse ? 2 : 1);
    }
}

TEST_F(Amr, SpacingsOfSixDigitsAreThoseOfTheImages) {
    origin_ = {1. / 3, 0, -1. / 7};
    const std::vector<Level> levels{{1. / 3, {{0, 3, 0, 3, 0, 3}, {4, 399, 0, 3, 0, 3}}}, {1. / 6, {{2, 5, 2, 5, 2, 5}}}};
    std::string text = list(levels);
    const auto shorten = [&](const std::string& from, const std::string& to) {
        for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from)) text.replace(at, from.size(), to);
    };
    shorten(number(1. / 3), "0.333333");
    shorten(number(1. / 6), "0.166667");
    shorten(number(-1. / 7), "-0.142857");
    const ReadResult result = read("a.vth", text, {.cell_values = CellValues::Constant});
    expect_linear(result, origin_, origin_ + 1. / 3 * Vec3(400, 4, 4));
}

TEST_F(Amr, TheFinestCellsAreTheMesh) {
    const ReadResult result = amr(two_levels(), {.cell_values = CellValues::Constant});
    EXPECT_EQ(result.mesh.cells.size(), 64u - 8 + 64);
    // 5³ points of each level, of which the 3³ around the divided cells are the same.
    EXPECT_EQ(result.mesh.points.size(), 125u + 125 - 27);
    EXPECT_EQ(inspect(result.mesh).points_used, result.mesh.points.size());
    expect_linear(result, {0, 0, 0}, {4, 4, 4});
    EXPECT_THAT(result.warnings, Contains("2 levels of refinement put together; 8 cells that finer ones cover left out"));
    // On the six faces of the divided cells: 5² points, without the 3² of the coarse cells and each edge once.
    EXPECT_THAT(result.warnings, Contains(HasSubstr("72 points hang in the middle of edges or faces of larger cells")));
    const ReadResult welded = amr(two_levels(), {.weld = 0});
    EXPECT_NEAR(inspect(welded.mesh).volume, 64, 1e-11);
    EXPECT_EQ(welded.mesh.find_attribute("p") != nullptr, true);
}

TEST_F(Amr, ThreeLevelsWithNegativeNumbersAndAnOriginMeetExactly) {
    origin_ = {.1, -7.3, 1e3};
    const double h = .3;  // neither it nor its halves are binary fractions
    const std::vector<Level> levels{{h, {{-3, -1, 0, 3, -5, 0}, {0, 2, 0, 3, -5, 0}}},
                                    {h / 2, {{-4, -1, 2, 5, -8, -3}, {0, 3, 2, 5, -8, -3}}},
                                    {h / 4, {{-4, 3, 6, 9, -14, -9}}}};
    const ReadResult result = amr(levels, {.cell_values = CellValues::Constant});
    const std::size_t coarse = 6 * 4 * 6, fine = 8 * 4 * 6, finest = 8 * 4 * 6;
    EXPECT_EQ(result.mesh.cells.size(), coarse - fine / 8 + fine - finest / 8 + finest);
    EXPECT_THAT(result.warnings, Contains("3 levels of refinement put together; 48 cells that finer ones cover left out"));
    expect_linear(result, origin_ + h * Vec3(-3, 0, -5), origin_ + h * Vec3(3, 4, 1));
    const MeshReport report = inspect(result.mesh);
    EXPECT_EQ(report.points_used, result.mesh.points.size());
    EXPECT_EQ(report.nonmanifold_faces, 0u);
    // Points at one place would be two points that are nearer than the finest cells.
    for (std::size_t p = 0; p < result.mesh.points.size(); ++p) {
        for (std::size_t q = 0; q < p; ++q) ASSERT_GT(glm::distance(result.mesh.points[p], result.mesh.points[q]), h / 8);
    }
}

TEST_F(Amr, OtherTypesAndEndings) {
    const ReadResult boxes = read("a.vthb", list(two_levels(), "vtkHierarchicalBoxDataSet"));
    EXPECT_EQ(boxes.mesh.cells.size(), 120u);
    EXPECT_EQ(read("a.vth.xml", list(two_levels())).mesh.cells.size(), 120u);
    // Blocks that do not overlap have no boxes: 2 x 4 x 4 cells beside 4 x 8 x 8 of half the size.
    const std::vector<Level> levels{{1, {{0, 1, 0, 3, 0, 3}}}, {.5, {{4, 7, 0, 7, 0, 7}}}};
    static_cast<void>(list(levels));  // the images
    const ReadResult beside = read("b.vth",
                                   "<VTKFile type=\"vtkNonOverlappingAMR\" version=\"1.1\"><vtkNonOverlappingAMR>"
                                   "<Block level=\"0\"><DataSet index=\"0\" file=\"0_0.vti\"/></Block>"
                                   "<Block level=\"1\"><DataSet index=\"0\" file=\"1_0.vti\"/></Block>"
                                   "</vtkNonOverlappingAMR></VTKFile>",
                                   {.cell_values = CellValues::Constant});
    EXPECT_EQ(beside.mesh.cells.size(), 32u + 256);
    expect_linear(beside, {0, 0, 0}, {4, 4, 4});
}

TEST_F(Amr, APointKeepsTheValueOfTheFinestLevel) {
    std::vector<Level> levels = two_levels();
    levels[1].added = 100;
    const ReadResult result = amr(levels);
    const Attribute& p = *result.mesh.find_attribute("p");
    for (std::size_t i = 0; i < result.mesh.points.size(); ++i) {
        const Vec3 from_middle = glm::abs(result.mesh.points[i] - Vec3(2, 2, 2));
        const bool of_fine = std::max({from_middle.x, from_middle.y, from_middle.z}) <= 1;
        EXPECT_EQ(p.values[i], linear(result.mesh.points[i]) + (of_fine ? 100 : 0));
    }
}

// The marks of VTK's own blanking say what the boxes say; where they differ, a warning counts.
TEST_F(Amr, MarksOfGhosts) {
    const auto marks = [](const std::vector<int>& refined, int bit) {
        std::string numbers;
        for (int c = 0; c < 32; ++c)
            numbers += std::ranges::find(refined, c) != refined.end() ? std::to_string(bit) + " " : "0 ";
        return array_text("vtkGhostType", numbers, "UInt8");
    };
    ghosts_ = marks({11, 13, 19, 21}, 8);  // cells at x = 1, y and z = 1 and 2, of 2 x 4 x 4
    ReadResult result = amr(two_levels());
    EXPECT_EQ(result.mesh.cells.size(), 120u);
    EXPECT_THAT(result.warnings, Not(Contains(HasSubstr("vtkGhostType"))));
    ghosts_ = marks({11, 13, 19, 0}, 8);
    result = amr(two_levels());
    EXPECT_EQ(result.mesh.cells.size(), 119u);
    EXPECT_THAT(result.warnings, Contains("1 cell left out, which vtkGhostType marks as refined where no finer block is"));
    EXPECT_THAT(result.warnings,
                Contains("1 cell left out, which finer blocks cover and vtkGhostType does not mark as refined"));
    ghosts_ = marks({0, 1}, 32);
    result = amr(two_levels());
    EXPECT_EQ(result.mesh.cells.size(), 118u);
    EXPECT_THAT(result.warnings, Contains("2 ghost cells (duplicate or hidden) left out"));
}

TEST_F(Amr, ArraysThatABlockOrALevelLacksAreLeftOut) {
    ghosts_ = array_text("mine", "1 2 3 4 5 6 7 8 1 2 3 4 5 6 7 8 1 2 3 4 5 6 7 8 1 2 3 4 5 6 7 8");
    const ReadResult result = amr(two_levels());
    EXPECT_EQ(result.mesh.find_attribute("mine"), nullptr);
    EXPECT_NE(result.mesh.find_attribute("p"), nullptr);
    EXPECT_THAT(result.warnings, Contains("array \"mine\" ignored: it is not in every block"));
    const ReadResult level = amr({{1, {{0, 1, 0, 3, 0, 3}}}, {.5, {{0, 1, 0, 1, 0, 1}}}});
    EXPECT_EQ(level.mesh.find_attribute("mine"), nullptr);
    EXPECT_THAT(level.warnings, Contains("array \"mine\" ignored: it is not in every level"));
    // A level that is covered has no say.
    EXPECT_NE(amr({{.5, {{0, 1, 0, 3, 0, 3}}}}).mesh.find_attribute("mine"), nullptr);
}

TEST_F(Amr, ABlockWithoutAFileHasToBeCovered) {
    std::string text = list({{1, {{0, 1, 0, 1, 0, 1}, {2, 3, 0, 1, 0, 1}}}, {.5, {{0, 3, 0, 3, 0, 3}}}});
    const std::string without =
        text.substr(0, text.find(" file=\"0_0.vti\"")) + text.substr(text.find(" file=\"0_0.vti\"") + 15);
    const ReadResult result = read("a.vth", without, {.cell_values = CellValues::Constant});
    EXPECT_EQ(result.mesh.cells.size(), 8u + 64);
    expect_linear(result, {0, 0, 0}, {4, 2, 2});
    text.erase(text.find(" file=\"0_1.vti\""), 15);
    EXPECT_THAT(read_error("a.vth", text),
                HasSubstr("line 5: block 1 of level 0 has no file, and finer blocks do not cover it"));
}

TEST_F(Amr, DivisionsInThreeAreSaid) {
    const ReadResult result =
        amr({{1, {{0, 3, 0, 3, 0, 3}}}, {1. / 3, {{3, 8, 3, 8, 3, 8}}}}, {.cell_values = CellValues::Constant});
    EXPECT_EQ(result.mesh.cells.size(), 64u - 8 + 216);
    EXPECT_EQ(result.mesh.points.size(), 125u + 343 - 27);
    expect_linear(result, {0, 0, 0}, {4, 4, 4});
    EXPECT_THAT(result.warnings,
                Contains("the cells of level 0 are not halved by level 1: where they meet, the mesh stays open, "
                         "also with --weld"));
}

TEST_F(Amr, BoxesThatDoNotFit) {
    const Box all{0, 3, 0, 3, 0, 3};
    EXPECT_THAT(error({{1, {all, {3, 4, 0, 3, 0, 3}}}}), HasSubstr("line 5: block 1 of level 0 overlaps block 0 of level 0"));
    EXPECT_THAT(error({{1, {all}}, {.5, {{6, 9, 2, 5, 2, 5}}}}),
                HasSubstr("line 7: block 0 of level 1 lies outside of the blocks of level 0"));
    EXPECT_THAT(error({{1, {all}}, {.5, {{3, 5, 2, 5, 2, 5}}}}),
                HasSubstr("block 0 of level 1: its box 3 5 2 5 2 5 divides cells of level 0 along x in part"));
    EXPECT_THAT(error({{1, {all}}, {.4, {{2, 5, 2, 5, 2, 5}}}}),
                HasSubstr("level 1: its spacing along x, 0.4, does not divide that of level 0, 1"));
    EXPECT_THAT(error({{1, {all}}, {2, {{0, 1, 0, 1, 0, 1}}}}), HasSubstr("level 1: its spacing along x, 2, does not divide"));
    EXPECT_THAT(error({{0, {all}}}), HasSubstr("level 0: its spacing along x is 0"));
    EXPECT_THAT(error({{1, {}}, {.5, {{0, 1, 0, 1, 0, 1}}}}),
                HasSubstr("block 0 of level 1 lies outside of the blocks of level 0"));
    EXPECT_THAT(error(std::vector<Level>{}), HasSubstr("there is no level of refinement"));
    EXPECT_THAT(error(std::vector<Level>{{1, {}}}), HasSubstr("no hexahedra in any of its blocks"));
}

TEST_F(Amr, ListsThatAreWrong) {
    EXPECT_THAT(error("0 1 0 3 0 3", "0 1 0 3 0"), HasSubstr("its amr_box is \"0 1 0 3 0\""));
    EXPECT_THAT(error("0 1 0 3 0 3", "0 1 0 3 0 -1"), HasSubstr("its box 0 1 0 3 0 -1 has no cells along z"));
    EXPECT_THAT(error("0 1 0 3 0 3", "0 99999999999 0 3 0 3"), HasSubstr("its box 0 99999999999 0 3 0 3 is out of range"));
    EXPECT_THAT(error("0 1 0 3 0 3", "0 1 0 2000000000 0 2000000000"), HasSubstr("the boxes have too many points"));
    EXPECT_THAT(error("0 1 0 3 0 3", "0 1 0 2000 0 2000"), HasSubstr("is not the image of its amr_box"));
    EXPECT_THAT(error("origin=\"0 0 0\"", "origin=\"0 0 1\""),
                HasSubstr("its corners are not where origin, spacing and box are"));
    EXPECT_THAT(error("0_0.vti", "none.vti"), HasSubstr("none.vti"));
    EXPECT_THAT(error("0_0.vti", "a.vth"), HasSubstr("cannot be read as a part of a mesh"));
    EXPECT_THAT(error("\"XYZ\"", "\"XY\""), HasSubstr("its grid_description is \"XY\", which has no volume"));
    EXPECT_THAT(error("level=\"1\"", "level=\"7\""), HasSubstr("its level is \"7\""));
    EXPECT_THAT(error("level=\"1\"", "level=\"1\" refinement_ratio=\"0\""), HasSubstr("its refinement_ratio is \"0\""));
    EXPECT_THAT(error("spacing=\"1 1 1\"", "spacing=\"1 1 nan\""), HasSubstr("level 0: its spacing along z is"));
    EXPECT_THAT(error("spacing=\"1 1 1\"", ""), HasSubstr("its spacing is \"\""));
    EXPECT_THAT(error("spacing=\"0.5 0.5 0.5\"", "spacing=\"1e-9 1e-9 1e-9\""), HasSubstr("does not divide that of level 0"));
    EXPECT_THAT(error("origin=\"0 0 0\"", ""), HasSubstr("it has no origin"));
    EXPECT_THAT(error("origin=\"0 0 0\"", "origin=\"0 inf 0\""), HasSubstr("the origin is not finite"));
}

}  // namespace amr_test

}  // namespace subvol::test
