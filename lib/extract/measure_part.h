// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "subvol/measure.h"

namespace subvol::detail {

/// The cells of a part of a mesh that are measured; the others are its halo.
///
/// owned:        a flag for each cell
/// longest_side: of the box of the whole
struct MeasuredCells {
    std::span<const std::uint8_t> owned;
    double longest_side;
};

/// Volume, integrals and extremes over the owned cells; without histograms. options.groups: empty
[[nodiscard]] LimitMeasure measure_part(const HexMesh& part, const MeasuredCells& cells, const MeasureOptions& options);

/// Adds the owned cells to the histograms of the whole, between the extremes that it has. The histograms have their bins.
void add_to_histograms(const HexMesh& part, const MeasuredCells& cells, const MeasureOptions& options, PartMeasure& whole);

}  // namespace subvol::detail
