// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/cell.h"
#include "subvol/limit.h"
#include "subvol/limit_shells.h"
#include "subvol/limit_sides.h"
#include "subvol/mesh_report.h"
#include "subvol/mesh_sets.h"
#include "subvol/model.h"
#include "subvol/quantity.h"
#include "subvol/topology.h"

namespace subvol {
namespace shells_test {

using Quads = std::vector<std::array<Index, 4>>;
using Lines = std::vector<std::array<Index, 2>>;

constexpr double kRounding = 1e-13;  // sums of some ten terms of size 1, a few levels deep

HexMesh with_field(HexMesh mesh) {
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(3 * p.x + p.y) + p.z * p.z; });
    return mesh;
}

/// The hull of a mesh, and its edges with one cell, which are creases of the mesh.
struct Hull {
    Quads quads;
    Lines creases;
};
Hull hull_of(const HexMesh& mesh) {
    const Topology topology = build_topology(mesh);
    Hull hull;
    for (std::size_t f = 0; f < topology.faces.size(); ++f) {
        if (topology.face_on_hull(static_cast<Index>(f))) hull.quads.push_back(topology.faces[f]);
    }
    for (std::size_t e = 0; e < topology.edges.size(); ++e) {
        if (topology.edge_is_crease[e]) hull.creases.push_back(topology.edges[e]);
    }
    return hull;
}

Shells detached(Shells shells) {
    for (CellCorner& corner : shells.solid) corner = {};
    return shells;
}

/// The places and values of the points of a mesh at the shells' corners: the same bits.
void expect_those_of(const Shells& shells, const HexMesh& mesh) {
    for (std::size_t p = 0; p < shells.points.size(); ++p) {
        const auto& [cell, corner] = shells.solid[p];
        if (cell == kNone) continue;
        const Index q = mesh.cells.at(cell)[corner];
        ASSERT_EQ(shells.points[p], mesh.points[q]);
        for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
            ASSERT_EQ(shells.attributes[a].values[p], mesh.attributes[a].values[q]);
        }
    }
}

void expect_near(const Shells& a, const Shells& b, double tolerance) {
    EXPECT_EQ(a.quads, b.quads);
    EXPECT_EQ(a.lines, b.lines);
    ASSERT_EQ(a.points.size(), b.points.size());
    ASSERT_EQ(a.attributes.size(), b.attributes.size());
    for (std::size_t p = 0; p < a.points.size(); ++p) {
        ASSERT_LE(glm::distance(a.points[p], b.points[p]), tolerance) << "point " << p;
        for (std::size_t f = 0; f < a.attributes.size(); ++f) {
            ASSERT_NEAR(a.attributes[f].values[p], b.attributes[f].values[p], tolerance);
        }
    }
}

/// A bent plate with a fin on it that leaves the plate, a rod from the fin, and all values of a field.
struct Bracket {
    HexMesh mesh;
    Shells shells;
};
Bracket make_bracket() {
    HexMesh mesh = test::make_box(4, 3, 2);
    const auto id = [](Index i, Index j, Index k) { return i + 5 * (j + 4 * k); };
    const auto above = static_cast<Index>(mesh.points.size());
    for (Index k = 1; k <= 2; ++k) {
        for (Index i = 0; i <= 4; ++i) mesh.points.emplace_back(i, 1.0 + .2 * k, 2.0 + k);
    }
    for (Index n = 1; n <= 3; ++n) mesh.points.emplace_back(4.0 + n, 1.4 + .1 * n * n, 4.0);
    for (Vec3& p : mesh.points) p += Vec3(.1 * std::sin(p.y + p.z), .2 * std::sin(p.x), .1 * std::cos(p.x * p.y));
    Quads quads;
    for (Index i = 0; i < 4; ++i) {
        quads.push_back({id(i, 1, 2), id(i + 1, 1, 2), above + i + 1, above + i});
        quads.push_back({above + i, above + i + 1, above + i + 6, above + i + 5});
    }
    const Lines lines{{above + 9, above + 10}, {above + 10, above + 11}, {above + 11, above + 12}};
    mesh = with_field(std::move(mesh));
    return {mesh, make_shells(mesh, quads, lines)};
}

