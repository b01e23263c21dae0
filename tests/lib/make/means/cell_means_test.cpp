// SPDX-License-Identifier: Apache-2.0
// Known fields, given by their means over cells.

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <cmath>
#include <iostream>
#include <numeric>
#include <random>

#include "lib/finite_volumes.h"
#include "lib/test_meshes.h"
#include "subvol/cell.h"
#include "subvol/cell_means.h"
#include "subvol/error.h"
#include "subvol/limit.h"
#include "subvol/measure.h"
#include "subvol/mesh_io.h"
#include "subvol/model.h"
#include "subvol/quantity.h"

namespace subvol::test {

namespace cell_means_test {

double smooth(const Vec3& x) {
    return std::sin(2 * x.x) * std::cos(1.5 * x.y) + .5 * std::sin(x.z + x.x);
}

// The means over the cells of the limit, by Gauss' rule of four points along each axis.
template <class Field>
std::vector<double> means(const HexMesh& mesh, const Field& field) {
    constexpr std::array<double, 4> kAt{.06943184420297371, .33000947820757187, .6699905217924281, .9305681557970263};
    constexpr std::array<double, 4> kWeight{.17392742256872692, .3260725774312731, .3260725774312731, .17392742256872692};
    std::vector<LimitQuery> queries;
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        for (const double w : kAt) {
            for (const double v : kAt) {
                for (const double u : kAt) queries.push_back({c, {u, v, w}});
            }
        }
    }
    const LimitSamples samples = evaluate_limit(mesh, queries, {.tolerance = 1e-3, .max_levels = 3});
    std::vector<double> means;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        double sum = 0, volume = 0;
        for (std::size_t k = 0; k < 64; ++k) {
            const double weight =
                kWeight[k % 4] * kWeight[k / 4 % 4] * kWeight[k / 16] * glm::determinant(samples.jacobians[64 * c + k]);
            sum += weight * field(samples.positions[64 * c + k]);
            volume += weight;
        }
        means.push_back(sum / volume);
    }
    return means;
}

std::vector<double> mean_at_points(const HexMesh& mesh, const std::vector<double>& of_cells) {
    std::vector<double> sums(mesh.points.size()), counts(mesh.points.size());
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        for (const Index p : mesh.cells[c]) {
            sums[p] += of_cells[c];
            counts[p] += 1;
        }
    }
    for (std::size_t p = 0; p < sums.size(); ++p) sums[p] /= std::max(1., counts[p]);
    return sums;
}

template <class Field>
double rmse(HexMesh mesh, const std::vector<double>& values, const Field& field) {
    mesh.attributes = {{"f", 1, values}};
    std::vector<LimitQuery> queries;
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        for (const Vec3& at : {Vec3(.5, .5, .5), Vec3(.1, .3, .8), Vec3(0, .9, .4), Vec3(1, 1, 1)}) queries.push_back({c, at});
    }
    const LimitSamples samples = evaluate_limit(mesh, queries, {.tolerance = 1e-3, .max_levels = 3});
    double sum = 0;
    for (std::size_t q = 0; q < queries.size(); ++q) {
        const double off = samples.attributes[0].values[q] - field(samples.positions[q]);
        sum += off * off;
    }
    return std::sqrt(sum / static_cast<double>(queries.size()));
}

double linear(const Vec3& x) {
    return 1 + 2 * x.x - x.y + .5 * x.z;
}

double variation(const std::vector<double>& values) {
    double sum = 0;
    for (std::size_t i = 1; i < values.size(); ++i) sum += std::abs(values[i] - values[i - 1]);
    return sum;
}

// Values of the limit along a row of cells that are crossed along u, from the first centre to the last.
std::vector<double> along_row(HexMesh mesh, const std::vector<double>& values, const std::vector<Index>& row) {
    mesh.attributes = {{"f", 1, values}};
    constexpr int kSteps = 8;
    std::vector<LimitQuery> queries;
    for (std::size_t i = 0; i < row.size(); ++i) {
        for (int s = 0; s < kSteps; ++s) {
            const double t = (s + .5) / kSteps;
            if ((i == 0 && t < .5) || (i + 1 == row.size() && t > .5)) continue;
            queries.push_back({row[i], {t, .5, .5}});
        }
    }
    return evaluate_limit(mesh, queries, {.tolerance = 1e-4, .max_levels = 4}).attributes[0].values;
}

