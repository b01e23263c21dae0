// SPDX-License-Identifier: Apache-2.0
// The spectra of the schemes' local subdivision matrices, from our stencils, against those of independent prototypes.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <functional>
#include <map>
#include <numeric>

#include "lib/stencil_rows.h"
#include "subvol/refine.h"

namespace subvol {
namespace eigenvalue_test {

/// The neighbourhood of a point: each triangle is a hexahedron at the point, its vertices are the directions of the
/// hexahedron's edges. A closed surface gives an interior point, one with a rim a boundary point.
using Link = std::vector<std::array<int, 3>>;

/// A ring around a middle axis: `count` quads between the directions first, first+1, …; closed or not.
Link turn(int axis, int first, int count, bool closed) {
    Link link;
    for (int i = 0; i < count; ++i) link.push_back({axis, first + i, first + (closed ? (i + 1) % count : i + 1)});
    return link;
}

Link both(const Link& a, const Link& b) {
    Link link = a;
    link.insert(link.end(), b.begin(), b.end());
    return link;
}

/// Replaces the last triangle by three that meet in a new vertex.
Link stacked(Link link, int vertex) {
    const auto [a, b, c] = link.back();
    link.pop_back();
    return both(link, {{a, b, vertex}, {b, c, vertex}, {c, a, vertex}});
}

Link interior_edge(int valence) {
    return both(turn(0, 2, valence, true), turn(1, 2, valence, true));
}
Link boundary_vertex(int valence) {
    return turn(0, 1, valence, true);
}
Link inside_reentrant_edge(int hexes) {
    return both(turn(0, 2, hexes, false), turn(1, 2, hexes, false));
}
Link end_of_reentrant_edge(int hexes) {
    return turn(0, 1, hexes, false);
}
Link tetrahedron() {
    return {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
}
Link octahedron() {
    return interior_edge(4);
}

Link icosahedron() {
    Link link = both(turn(0, 2, 5, true), turn(1, 7, 5, true));
    for (int i = 0; i < 5; ++i) {
        const int j = (i + 1) % 5;
        link.push_back({2 + i, 2 + j, 7 + i});
        link.push_back({7 + i, 7 + j, 2 + j});
    }
    return link;
}

/// Where a lattice point is: (direction, steps) for the up to three directions along which it is away from the middle.
using Place = std::map<int, int>;

/// The neighbourhood with `layers` layers of hexahedra, and the places of its points.
struct Neighbourhood {
    HexMesh mesh;
    std::vector<Place> places;
};

Neighbourhood make_neighbourhood(const Link& link, int layers) {
    Neighbourhood result;
    std::map<Place, Index> ids;
    const auto point = [&](const std::array<int, 3>& directions, const std::array<int, 3>& steps) {
        Place place;
        for (std::size_t a = 0; a < 3; ++a) {
            if (steps[a] > 0) place[directions[a]] = steps[a];
        }
        const auto [found, is_new] = ids.try_emplace(place, static_cast<Index>(result.places.size()));
        if (is_new) result.places.push_back(place);
        return found->second;
    };
    for (const auto& triangle : link) {
        for (int cell = 0; cell < layers * layers * layers; ++cell) {
            const int i = cell % layers, j = cell / layers % layers, k = cell / (layers * layers);
            const auto at = [&](int u, int v, int w) { return point(triangle, {i + u, j + v, k + w}); };
            result.mesh.cells.push_back({at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0),  //
                                         at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1)});
        }
    }
    result.mesh.points.resize(result.places.size());  // the rules do not use positions
    return result;
}

/// The places of the child's points in half steps, in the numbering of `refine`.
std::vector<Place> child_places(const Topology& topology, const std::vector<Place>& parents) {
    std::vector<Place> places;
    const auto mean_of = [&](std::span<const Index> points) {
        Place place;
        for (const Index p : points) {
            for (const auto& [direction, steps] : parents[p]) place[direction] += steps;
        }
        for (auto& [direction, steps] : place) steps = 2 * steps / static_cast<int>(points.size());
        return place;
    };
    for (Index p = 0; p < topology.point_count; ++p) places.push_back(mean_of(std::array{p}));
    for (const auto& edge : topology.edges) places.push_back(mean_of(edge));
    for (const auto& face : topology.faces) places.push_back(mean_of(face));
    const std::size_t cells = places.size();
    places.resize(cells + topology.cells.size());
    for (std::size_t c = 0; c < topology.cells.size(); ++c) {
        places[cells + topology.cell_ordinal[c]] = mean_of(topology.cells[c]);
    }
    return places;
}

/// The eigenvalues of the scheme on the first `layers` layers, by falling modulus.
std::vector<std::complex<double>> spectrum(const Link& link, Scheme scheme, int layers) {
    const Neighbourhood around = make_neighbourhood(link, layers + 1);  // one more, so that its end has no effect on the rows
    const auto inside = [&](const Place& place) {
        return std::all_of(place.begin(), place.end(), [&](const auto& step) { return step.second <= layers; });
    };
    std::map<Place, Eigen::Index> number;
    for (const Place& place : around.places) {
        if (inside(place)) number.emplace(place, static_cast<Eigen::Index>(number.size()));
    }
    const Topology topology = build_topology(around.mesh);
    const auto rows = test::stencils(topology, {scheme});
    const auto places = child_places(topology, around.places);
    const auto size = static_cast<Eigen::Index>(number.size());
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
    Eigen::Index rows_found = 0;
    for (std::size_t child = 0; child < places.size(); ++child) {
        const auto row = number.find(places[child]);
        if (row == number.end()) continue;
        ++rows_found;
        for (const auto& [p, weight] : rows[child]) {
            const auto column = number.find(around.places[p]);
            EXPECT_NE(column, number.end()) << "the neighbourhood is not invariant";
            if (column != number.end()) matrix(row->second, column->second) += weight;
        }
    }
    EXPECT_EQ(rows_found, size);
    const Eigen::VectorXcd values = Eigen::EigenSolver<Eigen::MatrixXd>(matrix, false).eigenvalues();
    std::vector<std::complex<double>> sorted(values.begin(), values.end());
    std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return std::abs(a) > std::abs(b); });
    return sorted;
}