class ShellsOfEveryScheme : public testing::TestWithParam<Scheme> {};
INSTANTIATE_TEST_SUITE_P(Schemes, ShellsOfEveryScheme,
                         testing::Values(Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw, Scheme::Linear));

TEST_P(ShellsOfEveryScheme, AreRefinedAsTheBoundaryOfCellsIs) {
    for (const bool box : {true, false}) {
        HexMesh mesh = with_field(box ? test::make_box(4, 3, 2) : test::make_nested_cubes(2));
        test::jitter(mesh, .05, 3);
        const Hull hull = hull_of(mesh);
        const Shells attached = make_shells(mesh, hull.quads, hull.creases);
        for (const int levels : {1, 2, 3}) {
            const RefineOptions options{.scheme = {GetParam()}, .levels = levels};
            const HexMesh fine = refine(mesh, options);
            const Shells with_cells = refine_shells(mesh, attached, options);
            expect_those_of(with_cells, fine);
            expect_near(refine_shells(mesh, detached(attached), options), with_cells, kRounding);
            const Shells limit = limit_shells(mesh, attached, options);
            expect_near(limit_shells(mesh, detached(attached), options), limit, 1e-12);  // eigenvectors are found to 1e-13
        }
    }
}

TEST_P(ShellsOfEveryScheme, FollowTheCellsThatTheyAreAttachedTo) {
    const auto& [mesh, shells] = make_bracket();
    const RefineOptions options{.scheme = {GetParam()}, .levels = 3};
    const Shells fine = refine_shells(mesh, shells, options), limit = limit_shells(mesh, shells, options);
    const HexMesh cells = refine(mesh, options);
    expect_those_of(fine, cells);
    const HexMesh limit_of_cells = on_limit(cells, GetParam());
    std::size_t attached = 0;
    for (std::size_t p = 0; p < limit.points.size(); ++p) {
        const auto& [cell, corner] = limit.solid[p];
        if (cell == kNone) continue;
        ++attached;
        EXPECT_LE(glm::distance(limit.points[p], limit_of_cells.points[limit_of_cells.cells[cell][corner]]), kRounding);
    }
    EXPECT_EQ(attached, 4u * 8 + 1);  // four edges of the plate
    EXPECT_EQ(fine.quads.size(), 8u * 64);
    EXPECT_EQ(fine.lines.size(), 3u * 8);
}

/// Half of a ball: a part of its boundary, and faces between cells.
TEST_P(ShellsOfEveryScheme, SidesLieInTheLimitOfTheWholeMesh) {
    HexMesh mesh = make_model("ball", 4);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x * p.y; });
    mesh.attributes.push_back({"v", 3, {}});
    for (const Vec3& p : mesh.points) mesh.attributes.back().values.insert(mesh.attributes.back().values.end(), {p.x, p.y, .5});
    mesh.attributes.push_back(field_of(mesh, "length", "length(v)"));
    CellSet half{"half", {}};
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        Vec3 middle(0.0);
        for (const Index p : mesh.cells[c]) middle += mesh.points[p] / 8.0;
        if (middle.x > 0) half.cells.push_back(c);
    }
    const Patch hull = subvol::hull_of(mesh, half);
    const Shells sides = patch_shells(mesh, std::vector{hull});
    const Shells limit = limit_sides(mesh, sides, {.scheme = {GetParam()}, .levels = 1});
    ASSERT_EQ(limit.quads.size(), 4 * hull.sides.size());
    ASSERT_EQ(limit.attributes.size(), mesh.attributes.size() + 1);
    std::vector<LimitQuery> places;
    std::vector<Index> points;
    for (std::size_t q = 0; q < hull.sides.size(); ++q) {
        constexpr std::array<std::array<double, 2>, 4> kCorners{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
        const auto add = [&](double s, double t, Index point) {
            const auto at = place_on_side(hull.sides[q].side, s, t);
            places.push_back({hull.sides[q].cell, {at[0], at[1], at[2]}});
            points.push_back(point);
        };
        for (std::size_t k = 0; k < 4; ++k) add(kCorners[k][0], kCorners[k][1], limit.quads[4 * q + k][0]);
        add(.5, .5, limit.quads[4 * q][2]);
    }
    const LimitSamples expected = evaluate_limit(mesh, places, {.scheme = {GetParam()}, .tolerance = 1e-9});
    for (std::size_t i = 0; i < places.size(); ++i) {
        // Beside extraordinary edges the evaluator refines up to its last level, which leaves 3e-8; elsewhere there are
        // roundings.
        constexpr double kLastLevel = 1e-7;
        EXPECT_LE(glm::distance(limit.points[points[i]], expected.positions[i]), kLastLevel);
        for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
            const auto channels = static_cast<std::size_t>(mesh.attributes[a].channels);
            for (std::size_t c = 0; c < channels; ++c) {
                EXPECT_NEAR(limit.attributes[a].values[points[i] * channels + c],
                            expected.attributes[a].values[i * channels + c], kLastLevel)
                    << mesh.attributes[a].name;
            }
        }
        EXPECT_EQ(limit.attributes.back().values[points[i]], 1) << "the number of the patch";
    }
}

