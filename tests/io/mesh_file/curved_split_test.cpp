// SPDX-License-Identifier: Apache-2.0
// Curved hexahedra: the order of their nodes, their polynomials, and the smaller cells that they become.
#include "curved_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <set>
#include <vector>

#include "curved_pieces.h"
#include "made_files.h"

namespace subvol::detail {
namespace curved_split_test {

using test::assembled;
using test::make_box;
using test::refusal_of;
using test::volume_of;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;

using Sizes = std::array<std::size_t, 3>;

/// The number of the node at place i, j, k in VTK 9, as vtkHigherOrderHexahedron::PointIndexFromIJK has it; old: in VTK 8.
std::size_t vtk_number(const Sizes& at, const Sizes& degrees, bool old) {
    const auto [i, j, k] = at;
    const std::size_t p = degrees[0] - 1, q = degrees[1] - 1, r = degrees[2] - 1;
    const bool on_i = i == 0 || i == degrees[0], on_j = j == 0 || j == degrees[1], on_k = k == 0 || k == degrees[2];
    const std::size_t around = i != 0 ? (j != 0 ? 2 : 1) : (j != 0 ? 3 : 0);
    if (on_i && on_j && on_k) return around + (k != 0 ? 4 : 0);
    std::size_t first = 8;
    if (!on_i && on_j && on_k) return first + i - 1 + (j != 0 ? p + q : 0) + (k != 0 ? 2 * (p + q) : 0);
    if (!on_j && on_i && on_k) return first + j - 1 + (i != 0 ? p : 2 * p + q) + (k != 0 ? 2 * (p + q) : 0);
    first += 4 * (p + q);
    if (!on_k && on_i && on_j) return first + k - 1 + r * (old && around > 1 ? 5 - around : around);
    first += 4 * r;
    if (on_i) return first + j - 1 + q * (k - 1) + (i != 0 ? q * r : 0);
    first += 2 * q * r;
    if (on_j) return first + i - 1 + p * (k - 1) + (j != 0 ? r * p : 0);
    first += 2 * r * p;
    if (on_k) return first + i - 1 + p * (j - 1) + (k != 0 ? p * q : 0);
    return first + 2 * p * q + i - 1 + p * (j - 1 + q * (k - 1));
}

/// The slot of each node in that order.
std::vector<std::size_t> vtk_slots(const Sizes& degrees, bool old = false) {
    std::vector<std::size_t> slots((degrees[0] + 1) * (degrees[1] + 1) * (degrees[2] + 1));
    std::size_t slot = 0;
    for (std::size_t k = 0; k <= degrees[2]; ++k) {
        for (std::size_t j = 0; j <= degrees[1]; ++j) {
            for (std::size_t i = 0; i <= degrees[0]; ++i) slots[vtk_number({i, j, k}, degrees, old)] = slot++;
        }
    }
    return slots;
}

/// The parameters of a slot.
Vec3 parameters_of(std::size_t slot, const Sizes& degrees) {
    const std::size_t row = degrees[0] + 1, layer = row * (degrees[1] + 1);
    return Vec3(static_cast<double>(slot % row) / static_cast<double>(degrees[0]),
                static_cast<double>(slot % layer / row) / static_cast<double>(degrees[1]),
                static_cast<double>(slot / layer) / static_cast<double>(degrees[2]));
}

TEST(CurvedOrders, OfVtkAreThoseOfItsFormula) {
    for (const Sizes degrees : {Sizes{1, 1, 1}, Sizes{2, 2, 2}, Sizes{3, 2, 4}, Sizes{1, 5, 2}, Sizes{4, 4, 4}}) {
        const std::size_t nodes = vtk_slots(degrees).size();
        EXPECT_EQ(curved_layout(CurvedOrder::Vtk, degrees, nodes).slots, vtk_slots(degrees));
        EXPECT_EQ(curved_layout(CurvedOrder::VtkBezier, degrees, nodes).slots, vtk_slots(degrees));
        EXPECT_EQ(curved_layout(CurvedOrder::Vtk8, degrees, nodes).slots, vtk_slots(degrees, true));
        EXPECT_EQ(curved_layout(CurvedOrder::VtkBezier8, degrees, nodes).slots, vtk_slots(degrees, true));
    }
}

// As the manuals of Exodus and Gmsh draw their hexahedra of 27 nodes: i + 3 (j + 3 k) of each.
TEST(CurvedOrders, OfExodusAndGmshAreThoseOfTheirManuals) {
    const std::vector<std::size_t> exodus{0,  2,  8,  6,  18, 20, 26, 24, 1,  5,  7,  3,  9, 11,
                                          17, 15, 19, 23, 25, 21, 13, 4,  22, 12, 14, 10, 16};
    const std::vector<std::size_t> gmsh{0,  2,  8,  6,  18, 20, 26, 24, 1,  3,  9,  5,  11, 7,
                                        17, 15, 19, 21, 23, 25, 4,  10, 12, 14, 16, 22, 13};
    EXPECT_EQ(curved_layout(CurvedOrder::Exodus, {2, 2, 2}, 27).slots, exodus);
    EXPECT_EQ(curved_layout(CurvedOrder::Gmsh, {2, 2, 2}, 27).slots, gmsh);
    const CurvedLayout twenty = curved_layout(CurvedOrder::Gmsh, {2, 2, 2}, 20);
    EXPECT_TRUE(twenty.completed);
    EXPECT_EQ(twenty.slots, std::vector<std::size_t>(gmsh.begin(), gmsh.begin() + 20));
}

// In Gmsh the nodes inside are those of a hexahedron of two degrees less.
TEST(CurvedOrders, OfGmshNest) {
    for (std::size_t degree = 3; degree <= 7; ++degree) {
        const std::size_t row = degree + 1, inner_row = degree - 1, all = row * row * row;
        const auto slots = curved_layout(CurvedOrder::Gmsh, {degree, degree, degree}, all).slots;
        const std::size_t inside = inner_row * inner_row * inner_row;
        const auto inner = curved_layout(CurvedOrder::Gmsh, {degree - 2, degree - 2, degree - 2}, inside).slots;
        ASSERT_EQ(slots.size(), all);
        EXPECT_EQ(std::set<std::size_t>(slots.begin(), slots.end()).size(), all) << "each slot once";
        for (std::size_t n = 0; n < inside; ++n) {
            const std::size_t s = inner[n], i = s % inner_row, j = s / inner_row % inner_row, k = s / inner_row / inner_row;
            EXPECT_EQ(slots[all - inside + n], i + 1 + row * (j + 1 + row * (k + 1))) << degree;
        }
    }
}

TEST(CurvedOrders, DegreesFollowFromTheNumberOfNodes) {
    for (std::size_t degree = 1; degree <= kMostDegree; ++degree) {
        EXPECT_EQ(uniform_degree(CurvedOrder::Vtk, (degree + 1) * (degree + 1) * (degree + 1)), degree);
    }
    EXPECT_EQ(uniform_degree(CurvedOrder::Vtk, 20), 2U);
    EXPECT_EQ(uniform_degree(CurvedOrder::Vtk, 24), 2U);
    EXPECT_EQ(uniform_degree(CurvedOrder::Exodus, 24), std::nullopt);
    EXPECT_EQ(uniform_degree(CurvedOrder::VtkBezier, 20), std::nullopt);
    EXPECT_EQ(uniform_degree(CurvedOrder::Gmsh, 18 * 18 * 18), std::nullopt);
    EXPECT_EQ(uniform_degree(CurvedOrder::Vtk, 28), std::nullopt);
}

double monomial(const Vec3& at, const Sizes& exponents) {
    double value = 1;
    for (int a = 0; a < 3; ++a) value *= std::pow(at[a], static_cast<double>(exponents[static_cast<std::size_t>(a)]));
    return value;
}

/// The values of a monomial at the nodes of a layout.
std::vector<double> at_nodes(const CurvedLayout& layout, const Sizes& exponents) {
    std::vector<double> values;
    for (const std::size_t slot : layout.slots) values.push_back(monomial(parameters_of(slot, layout.degrees), exponents));
    return values;
}

void expect_reproduced(const CurvedLayout& layout, const Sizes& exponents) {
    const auto nodes = at_nodes(layout, exponents);
    const Sizes pieces{3, 5, 4};
    const auto grid = CurvedCell(layout, nodes, 1, false).at_grid(pieces);
    std::size_t place = 0;
    for (std::size_t k = 0; k <= pieces[2]; ++k) {
        for (std::size_t j = 0; j <= pieces[1]; ++j) {
            for (std::size_t i = 0; i <= pieces[0]; ++i) {
                const Vec3 at = Vec3(i, j, k) / Vec3(3, 5, 4);
                ASSERT_NEAR(grid[place++], monomial(at, exponents), 1e-12) << exponents[0] << exponents[1] << exponents[2];
            }
        }
    }
}

TEST(CurvedPolynomials, AreReproducedUpToTheirDegrees) {
    const Sizes degrees{3, 1, 4};
    const CurvedLayout layout = curved_layout(CurvedOrder::Vtk, degrees, 4 * 2 * 5);
    for (std::size_t a = 0; a <= 3; ++a) {
        for (std::size_t b = 0; b <= 1; ++b) {
            for (std::size_t c = 0; c <= 4; ++c) expect_reproduced(layout, {a, b, c});
        }
    }
}

// The element of 20 nodes has the monomials whose superlinear degree is at most 2; that of 24 also those of its four full
// faces.
TEST(CurvedPolynomials, OfTwentyNodesAreThoseOfTheSerendipityElement) {
    for (const std::size_t nodes : {20U, 24U}) {
        const CurvedLayout layout = curved_layout(CurvedOrder::Vtk, {2, 2, 2}, nodes);
        std::size_t count = 0;
        for (std::size_t m = 0; m < 27; ++m) {
            const Sizes exponents{m % 3, m / 3 % 3, m / 9};
            const auto squares = std::ranges::count(exponents, 2U);
            if (squares > 2 || (squares == 2 && (nodes == 20 || exponents[2] != 2))) continue;
            expect_reproduced(layout, exponents);
            ++count;
        }
        EXPECT_EQ(count, nodes);
    }
}

TEST(CurvedPolynomials, BendAsTheirSecondDerivatives) {
    const CurvedLayout layout = curved_layout(CurvedOrder::Vtk, {3, 3, 3}, 64);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Sizes square{}, cube{}, linear{1, 1, 1};
        square[axis] = 2;
        cube[axis] = 3;
        const auto bend = [&](const Sizes& exponents) {
            const CurvedCell cell(layout, at_nodes(layout, exponents), 1, false);
            return cell.bend(axis, cell.samples(axis), 0, 1);
        };
        EXPECT_NEAR(bend(square), 2, 1e-10);
        EXPECT_NEAR(bend(cube), 6, 1e-10) << "at its end";
        EXPECT_NEAR(bend(linear), 0, 1e-10);
        // A vector (3 t², 4 t²) bends by the length of (6, 8).
        std::vector<double> vector;
        for (const double t2 : at_nodes(layout, square)) vector.insert(vector.end(), {0, 3 * t2, 4 * t2});
        const CurvedCell cell(layout, vector, 3, false);
        EXPECT_NEAR(cell.bend(axis, cell.samples(axis), 1, 2), 10, 1e-9);
        EXPECT_FALSE(cell.is_straight(axis));
    }
}

// A quarter of a ring between the radii 1 and 2, by the weights 1, √½, 1 and the corners of a square.
TEST(CurvedPolynomials, RationalOnesAreExactCircles) {
    const CurvedLayout layout = curved_layout(CurvedOrder::VtkBezier, {2, 1, 1}, 12);
    std::vector<double> values;
    for (const std::size_t slot : layout.slots) {
        const Vec3 at = parameters_of(slot, layout.degrees);
        const double radius = 1 + at.y;
        const Vec2 corner = at.x == 0 ? Vec2(1, 0) : at.x == 1 ? Vec2(0, 1) : Vec2(1, 1);
        values.insert(values.end(), {radius * corner.x, radius * corner.y, at.z, at.x == 0.5 ? std::sqrt(0.5) : 1});
    }
    const CurvedCell ring(layout, values, 4, true);
    const auto grid = ring.at_grid({7, 2, 1});
    ASSERT_EQ(grid.size(), 3U * 8 * 3 * 2) << "without the weights";
    for (std::size_t p = 0; p < grid.size() / 3; ++p) {
        EXPECT_NEAR(std::hypot(grid[3 * p], grid[3 * p + 1]), 1 + static_cast<double>(p / 8 % 3) / 2, 1e-14);
    }
    EXPECT_FALSE(ring.is_straight(1));
}

/// A file of one curved cell whose points are those of a function of its parameters.
template <class Shape>
MeshFile curved_file(const Sizes& degrees, const Shape& shape) {
    MeshFile file;
    std::vector<Index> nodes;
    for (const std::size_t slot : vtk_slots(degrees)) {
        nodes.push_back(static_cast<Index>(file.points.size()));
        file.points.push_back(shape(parameters_of(slot, degrees)));
    }
    file.hexes.corners = {{0, 1, 2, 3, 4, 5, 6, 7}};
    file.hexes.numbers = {0};
    file.curved.add(0, CurvedOrder::Vtk, nodes);
    FileArray array{"HigherOrderDegrees", 3, true, {}};
    for (const std::size_t degree : degrees) array.values.push_back(static_cast<double>(degree));
    file.arrays.push_back(array);
    return file;
}

/// A shear of the unit cube: its volume stays 1, and straight pieces of it have this volume too.
constexpr double kShear = 0.4;
Vec3 sheared(const Vec3& u) {
    return {u.x, u.y + kShear * u.x * u.x, u.z};
}

TEST(SplitCurved, PointsLieOnTheCurvedShape) {
    const double diagonal = std::sqrt(1 + (1 + kShear) * (1 + kShear) + 1);
    for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
        MeshFile file = curved_file({2, 1, 1}, sheared);
        test::add_at_points(file, "square", [](const Vec3& x) { return x.x * x.x + 0.25; });
        test::add_at_cells(file, "T", {3.5});
        const ReadResult result = assembled(file, {.curved_tolerance = tolerance});
        // A chord of length h is h² f''/8 from its curve; the three directions share the tolerance.
        const double bend = 2 * kShear / 8 / diagonal;
        const auto n = static_cast<std::size_t>(std::ceil(std::sqrt(3 * bend / tolerance)));
        EXPECT_EQ(result.mesh.cells.size(), n) << tolerance;
        ASSERT_TRUE(result.curved);
        EXPECT_NEAR(result.curved->shape_error, bend / static_cast<double>(n * n), 1e-6 * bend);
        EXPECT_LE(result.curved->shape_error, tolerance);
        EXPECT_NEAR(volume_of(result.mesh), 1, 1e-12);
        for (const Vec3& x : result.mesh.points) {
            EXPECT_NEAR(x.x * static_cast<double>(n), std::round(x.x * static_cast<double>(n)), 1e-9);
            const double v = x.y - kShear * x.x * x.x;
            EXPECT_NEAR(std::min(std::abs(v), std::abs(v - 1)), 0, 1e-12) << "at a side of the curved cell";
            EXPECT_NEAR(test::value_at(result.mesh, "square", x), x.x * x.x + 0.25, 1e-12);
        }
        EXPECT_THAT(result.mesh.find_attribute("T")->cells, Each(3.5));
        EXPECT_EQ(result.mesh.find_attribute("HigherOrderDegrees"), nullptr);
    }
}