/// leading: the eigenvalues behind the 1, by falling modulus, as printed in the source
struct Case {
    const char* name;
    Scheme scheme;
    Link link;
    std::vector<double> leading;
    double tolerance = 5e-5;  // half a unit of the fourth decimal
};

void PrintTo(const Case& c, std::ostream* out) {
    *out << c.name;
}

class Eigenvalues : public testing::TestWithParam<Case> {};

TEST_P(Eigenvalues, AreThoseListed) {
    const auto& [name, scheme, link, leading, tolerance] = GetParam();
    // Two layers contain the supports of all three schemes; further layers add only small eigenvalues.
    const auto values = spectrum(link, scheme, 2);
    ASSERT_GT(values.size(), leading.size());
    EXPECT_NEAR(std::abs(values[0] - 1.0), 0, 1e-12) << "constants stay";
    for (std::size_t i = 0; i < leading.size(); ++i) {
        EXPECT_NEAR(std::abs(values[i + 1]), leading[i], tolerance) << name << ", eigenvalue " << i + 1;
    }
    std::string measured;
    for (std::size_t i = 1; i < std::min<std::size_t>(6, values.size()); ++i) {
        measured += (i > 1 ? " " : "") + std::to_string(std::abs(values[i]));
    }
    RecordProperty("measured", measured);
}

INSTANTIATE_TEST_SUITE_P(
    Mcq, Eigenvalues,
    testing::Values(
        Case{"Regular", Scheme::Mcq, octahedron(), {.5, .5, .5, .25}},
        Case{"Edge3", Scheme::Mcq, interior_edge(3), {.5, .4881, .4881, .25}},
        Case{"Edge5", Scheme::Mcq, interior_edge(5), {.5, .4919, .4919, .3791}},
        Case{"Edge6", Scheme::Mcq, interior_edge(6), {.5, .4826, .4826, .4183}},
        Case{"Edge7", Scheme::Mcq, interior_edge(7), {.5, .4752, .4752, .4273}},
        Case{"Edge8", Scheme::Mcq, interior_edge(8), {.5, .4697, .4697, .4239}},
        Case{"Edge10", Scheme::Mcq, interior_edge(10), {.5, .4624, .4624, .4262}},
        Case{"VertexTetrahedron", Scheme::Mcq, tetrahedron(), {.4899, .4899, .4899, .25}},
        Case{"VertexOctahedronPlus1", Scheme::Mcq, stacked(octahedron(), 6), {.4915, .4915, .4873, .3910}},
        Case{"VertexTetrahedronPlus2", Scheme::Mcq, stacked(stacked(tetrahedron(), 4), 5), {.4912, .4869, .4818, .3712}},
        Case{"VertexIcosahedron", Scheme::Mcq, icosahedron(), {.4710, .4710, .4710, .4437}},
        Case{"BoundaryPlane", Scheme::Mcq, boundary_vertex(4), {.5, .5, .5, .25}},
        Case{"Crease", Scheme::Mcq, end_of_reentrant_edge(2), {.5, .5, .5, .25}},
        Case{"BoxCorner", Scheme::Mcq, end_of_reentrant_edge(1), {.5, .5, .5, .25}},
        Case{"Boundary3", Scheme::Mcq, boundary_vertex(3), {.5, .4881, .4881, .25}},
        Case{"Boundary5", Scheme::Mcq, boundary_vertex(5), {.5, .4919, .4919, .379}, 5e-4},
        Case{"Boundary6", Scheme::Mcq, boundary_vertex(6), {.5, .4826, .4826, .418}, 5e-4},
        Case{"EndOfReentrantEdge", Scheme::Mcq, end_of_reentrant_edge(3), {.5, .5, .4902, .4731}},
        Case{"InsideReentrantEdge3", Scheme::Mcq, inside_reentrant_edge(3), {.5, .5, .4937, .4740}},
        Case{"InsideReentrantEdge4", Scheme::Mcq, inside_reentrant_edge(4), {.5, .5, .5, .4725}},
        Case{"InsideReentrantEdge5", Scheme::Mcq, inside_reentrant_edge(5), {.50005}, 5e-6},
        Case{"InsideReentrantEdge7", Scheme::Mcq, inside_reentrant_edge(7), {.5011}}),
    [](const auto& each) { return each.param.name; });