TEST(CellMeans, LinearFieldsAreReproduced) {
    HexMesh mesh = make_box(5, 4, 3);
    jitter(mesh, .1, 3);
    const auto fit = fit_cell_means(mesh, std::vector<Attribute>{{"f", 1, straight_means(mesh, linear)}});
    EXPECT_LT(fit.report.most_off, 1e-5);
    const double range = 17;
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        EXPECT_NEAR(fit.fields[0].values[p], linear(mesh.points[p]), 1e-5 * range) << p;
    }
    const auto exact = fit_exact_cell_means(mesh, std::vector<Attribute>{{"f", 1, means(mesh, linear)}});
    EXPECT_LT(exact.report.found.rms_off, 1e-4);
    EXPECT_LT(rmse(mesh, exact.fields[0].values, linear), .02);
}

// Where lines of the mesh fork, too.
TEST(CellMeans, LinearFieldsAreReproducedAroundIrregularEdges) {
    const HexMesh mesh = irregular();
    const auto fit = fit_cell_means(mesh, std::vector<Attribute>{{"f", 1, straight_means(mesh, linear)}});
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        EXPECT_NEAR(fit.fields[0].values[p], linear(mesh.points[p]), 1e-5) << p;
    }
    Attribute turning{"v", 3, {}};  // around an axis: its length is what the corners have alone
    const auto x = straight_means(mesh, [](const Vec3& at) { return at.x; });
    const auto y = straight_means(mesh, [](const Vec3& at) { return at.y; });
    for (std::size_t c = 0; c < x.size(); ++c) turning.values.insert(turning.values.end(), {-y[c], x[c], .5});
    const auto vectors = fit_cell_means(mesh, std::vector<Attribute>{turning}).fields[0].values;
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        EXPECT_NEAR(vectors[3 * p], -mesh.points[p].y, 1e-5) << p;
        EXPECT_NEAR(vectors[3 * p + 1], mesh.points[p].x, 1e-5) << p;
    }
}

// Fourth order at the points of even grids, away from the boundary.
TEST(CellMeans, EvenGridsAreOfFourthOrder) {
    std::array<double, 2> errors{};
    for (std::size_t k = 0; k < 2; ++k) {
        const Index n = k == 0 ? 8 : 16;
        HexMesh mesh = distorted_box(n, 0);
        const auto fit = fit_cell_means(mesh, std::vector<Attribute>{{"f", 1, straight_means(mesh, smooth)}});
        for (std::size_t p = 0; p < mesh.points.size(); ++p) {
            const Vec3 from_middle = glm::abs(mesh.points[p] - Vec3(.5));
            if (std::max({from_middle.x, from_middle.y, from_middle.z}) > .125) continue;
            errors[k] = std::max(errors[k], std::abs(fit.fields[0].values[p] - smooth(mesh.points[p])));
        }
    }
    EXPECT_GT(errors[0] / errors[1], 12);  // 16
}

TEST(CellMeans, DistortedGridsAreOfSecondOrder) {
    std::array<double, 2> errors{}, by_mean{};
    for (std::size_t k = 0; k < 2; ++k) {
        const HexMesh mesh = distorted_box(k == 0 ? 8 : 16, .15);
        const auto of_cells = straight_means(mesh, smooth);
        errors[k] = rmse(mesh, fit_cell_means(mesh, std::vector<Attribute>{{"f", 1, of_cells}}).fields[0].values, smooth);
        by_mean[k] = rmse(mesh, mean_at_points(mesh, of_cells), smooth);
    }
    std::cout << "distorted: mean " << by_mean[0] << ", " << by_mean[1] << "; fit " << errors[0] << ", " << errors[1] << "\n";
    EXPECT_GT(errors[0] / errors[1], 3.5);
    EXPECT_LT(errors[1], .1 * by_mean[1]);
}

