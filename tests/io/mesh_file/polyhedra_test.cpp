// SPDX-License-Identifier: Apache-2.0
// Cells that are given by their faces.
#include "polyhedra.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "join_pieces.h"
#include "made_files.h"
#include "vtk_cells.h"

namespace subvol::detail {
namespace polyhedra_test {

using test::assembled;
using test::make_box;
using test::open_area;
using test::volume_of;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kRounding = 1e-12;

/// The faces of the unit cube as `make_box` numbers its points, in both orientations.
const CellFaces kCube{{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 6, 4}, {1, 3, 7, 5}};

/// A prism over a polygon in the plane z = 0, up to the height 1: the points of the polygon, then those above them.
CellFaces prism_over(std::size_t sides, Index first = 0) {
    CellFaces faces(2);
    const auto n = static_cast<Index>(sides);
    for (Index k = 0; k < n; ++k) {
        faces[0].push_back(first + k);
        faces[1].push_back(first + n + k);
        const Index next = (k + 1) % n;
        faces.push_back({first + k, first + next, first + n + next, first + n + k});
    }
    return faces;
}

std::vector<Vec3> points_over(const std::vector<Vec2>& polygon) {
    std::vector<Vec3> points;
    for (const double z : {0., 1.}) {
        for (const Vec2& x : polygon) points.emplace_back(x, z);
    }
    return points;
}

/// By the divergence theorem: a third of the sum of height and area of all faces.
double volume_inside(const CellFaces& faces, const std::vector<Vec3>& points) {
    double volume = 0;
    for (const auto& face : faces) {
        for (std::size_t k = 1; k + 1 < face.size(); ++k) {
            volume += glm::dot(points[face[0]], glm::cross(points[face[k]], points[face[k + 1]])) / 6;
        }
    }
    return volume;
}

/// The same faces in another order, each turned and begun anywhere.
CellFaces shuffled(CellFaces faces, std::mt19937& random) {
    std::ranges::shuffle(faces, random);
    for (auto& face : faces) {
        std::rotate(face.begin(), face.begin() + static_cast<std::ptrdiff_t>(random() % face.size()), face.end());
        if (random() % 2 == 0) std::ranges::reverse(face);
    }
    return faces;
}

TEST(CellsByFaces, AreClosedIfEachEdgeHasTwoFaces) {
    EXPECT_TRUE(is_closed(kCube));
    for (std::size_t f = 0; f < 6; ++f) {
        CellFaces open = kCube, thrice = kCube;
        open.erase(open.begin() + static_cast<std::ptrdiff_t>(f));
        EXPECT_FALSE(is_closed(open)) << f;
        thrice.insert(thrice.end(), 2, kCube[f]);
        EXPECT_FALSE(is_closed(thrice)) << "face " << f << " is there three times";
    }
    EXPECT_FALSE(is_closed({{0, 1, 2}, {0, 2, 1}, {0, 1, 2}})) << "faces on each other";
    CellFaces thin = kCube;
    thin.push_back({0, 1});
    EXPECT_FALSE(is_closed(thin)) << "a face of two points";
    EXPECT_FALSE(is_closed({}));
}

TEST(CellsByFaces, AreTurnedSoThatNormalsPointOut) {
    const std::vector<Vec3> cube = make_box(1, 1, 1).points;
    for (unsigned turned = 0; turned < 64; ++turned) {
        CellFaces faces = kCube;
        for (std::size_t f = 0; f < 6; ++f) {
            if ((turned >> f & 1) != 0) std::ranges::reverse(faces[f]);
        }
        orient_faces(faces, cube);
        for (const auto& face : faces) {
            const Vec3 normal = glm::cross(cube[face[1]] - cube[face[0]], cube[face[2]] - cube[face[0]]);
            EXPECT_GT(glm::dot(normal, test::mean_at(cube, face) - Vec3(0.5)), 0) << turned;
        }
    }
}

// The middle of an L lies on its re-entrant edge, so nothing but the volume says which side is outside.
TEST(CellsByFaces, AreTurnedAlsoIfTheyAreNotConvex) {
    const std::vector<Vec3> points = points_over({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});
    std::mt19937 random(1);
    for (int k = 0; k < 20; ++k) {
        CellFaces faces = shuffled(prism_over(6), random);
        orient_faces(faces, points);
        EXPECT_NEAR(volume_inside(faces, points), 3, kRounding);
        std::map<std::pair<Index, Index>, int> walks;
        for (const auto& face : faces) {
            for (std::size_t i = 0; i < face.size(); ++i) ++walks[{face[i], face[(i + 1) % face.size()]}];
        }
        for (const auto& [edge, count] : walks) EXPECT_EQ(count, 1) << "each edge is walked once in each direction";
        EXPECT_EQ(walks.size(), 2U * 18);
    }
    CellFaces open(kCube.begin(), kCube.end() - 1);
    const CellFaces before = open;
    orient_faces(open, make_box(1, 1, 1).points);
    EXPECT_EQ(open, before);
}

TEST(CellsByFaces, AreTheCellsThatTheirFacesMakeThem) {
    const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
    struct Case {
        CellFaces faces;
        std::array<std::size_t, 4> counts;  // of hexahedra, tetrahedra, prisms and pyramids
        double volume;
    };
    const std::vector<Case> cases{{kCube, {1, 0, 0, 0}, 1},
                                  {{{0, 1, 2}, {0, 1, 4}, {0, 2, 4}, {1, 2, 4}}, {0, 1, 0, 0}, 1 / 6.},
                                  {{{0, 1, 2}, {4, 5, 6}, {0, 1, 5, 4}, {1, 2, 6, 5}, {0, 2, 6, 4}}, {0, 0, 1, 0}, 1 / 2.},
                                  {{{0, 1, 3, 2}, {0, 1, 4}, {1, 3, 4}, {3, 2, 4}, {2, 0, 4}}, {0, 0, 0, 1}, 1 / 3.}};
    std::mt19937 random(2);
    for (const Case& one : cases) {
        for (int k = 0; k < 10; ++k) {
            MeshFile file;
            file.points = points;
            Polyhedra cells;
            cells.add(5, shuffled(one.faces, random));
            EXPECT_EQ(cells.take_into(file, false), 0U);
            const std::array counts{file.hexes.corners.size(), file.tets.corners.size(), file.prisms.corners.size(),
                                    file.pyramids.corners.size()};
            EXPECT_EQ(counts, one.counts);
            each_kind(file, [](const auto& kind) {
                for (const Index number : kind.numbers) EXPECT_EQ(number, 5U);
            });
            EXPECT_THAT(file.warnings, ElementsAre());
            file.turned = true;  // the hexahedron is right-handed as it is
            EXPECT_NEAR(volume_of(assembled(file).mesh), one.volume, kRounding);
        }
    }
}

std::vector<Vec2> regular_polygon(int sides) {
    std::vector<Vec2> polygon;
    for (int k = 0; k < sides; ++k) {
        const double angle = 2 * std::numbers::pi * k / sides;
        polygon.emplace_back(std::cos(angle), std::sin(angle));
    }
    return polygon;
}

/// The area of a regular polygon with corners at the distance 1.
double area_of_regular(int sides) {
    return sides * std::sin(2 * std::numbers::pi / sides) / 2;
}

TEST(CellsByFaces, OthersAreSplitIntoTetrahedra) {
    std::mt19937 random(3);
    for (const int sides : {5, 6, 9}) {
        MeshFile file;
        file.points = points_over(regular_polygon(sides));
        Polyhedra cells;
        cells.add(0, shuffled(prism_over(static_cast<std::size_t>(sides)), random));
        EXPECT_EQ(cells.take_into(file, false), 0U);
        const int triangles = 2 * (sides - 2) + 2 * sides;
        EXPECT_EQ(file.tets.corners.size(), static_cast<std::size_t>(triangles));
        EXPECT_THAT(file.warnings,
                    ElementsAre("1 polyhedron split from the middle into " + std::to_string(triangles) + " tetrahedra"));
        for (const auto& [a, b, c, d] : file.tets.corners) {
            const auto& x = file.points;
            EXPECT_GT(glm::dot(x[d] - x[a], glm::cross(x[b] - x[a], x[c] - x[a])), 0) << "right-handed";
        }
        const ReadResult result = assembled(file);
        EXPECT_NEAR(volume_of(result.mesh), area_of_regular(sides), kRounding);
        EXPECT_NEAR(open_area(result.mesh), 2 * area_of_regular(sides) + 2 * sides * std::sin(std::numbers::pi / sides),
                    kRounding);
    }
}

// A corner of the polygon points inwards, and the mean of its points lies outside. Its area is that of two triangles, 5 each.
TEST(CellsByFaces, TheMiddleIsInsideOfCellsThatHideTheMeanOfTheirPoints) {
    std::mt19937 random(5);
    for (int k = 0; k < 10; ++k) {
        std::vector<Vec3> points = points_over({{0, 0}, {10, 0}, {1, 1}, {0, 10}, {0, 5}});
        std::vector<Index> number(points.size());
        std::iota(number.begin(), number.end(), Index{0});
        std::ranges::shuffle(number, random);
        MeshFile file;
        file.points.resize(points.size());
        for (std::size_t p = 0; p < points.size(); ++p) file.points[number[p]] = points[p];
        FileArray& array = file.arrays.emplace_back(FileArray{"f", 1, false, {}});
        for (const Vec3& x : file.points) array.values.push_back(3 * x.x - x.y + 2 * x.z);
        CellFaces faces = shuffled(prism_over(5), random);
        for (auto& face : faces) {
            for (Index& p : face) p = number[p];
        }
        Polyhedra cells;
        cells.add(0, std::move(faces));
        cells.take_into(file, false);
        const Vec3 middle = file.points.back();
        EXPECT_LT(std::max(middle.x, middle.y), 1 + 1. / 9) << "the lines of the two edges at the corner meet the axes there";
        EXPECT_NEAR(file.arrays[0].values.back(), 3 * middle.x - middle.y + 2 * middle.z, kRounding) << "linear fields stay so";
        EXPECT_THAT(file.warnings, ElementsAre("1 polyhedron split from the middle into 16 tetrahedra"));
        const ReadResult result = assembled(file);
        EXPECT_NEAR(volume_of(result.mesh), 10, kRounding);
        EXPECT_GT(test::least_volume(result.mesh), 0);
    }
}

// A prism over a U, of which no place sees everything: its arms are 1 wide and 3 high, its ground is 1 by 1.
TEST(CellsByFaces, ThatNoPlaceSeesAllOfAreSaid) {
    MeshFile file;
    file.points = points_over({{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}});
    Polyhedra cells;
    cells.add(0, prism_over(8));
    cells.take_into(file, false);
    EXPECT_THAT(file.warnings,
                Contains("1 polyhedron has no point from which all faces are seen from inside, or none that is found: "
                         "tetrahedra overlap there"));
}

// Whatever the numbers of the points, both prisms cut the hexagon between them and the quad beside the cube alike.
TEST(CellsByFaces, NeighboursCutTheirFaceAlike) {
    std::mt19937 random(4);
    for (int k = 0; k < 10; ++k) {
        std::vector<Vec3> points;
        for (const double z : {0., 1., 2.}) {
            for (const Vec2& x : regular_polygon(6)) points.emplace_back(x, z);
        }
        points.insert(points.end(), {{2, 0, 0}, {1.5, std::sqrt(0.75), 0}, {2, 0, 1}, {1.5, std::sqrt(0.75), 1}});
        std::vector<Index> number(points.size());
        std::iota(number.begin(), number.end(), Index{0});
        std::ranges::shuffle(number, random);
        MeshFile file;
        file.points.resize(points.size());
        for (std::size_t p = 0; p < points.size(); ++p) file.points[number[p]] = points[p];
        Polyhedra cells;
        for (const Index first : {0U, 6U}) {
            CellFaces faces = shuffled(prism_over(6, first), random);
            for (auto& face : faces) {
                for (Index& p : face) p = number[p];
            }
            cells.add(first / 6, std::move(faces));
        }
        cells.take_into(file, false);
        file.hexes.corners = {{number[0], number[18], number[19], number[1], number[6], number[20], number[21], number[7]}};
        file.hexes.numbers = {2};
        const ReadResult result = assembled(file);
        EXPECT_NEAR(volume_of(result.mesh), 2 * area_of_regular(6) + std::sqrt(0.75), kRounding);
        EXPECT_NEAR(open_area(result.mesh), 2 * area_of_regular(6) + 11 + 2 * std::sqrt(0.75) + 3, kRounding);
        EXPECT_GT(test::least_volume(result.mesh), 0);
    }
}

TEST(CellsByFaces, FieldsHaveTheMeanOfTheCellInTheMiddle) {
    MeshFile file;
    file.points = points_over(regular_polygon(5));
    file.points.emplace_back(7, 7, 7);  // of no cell
    for (const std::string name : {"x", "GlobalNodeId"}) {
        FileArray& array = file.arrays.emplace_back(FileArray{name, 1, false, {}});
        for (int p = 0; p < 11; ++p) array.values.push_back(p == 10 ? 1000 : p * p);
    }
    file.arrays.push_back({"U", 2, false, {}});
    for (int p = 0; p < 11; ++p) file.arrays.back().values.insert(file.arrays.back().values.end(), {1. * p, -2. * p});
    file.arrays.push_back({"c", 1, true, {3}});
    Polyhedra cells;
    cells.add(0, prism_over(5));
    cells.take_into(file, false);
    ASSERT_EQ(file.points.size(), 12U);
    EXPECT_NEAR(glm::distance(file.points.back(), Vec3(0, 0, 0.5)), 0, kRounding);
    EXPECT_NEAR(file.arrays[0].values.back(), 285 / 10., kRounding) << "the mean of the squares up to 9";
    ASSERT_EQ(file.arrays[2].values.size(), 24U);
    EXPECT_NEAR(file.arrays[2].values[22], 4.5, kRounding);
    EXPECT_NEAR(file.arrays[2].values[23], -9, kRounding);
    EXPECT_THAT(file.arrays[3].values, ElementsAre(3));
    const auto& numbers = file.arrays[1].values;
    ASSERT_EQ(numbers.size(), 12U);
    EXPECT_EQ(std::count(numbers.begin(), numbers.end(), numbers.back()), 1) << "no other point has its number";
    EXPECT_EQ(numbers.back(), std::floor(numbers.back()));
}

TEST(CellsByFaces, OthersAreCountedIfTheyAreIgnored) {
    MeshFile file;
    file.points = make_box(1, 1, 1).points;
    for (const Vec3& x : points_over(regular_polygon(5))) file.points.push_back(x);
    Polyhedra cells;
    cells.add(0, CellFaces(kCube));
    cells.add(1, prism_over(5, 8));
    cells.add(2, {{0, 1, 2}, {0, 1, 4}, {0, 2, 4}, {1, 2, 4}});
    EXPECT_EQ(cells.take_into(file, true), 2U);
    EXPECT_EQ(file.hexes.corners.size(), 1U);
    EXPECT_EQ(file.points.size(), 18U);
    EXPECT_EQ(volume_of(assembled(file).mesh), 1);
}

TEST(CellsByFaces, ThoseThatAreNotClosedAreLeftOut) {
    MeshFile file = test::file_of(make_box(1, 1, 1));
    Polyhedra cells;
    CellFaces open(kCube.begin(), kCube.end() - 1), thrice = kCube;
    thrice.insert(thrice.end(), 2, kCube[3]);
    cells.add(1, std::move(open));
    cells.add(2, std::move(thrice));
    cells.take_into(file, false);
    EXPECT_THAT(file.warnings, ElementsAre("2 polyhedra whose faces do not enclose a volume left out"));
    EXPECT_EQ(file.hexes.corners.size(), 1U);
    EXPECT_TRUE(file.tets.corners.empty());
}

// The faces of a hexahedron of which two opposite edges of a side are collapsed: a prism.
TEST(CellsByFaces, FacesThatRepeatPointsAreSmallerFaces) {
    MeshFile file;
    file.points = make_box(1, 1, 1).points;
    CellFaces faces = kCube;
    for (auto& face : faces) {
        for (Index& p : face) p = p == 3 ? 1 : p == 7 ? 5 : p;
    }
    Polyhedra cells;
    cells.add(0, std::move(faces));
    cells.take_into(file, false);
    EXPECT_EQ(file.prisms.corners.size(), 1U);
    EXPECT_NEAR(volume_of(assembled(file).mesh), 1 / 2., kRounding);
}

/// A regular dodecahedron: a cube and the corners of three golden rectangles.
std::vector<Vec3> dodecahedron() {
    std::vector<Vec3> points = make_box(1, 1, 1).points;
    for (Vec3& x : points) x = 2. * x - Vec3(1);
    for (const double a : {-1., 1.}) {
        for (const double b : {-1., 1.}) {
            const double s = a / std::numbers::phi, t = b * std::numbers::phi;
            points.insert(points.end(), {{0, s, t}, {s, t, 0}, {t, 0, s}});
        }
    }
    return points;
}

std::vector<Index> all_of(const std::vector<Vec3>& points) {
    std::vector<Index> all(points.size());
    std::iota(all.begin(), all.end(), Index{0});
    return all;
}

TEST(HullFaces, AreThoseOfARegularDodecahedron) {
    const std::vector<Vec3> points = dodecahedron();
    CellFaces faces = hull_faces(all_of(points), points);
    const double edge = 2 / std::numbers::phi;
    ASSERT_EQ(faces.size(), 12U);
    for (const auto& face : faces) {
        ASSERT_EQ(face.size(), 5U);
        for (std::size_t k = 0; k < 5; ++k) {
            EXPECT_NEAR(glm::distance(points[face[k]], points[face[(k + 1) % 5]]), edge, 1e-12) << "in their order around it";
        }
    }
    ASSERT_TRUE(is_closed(faces));
    orient_faces(faces, points);
    const double volume = (15 + 7 * std::sqrt(5)) / 4 * std::pow(edge, 3);
    EXPECT_NEAR(volume_inside(faces, points), volume, 1e-12);
    MeshFile file;
    file.points = points;
    Polyhedra cells;
    cells.add(0, std::move(faces));
    cells.take_into(file, false);
    EXPECT_NEAR(volume_of(assembled(file).mesh), volume, 1e-11);
    EXPECT_THAT(file.warnings, ElementsAre(HasSubstr("into 36 tetrahedra"))) << "three triangles of each pentagon";
}

TEST(HullFaces, NeedCornersThatEncloseAVolume) {
    std::vector<Vec3> points = make_box(1, 1, 1).points;
    EXPECT_EQ(hull_faces(all_of(points), points).size(), 6U);
    points.emplace_back(0.5, 0.4, 0.6);
    EXPECT_THAT(hull_faces(all_of(points), points), ElementsAre()) << "a point inside is no corner";
    std::vector<Vec3> plane = make_box(2, 2, 1).points;
    for (Vec3& x : plane) x.z = 0.3 * x.x - x.y;
    EXPECT_THAT(hull_faces(all_of(plane), plane), ElementsAre());
    EXPECT_THAT(hull_faces({0, 1, 2}, points), ElementsAre());
    std::vector<Vec3> sphere;
    for (int k = 0; k < 65; ++k) {
        const double z = (2 * k + 1) / 65. - 1, angle = 2.4 * k;
        sphere.emplace_back(std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z);
    }
    EXPECT_THAT(hull_faces(all_of(sphere), sphere), ElementsAre()) << "more than 64";
    sphere.pop_back();
    const CellFaces faces = hull_faces(all_of(sphere), sphere);
    EXPECT_TRUE(is_closed(faces));
    std::size_t edges = 0;
    for (const auto& face : faces) edges += face.size();
    EXPECT_EQ(sphere.size() + faces.size(), edges / 2 + 2) << "Euler";
}

TEST(VtkFaceLists, OfBothGenerationsGiveTheSameFaces) {
    const std::vector<std::int64_t> tet{4, 3, 0, 1, 2, 3, 0, 1, 3, 3, 0, 2, 3, 3, 1, 2, 3};
    const CellFaces expected{{7, 8, 9}, {7, 8, 10}, {7, 9, 10}, {8, 9, 10}};
    EXPECT_EQ(faces_of_stream(tet, 7, 4), expected);
    VtkFaces streams;
    streams.stream = {-1};  // what no cell refers to
    streams.stream.insert(streams.stream.end(), tet.begin(), tet.end());
    streams.ends = {1, 18};
    EXPECT_EQ(streams.of_cell(1, 7, 4), expected);
    VtkFaces numbered;
    numbered.points = {1, 2, 3, 0, 1, 2, 0, 1, 3, 0, 2, 3};
    numbered.point_ends = {3, 6, 9, 12};
    numbered.numbers = {1, 2, 3, 0};
    numbered.number_ends = {4};
    EXPECT_EQ(numbered.of_cell(0, 7, 4), expected);
    for (const std::int64_t wrong : {-1, 4}) {
        VtkFaces bad = numbered;
        bad.numbers[2] = wrong;
        EXPECT_FALSE(bad.of_cell(0, 7, 4)) << "face " << wrong << " of 4";
        bad = numbered;
        bad.points[5] = wrong;
        EXPECT_FALSE(bad.of_cell(0, 7, 4)) << "point " << wrong << " of 4";
        bad = numbered;
        bad.point_ends[1] = wrong * 4;
        EXPECT_FALSE(bad.of_cell(0, 7, 4)) << "an end of a face at " << 4 * wrong;
        bad = numbered;
        bad.number_ends[0] = wrong + 1;
        EXPECT_FALSE(bad.of_cell(0, 7, 4)) << "an end of the cell at " << wrong + 1;
    }
}

TEST(VtkFaceLists, AreRefusedIfTheyAreDamaged) {
    const std::vector<std::int64_t> tet{4, 3, 0, 1, 2, 3, 0, 1, 3, 3, 0, 2, 3, 3, 1, 2, 3};
    EXPECT_FALSE(faces_of_stream(tet, 0, 3)) << "there is no point 3";
    for (std::size_t length = 0; length < tet.size(); ++length) {
        EXPECT_FALSE(faces_of_stream(std::span(tet).first(length), 0, 4)) << length;
    }
    for (const std::size_t place : {0U, 1U, 5U}) {  // counts
        for (const std::int64_t count : {std::int64_t{0}, std::int64_t{-1}, std::int64_t{9}, std::int64_t{1} << 62}) {
            std::vector<std::int64_t> damaged = tet;
            damaged[place] = count;
            EXPECT_FALSE(faces_of_stream(damaged, 0, 4)) << count << " at " << place;
        }
    }
    std::vector<std::int64_t> longer = tet;
    longer.push_back(0);
    EXPECT_FALSE(faces_of_stream(longer, 0, 4));
}

}  // namespace polyhedra_test
}  // namespace subvol::detail