TEST(SplitCurved, CornersAreUsedWhereThatIsEnough) {
    const MeshFile straight = curved_file({2, 2, 2}, [](const Vec3& u) { return u; });
    ReadResult result = assembled(straight);
    EXPECT_EQ(result.mesh.cells.size(), 1U);
    ASSERT_TRUE(result.curved);
    EXPECT_FALSE(result.curved->split());
    EXPECT_THAT(result.warnings, Contains(HasSubstr("1 curved cell is straight")));
    const MeshFile bent = curved_file({2, 2, 2}, sheared);
    EXPECT_GT(assembled(bent).mesh.cells.size(), 1U);
    EXPECT_EQ(assembled(bent, {.curved_tolerance = std::nullopt}).mesh.cells.size(), 1U);
    MeshFile with_tet = bent;
    with_tet.points.insert(with_tet.points.end(), {{5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}});
    test::add_cell(with_tet, with_tet.tets, {27, 28, 29, 30});
    with_tet.arrays.clear();
    result = assembled(with_tet);
    EXPECT_FALSE(result.curved);
    EXPECT_THAT(result.warnings, Contains("1 curved cell beside cells of other kinds: only the corners are used"));
    MeshFile tagged = bent;
    tagged.sharp.edges = {{0, 1}};
    EXPECT_THAT(assembled(tagged).warnings, Contains("1 curved cell with sharp groups: only the corners are used"));
}