// On the boundary the eigenvalues are those of the surface scheme, which are the values of an irregular edge; the third
// direction adds 1/2.
INSTANTIATE_TEST_SUITE_P(
    CatmullClark, Eigenvalues,
    testing::Values(Case{"Regular", Scheme::CatmullClark, octahedron(), {.5, .5, .5, .25}},
                    Case{"Edge3", Scheme::CatmullClark, interior_edge(3), {.5, .4101, .4101}},
                    Case{"Edge5", Scheme::CatmullClark, interior_edge(5), {.55, .55, .5}, 5e-4},
                    Case{"Edge6", Scheme::CatmullClark, interior_edge(6), {.5797, .5797, .5}},
                    Case{"BoundaryPlane", Scheme::CatmullClark, boundary_vertex(4), {.5, .5, .5, .25}},
                    Case{"Crease", Scheme::CatmullClark, end_of_reentrant_edge(2), {.5, .5, .5, .25}},
                    Case{"BoxCorner", Scheme::CatmullClark, end_of_reentrant_edge(1), {.5, .5, .5, .25}},
                    Case{"Boundary3", Scheme::CatmullClark, boundary_vertex(3), {.5, .4101, .4101}},
                    Case{"Boundary5", Scheme::CatmullClark, boundary_vertex(5), {.55, .55, .5}, 5e-4},
                    Case{"Boundary6", Scheme::CatmullClark, boundary_vertex(6), {.5797, .5797, .5}},
                    Case{"VertexTetrahedron", Scheme::CatmullClark, tetrahedron(), {.3476, .3476, .3476}},
                    Case{"VertexIcosahedron", Scheme::CatmullClark, icosahedron(), {.615, .615, .615}, 5e-4}),
    [](const auto& each) { return each.param.name; });

INSTANTIATE_TEST_SUITE_P(Bsxw, Eigenvalues,
                         testing::Values(Case{"Regular", Scheme::Bsxw, octahedron(), {.5, .5, .5, .25}},
                                         Case{"Edge3", Scheme::Bsxw, interior_edge(3), {.5, .4101, .4101}},
                                         Case{"Edge5", Scheme::Bsxw, interior_edge(5), {.55, .55, .5}, 5e-4},
                                         Case{"Edge6", Scheme::Bsxw, interior_edge(6), {.5797, .5797, .5}},
                                         Case{"BoundaryPlane", Scheme::Bsxw, boundary_vertex(4), {.5, .5, .5, .25}},
                                         Case{"Crease", Scheme::Bsxw, end_of_reentrant_edge(2), {.5, .5, .5, .25}},
                                         Case{"BoxCorner", Scheme::Bsxw, end_of_reentrant_edge(1), {.5, .5, .5, .25}},
                                         Case{"Boundary3", Scheme::Bsxw, boundary_vertex(3), {.5, .4101, .4101}},
                                         Case{"Boundary5", Scheme::Bsxw, boundary_vertex(5), {.55, .55, .5}, 5e-4},
                                         Case{"Boundary6", Scheme::Bsxw, boundary_vertex(6), {.5797, .5797, .5}},
                                         Case{"VertexTetrahedron", Scheme::Bsxw, tetrahedron(), {.3632, .3632, .3632}},
                                         Case{"VertexIcosahedron", Scheme::Bsxw, icosahedron(), {.629, .629, .629}, 5e-4}),
                         [](const auto& each) { return each.param.name; });

// The eigenvalue 1/4 of the quadratics is defective: rounding appears in it as its cube root.
TEST(Eigenvalues, MoreLayersAddOnlySmallOnes) {
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw}) {
        const auto two = spectrum(tetrahedron(), scheme, 2), three = spectrum(tetrahedron(), scheme, 3);
        for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(std::abs(two[i]), std::abs(three[i]), 5e-5) << i;
    }
}

}  // namespace eigenvalue_test
}  // namespace subvol