TEST_P(ShellsOfEveryScheme, OneLevelAfterTheOtherIsBothAtOnce) {
    const auto& [mesh, shells] = make_bracket();
    const RefineOptions one{.scheme = {GetParam()}, .levels = 1}, two{.scheme = {GetParam()}, .levels = 2};
    expect_near(refine_shells(refine(mesh, one), refine_shells(mesh, shells, one), one), refine_shells(mesh, shells, two),
                kRounding);
}

TEST_P(ShellsOfEveryScheme, CommuteWithAffineMaps) {
    const auto& [mesh, shells] = make_bracket();
    const auto map = [](const Vec3& p) { return Vec3(2 * p.x - p.y + 1, .5 * p.y + p.z, p.z - .3 * p.x - 2); };
    const RefineOptions options{.scheme = {GetParam()}, .levels = 2};
    HexMesh moved_mesh = mesh;
    Shells moved = shells, expected = limit_shells(mesh, shells, options);
    for (auto* points : {&moved_mesh.points, &moved.points, &expected.points}) {
        for (Vec3& p : *points) p = map(p);
    }
    expect_near(limit_shells(moved_mesh, moved, options), expected, 1e-12);
}

TEST_P(ShellsOfEveryScheme, AKinkedCrossingIsHeldTogetherByItsCrease) {
    // Four half planes about a bent line, a bundle: the line is a curve of its own.
    std::vector<Vec3> points;
    for (int side = -1; side < 4; ++side) {
        for (int i = 0; i < 5; ++i) {
            const Vec3 on_line(i, .1 * i * i, .2 * i);
            const double angle = 1.4 * side;
            points.push_back(side < 0 ? on_line : on_line + Vec3(0, std::cos(angle), std::sin(angle)));
        }
    }
    Quads quads;
    for (Index side = 1; side < 5; ++side) {
        for (Index i = 0; i < 4; ++i) quads.push_back({i, i + 1, 5 * side + i + 1, 5 * side + i});
    }
    const HexMesh none = test::only_points(points);
    const RefineOptions options{.scheme = {GetParam()}, .levels = 2};
    const Shells bundle = limit_shells(none, make_shells(none, quads, {}), options);
    const HexMesh alone = test::only_points({points.begin(), points.begin() + 5});
    const Shells curve = limit_shells(alone, make_shells(alone, {}, Lines{{0, 1}, {1, 2}, {2, 3}, {3, 4}}), options);
    for (const Vec3& p : curve.points) {
        double nearest = 1;
        for (const Vec3& q : bundle.points) nearest = std::min(nearest, glm::distance(p, q));
        EXPECT_LE(nearest, kRounding);
    }
}

