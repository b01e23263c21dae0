// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "sample_ways.h"
#include "subvol/detail/bucket_sort.h"
#include "subvol/rbf_field.h"

namespace subvol::detail {

namespace {

constexpr int kMostRounds = 6;
constexpr int kMostIntervals = 64;

/// The exact values of the first channel, and the difference of the largest from the smallest.
class ExactValues {
public:
    explicit ExactValues(const HexMesh& twice)
        : values_(twice.attributes.front().values), channels_(static_cast<std::size_t>(twice.attributes.front().channels)) {
        double low = at(0), high = at(0);
        for (std::size_t p = 1; p < twice.points.size(); ++p) {
            low = std::min(low, at(static_cast<Index>(p)));
            high = std::max(high, at(static_cast<Index>(p)));
        }
        range_ = high - low;
    }

    [[nodiscard]] double at(Index p) const { return values_[p * channels_]; }

    /// The error of a value. A place that no kernel covers shows what lies outside instead of the field: it is as wrong as a
    /// value of the field can be, and at least as wrong as the value 0.
    [[nodiscard]] double error(Index p, double value) const {
        return std::isnan(value) ? std::max(range_, std::abs(at(p))) : std::abs(value - at(p));
    }

private:
    const std::vector<double>& values_;
    std::size_t channels_;
    double range_ = 0;
};

/// The largest error in each control cell, over the points of its 64 descendants.
std::vector<double> errors_of_cells(const RbfVolume& volume, const HexMesh& twice, std::size_t cells) {
    const std::vector<double> values = RbfField(volume, {.channel = 0, .least_weight = 0}).evaluate(twice.points);
    const ExactValues exact(twice);
    std::vector<double> errors(cells, 0);
    parallel_each(cells, [&](std::size_t c) {
        for (std::size_t descendant = 64 * c; descendant < 64 * (c + 1); ++descendant) {
            for (const Index p : twice.cells[descendant]) errors[c] = std::max(errors[c], exact.error(p, values[p]));
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
