// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "sample_ways.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/rbf_field.h"

namespace subvol::detail {

namespace {

constexpr int kMostRounds = 6;
constexpr int kMostIntervalsOfTolerance = 64;

/// The largest difference of two values of the first channel at the nodes.
double range_of(const CellBlocks& blocks, std::size_t cells) {
    double low = blocks.nodes(0)[3], high = low;
    for (std::size_t c = 0; c < cells; ++c) {
        for (std::size_t n = 0; n < CellBlocks::kNodes; ++n) {
            const double value = blocks.nodes(c)[n * blocks.row() + 3];
            low = std::min(low, value);
            high = std::max(high, value);
        }
    }
    return high - low;
}

/// The largest error of the first channel in each control cell, over its nodes. A place that no kernel covers shows what lies
/// outside instead of the field: it is as wrong as a value of the field can be, and at least as wrong as the value 0.
std::vector<double> errors_of_cells(const RbfVolume& volume, const CellBlocks& blocks, std::size_t cells) {
    constexpr std::size_t kBatch = 4096;  // cells: half a million places
    const RbfField field(volume, {.channel = 0, .least_weight = 0});
    const double range = range_of(blocks, cells);
    std::vector<double> errors(cells, 0);
    std::vector<Vec3> places;
    for (std::size_t first = 0; first < cells; first += kBatch) {
        const std::size_t count = std::min(kBatch, cells - first);
        places.resize(count * CellBlocks::kNodes);
        parallel_each(places.size(), [&](std::size_t i) {
            const double* node = blocks.nodes(first) + i * blocks.row();
            places[i] = Vec3(node[0], node[1], node[2]);
        });
        const std::vector<double> values = field.evaluate(places);
        parallel_each(count, [&](std::size_t c) {
            const double* node = blocks.nodes(first + c);
            for (std::size_t i = c * CellBlocks::kNodes; i < (c + 1) * CellBlocks::kNodes; ++i, node += blocks.row()) {
                const double exact = node[3];
                const double error = std::isnan(values[i]) ? std::max(range, std::abs(exact)) : std::abs(values[i] - exact);
                errors[first + c] = std::max(errors[first + c], error);
            }
        });
    }
    return errors;
}

/// Gives more intervals to edges with a cell at one of their ends whose error is too large: errors fall with the square of the
/// spacing, and a large kernel reaches into the next cell. Returns whether there was any.
bool refine_intervals(const Topology& topology, const std::vector<double>& errors, double tolerance,
                      std::vector<int>& intervals) {
    std::vector<double> at_points(topology.point_count, 0);
    for (std::size_t c = 0; c < errors.size(); ++c) {
        for (const Index p : topology.cells[c]) at_points[p] = std::max(at_points[p], errors[c]);
    }
    bool any = false;
    for (std::size_t e = 0; e < intervals.size(); ++e) {
        const auto& [a, b] = topology.edges[e];
        const double error = std::max(at_points[a], at_points[b]);
        if (error <= tolerance || intervals[e] == kMostIntervalsOfTolerance) continue;
        const double wanted = std::ceil(intervals[e] * std::sqrt(error / tolerance));
        intervals[e] = static_cast<int>(std::clamp(wanted, intervals[e] + 1.0, double(kMostIntervalsOfTolerance)));
        any = true;
    }
    return any;
}

}  // namespace

SampleResult sample_to_tolerance(const HexMesh& control, const CellBlocks& blocks, const Topology& topology,
                                 const SampleOptions& options) {
    std::vector<int> intervals(topology.edges.size(), 1);
    for (int round = 1;; ++round) {
        SampleResult result = sample_in_cells(control, blocks, topology, intervals, options);
        const auto errors = errors_of_cells(result.volume, blocks, control.cells.size());
        result.report.largest_error = *std::max_element(errors.begin(), errors.end());
        if (round == kMostRounds || !refine_intervals(topology, errors, options.tolerance, intervals)) return result;
    }
}

}  // namespace subvol::detail
