// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "bucket_sort.h"
#include "sample_ways.h"
#include "subvol/rbf_field.h"

namespace subvol::detail {

namespace {

constexpr int kMostRounds = 6;
constexpr int kMostIntervals = 64;

/// The largest error in each control cell, over the points of its 64 descendants.
std::vector<double> errors_of_cells(const RbfVolume& volume, const HexMesh& twice, std::size_t cells) {
    const std::vector<double> values = RbfField(volume, {.channel = 0, .least_weight = 0}).evaluate(twice.points);
    const Attribute& exact = twice.attributes.front();
    std::vector<double> errors(cells, 0);
    parallel_each(cells, [&](std::size_t c) {
        for (std::size_t descendant = 64 * c; descendant < 64 * (c + 1); ++descendant) {
            for (const Index p : twice.cells[descendant]) {
                const double error = std::abs(values[p] - exact.values[p * static_cast<std::size_t>(exact.channels)]);
                errors[c] = std::max(errors[c], std::isnan(error) ? std::abs(exact.values[p]) : error);
            }
        }
    });
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
        if (error <= tolerance || intervals[e] == kMostIntervals) continue;
        const double wanted = std::ceil(intervals[e] * std::sqrt(error / tolerance));
        intervals[e] = static_cast<int>(std::clamp(wanted, intervals[e] + 1.0, double(kMostIntervals)));
        any = true;
    }
    return any;
}

}  // namespace

SampleResult sample_to_tolerance(const HexMesh& control, const HexMesh& twice_refined, const Topology& topology,
                                 const SampleOptions& options) {
    std::vector<int> intervals(topology.edges.size(), 1);
    for (int round = 1;; ++round) {
        SampleResult result = sample_in_cells(control, twice_refined, topology, intervals, options);
        const auto errors = errors_of_cells(result.volume, twice_refined, control.cells.size());
        result.report.largest_error = *std::max_element(errors.begin(), errors.end());
        if (round == kMostRounds || !refine_intervals(topology, errors, options.tolerance, intervals)) return result;
    }
}

}  // namespace subvol::detail