// A smooth row with noise: its limit varies as the means do. Least squares that meet the means amplify the noise.
TEST(CellMeans, WavesFromCellToCellAreNotAmplified) {
    const HexMesh mesh = make_box(32, 5, 5);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> noise(-.03, .03);
    std::vector<double> of_cells;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        of_cells.push_back(std::sin(.25 * static_cast<double>(c % 32)) + noise(random));
    }
    std::vector<Index> row(32);
    std::iota(row.begin(), row.end(), Index{2 * 32 + 2 * 32 * 5});
    std::vector<double> of_row;
    for (const Index c : row) of_row.push_back(of_cells[c]);
    const std::vector<Attribute> field{{"f", 1, of_cells}};
    const double raw = variation(of_row);
    const double by_fit = variation(along_row(mesh, fit_cell_means(mesh, field).fields[0].values, row));
    const double by_exact = variation(along_row(mesh, fit_exact_cell_means(mesh, field).fields[0].values, row));
    EXPECT_LT(by_fit, 1.15 * raw);
    EXPECT_GT(by_exact, by_fit);
}

TEST(CellMeans, TheWholeIntegralIsThatOfTheMeans) {
    HexMesh mesh = distorted_box(6, .15);
    const std::vector<double> ones(mesh.cells.size(), 1);
    std::vector<double> of_cells;
    for (const double x : straight_means(mesh, smooth)) of_cells.push_back(x > .4 ? 1 : 0);  // a rough one, a fraction
    const std::vector<double> volumes = [&] {
        std::vector<double> found;
        for (const auto& cell : mesh.cells) {
            std::array<Vec3, 8> x;
            for (std::size_t k = 0; k < 8; ++k) x[k] = mesh.points[cell[k]];
            found.push_back(cell_volume(x));
        }
        return found;
    }();
    std::vector<double> vectors;
    for (const double f : of_cells) vectors.insert(vectors.end(), {f, 0, 0});
    const auto fit = fit_cell_means(mesh, std::vector<Attribute>{{"f", 1, of_cells}, {"one", 1, ones}, {"v", 3, vectors}});
    EXPECT_EQ(fit.fields[1].values, std::vector<double>(mesh.points.size(), 1));
    Attribute free{"free", 1, {}};  // components of vectors have no bounds
    for (std::size_t p = 0; p < mesh.points.size(); ++p) free.values.push_back(fit.fields[2].values[3 * p]);
    mesh.attributes = {fit.fields[0], free};
    double sum = 0;
    const LimitMeasure measure = measure_limit(mesh, {.tolerance = 1e-6});
    for (std::size_t c = 0; c < volumes.size(); ++c) sum += volumes[c] * of_cells[c];
    EXPECT_NEAR(measure.whole.volume, 1, 1e-6);  // pieces are floats
    // The limit is kept between 0 and 1, where the fit's own would swing beyond.
    EXPECT_NEAR(measure.whole.fields[0].integral, sum, 1e-3 * sum);
    EXPECT_NEAR(measure.whole.fields[1].integral, sum, 1e-4);  // the fit takes the limit by pieces of level 1
    // It is what is kept that has the integral: without the bounds the same values have another.
    mesh.attributes[0].bounds.clear();
    EXPECT_GT(std::abs(measure_limit(mesh, {.tolerance = 1e-6}).whole.fields[0].integral - sum), 1e-3);
}

// A field that is known is found far better than by means at points, and with a higher order.
TEST(CellMeans, KnownFieldsAreFound) {
    for (const std::string model : {"twist", "ball"}) {
        std::array<double, 2> by_mean{}, by_exact{}, by_fit{};
        const std::array<int, 2> sizes = model == "ball" ? std::array{3, 6} : std::array{6, 12};
        for (std::size_t k = 0; k < 2; ++k) {
            HexMesh mesh = make_model(model, sizes[k]);
            mesh.attributes.clear();
            const auto of_cells = means(mesh, smooth);
            const std::vector<Attribute> field{{"f", 1, of_cells}};
            const auto exact = fit_exact_cell_means(mesh, field);
            by_mean[k] = rmse(mesh, mean_at_points(mesh, of_cells), smooth);
            by_exact[k] = rmse(mesh, exact.fields[0].values, smooth);
            by_fit[k] = rmse(mesh, fit_cell_means(mesh, field).fields[0].values, smooth);
            std::cout << model << " " << mesh.cells.size() << " cells: mean " << by_mean[k] << ", fit " << by_fit[k]
                      << ", exact " << by_exact[k] << ", off " << exact.report.found.rms_off << " most "
                      << exact.report.found.most_off << " first " << exact.report.first_rms_off << ", "
                      << exact.report.iterations << " iterations, " << exact.report.found.seconds << " s\n";
        }
        EXPECT_LT(by_exact[1], .5 * by_mean[1]) << model;
        EXPECT_GT(by_exact[0] / by_exact[1], 3) << model;  // the order is above 1.6
        EXPECT_LT(by_fit[1], .5 * by_mean[1]) << model;
        EXPECT_GT(by_fit[0] / by_fit[1], 3) << model;
    }
}