TEST(Shells, AClosedOneHasTheLimitOfCatmullClark) {
    const HexMesh cube = test::make_box(1, 1, 1);
    Quads quads;
    for (const auto& face : kCellFaces) {
        quads.push_back({});
        for (std::size_t k = 0; k < 4; ++k) quads.back()[k] = cube.cells[0][static_cast<std::size_t>(face[k])];
    }
    HexMesh points = test::only_points(cube.points);
    const Shells shells = make_shells(points, quads, {});
    // The mask (n v + 4 mean of edges + mean of faces)/(n + 5) with n = 3, of the corner at the origin: along each axis
    // (3·0 + 4·1/3 + 2/3)/8 = 1/4.
    for (const int levels : {0, 1, 2, 4}) {
        const Shells limit = limit_shells(points, shells, {.scheme = {Scheme::CatmullClark}, .levels = levels});
        EXPECT_LE(glm::distance(limit.points[0], Vec3(.25)), kRounding);
        EXPECT_LE(glm::distance(limit.points[7], Vec3(.75)), kRounding);
    }
}

TEST(Shells, ACurveIsACubicSpline) {
    const HexMesh points = test::only_points({{0, 0, 0}, {1, 2, 0}, {2, -1, 1}, {3, 0, 2}, {5, 1, 0}});
    const Shells curve = make_shells(points, {}, Lines{{0, 1}, {1, 2}, {2, 3}, {3, 4}});
    for (const Scheme scheme : {Scheme::CatmullClark, Scheme::Bsxw}) {
        for (const int levels : {0, 1, 3}) {
            const Shells limit = limit_shells(points, curve, {.scheme = {scheme}, .levels = levels});
            EXPECT_EQ(limit.points[0], points.points[0]);  // ends stay
            for (std::size_t i = 1; i < 4; ++i) {
                const Vec3 expected = (points.points[i - 1] + 4.0 * points.points[i] + points.points[i + 1]) / 6.0;
                EXPECT_LE(glm::distance(limit.points[i], expected), kRounding);
            }
        }
        // The middle of a segment of a cubic B-spline: (1, 23, 23, 1)/48.
        const Shells once = limit_shells(points, curve, {.scheme = {scheme}, .levels = 1});
        const auto& p = points.points;
        EXPECT_LE(glm::distance(once.points[5 + 1], (p[0] + 23.0 * p[1] + 23.0 * p[2] + p[3]) / 48.0), kRounding);
    }
}

TEST(Shells, FourPointCurvesReproduceCubicsInsideAndQuadraticsToTheEnds) {
    for (const int degree : {2, 3}) {
        std::vector<Vec3> on_curve;
        Lines lines;
        for (int i = 0; i < 8; ++i) {
            on_curve.emplace_back(i, std::pow(i, degree), 0);
            if (i > 0) lines.push_back({static_cast<Index>(i - 1), static_cast<Index>(i)});
        }
        const HexMesh points = test::only_points(on_curve);
        const Shells fine = refine_shells(points, make_shells(points, {}, lines), {.levels = 1});
        for (const Vec3& p : fine.points) {
            const bool at_end = p.x < 1 || p.x > 6;
            if (degree == 3 && at_end) continue;
            EXPECT_NEAR(p.y, std::pow(p.x, degree), 1e-11);  // values up to 343
        }
    }
}

TEST(Shells, CornersOfAFreeSheetStayAndItsRimIsACurveOfItsOwn) {
    HexMesh points = test::only_points({});
    Quads quads;
    const auto id = [](Index i, Index j) { return i + 4 * j; };
    for (Index j = 0; j < 4; ++j) {
        for (Index i = 0; i < 4; ++i) points.points.emplace_back(i, j, .3 * i * j - .1 * j * j);
    }
    for (Index j = 0; j < 3; ++j) {
        for (Index i = 0; i < 3; ++i) quads.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)});
    }
    const RefineOptions options{.scheme = {Scheme::CatmullClark}, .levels = 2};
    const Shells limit = limit_shells(points, make_shells(points, quads, {}), options);
    for (const Index corner : {id(0, 0), id(3, 0), id(0, 3), id(3, 3)}) {
        EXPECT_EQ(limit.points[corner], points.points[corner]);
    }
    const Vec3 expected = (points.points[id(0, 0)] + 4.0 * points.points[id(1, 0)] + points.points[id(2, 0)]) / 6.0;
    EXPECT_LE(glm::distance(limit.points[id(1, 0)], expected), kRounding);
    const ShellReport report = inspect(make_shells(points, quads, {}));
    EXPECT_EQ(report.free_edges, 12u);
    EXPECT_EQ(report.nonmanifold_edges, 0u);
}