TEST(SplitCurved, PatchesLieOnTheCurvedFaces) {
    MeshFile file = curved_file({2, 2, 2}, sheared);
    file.patches = {{.name = "x = 0"}, {.name = "z = 1"}};
    file.patches[0].add(std::array<Index, 4>{0, 3, 7, 4});
    file.patches[1].add(std::array<Index, 4>{4, 5, 6, 7});
    const ReadResult result = assembled(file, {.curved_tolerance = 1e-4});
    ASSERT_EQ(result.sets.patches.size(), 2U);
    double area = 0;
    for (const auto& [cell, side] : result.sets.patches[1].sides) {
        const auto quad = test::side_of(result.mesh, cell, side);
        for (const Index p : quad) EXPECT_NEAR(result.mesh.points[p].z, 1, 1e-12);
        area += test::area_of(result.mesh, quad);
    }
    EXPECT_NEAR(area, 1, 1e-12) << "a shear keeps it";
    EXPECT_EQ(result.sets.patches[0].sides.size(), 1U) << "this face is not bent";
}

TEST(SplitCurved, FilesThatContradictThemselvesAreRefused) {
    const auto with_degrees = [](std::vector<double> degrees) {
        MeshFile file = curved_file({2, 1, 1}, sheared);
        file.arrays[0].values = std::move(degrees);
        return refusal_of(file);
    };
    EXPECT_EQ(with_degrees({2, 1, 1}), "no error");
    EXPECT_THAT(with_degrees({1, 1, 1}),
                HasSubstr("made.file: cell 0 has 12 points, but the degrees 1 1 1 in \"HigherOrderDegrees\""));
    EXPECT_THAT(with_degrees({2, 1, 1.5}), HasSubstr("the degrees 2 1 1.5"));
    EXPECT_THAT(with_degrees({2, 1, std::nan("")}), HasSubstr("made.file: cell 0 has 12 points"));
    EXPECT_THAT(with_degrees({0, 0, 0}), HasSubstr("the degrees 0 0 0"));
    EXPECT_THAT(with_degrees({17, 1, 1}), HasSubstr("p, q, r from 1 to 16"));
    MeshFile file = curved_file({2, 1, 1}, sheared);
    file.arrays.clear();
    EXPECT_THAT(refusal_of(file), HasSubstr("cell 0 has 12 points, and there is no array \"HigherOrderDegrees\""));
    for (const double weight : {0., -1., std::nan(""), HUGE_VAL}) {
        MeshFile rational = curved_file({2, 1, 1}, sheared);
        rational.curved.orders[0] = CurvedOrder::VtkBezier;
        rational.arrays.push_back({"RationalWeights", 1, false, std::vector<double>(12, 1)});
        EXPECT_EQ(refusal_of(rational), "no error");
        rational.arrays.back().values[5] = weight;
        EXPECT_THAT(refusal_of(rational), HasSubstr("made.file: the rational weight of point 5 is ")) << weight;
    }
    MeshFile gap = curved_file({2, 1, 1}, sheared);
    test::add_at_points(gap, "T", [](const Vec3& x) { return x.x == 0.5 ? std::nan("") : x.x; });
    test::add_at_points(gap, "S", [](const Vec3& x) { return x.y; });
    const ReadResult result = assembled(gap);
    ASSERT_EQ(result.unread.size(), 1U);
    EXPECT_THAT(result.unread[0].why, HasSubstr("the value at point 8 is not finite")) << "a node that is no corner";
}