TEST(CellMeans, PartsHaveTheMeanOfTheirWholeTogether) {
    const HexMesh mesh = make_box(6, 2, 2);
    std::vector<Index> parts;
    std::vector<double> values;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        parts.push_back(static_cast<Index>(c % 6 / 2));  // slabs of eight cells
        values.push_back(2. * static_cast<double>(parts.back()) + 1);
    }
    const auto exact = fit_exact_cell_means(mesh, std::vector<Attribute>{{"x", 1, values}}, parts);
    EXPECT_LT(exact.report.found.most_off, 1e-3);
    EXPECT_LT(rmse(mesh, exact.fields[0].values, [](const Vec3& x) { return x.x; }), .5);
    const auto fit = fit_cell_means(mesh, std::vector<Attribute>{{"x", 1, values}}, parts);
    for (std::size_t p = 0; p < mesh.points.size(); ++p) EXPECT_NEAR(fit.fields[0].values[p], mesh.points[p].x, 1e-4);
}

// A liquid: a front inside one layer of cells, whose means are between 0 and 1. Least squares alone would swing to -.3 and 1.6.
TEST(CellMeans, ValuesInsideStayWithinTheRangeOfTheMeans) {
    HexMesh mesh = make_box(6, 6, 12);
    jitter(mesh, .05, 3);
    std::vector<double> liquid;
    for (const auto& cell : mesh.cells) {
        Vec3 centre(0.0);
        for (const Index p : cell) centre += mesh.points[p] / 8.0;
        liquid.push_back(std::clamp(6 + .3 * (centre.x - 3) - centre.z, 0., 1.));
    }
    const std::vector<Attribute> fields{{"liquid", 1, liquid}, {"half", 1, std::vector<double>(liquid.size(), .5)}};
    const auto exact = fit_exact_cell_means(mesh, fields);
    const auto fit = fit_cell_means(mesh, fields);
    const Topology topology = build_topology(mesh);
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        const double beyond = topology.point_on_boundary[p] ? .5 : 0;  // what the gradient across the front allows
        EXPECT_GE(exact.fields[0].values[p], -beyond) << p;
        EXPECT_LE(exact.fields[0].values[p], 1 + beyond) << p;
        EXPECT_EQ(exact.fields[1].values[p], .5);
        EXPECT_GE(fit.fields[0].values[p], 0) << p;
        EXPECT_LE(fit.fields[0].values[p], 1) << p;
        EXPECT_EQ(fit.fields[1].values[p], .5);
    }
    EXPECT_LT(exact.report.found.rms_off, .06);  // one layer of 12 is off by at most .2; no values within the range are nearer
    EXPECT_GT(exact.report.found.most_off, 1e-3);  // the report does not hide it
    EXPECT_GT(fit.report.most_off, 1e-3);
}

