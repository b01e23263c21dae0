// SPDX-License-Identifier: Apache-2.0
// Points that are welded, and cells that repeat points: as values, by brute force.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "made_files.h"

namespace subvol::detail {
namespace joined_points_test {

using test::add_cell;
using test::assembled;
using test::error_of;
using test::file_of;
using test::kMadeFile;
using test::kMadeNames;
using test::make_box;
using test::volume_of;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// A box whose cells share no points, with the first point repeated before all others, used by no cell.
MeshFile box_of_single_cells(Index n, double gap = 0) {
    const HexMesh box = make_box(n, n, n);
    MeshFile file;
    file.points = {box.points[0]};
    for (const auto& cell : box.cells) {
        std::array<Index, 8> corners;
        const Vec3 shift = gap * box.points[cell[0]];
        for (std::size_t k = 0; k < 8; ++k) {
            corners[k] = static_cast<Index>(file.points.size());
            file.points.push_back(box.points[cell[k]] + shift);
        }
        add_cell(file, file.hexes, corners);
    }
    return file;
}

TEST(WeldPoints, AllThatNamesAPointNamesTheFirstOne) {
    MeshFile file = box_of_single_cells(2);
    const auto last = static_cast<Index>(file.points.size() - 1);  // (2, 2, 2)
    file.points.insert(file.points.end(), {{2, 2, 2}, {9, 9, 9}, {9, 9, 9}});
    file.quads.corners = {{last, last + 1, last + 2, last + 3}};
    file.lines.corners = {{last + 3, last + 2}};
    file.sharp.faces = {{60, 59, 58, 57}};  // of the last cell
    file.sharp.edges = {{57, last}, {0, last + 1}};
    file.patches = {{.name = "p"}};
    file.patches[0].add(std::array<Index, 4>{57, 58, 59, 60});
    file.curved.add(0, CurvedOrder::Vtk, std::vector<Index>{9, 10, 11, 12});
    const MeshFile before = file;
    weld_points(file, 0, kMadeFile, kMadeNames);
    // By brute force: of the points that a cell uses, then of the others that a shell uses, the first at the same place.
    const auto first_of = [&](Index p) {
        for (Index q = 1; q <= last; ++q) {
            if (before.points[q] == before.points[p]) return q;
        }
        return p == last + 3 ? last + 2 : p;
    };
    const auto expect_first = [&](const auto& is, const auto& was) {
        for (std::size_t k = 0; k < is.size(); ++k) EXPECT_EQ(is[k], first_of(was[k])) << was[k];
    };
    for (std::size_t c = 0; c < 8; ++c) expect_first(file.hexes.corners[c], before.hexes.corners[c]);
    expect_first(file.quads.corners[0], before.quads.corners[0]);
    expect_first(file.lines.corners[0], before.lines.corners[0]);
    expect_first(file.sharp.faces[0], before.sharp.faces[0]);
    expect_first(file.sharp.edges[0], before.sharp.edges[0]);
    expect_first(file.patches[0].corners, before.patches[0].corners);
    expect_first(file.curved.nodes, before.curved.nodes);
    EXPECT_EQ(file.sharp.edges[1][0], 0U) << "no cell uses this point: it stays";
    EXPECT_EQ(file.points.size(), before.points.size());
    EXPECT_THAT(file.warnings,
                ElementsAre(HasSubstr(std::to_string(64 - 27 + 2) + " points welded to others at the same place")));
}

TEST(WeldPoints, CellsThatWouldCollapseAreRefused) {
    MeshFile file = file_of(make_box(1, 1, 1));
    for (Vec3& x : file.points) x.z *= 1e-3;
    const std::vector<std::int64_t> numbers{11, 12, 13, 14, 21, 22, 23, 24};
    const EntityNames names{"node", "element", 1, numbers};
    EXPECT_EQ(error_of([&] { weld_points(file, 1e-3, kMadeFile, names); }),
              "made.file: a cell has node 11 and node 21, which would be welded (a smaller tolerance, or no welding)");
    MeshFile thin = file_of(make_box(1, 1, 1));
    for (Vec3& x : thin.points) x.z *= 1e-3;
    weld_points(thin, 0.99e-3, kMadeFile, names);
    EXPECT_EQ(thin.hexes.corners, file_of(make_box(1, 1, 1)).hexes.corners);
}

TEST(WeldPoints, GroupsThatShareNoPointsAreReported) {
    MeshFile file = box_of_single_cells(2);
    say_points_of_their_own(file);
    EXPECT_THAT(file.warnings, ElementsAre(HasSubstr("8 groups of cells share no points, though 37 of 64 points")));
    for (MeshFile quiet : {box_of_single_cells(2, 0.1), file_of(make_box(2, 2, 2))}) {
        say_points_of_their_own(quiet);
        EXPECT_TRUE(quiet.warnings.empty());
    }
}

constexpr std::array<std::array<std::size_t, 2>, 12> kEdges{
    {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};

/// Whether edges of the cube between corners of a set, which is a bit for each corner, join all of them.
bool is_joined(unsigned set) {
    unsigned reached = set & (~set + 1);
    for (int round = 0; round < 8; ++round) {
        for (const auto& [a, b] : kEdges) {
            const unsigned both = 1U << a | 1U << b;
            if ((set & both) == both && (reached & both) != 0) reached |= both;
        }
    }
    return reached == set;
}

/// The volume between the faces of a hexahedron that are cut along the diagonal from their smallest point.
double volume_between(const std::vector<Vec3>& x, const std::array<Index, 8>& hex) {
    double volume = 0;
    for (const auto& side : kCellFaces) {
        std::array<Index, 4> face;
        for (std::size_t k = 0; k < 4; ++k) face[k] = hex[side[k]];
        std::rotate(face.begin(), std::ranges::min_element(face), face.end());
        volume += glm::dot(x[face[0]], glm::cross(x[face[1]], x[face[2]]) + glm::cross(x[face[2]], x[face[3]])) / 6;
    }
    return volume;
}

TEST(CollapsedShapes, RepeatAPointOnlyAlongEdges) {
    HexMesh bent = make_box(1, 1, 1);
    test::jitter(bent, 0.05, 9);  // no four points are in one plane
    int torn = 0;
    for (unsigned set = 1; set < 256; ++set) {
        MeshFile file = file_of(bent);
        auto& cell = file.hexes.corners[0];
        const auto hex = cell;
        const auto least = static_cast<std::size_t>(std::countr_zero(set));
        for (std::size_t k = 0; k < 8; ++k) cell[k] = (set >> k & 1) != 0 ? hex[least] : hex[k];
        const auto shape = cell;
        const auto take = [&] { return take_collapsed(file, OtherCells::Split, kMadeFile, kMadeNames); };
        if (!is_joined(set)) {
            ++torn;
            EXPECT_THAT(error_of([&] { static_cast<void>(take()); }),
                        HasSubstr("made.file: cell 0 has point " + std::to_string(hex[least]) + " twice"))
                << set;
            continue;
        }
        static_cast<void>(take());
        const std::size_t left =
            file.hexes.corners.size() + file.tets.corners.size() + file.prisms.corners.size() + file.pyramids.corners.size();
        EXPECT_EQ(file.hexes.corners.size(), std::popcount(set) == 1 ? 1U : 0U);
        EXPECT_EQ(left == 0, std::abs(volume_between(file.points, shape)) < 1e-14) << set;
        each_kind(file, [](const auto& kind) {
            for (auto corners : kind.corners) {
                std::ranges::sort(corners);
                EXPECT_EQ(std::ranges::adjacent_find(corners), corners.end()) << "all different";
            }
        });
    }
    EXPECT_GT(torn, 50);
}

// Every edge, every pair of opposite edges of a side and every side of a cube, each collapsed to one of its corners: prisms,
// pyramids and other shapes, whose faces are cut so that the volume between them is that of the mesh.
TEST(CollapsedShapes, HaveTheVolumeBetweenTheirFaces) {
    const HexMesh box = make_box(1, 1, 1);
    std::vector<std::array<Index, 8>> shapes;
    const auto& hex = box.cells[0];
    for (const auto& [a, b] : kEdges) {
        auto one = hex;
        one[a] = one[b];
        shapes.push_back(one);
    }
    for (const auto& side : kCellFaces) {
        for (std::size_t k = 0; k < 4; ++k) {
            const auto at = [&](std::size_t i) { return side[(k + i) % 4]; };
            auto prism = hex, pyramid = hex;
            prism[at(0)] = prism[at(1)];
            prism[at(3)] = prism[at(2)];
            for (std::size_t i = 1; i < 4; ++i) pyramid[at(i)] = pyramid[at(0)];
            shapes.push_back(prism);
            shapes.push_back(pyramid);
        }
    }
    std::size_t prisms = 0, pyramids = 0;
    for (const auto& shape : shapes) {
        MeshFile file;
        file.points = box.points;
        add_cell(file, file.hexes, shape);
        MeshFile taken = file;
        static_cast<void>(take_collapsed(taken, OtherCells::Split, kMadeFile, kMadeNames));
        prisms += taken.prisms.corners.size();
        pyramids += taken.pyramids.corners.size();
        EXPECT_NEAR(volume_of(assembled(file).mesh), volume_between(file.points, shape), 1e-14);
    }
    EXPECT_EQ(prisms, 6U * 4);
    EXPECT_EQ(pyramids, 6U * 4);
}

TEST(CollapsedShapes, KeepTheNumbersOfTheirCells) {
    MeshFile file = file_of(make_box(3, 1, 1));
    const auto first = file.hexes.corners[0], second = file.hexes.corners[1];
    file.hexes.corners[0] = {first[0], first[1], first[2], first[2], first[4], first[5], first[6], first[6]};
    file.hexes.corners[1] = {second[0], second[1], second[2], second[3], second[0], second[1], second[2], second[3]};  // flat
    add_cell(file, file.prisms, {0, 1, 4, 8, 8, 8});
    MeshFile taken = file;
    EXPECT_FALSE(take_collapsed(taken, OtherCells::Split, kMadeFile, kMadeNames)) << "no cell has to be cut";
    EXPECT_THAT(taken.hexes.numbers, ElementsAre(2));
    EXPECT_THAT(taken.prisms.numbers, ElementsAre(0));
    EXPECT_THAT(taken.tets.numbers, ElementsAre(3));
    EXPECT_THAT(taken.warnings, ElementsAre("2 cells with repeated points taken as 1 prism, 1 tetrahedron",
                                            "1 cell without volume (too few different points) left out"));
    MeshFile ignored = file;
    EXPECT_FALSE(take_collapsed(ignored, OtherCells::Ignore, kMadeFile, kMadeNames));
    EXPECT_THAT(ignored.hexes.numbers, ElementsAre(2));
    EXPECT_TRUE(ignored.prisms.corners.empty() && ignored.tets.corners.empty());
    EXPECT_THAT(ignored.warnings, Contains("2 cells with repeated points ignored"));
}

}  // namespace joined_points_test
}  // namespace subvol::detail
