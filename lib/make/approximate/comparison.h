// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "located.h"

namespace subvol::detail {

/// Where the limit is compared with the data between the samples.
struct Comparison {
    std::vector<LimitQuery> places;   ///< places in control cells
    std::vector<LimitQuery> in_data;  ///< places in the cells of the data, which has a value there
    std::vector<Index> nearest;       ///< for other data, the nearest sample in the cells around
};

/// Of a mesh of data: some thousand places in it.
[[nodiscard]] Comparison comparison_in_data(const DataField& data, SampleFinder& finder, Progress* progress);

/// Of other data: some thousand places in the control cells.
[[nodiscard]] Comparison comparison_with_samples(const HexMesh& mesh, const Topology& topology, const Located& located,
                                                 const SchemeOptions& scheme);

/// Places in the cells in which a channel of a field has its least and its greatest values at corners.
[[nodiscard]] std::vector<LimitQuery> places_of_extremes(const Topology& topology, const Attribute& field);

}  // namespace subvol::detail