// Whatever the means are: inside, each value is within those of the cells around its point; on the boundary, no farther beyond
// than the cells' steps to their neighbours, one for each side of the boundary there.
TEST(CellMeans, ValuesStayWithinTheMeansAround) {
    const HexMesh mesh = distorted_box(7, .15);
    const Topology topology = build_topology(mesh);
    std::mt19937 random(3);
    std::normal_distribution<double> number;
    std::vector<double> of_cells;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) of_cells.push_back(std::exp(number(random)));
    const std::vector<double> values = fit_cell_means(mesh, std::vector<Attribute>{{"f", 1, of_cells}}).fields[0].values;
    std::vector<double> low(mesh.points.size(), HUGE_VAL), high(mesh.points.size(), -HUGE_VAL), step(mesh.points.size(), 0);
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        for (const Index p : mesh.cells[c]) {
            low[p] = std::min(low[p], of_cells[c]);
            high[p] = std::max(high[p], of_cells[c]);
            for (const Index face : topology.cell_faces[c]) {
                for (const Index other : topology.face_cells[face]) {
                    if (other != kNone) step[p] = std::max(step[p], std::abs(of_cells[other] - of_cells[c]));
                }
            }
        }
    }
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        int sides = 0;
        for (int a = 0; a < 3; ++a) sides += mesh.points[p][a] == 0 || mesh.points[p][a] == 1 ? 1 : 0;
        EXPECT_GE(values[p], low[p] - sides * step[p] - 1e-12) << p;
        EXPECT_LE(values[p], high[p] + sides * step[p] + 1e-12) << p;
    }
}

// A thin layer along a wall leads nowhere beyond it: the step into it is not the step out of the cell behind.
TEST(CellMeans, ALayerOfOneCellLeadsNowhere) {
    const HexMesh mesh = make_box(6, 6, 6);
    std::vector<double> of_cells;
    for (const auto& cell : mesh.cells) of_cells.push_back(mesh.points[cell[0]].z == 0 ? -1 : 3);
    const std::vector<double> values = fit_cell_means(mesh, std::vector<Attribute>{{"f", 1, of_cells}}).fields[0].values;
    const auto [least, most] = std::ranges::minmax(values);
    EXPECT_GE(least, -1);
    EXPECT_LE(most, 3);
}

// A pressure of the atmosphere that varies by a few digits.
TEST(CellMeans, AConstantTakesNoDigits) {
    const HexMesh mesh = irregular();
    const std::vector<double> plain = straight_means(mesh, smooth);
    std::vector<double> shifted = plain;
    for (double& value : shifted) value += 1e8;
    const auto fit = fit_cell_means(mesh, std::vector<Attribute>{{"plain", 1, plain}, {"shifted", 1, shifted}});
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        EXPECT_NEAR(fit.fields[1].values[p] - 1e8, fit.fields[0].values[p], 1e-6) << p;
    }
}

// The flow of OpenFOAM's tutorial in a T junction: rows of 48 cells, whose limit varies as the cells do.
TEST(CellMeans, FlowsOfFiniteVolumesHaveNoRipples) {
    const auto file = beside_data("series/tjunction");
    if (!file) GTEST_SKIP() << "no series/tjunction beside the folder that SUBVOL_DATA names, or SUBVOL_DATA is not set";
    const ReadResult read = read_mesh(*file);
    ASSERT_EQ(read.cell_means.size(), 2u);
    ASSERT_TRUE(read.cell_values);
    EXPECT_EQ(read.cell_values->method, CellValues::Fit);
    const Attribute* pressure = read.mesh.find_attribute("p");
    const Attribute& of_cells = *std::ranges::find(read.cell_means, "p", &Attribute::name);
    std::vector<LimitQuery> centres;
    for (Index c = 0; c < read.mesh.cells.size(); ++c) centres.push_back({c, {.5, .5, .5}});
    HexMesh mesh = read.mesh;
    mesh.attributes = {*pressure};
    const LimitSamples samples = evaluate_limit(mesh, centres, {.tolerance = 1e-4, .max_levels = 3});
    double squares = 0;
    for (std::size_t c = 0; c < centres.size(); ++c)
        squares += std::pow(samples.attributes[0].values[c] - of_cells.values[c], 2);
    EXPECT_LT(std::sqrt(squares / static_cast<double>(centres.size())), .1);
    double by_fit = 0, raw = 0;
    const Topology topology = build_topology(mesh);
    for (Index start = 0; start < mesh.cells.size(); start += 97) {
        std::vector<Index> row;  // along u, while cells are numbered alike
        for (Index c = start; c != kNone && row.size() < 48;) {
            row.push_back(c);
            const Index face = topology.cell_faces[c][1];
            const auto& cells = topology.face_cells[face];
            const Index next = cells[0] == c ? cells[1] : cells[0];
            c = next != kNone && topology.cell_faces[next][0] == face ? next : kNone;
        }
        if (row.size() < 3) continue;
        std::vector<double> of_row;
        for (const Index c : row) of_row.push_back(of_cells.values[c]);
        raw += variation(of_row);
        by_fit += variation(along_row(mesh, pressure->values, row));
    }
    std::cout << "p along rows of cells: " << by_fit / raw << " of the cells' variation\n";
    EXPECT_LT(by_fit, 1.06 * raw);
    EXPECT_LT(read.cell_values->rms_of_range, .01);
}

