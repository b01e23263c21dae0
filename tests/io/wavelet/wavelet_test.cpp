// SPDX-License-Identifier: Apache-2.0
#include "subvol/wavelet.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <glm/mat3x3.hpp>
#include <random>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/model.h"
#include "subvol/refine.h"

namespace subvol {
namespace wavelet_test {

using test::expect_error;

struct NamedMesh {
    std::string name;
    HexMesh mesh;
};

/// Regular, irregular, with tags, with a non-manifold point.
std::vector<NamedMesh> meshes() {
    HexMesh creased = test::make_box(2, 2, 2);
    creased.creases = {{1, 4}, {4, 7}};  // across the bottom
    HexMesh sharp = test::irregular();
    const Topology topology = build_topology(sharp);
    for (std::size_t f = 0; f < topology.faces.size(); ++f) {
        if (!topology.face_on_hull(static_cast<Index>(f))) {
            sharp.sharp_faces.push_back(topology.faces[f]);
            break;
        }
    }
    HexMesh touching = test::make_box(1, 1, 1);  // two cells with one point in common
    for (std::size_t k = 1; k < 8; ++k) touching.points.push_back(touching.points[7] + touching.points[k]);
    touching.cells.push_back({7, 8, 10, 9, 11, 12, 14, 13});
    return {{"box", test::make_box(3, 2, 4)},
            {"nested cubes", test::irregular()},
            {"one cell", test::make_box(1, 1, 1)},
            {"creases", creased},
            {"a sharp face", sharp},
            {"ball", make_model("ball", 2)},
            {"pawn", make_model("pawn", 8)},
            {"touching", touching}};
}

const std::vector<Scheme> kSchemes{Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw, Scheme::Linear};

std::vector<double> random_values(std::size_t count, unsigned seed = 5) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> value(-1, 1);
    std::vector<double> values(count);
    for (double& v : values) v = value(random);
    return values;
}

/// Where three cells meet at an edge, or three faces at a point of the boundary, Catmull-Clark's rule cannot be turned round.
bool has_threes(const HexMesh& mesh) {
    const Topology topology = build_topology(mesh);
    for (std::size_t e = 0; e < topology.edges.size(); ++e) {
        if (!topology.edge_on_boundary[e] && topology.edge_cells[e].size() == 3) return true;
    }
    return false;
}

double largest(std::span<const double> values) {
    double most = 0;
    for (const double v : values) most = std::max(most, std::abs(v));
    return most;
}

double largest_difference(std::span<const double> a, std::span<const double> b) {
    EXPECT_EQ(a.size(), b.size());
    return difference(a, b, 1).max;
}

std::vector<double> flat(const std::vector<Vec3>& points) {
    std::vector<double> values;
    for (const Vec3& p : points) values.insert(values.end(), {p.x, p.y, p.z});
    return values;
}

template <class Test>
void for_all(const Test& test) {
    for (const auto& [name, mesh] : meshes()) {
        for (const Scheme scheme : kSchemes) {
            if (scheme == Scheme::CatmullClark && has_threes(mesh)) continue;
            SCOPED_TRACE(name + ", scheme " + std::to_string(static_cast<int>(scheme)));
            test(mesh, SchemeOptions{.kind = scheme});
        }
    }
}

TEST(Wavelet, PutsAnyValuesTogetherAgain) {
    for_all([](const HexMesh& mesh, const SchemeOptions& scheme) {
        const WaveletBasis basis = wavelet_basis(build_topology(mesh), {.scheme = scheme, .levels = 2});
        const std::vector<double> values = random_values(2 * basis.points());
        const WaveletField field = analyze(basis, values, 2);
        // Each level of a scheme that moves points multiplies rounding errors by up to 27, the sum of its weights.
        EXPECT_LT(largest_difference(synthesize(basis, field), values), 1e-10);
    });
}

TEST(Wavelet, ARefinedFieldHasNoDetails) {
    for_all([](const HexMesh& mesh, const SchemeOptions& scheme) {
        const WaveletBasis basis = wavelet_basis(build_topology(mesh), {.scheme = scheme, .levels = 2});
        const HexMesh fine = refine(mesh, {.scheme = scheme, .levels = 2});
        const WaveletField field = analyze(basis, flat(fine.points), 3);
        for (const auto& details : field.details) EXPECT_LT(largest(details), 1e-11);
        EXPECT_LT(largest_difference(field.coarse, flat(mesh.points)), 1e-10);  // so linear fields are what they were
    });
}

TEST(Wavelet, SynthesisWithoutDetailsIsRefinement) {
    const HexMesh mesh = test::irregular();
    const HexMesh fine = refine(mesh, {.levels = 2});
    const WaveletBasis basis = wavelet_basis(build_topology(mesh), {.levels = 2});
    WaveletField field = analyze(basis, flat(fine.points), 3);
    field.coarse = flat(mesh.points);
    for (auto& details : field.details) std::fill(details.begin(), details.end(), 0.0);
    EXPECT_EQ(synthesize(basis, field), flat(fine.points));
    EXPECT_EQ(basis.cells, fine.cells);
    field.details.pop_back();
    EXPECT_EQ(synthesize(basis, field), flat(refine(mesh, {.levels = 1}).points));
}

TEST(Wavelet, AnalysisKeepsTheMean) {
    for_all([](const HexMesh& mesh, const SchemeOptions& scheme) {
        const WaveletBasis basis = wavelet_basis(build_topology(mesh), {.scheme = scheme, .levels = 2});
        const std::vector<double> values = random_values(basis.points());
        const WaveletField field = analyze(basis, values);
        const auto mean = [](const std::vector<double>& of, const std::vector<double>& measure) {
            double sum = 0, all = 0;
            for (std::size_t i = 0; i < of.size(); ++i) sum += of[i] * measure[i];
            for (const double m : measure) all += m;
            return sum / all;
        };
        EXPECT_NEAR(mean(field.coarse, basis.measure), mean(values, basis.steps.back().measure), 1e-11);
    });
}

TEST(Wavelet, MeasuresAreThoseOfTheCells) {
    const HexMesh mesh = test::irregular();
    const WaveletBasis basis = wavelet_basis(build_topology(mesh), {.levels = 2});
    double sum = 0;
    for (const double m : basis.measure) sum += m;
    EXPECT_NEAR(sum, static_cast<double>(basis.cells.size()), 1e-9);  // basis functions add up to 1
}

/// Cubic B-splines: even − ¼ (left + right) = ½ control value along each axis.
TEST(Wavelet, TheRuleInAGridIsATensorProduct) {
    const Topology topology = build_topology(test::make_box(6, 6, 6));
    const Index middle = 3 + 7 * (3 + 7 * 3);
    for (const Scheme scheme : {Scheme::CatmullClark, Scheme::Bsxw}) {
        const WaveletStep step = wavelet_basis(topology, {.scheme = {.kind = scheme}}).steps.front();
        EXPECT_NEAR(step.own[middle], 1.0 / 8, 1e-14);
        EXPECT_EQ(step.star[middle].size(), 26u);
        for (std::size_t i = step.star.offsets[middle]; i < step.star.offsets[middle + 1]; ++i) {
            const std::size_t n = step.star.values[i], faces = topology.edges.size(), cells = faces + topology.faces.size();
            EXPECT_NEAR(step.even[i], n < faces ? 1.0 / 4 : n < cells ? -1.0 / 16 : 1.0 / 64, 1e-13);
        }
        EXPECT_NEAR(step.own[0], 1, 1e-14);                // a corner stays
        EXPECT_NEAR(step.own[3], 1.0 / 2, 1e-14);          // on an edge of the box
        EXPECT_NEAR(step.own[3 + 7 * 3], 1.0 / 4, 1e-14);  // on a side
    }
}

/// 1/8 inside, 1/4 on sides, 1/2 on creases, 1 at corners, around any number of cells.
TEST(Wavelet, TheRuleOfBsxwCanBeTurnedRoundOnEveryMesh) {
    for (const auto& [name, mesh] : meshes()) {
        const Topology topology = build_topology(mesh);
        const WaveletStep step = wavelet_basis(topology, {.scheme = {.kind = Scheme::Bsxw}}).steps.front();
        for (std::size_t p = 0; p < topology.point_count; ++p) {
            const double expected = topology.point_on_boundary[p] == 0 ? 1.0 / 8 : std::round(4 * step.own[p]) / 4;
            EXPECT_NEAR(step.own[p], expected, 1e-12) << name << ", point " << p;
            EXPECT_GE(step.own[p], .12);
        }
    }
}

TEST(Wavelet, ThatOfCatmullClarkCannotWhereThreeCellsMeet) {
    expect_error(ErrorCode::InvalidInput, "bsxw",
                 [] { (void)wavelet_basis(build_topology(test::irregular()), {.scheme = {.kind = Scheme::CatmullClark}}); });
}

TEST(Wavelet, QuadraticsOnABoxHaveNoDetailsOfMcq) {
    const HexMesh coarse = test::make_box(4, 3, 3);
    const WaveletBasis basis = wavelet_basis(build_topology(coarse), {.levels = 2});
    const HexMesh fine = refine(coarse, {.scheme = {.kind = Scheme::Linear}, .levels = 2});
    std::vector<double> values;
    for (const Vec3& p : fine.points) values.push_back(1 + p.x * p.y - 2 * p.z * p.z + .5 * p.x * p.z);
    const WaveletField field = analyze(basis, values);
    for (const auto& details : field.details) EXPECT_LT(largest(details), 1e-12);
}

TEST(Wavelet, DetailsFallWithTheLevel) {
    const HexMesh coarse = test::make_box(4, 4, 4);
    const WaveletBasis basis = wavelet_basis(build_topology(coarse), {.levels = 3});
    const HexMesh fine = refine(coarse, {.scheme = {.kind = Scheme::Linear}, .levels = 3});
    std::vector<double> values;
    for (const Vec3& p : fine.points) values.push_back(std::sin(p.x + .3 * p.y) * std::cos(.7 * p.z));
    const WaveletField field = analyze(basis, values);
    // Quadratics have no details, so that these fall with the third power of the cells' size at least: 8 a level.
    EXPECT_LT(largest(field.details[1]), largest(field.details[0]) / 5);
    EXPECT_LT(largest(field.details[2]), largest(field.details[1]) / 5);
}

TEST(Wavelet, TheSameBitsForAnyNumberOfThreads) {
    const HexMesh mesh = make_model("ball", 4);
    const auto run = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        const WaveletBasis basis = wavelet_basis(build_topology(mesh), {.scheme = {.kind = Scheme::Bsxw}, .levels = 2});
        WaveletField field = analyze(basis, random_values(basis.points()));
        drop_details(basis, field, .05);
        return std::pair(field.details, synthesize(basis, field));
    };
    EXPECT_EQ(run(1), run(4));
}

