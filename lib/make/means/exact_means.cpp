// SPDX-License-Identifier: Apache-2.0
#include "subvol/cell_means.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mean_channels.h"
#include "mean_rows.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"

namespace subvol {

namespace {

using detail::kLanes;
using detail::LaneMatrix;
using detail::Lanes;
using detail::MeanRows;
using detail::parallel_each;
using detail::Wholes;

// Values at points, and how far each may leave the range of the means.
struct Guess {
    std::vector<double> values, beyond;
};

// Each cell's mean with a gradient by its neighbours; at points the mean over the cells, weighted by volume. Points of the
// boundary lie outside the centres of all cells: there a value may go beyond the means by what the gradient says.
Guess first_guess(const HexMesh& mesh, const Topology& topology, const MeanRows& means, std::span<const double> values) {
    std::vector<Vec3> gradients(mesh.cells.size());
    parallel_each(mesh.cells.size(), [&](std::size_t c) {
        Mat3 normal(0.0);
        Vec3 right(0.0);
        for (const Index face : topology.cell_faces[c]) {
            const auto& sides = topology.face_cells[face];
            const Index other = sides[0] == c ? sides[1] : sides[0];
            if (other == kNone) continue;
            const Vec3 d = means.centres[other] - means.centres[c];
            const double weight = 1 / std::max(glm::dot(d, d), 1e-300);
            normal += weight * glm::outerProduct(d, d);
            right += weight * (values[other] - values[c]) * d;
        }
        const double few = 1e-6 * (normal[0][0] + normal[1][1] + normal[2][2]) + 1e-300;  // a direction without neighbours
        for (int a = 0; a < 3; ++a) normal[a][a] += few;
        gradients[c] = glm::inverse(normal) * right;
        if (!std::isfinite(gradients[c].x + gradients[c].y + gradients[c].z)) gradients[c] = Vec3(0.0);
    });
    std::vector<double> sums(mesh.points.size()), weights(mesh.points.size()), changes(mesh.points.size());
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        for (const Index p : mesh.cells[c]) {
            const double change = glm::dot(gradients[c], mesh.points[p] - means.centres[c]);
            sums[p] += means.volumes[c] * (values[c] + change);
            weights[p] += means.volumes[c];
            changes[p] += means.volumes[c] * change;
        }
    }
    for (std::size_t p = 0; p < sums.size(); ++p) {
        sums[p] = weights[p] > 0 ? sums[p] / weights[p] : 0;
        changes[p] = weights[p] > 0 && topology.point_on_boundary[p] ? std::abs(changes[p]) / weights[p] : 0;
    }
    return {std::move(sums), std::move(changes)};
}

// Up to kLanes channels, which are fitted together.
struct Batch {
    std::vector<Lanes> values, off;      // at points; of wholes: what their means lack
    std::vector<Lanes> lowest, highest;  // of values at points
    Lanes least{}, range{};              // of the means
};

Batch first_batch(const HexMesh& mesh, const Topology& topology, const MeanRows& means, const Wholes& wholes,
                  const std::vector<std::vector<double>>& of_cells) {
    Batch batch;
    batch.values.resize(mesh.points.size());
    batch.lowest = batch.highest = batch.values;
    batch.off.resize(wholes.size());
    std::vector<Lanes> found(wholes.size());
    for (std::size_t l = 0; l < of_cells.size(); ++l) {
        for (std::size_t w = 0; w < wholes.size(); ++w) batch.off[w][l] = of_cells[l][wholes.cells_of(w).front()];
        const auto [low, high] = std::ranges::minmax(of_cells[l]);
        batch.least[l] = low;
        batch.range[l] = high - low;
        const Guess guess = first_guess(mesh, topology, means, of_cells[l]);
        for (std::size_t p = 0; p < guess.values.size(); ++p) {
            batch.values[p][l] = guess.values[p];
            batch.lowest[p][l] = low - guess.beyond[p];
            batch.highest[p][l] = high + guess.beyond[p];
        }
    }
    multiply(means.matrix, batch.values, found);
    for (std::size_t w = 0; w < found.size(); ++w) {
        for (std::size_t l = 0; l < kLanes; ++l) batch.off[w][l] -= found[w][l];
    }
    return batch;
}

// Sets values that left their bounds to these, and holds them there. Returns how many.
std::size_t hold(Batch& batch, std::vector<Lanes>& free) {
    std::size_t held = 0;
    for (std::size_t p = 0; p < batch.values.size(); ++p) {
        for (std::size_t l = 0; l < kLanes; ++l) {
            const double within = std::clamp(batch.values[p][l], batch.lowest[p][l], batch.highest[p][l]);
            if (within == batch.values[p][l]) continue;
            batch.values[p][l] = within;
            free[p][l] = 0;
            ++held;
        }
    }
    return held;
}

// Finds the values. A front that is thinner than a cell makes least squares swing beyond the range of the means: such values
// are held at their bounds while the others are searched again, a few times.
int fit(const LaneMatrix& rows, const LaneMatrix& columns, Batch& batch, const ExactMeansOptions& options) {
    constexpr int kRounds = 4;
    detail::LaneSearch search{.tie = options.tie, .max_iterations = options.max_iterations};
    for (std::size_t l = 0; l < kLanes; ++l) search.enough[l] = options.tolerance * batch.range[l];
    std::vector<Lanes> free(batch.values.size(), {1, 1, 1, 1});
    int iterations = 0;
    for (int round = 0; round < kRounds; ++round) {
        iterations += detail::search(rows, columns, free, batch.values, batch.off, search);
        search.max_iterations = std::max(1, options.max_iterations / 5);  // what is left lies around the held values
        std::vector<Lanes> before = batch.values;
        if (hold(batch, free) == 0) break;
        for (std::size_t p = 0; p < before.size(); ++p) {
            for (std::size_t l = 0; l < kLanes; ++l) before[p][l] -= batch.values[p][l];
        }
        std::vector<Lanes> lost(batch.off.size());
        multiply(rows, before, lost);
        for (std::size_t w = 0; w < lost.size(); ++w) {
            for (std::size_t l = 0; l < kLanes; ++l) batch.off[w][l] += lost[w][l];
        }
    }
    return iterations;
}

double most_rms(const Batch& batch) {
    const Lanes squares = detail::dot(batch.off, batch.off);
    double most = 0;
    for (std::size_t l = 0; l < kLanes; ++l) {
        if (batch.range[l] > 0) {
            most = std::max(most, std::sqrt(squares[l] / static_cast<double>(batch.off.size())) / batch.range[l]);
        }
    }
    return most;
}

}  // namespace