// Neither a component, a length nor the pressure leaves the range of the cells: by 2 % of it at most, as the limit swings
// between points.
TEST(CellMeans, FlowsStayInTheRangeOfTheCells) {
    const auto file = beside_data("series/tjunction");
    if (!file) GTEST_SKIP() << "no series/tjunction beside the folder that SUBVOL_DATA names, or SUBVOL_DATA is not set";
    const ReadResult read = read_mesh(*file);
    const auto of_cells = [&](const char* name) { return *std::ranges::find(read.cell_means, name, &Attribute::name); };
    const auto lengths = [](const std::vector<double>& u) {
        std::vector<double> found;
        for (std::size_t i = 0; i < u.size(); i += 3) found.push_back(glm::length(Vec3(u[i], u[i + 1], u[i + 2])));
        return found;
    };
    const auto second = [](const std::vector<double>& u) {
        std::vector<double> found;
        for (std::size_t i = 1; i < u.size(); i += 3) found.push_back(u[i]);
        return found;
    };
    HexMesh mesh = read.mesh;
    mesh.attributes = {*read.mesh.find_attribute("U"), *read.mesh.find_attribute("p")};
    std::vector<LimitQuery> places;
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        for (int i = 0; i < 27; ++i) places.push_back({c, Vec3(i % 3, i / 3 % 3, i / 9) / 2.});
    }
    const LimitSamples samples = evaluate_limit(mesh, places, {.tolerance = 1e-3, .max_levels = 3});
    const std::vector<double>&u = samples.attributes[0].values, means = of_cells("U").values;
    const std::array<std::array<std::vector<double>, 2>, 3> pairs{
        {{second(means), second(u)}, {lengths(means), lengths(u)}, {of_cells("p").values, samples.attributes[1].values}}};
    for (const auto& [cells, limit] : pairs) {
        const auto [low, high] = std::ranges::minmax(cells);
        const auto [least, most] = std::ranges::minmax(limit);
        EXPECT_GT(least, low - .02 * (high - low));
        EXPECT_LT(most, high + .02 * (high - low));
    }
}

// The shear at the walls is that of the first cells: |U| / .002 for each face, along it (3,075 faces of 4 mm).
TEST(WallGradients, FlowsHaveTheShearOfTheirFirstCells) {
    const auto file = beside_data("series/tjunction");
    if (!file) GTEST_SKIP() << "no series/tjunction beside the folder that SUBVOL_DATA names, or SUBVOL_DATA is not set";
    const ReadResult read = read_mesh(*file);
    const Attribute& means = *std::ranges::find(read.cell_means, "U", &Attribute::name);
    const Attribute shear = field_of(read.mesh, "shear", "norm(grad(U))");
    double of_cells = 0, found = 0;
    std::size_t faces = 0;
    for (const auto& [side, face] : read.on_patches.sides) {
        if (read.on_patches.roles[face] != PatchRole::Wall) continue;
        std::array<Vec3, 4> x;
        for (std::size_t k = 0; k < 4; ++k) x[k] = read.mesh.points[read.mesh.cells[side.cell][kCellFaces[side.side][k]]];
        const Vec3 normal = glm::normalize(glm::cross(x[2] - x[0], x[3] - x[1]));
        const double* m = &means.values[3 * std::size_t{side.cell}];
        const Vec3 u(m[0], m[1], m[2]);
        of_cells += glm::length(u - glm::dot(u, normal) * normal) / .002;
        for (const std::size_t k : kCellFaces[side.side]) found += shear.values[read.mesh.cells[side.cell][k]] / 4;
        ++faces;
    }
    EXPECT_EQ(faces, 3075u);
    std::cout << "shear at walls " << found / static_cast<double>(faces) << ", by the first cells "
              << of_cells / static_cast<double>(faces) << "\n";
    EXPECT_NEAR(found / of_cells, 1, .05);  // points at edges are of two walls
}