// Two cells side by side, the second one with its corners in any of the 24 orders that a right-handed cube has.
TEST(SplitCurved, NeighboursShareTheirPointsInAnyOrientation) {
    const HexMesh box = make_box(2, 1, 1);
    std::vector<std::array<std::size_t, 8>> orders;
    std::array<std::size_t, 8> turn{0, 1, 2, 3, 4, 5, 6, 7};
    const auto turned = [](const std::array<std::size_t, 8>& t, const std::array<std::size_t, 8>& by) {
        std::array<std::size_t, 8> result{};
        for (std::size_t k = 0; k < 8; ++k) result[k] = t[by[k]];
        return result;
    };
    constexpr std::array<std::size_t, 8> kAboutW{1, 2, 3, 0, 5, 6, 7, 4}, kAboutU{3, 2, 6, 7, 0, 1, 5, 4};
    for (int a = 0; a < 4; ++a, turn = turned(turn, kAboutW)) {
        for (int b = 0; b < 4; ++b, turn = turned(turn, kAboutU)) {
            for (int c = 0; c < 4; ++c, turn = turned(turn, kAboutW)) orders.push_back(turn);
        }
    }
    std::ranges::sort(orders);
    orders.erase(std::unique(orders.begin(), orders.end()), orders.end());
    ASSERT_EQ(orders.size(), 24U);
    std::mt19937 random(6);
    for (const auto& order : orders) {
        auto cells = box.cells;
        for (std::size_t k = 0; k < 8; ++k) cells[1][k] = box.cells[1][order[k]];
        const EdgeClasses edges(cells);
        std::vector<std::size_t> pieces(edges.size());
        for (std::size_t& n : pieces) n = 1 + random() % 4;
        const SplitGrids grids(cells, edges, pieces, box.points.size());
        std::map<Index, Vec3> places;
        for (std::size_t c = 0; c < 2; ++c) {
            const Sizes n = grids.pieces_of(c);
            const auto grid = grids.grid_of(c);
            ASSERT_EQ(grid.size(), (n[0] + 1) * (n[1] + 1) * (n[2] + 1));
            for (std::size_t i = 0; i < grid.size(); ++i) {
                const Vec3 u = parameters_of(i, n);
                Vec3 place(0);
                for (std::size_t k = 0; k < 8; ++k) {
                    double weight = 1;
                    for (int a = 0; a < 3; ++a)
                        weight *= kCornerParameters[k][static_cast<std::size_t>(a)] == 0 ? 1 - u[a] : u[a];
                    place += weight * box.points[cells[c][k]];
                }
                const auto [known, is_new] = places.try_emplace(grid[i], place);
                EXPECT_LT(glm::distance(known->second, place), 1e-12) << "one number, one place";
            }
        }
        EXPECT_EQ(places.size(), grids.point_count());
        for (auto a = places.begin(); a != places.end(); ++a) {
            for (auto b = std::next(a); b != places.end(); ++b) {
                EXPECT_GT(glm::distance(a->second, b->second), 0.1) << "one place, one number";
            }
        }
    }
}

