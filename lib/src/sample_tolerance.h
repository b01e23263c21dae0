#pragma once

#include "subvol/sample.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// Samples with as many intervals as it takes until the field's first channel errs by less than options.tolerance at every
/// point of the twice refined mesh, or has 64 intervals on every edge where it does not.
[[nodiscard]] SampleResult sample_to_tolerance(const HexMesh& control, const HexMesh& twice_refined, const Topology& topology,
                                               const SampleOptions& options);

}  // namespace subvol::detail