// All sides of a mesh as faces of one patch, with values of a field at the centres of the straight sides.
ValuesOnPatches all_sides(const HexMesh& mesh, double (*field)(const Vec3&)) {
    ValuesOnPatches on_patches;
    const Topology topology = build_topology(mesh);
    FieldOnPatches values{"f", 1, {}, {}};
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        for (std::uint8_t side = 0; side < 6; ++side) {
            if (!topology.face_on_boundary(topology.cell_faces[c][side])) continue;
            std::array<Vec3, 4> x;
            for (std::size_t k = 0; k < 4; ++k) x[k] = mesh.points[mesh.cells[c][kCellFaces[side][k]]];
            const double a = glm::length(glm::cross(x[1] - x[0], x[2] - x[0])),
                         b = glm::length(glm::cross(x[2] - x[0], x[3] - x[0]));
            const Vec3 centre = (a * (x[0] + x[1] + x[2]) + b * (x[0] + x[2] + x[3])) / (3 * (a + b));
            on_patches.sides.push_back({{c, side}, static_cast<Index>(on_patches.sides.size())});
            values.values.push_back(field(centre));
        }
    }
    on_patches.patches.assign(on_patches.sides.size(), 0);
    on_patches.roles.assign(on_patches.sides.size(), PatchRole::Wall);
    values.along.assign(on_patches.sides.size(), 0);
    on_patches.fields = {values};
    return on_patches;
}

TEST(PatchValues, LinearFieldsAreExactOnDistortedPatches) {
    HexMesh mesh = distorted_box(6, .15);
    mesh.attributes = {{"f", 1, std::vector<double>(mesh.points.size(), 0)}};
    const PatchValuesReport report = meet_patch_values(mesh, all_sides(mesh, linear));
    EXPECT_EQ(report.fields, 1u);
    EXPECT_EQ(report.points, 7u * 7 * 7 - 5 * 5 * 5);
    for (Index p = 0; p < mesh.points.size(); ++p) {
        const Vec3& x = mesh.points[p];
        const bool inside = x.x > 0 && x.x < 1 && x.y > 0 && x.y < 1 && x.z > 0 && x.z < 1;
        // Gradients lack two millionths, for directions without neighbours.
        EXPECT_NEAR(mesh.attributes[0].values[p], inside ? 0 : linear(x), 2e-6) << p;
    }
}

// The gradient at all points, edges and corners is that of a linear field: by the means of the cells and the values on faces.
TEST(WallGradients, AreExactForLinearFields) {
    HexMesh mesh = distorted_box(5, .15);
    const std::vector<double> means = straight_means(mesh, linear);
    mesh.attributes = {{.name = "f", .channels = 1, .values = std::vector<double>(mesh.points.size(), 0), .cells = means}};
    set_wall_gradients(mesh, all_sides(mesh, linear));
    const GradientsAtPoints& walls = mesh.attributes[0].walls;
    EXPECT_EQ(walls.points.size(), 6u * 6 * 6 - 4 * 4 * 4);
    for (const Vec3& gradient : walls.gradients) EXPECT_NEAR(glm::length(gradient - Vec3(2, -1, .5)), 0, 1e-5);
    const Attribute gradient = field_of(mesh, "g", "grad(f)");
    for (std::size_t i = 0; i < walls.points.size(); ++i) EXPECT_EQ(gradient.values[3 * walls.points[i]], walls.gradients[i].x);
}