ExactMeansFit fit_exact_cell_means(const HexMesh& mesh, std::span<const Attribute> fields, std::span<const Index> parts,
                                   const ExactMeansOptions& options) {
    detail::check_means(mesh, fields, parts);
    if (!(options.tie > 0) || !(options.tolerance > 0)) {
        throw Error(ErrorCode::InvalidInput, "tie and tolerance have to be greater than 0");
    }
    const detail::Stopwatch watch;
    const Topology topology = build_topology(mesh);
    const Wholes wholes = detail::wholes_of(mesh.cells.size(), parts);
    const MeanRows means = detail::mean_rows(mesh, topology, wholes, options.scheme, options.progress);
    const LaneMatrix columns = transpose_of(means.matrix, mesh.points.size());
    ExactMeansFit result;
    result.fields = detail::empty_fields(mesh, fields);
    const std::vector<detail::MeanChannel> channels = detail::mean_channels(fields);
    for (std::size_t first = 0; first < channels.size(); first += kLanes) {
        const std::size_t count = std::min(kLanes, channels.size() - first);
        std::vector<std::vector<double>> of_cells;
        std::array<int, kLanes> exponents{};
        for (std::size_t l = 0; l < count; ++l) {
            std::vector<double>& values = of_cells.emplace_back(detail::channel_values(fields, channels[first + l]));
            exponents[l] = detail::mean_exponent(values);
            detail::divide_values(values, exponents[l]);
        }
        Batch batch = first_batch(mesh, topology, means, wholes, of_cells);
        ExactMeansReport& report = result.report;
        report.first_rms_off = std::max(report.first_rms_off, most_rms(batch));
        report.iterations = std::max(report.iterations, fit(means.matrix, columns, batch, options));
        report.found.rms_off = std::max(report.found.rms_off, most_rms(batch));
        const Lanes most = detail::largest(batch.off);
        for (std::size_t l = 0; l < count; ++l) {
            const bool constant = !(batch.range[l] > 0);  // has no rounding
            if (!constant) report.found.most_off = std::max(report.found.most_off, most[l] / batch.range[l]);
            Attribute& fitted = result.fields[channels[first + l].field];
            const auto width = static_cast<std::size_t>(fitted.channels);
            for (std::size_t p = 0; p < batch.values.size(); ++p) {
                const double value = constant ? batch.least[l] : batch.values[p][l];
                fitted.values[p * width + channels[first + l].number] = detail::multiplied_value(value, exponents[l]);
            }
        }
    }
    result.report.found.seconds = watch.seconds();
    return result;
}

}  // namespace subvol