// A ring of four cells of 27 nodes: the pieces go round, and all of them together have the area of the ring.
TEST(SplitCurved, ARingIsClosed) {
    MeshFile file;
    constexpr Index kAround = 8, kRadial = 3;
    for (Index k = 0; k < 3; ++k) {
        for (Index j = 0; j < kRadial; ++j) {
            for (Index i = 0; i < kAround; ++i) {
                const double angle = -2 * std::numbers::pi * i / kAround, radius = 1 + j / 2.;
                file.points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), k / 2.);
            }
        }
    }
    for (Index c = 0; c < 4; ++c) {
        std::vector<Index> nodes;
        for (const std::size_t slot : vtk_slots({2, 2, 2})) {
            const auto s = static_cast<Index>(slot);
            nodes.push_back((2 * c + s % 3) % kAround + kAround * (s / 3 % 3 + kRadial * (s / 9)));
        }
        file.hexes.numbers.push_back(c);
        auto& corners = file.hexes.corners.emplace_back();
        std::copy_n(nodes.begin(), 8, corners.begin());
        file.curved.add(c, CurvedOrder::Vtk, nodes);
    }
    const ReadResult result = assembled(file, {.curved_tolerance = 1e-5});
    EXPECT_FALSE(result.curved->limited);
    EXPECT_EQ(result.curved->curved, 4U);
    EXPECT_GT(test::least_volume(result.mesh), 0);
    // The parabola through the points at 0, 45 and 90 degrees bounds a sector of the area (8 √½ - 1)/6: half of the integral of
    // x dy - y dx, which Simpson's rule has exactly.
    EXPECT_NEAR(volume_of(result.mesh), 4 * (4 - 1) * (8 * std::sqrt(0.5) - 1) / 6, 1e-3);
    EXPECT_EQ(assembled(file, {.curved_tolerance = std::nullopt}).mesh.cells.size(), 4U);
}

}  // namespace curved_split_test
}  // namespace subvol::detail