TEST(Wavelet, DropsDetailsWithinTheTolerance) {
    for (const Scheme scheme : {Scheme::Mcq, Scheme::Bsxw, Scheme::Linear}) {
        const HexMesh mesh = make_model("ball", 3);
        const WaveletBasis basis = wavelet_basis(build_topology(mesh), {.scheme = {.kind = scheme}, .levels = 2});
        const HexMesh fine = refine(mesh, {.levels = 2});
        std::vector<double> values;
        for (const Vec3& p : fine.points) values.push_back(BallField::density(p));
        std::size_t kept_before = 0;
        for (const double tolerance : {1e-1, 1e-2, 1e-3}) {
            WaveletField field = analyze(basis, values);
            const DroppedDetails dropped = drop_details(basis, field, tolerance);
            const WaveletError error = difference(synthesize(basis, field), values, 1);
            EXPECT_LE(error.rms, tolerance * (1 + 1e-9));
            EXPECT_NEAR(error.rms, dropped.error.rms, 1e-9);  // of a scheme that moves points analysis has rounding errors
            EXPECT_GE(error.max, error.rms);
            EXPECT_GE(dropped.kept, kept_before);
            kept_before = dropped.kept;
            EXPECT_EQ(dropped.details + basis.control_points, basis.points());
        }
        WaveletField field = analyze(basis, values);
        EXPECT_EQ(drop_details(basis, field, 1e6).kept, 0u);
    }
}

