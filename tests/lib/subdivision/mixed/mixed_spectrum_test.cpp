// SPDX-License-Identifier: Apache-2.0
// The eigenvalues of the refinement of the cells around a point.
#include <Eigen/Eigenvalues>

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <string>

#include "mixed_meshes.h"
#include "subvol/detail/mixed_levels.h"

namespace subvol {
namespace mixed_spectrum_test {

using namespace test;

std::vector<double> spectrum(const MixedMesh& mesh, TetScheme scheme, Index point) {
    const detail::StarMatrix star = detail::star_matrix(mesh, scheme, point);
    const auto n = static_cast<Eigen::Index>(star.points.size());
    const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> matrix(star.weights.data(),
                                                                                                          n, n);
    std::vector<double> values;
    const Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix, false);
    for (const auto& value : solver.eigenvalues()) values.push_back(std::abs(value));
    std::sort(values.rbegin(), values.rend());
    return values;
}

/// Tetrahedra from point 0 to each triangle of a closed surface: the link of the point.
MixedMesh star_of(const std::vector<std::array<Index, 3>>& link) {
    MixedMesh mesh;
    Index most = 0;
    for (const auto& [a, b, c] : link) {
        mesh.tets.push_back({0, a + 1, b + 1, c + 1});
        most = std::max({most, a + 1, b + 1, c + 1});
    }
    for (Index p = 0; p <= most; ++p) mesh.points.emplace_back(p, p * p, 1.0 / (1 + p));
    return mesh;
}

std::vector<std::array<Index, 3>> bipyramid(Index n) {
    std::vector<std::array<Index, 3>> link;
    for (Index i = 0; i < n; ++i) {
        link.push_back({n, i, (i + 1) % n});
        link.push_back({n + 1, (i + 1) % n, i});
    }
    return link;
}

std::vector<std::array<Index, 3>> icosahedron() {
    std::vector<std::array<Index, 3>> link;
    for (Index i = 0; i < 5; ++i) {
        const Index j = (i + 1) % 5;
        link.push_back({10, i, j});
        link.push_back({11, 5 + j, 5 + i});
        link.push_back({i, 5 + i, j});
        link.push_back({5 + i, 5 + j, j});
    }
    return link;
}

Index nearest(const MixedMesh& mesh, const Vec3& x) {
    const auto closer = [&](const Vec3& a, const Vec3& b) { return glm::distance(a, x) < glm::distance(b, x); };
    return static_cast<Index>(std::min_element(mesh.points.begin(), mesh.points.end(), closer) - mesh.points.begin());
}

/// The middle of an inner edge with n tetrahedra, after one refinement.
MixedMesh ring_of(Index n) {
    MixedMesh ring;
    ring.points.assign(n + 2, Vec3(0));
    for (Index i = 0; i < n; ++i) {
        ring.points[i] = Vec3(std::cos(6.283185307 * i / n), std::sin(6.283185307 * i / n), 0);
        ring.tets.push_back({n, n + 1, i, (i + 1) % n});
    }
    ring.points[n] = Vec3(0, 0, -1);
    ring.points[n + 1] = Vec3(0, 0, 1);
    return refine(ring, {.scheme = TetScheme::Linear, .levels = 1});
}

/// The greatest eigenvalues, in absolute value: 1, then these four. The figures of docs/schemes.md.
using Four = std::array<double, 4>;

void expect_spectrum(const MixedMesh& mesh, TetScheme scheme, const Vec3& at, const Four& expected, const std::string& where) {
    const auto found = spectrum(mesh, scheme, nearest(mesh, at));
    ASSERT_GT(found.size(), 4u) << where;
    EXPECT_NEAR(found[0], 1, 1e-9) << where;
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(found[k + 1], expected[k], 6e-5) << where << ", eigenvalue " << k + 1;
}

constexpr Four kRegular{.5, .5, .5, .25};

TEST(MixedSpectrum, IsThatOfSplinesWhereTheMeshIsRegular) {
    const MixedMesh honeycomb = refine(make_octahedron(), {.scheme = TetScheme::Linear, .levels = 2});
    const MixedMesh lattice = make_kuhn_box(4);
    for (const Vec3& at : {Vec3(0), Vec3(.5, 0, 0)}) {
        expect_spectrum(honeycomb, TetScheme::Tetoct, at, kRegular, "tetoct");
        expect_spectrum(honeycomb, TetScheme::Boxspline, at, kRegular, "boxspline");
    }
    expect_spectrum(lattice, TetScheme::Boxspline, {2, 2, 2}, kRegular, "the lattice");
    expect_spectrum(lattice, TetScheme::Boxspline, {2, 2, 0}, kRegular, "its boundary");
    // A control mesh that is this lattice is not regular for tetoct: a point has 24 tetrahedra and no octahedron.
    expect_spectrum(lattice, TetScheme::Tetoct, {2, 2, 2}, {.5, .5, .5, .3056}, "tetoct in the lattice");
}

// The shares of the kinds of cells make a point on a seam between two kinds regular.
TEST(MixedSpectrum, SeamsBetweenKindsOfCellsAreRegular) {
    const MixedMesh mixed = refine(make_mixed(), {.scheme = TetScheme::Linear, .levels = 2});
    const auto expect_regular = [&](const Vec3& at, const std::string& where) {
        expect_spectrum(mixed, TetScheme::Tetoct, at, kRegular, where);
    };
    expect_regular({.5, .5, .5}, "hexahedra");
    expect_regular({1.5, .5, .5}, "prisms");
    expect_regular({.5, .5, 1}, "hexahedra and pyramids");
    expect_regular({1, .5, .5}, "hexahedra and prisms");
    expect_regular({1.25, .5, 1}, "prisms and tetrahedra");
    expect_regular({.75, .625, 1.2}, "pyramids and tetrahedra");
}

TEST(MixedSpectrum, HasKnownValuesAroundIrregularEdges) {
    const std::array<Four, 6> tetoct{{{.5, .3170, .3170, .2874},
                                      {.5, .4281, .4281, .2874},
                                      {.5, .4948, .4948, .2874},
                                      {.5356, .5356, .5, .3170},
                                      {.5619, .5619, .5, .3794},
                                      {.5797, .5797, .5, .4281}}};
    const std::array<Four, 6> boxspline{{{.5, .4101, .4101, .2639},
                                         {.5, .5, .5, .25},
                                         {.55, .55, .5, .3401},
                                         {.5797, .5797, .5, .4101},
                                         {.5985, .5985, .5, .4619},
                                         {.6111, .6111, .5, .5}}};
    for (Index n = 3; n <= 8; ++n) {
        const std::string where = "an edge with " + std::to_string(n) + " tetrahedra";
        expect_spectrum(ring_of(n), TetScheme::Tetoct, Vec3(0), tetoct[n - 3], where);
        expect_spectrum(ring_of(n), TetScheme::Boxspline, Vec3(0), boxspline[n - 3], where);
    }
}

// Points with few tetrahedra are drawn in fast: the three eigenvalues of the characteristic map are small.
TEST(MixedSpectrum, HasKnownValuesAtIrregularPoints) {
    const auto at_zero = [](const std::vector<std::array<Index, 3>>& link, TetScheme scheme, const Four& expected) {
        const auto found = spectrum(star_of(link), scheme, 0);
        for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(found[k + 1], expected[k], 6e-5) << link.size() << " tetrahedra";
    };
    const std::vector<std::array<Index, 3>> tetrahedron{{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    at_zero(tetrahedron, TetScheme::Tetoct, {.1759, .1759, .1759, .1632});
    at_zero(bipyramid(4), TetScheme::Tetoct, {.3056, .3056, .3056, .1632});
    at_zero(bipyramid(6), TetScheme::Tetoct, {.4028, .4028, .3056, .2083});
    at_zero(icosahedron(), TetScheme::Tetoct, {.4795, .4795, .4795, .2278});
    at_zero(tetrahedron, TetScheme::Boxspline, {.2266, .2266, .1744, .1744});
    at_zero(bipyramid(4), TetScheme::Boxspline, {.3250, .3250, .25, .25});
    at_zero(bipyramid(6), TetScheme::Boxspline, {.4125, .4125, .2658, .2375});
    at_zero(icosahedron(), TetScheme::Boxspline, {.4890, .4890, .4585, .2608});
}

}  // namespace mixed_spectrum_test
}  // namespace subvol
