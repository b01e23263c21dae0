// SPDX-License-Identifier: Apache-2.0
// Known fields, given by their means over cells.

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <iostream>

#include "lib/test_meshes.h"
#include "subvol/cell_means.h"
#include "subvol/error.h"
#include "subvol/limit.h"
#include "subvol/model.h"

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

TEST(CellMeans, LinearFieldsAreReproduced) {
    HexMesh mesh = make_box(5, 4, 3);
    jitter(mesh, .1, 3);
    const auto linear = [](const Vec3& x) { return 1 + 2 * x.x - x.y + .5 * x.z; };
    const auto fit = fit_cell_means(mesh, std::vector<Attribute>{{"f", 1, means(mesh, linear)}});
    EXPECT_LT(fit.report.rms_off, 1e-4);
    EXPECT_LT(rmse(mesh, fit.fields[0].values, linear), .02);  // of a range of 17
}

// A field that is known is found far better than by means at points, and with a higher order.
TEST(CellMeans, KnownFieldsAreFound) {
    for (const std::string model : {"twist", "ball"}) {
        std::array<double, 2> by_mean{}, by_fit{};
        const std::array<int, 2> sizes = model == "ball" ? std::array{3, 6} : std::array{6, 12};
        for (std::size_t k = 0; k < 2; ++k) {
            HexMesh mesh = make_model(model, sizes[k]);
            mesh.attributes.clear();
            const auto of_cells = means(mesh, smooth);
            const auto fit = fit_cell_means(mesh, std::vector<Attribute>{{"f", 1, of_cells}});
            by_mean[k] = rmse(mesh, mean_at_points(mesh, of_cells), smooth);
            by_fit[k] = rmse(mesh, fit.fields[0].values, smooth);
            std::cout << model << " " << mesh.cells.size() << " cells: mean " << by_mean[k] << ", fit " << by_fit[k] << ", off "
                      << fit.report.rms_off << " most " << fit.report.most_off << " first " << fit.report.first_rms_off << ", "
                      << fit.report.iterations << " iterations, " << fit.report.seconds << " s\n";
        }
        EXPECT_LT(by_fit[1], .5 * by_mean[1]) << model;
        EXPECT_GT(by_fit[0] / by_fit[1], 3) << model;  // the order is above 1.6
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
    const auto fit = fit_cell_means(mesh, std::vector<Attribute>{{"x", 1, values}}, parts);
    EXPECT_LT(fit.report.most_off, 1e-3);
    EXPECT_LT(rmse(mesh, fit.fields[0].values, [](const Vec3& x) { return x.x; }), .5);
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
    const auto fit = fit_cell_means(
        mesh, std::vector<Attribute>{{"liquid", 1, liquid}, {"half", 1, std::vector<double>(liquid.size(), .5)}});
    const Topology topology = build_topology(mesh);
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        const double beyond = topology.point_on_boundary[p] ? .5 : 0;  // what the gradient across the front allows
        EXPECT_GE(fit.fields[0].values[p], -beyond) << p;
        EXPECT_LE(fit.fields[0].values[p], 1 + beyond) << p;
        EXPECT_EQ(fit.fields[1].values[p], .5);
    }
    EXPECT_LT(fit.report.rms_off, .06);    // one layer of 12 is off by at most .2; no values within the range are nearer
    EXPECT_GT(fit.report.most_off, 1e-3);  // the report does not hide it
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