TEST(Shells, TwoThatTouchInAPointAreHeldThere) {
    HexMesh points = test::only_points({});
    Quads quads;
    const auto add = [&](const Vec3& u, const Vec3& v) {  // four quads about the origin, which is point 0
        std::array<Index, 9> at{};
        for (int j = -1; j <= 1; ++j) {
            for (int i = -1; i <= 1; ++i) {
                const auto n = static_cast<std::size_t>(3 * (j + 1) + i + 1);
                if (i == 0 && j == 0 && !points.points.empty() && !quads.empty()) continue;
                at[n] = static_cast<Index>(points.points.size());
                points.points.push_back(double(i) * u + double(j) * v);
            }
        }
        const Index center = quads.empty() ? at[4] : quads[0][2];
        at[4] = center;
        for (const auto& [a, b, c, d] : {std::array<std::size_t, 4>{0, 1, 4, 3}, {1, 2, 5, 4}, {3, 4, 7, 6}, {4, 5, 8, 7}}) {
            quads.push_back({at[a], at[b], at[c], at[d]});
        }
    };
    add({1, 0, 0}, {0, 1, 0});
    add({0, 1, 1}, {1, 0, 2});
    points.points[quads[0][2]] = Vec3(0, 0, .5);
    const Shells limit = limit_shells(points, make_shells(points, quads, {}), {.scheme = {Scheme::CatmullClark}, .levels = 2});
    double nearest = 1;
    for (const Vec3& p : limit.points) nearest = std::min(nearest, glm::distance(p, Vec3(0, 0, .5)));
    EXPECT_EQ(nearest, 0);
}

TEST(Shells, LeaveTheTrianglesAndTubesThatArePromised) {
    const Shells shells = make_bracket().shells;
    const ShellSurface plain = shell_surface(shells, 0), tubes = shell_surface(shells, .05);
    EXPECT_EQ(plain.surface.triangles.size(), 2 * shells.quads.size());
    EXPECT_EQ(tubes.shell_triangles, plain.surface.triangles.size());
    ASSERT_EQ(tubes.sources.size(), tubes.surface.points.size());
    for (std::size_t p = shells.points.size(); p < tubes.sources.size(); ++p) {
        EXPECT_NEAR(glm::distance(tubes.surface.points[p], shells.points[tubes.sources[p]]), .05, 1e-14);
    }
    test::expect_error(ErrorCode::InvalidInput, "radius", [&] { (void)shell_surface(shells, -1); });
}

TEST(Shells, RefuseWhatIsMalformed) {
    const Bracket bracket = make_bracket();
    const HexMesh& mesh = bracket.mesh;
    const Shells& shells = bracket.shells;
    const auto refuses = [&](const std::string& part, const auto& change) {
        Shells bad = shells;
        change(bad);
        test::expect_error(ErrorCode::InvalidInput, part, [&] { (void)refine_shells(mesh, bad); });
    };
    refuses("there is no point 99", [](Shells& s) { s.quads[0][2] = 99; });
    refuses("twice", [](Shells& s) { s.lines[0][0] = s.lines[0][1]; });
    refuses("not finite", [](Shells& s) { s.points[3].y = std::numeric_limits<double>::quiet_NaN(); });
    refuses("corners of cells", [](Shells& s) { s.solid.pop_back(); });
    refuses("there is no corner", [](Shells& s) { s.solid[0] = {24, 0}; });
    refuses("there is no corner", [](Shells& s) { s.solid[0] = {0, 8}; });
    refuses("attributes", [](Shells& s) { s.attributes.clear(); });
    refuses("attributes", [](Shells& s) { s.attributes[0].values[0] = std::numeric_limits<double>::infinity(); });
    test::expect_error(ErrorCode::InvalidInput, "levels", [&] { (void)refine_shells(mesh, shells, {.levels = 11}); });
    test::expect_error(ErrorCode::InvalidInput, "there is no point", [&] {
        (void)make_shells(mesh, Quads{{0, 1, 2, 1000}}, {});
    });
}

}  // namespace shells_test
}  // namespace subvol
