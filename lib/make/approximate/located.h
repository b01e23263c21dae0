// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "data_field.h"
#include "fitter.h"
#include "subvol/limit.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// How well samples decide the control values.
struct Support {
    std::vector<double> of_points;  ///< the sum of the squares of the trilinear weights that a value has in the samples
    double usual = 0;               ///< median of the values of `of_points` above 0

    /// places: of the samples, in control cells
    Support(const Topology& topology, const std::vector<LimitQuery>& places);

    /// Samples hardly decide the value at a point.
    [[nodiscard]] bool is_poor(std::size_t point) const {
        constexpr double kPoor = 0.05;  // of the usual support: the corner of a box has an eighth of it
        return of_points[point] <= kPoor * usual;
    }
};

/// Samples that lie in the volume, with their places in control cells. After those at points of the data come those between
/// them.
struct Located {
    std::vector<LimitQuery> places;
    std::vector<Vec3> positions;
    std::vector<std::uint8_t> is_snapped;  ///< a flag for each sample, whether it lies outside
    std::vector<Index> samples;            ///< points of the data, of the first samples
    std::vector<LimitQuery> between;       ///< places in the cells of the data, of the other samples
    std::size_t outside = 0, snapped = 0;

    /// Of the values at points of the data, if some lie in the volume.
    [[nodiscard]] std::ranges::minmax_result<double> range_of(const std::vector<double>& values) const {
        return std::ranges::minmax(std::span(values).first(samples.empty() ? values.size() : samples.size()));
    }
};

/// Finds the points of the data, and places between them where these are few.
///
/// throws: Error(InvalidInput) if there is none in the volume
[[nodiscard]] Located located_samples(const HexMesh& mesh, const Topology& topology, const DataField& data,
                                      const ApproximateOptions& options, SampleFinder& finder);

}  // namespace subvol::detail