TEST(Wavelet, WholeNumbersWithinTheTolerance) {
    const HexMesh mesh = test::irregular();
    for (const Scheme scheme : {Scheme::Mcq, Scheme::Bsxw, Scheme::Linear}) {
        const WaveletBasis basis = wavelet_basis(build_topology(mesh), {.scheme = {.kind = scheme}, .levels = 2});
        const std::vector<double> values = random_values(3 * basis.points());
        for (const double tolerance : {.5, 1e-2, 1e-6}) {
            const QuantizedWavelets numbers = quantize_within(basis, values, 3, tolerance);
            const WaveletField field = restore(basis, numbers);
            EXPECT_LE(difference(synthesize(basis, field), values, 3).rms, tolerance);
            const QuantizedWavelets again = quantize(basis, field, numbers.step);
            EXPECT_EQ(again.coarse, numbers.coarse);  // numbers stay themselves
            EXPECT_EQ(again.details, numbers.details);
        }
    }
}

/// Moves the control points of a shape; details that are attached to it move as it does.
TEST(Wavelet, DetailsOfAShapeTurnWithIt) {
    for (const Scheme scheme : {Scheme::Mcq, Scheme::Bsxw}) {
        const HexMesh mesh = test::irregular();
        const WaveletBasis basis = wavelet_basis(build_topology(mesh), {.scheme = {.kind = scheme}, .levels = 2});
        HexMesh fine = refine(mesh, {.levels = 2});
        test::jitter(fine, .004, 3);
        const std::vector<double> places = flat(fine.points);
        WaveletField shape = analyze(basis, places, 3);
        turn_details_to_shape(basis, shape);
        WaveletField back = shape;
        turn_details_to_world(basis, back);
        EXPECT_LT(largest_difference(synthesize(basis, back), places), 1e-10);
        const double c = std::cos(1.1), s = std::sin(1.1);
        const auto motion = [&](const Vec3& p) { return Vec3(c * p.x - s * p.y + 2, s * p.x + c * p.y, p.z - 1); };
        for (std::size_t i = 0; i < shape.coarse.size(); i += 3) {
            const Vec3 p = motion({shape.coarse[i], shape.coarse[i + 1], shape.coarse[i + 2]});
            for (int a = 0; a < 3; ++a) shape.coarse[i + static_cast<std::size_t>(a)] = p[a];
        }
        turn_details_to_world(basis, shape);
        std::vector<Vec3> moved;
        for (const Vec3& p : fine.points) moved.push_back(motion(p));
        EXPECT_LT(largest_difference(synthesize(basis, shape), flat(moved)), 1e-10);
    }
}