// A flow of speed 1 beside walls at rest: the shear is that of half a cell, whatever the limit makes of the layer.
TEST(WallGradients, AreThoseOfTheFirstCells) {
    HexMesh mesh = make_box(8, 5, 5);
    for (Vec3& x : mesh.points) x *= .25;
    ValuesOnPatches on_patches = all_sides(mesh, [](const Vec3&) { return 0.; });
    on_patches.fields[0].name = "u";
    std::vector<double> flow;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) flow.push_back(1);
    mesh.attributes = {{.name = "u", .channels = 1, .values = std::vector<double>(mesh.points.size(), 1), .cells = flow}};
    set_wall_gradients(mesh, on_patches);
    const GradientsAtPoints& walls = mesh.attributes[0].walls;
    for (std::size_t i = 0; i < walls.points.size(); ++i) {
        const Vec3& x = mesh.points[walls.points[i]];
        const Vec3 ends(2, 1.25, 1.25);
        int sides = 0;
        for (int a = 0; a < 3; ++a) sides += x[a] == 0 || x[a] == ends[a] ? 1 : 0;
        for (int a = 0; a < 3; ++a) {
            const double wanted = x[a] == 0 ? 8 : x[a] == ends[a] ? -8 : 0;  // 1 / .125
            // At edges and corners it is between what all sides ask for and the length of one of them, the geometric mean; up
            // to kFew of patch_points.cpp.
            const double part = std::pow(sides, -.25);
            EXPECT_NEAR(walls.gradients[i][a], part * wanted, sides == 1 ? 1e-9 : .02 * 8) << i;
        }
    }
}

TEST(PatchValues, SmoothFieldsAreOfSecondOrder) {
    std::array<double, 2> errors{};
    for (std::size_t k = 0; k < errors.size(); ++k) {
        HexMesh mesh = distorted_box(k == 0 ? 8 : 16, .15);
        mesh.attributes = {{"f", 1, {}}};
        for (const Vec3& x : mesh.points) mesh.attributes[0].values.push_back(smooth(x));
        const std::vector<double> truth = mesh.attributes[0].values;
        static_cast<void>(meet_patch_values(mesh, all_sides(mesh, smooth)));
        double squares = 0;
        for (std::size_t p = 0; p < truth.size(); ++p) squares += std::pow(mesh.attributes[0].values[p] - truth[p], 2);
        errors[k] = std::sqrt(squares / static_cast<double>(truth.size()));
    }
    EXPECT_LT(errors[1], errors[0] / 3.5) << errors[0];
}

TEST(CellMeans, AreTheSameForAnyNumberOfThreads) {
    const HexMesh mesh = irregular();
    const std::vector<Attribute> of_cells{{"f", 1, means(mesh, smooth)}};
    std::vector<std::vector<double>> found;
    for (const std::size_t threads : {1u, 2u, 5u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        found.push_back(fit_cell_means(mesh, of_cells).fields[0].values);
    }
    EXPECT_EQ(found[0], found[1]);
    EXPECT_EQ(found[0], found[2]);
}

TEST(CellMeans, VeryLargeAndVerySmallValuesAreFittedAlike) {
    const HexMesh mesh = irregular();
    const std::vector<double> plain = means(mesh, smooth);
    const auto fitted = [&](int exponent) {
        Attribute field{"f", 1, plain};
        for (double& value : field.values) value = std::ldexp(value, exponent);
        return fit_cell_means(mesh, std::vector<Attribute>{field});
    };
    const CellMeansFit expected = fitted(0);
    for (const int exponent : {-900, -290, 290, 900}) {
        const CellMeansFit found = fitted(exponent);
        for (std::size_t p = 0; p < mesh.points.size(); ++p) {
            EXPECT_EQ(found.fields[0].values[p], std::ldexp(expected.fields[0].values[p], exponent)) << exponent;
        }
        EXPECT_EQ(found.report.rms_off, expected.report.rms_off) << exponent;
    }
    const HexMesh two = make_box(2, 1, 1);
    const CellMeansFit steep = fit_cell_means(two, std::vector<Attribute>{{"f", 1, {1e308, -1e308}}});
    for (const double value : steep.fields[0].values) EXPECT_TRUE(std::isfinite(value));
}

TEST(CellMeans, WrongInputIsRefused) {
    const HexMesh mesh = make_box(1, 1, 1);
    EXPECT_THROW(static_cast<void>(fit_cell_means(mesh, std::vector<Attribute>{{"f", 1, {1, 2}}})), Error);
    EXPECT_THROW(static_cast<void>(fit_cell_means(mesh, std::vector<Attribute>{{"f", 1, {std::nan("")}}})), Error);
    EXPECT_THROW(static_cast<void>(fit_cell_means(mesh, std::vector<Attribute>{{"f", 1, {1}}}, std::vector<Index>{0, 0})),
                 Error);
}

}  // namespace cell_means_test

}  // namespace subvol::test