TEST(Wavelet, AMovedControlValueMovesOnlyItsSurroundings) {
    const HexMesh mesh = test::make_box(8, 8, 8);
    const WaveletBasis basis = wavelet_basis(build_topology(mesh), {.levels = 1});
    const std::vector<double> values = random_values(basis.points());
    WaveletField field = analyze(basis, values);
    field.coarse[0] += 1;
    const std::vector<double> moved = synthesize(basis, field);
    const HexMesh fine = refine(mesh, {.scheme = {.kind = Scheme::Linear}});
    for (std::size_t p = 0; p < moved.size(); ++p) {
        const bool near = std::max({fine.points[p].x, fine.points[p].y, fine.points[p].z}) < 4;
        if (!near) {
            EXPECT_NEAR(moved[p], values[p], 1e-14);
        }
    }
    EXPECT_NEAR(moved[0], values[0] + 1, 1e-14);
}

TEST(Wavelet, RefusesWhatIsNotOfTheBasis) {
    const WaveletBasis basis = wavelet_basis(build_topology(test::make_box(2, 2, 2)), {.levels = 1});
    const std::vector<double> values(basis.points(), 1.0);
    expect_error(ErrorCode::InvalidInput, "values", [&] { (void)analyze(basis, std::span(values).first(3)); });
    WaveletField field = analyze(basis, values);
    expect_error(ErrorCode::InvalidInput, "channels of positions", [&] { turn_details_to_shape(basis, field); });
    expect_error(ErrorCode::InvalidInput, "greater than 0", [&] { drop_details(basis, field, 0); });
    expect_error(ErrorCode::InvalidInput, "greater than 0", [&] { drop_details(basis, field, std::nan("")); });
    expect_error(ErrorCode::InvalidInput, "too small", [&] { (void)quantize(basis, field, 1e-300); });
    field.details[0].pop_back();
    expect_error(ErrorCode::InvalidInput, "details", [&] { (void)synthesize(basis, field); });
    expect_error(ErrorCode::InvalidInput, "0 to 10",
                 [&] { (void)wavelet_basis(build_topology(test::make_box(1, 1, 1)), {.levels = 11}); });
}

}  // namespace wavelet_test
}  // namespace subvol
