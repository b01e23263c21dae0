// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "subvol/reduce.h"

namespace subvol::detail {

/// Moves centres, sizes and terms of the volume's first channel to fit the samples. Returns iterations and bytes.
struct MovingFitReport {
    int iterations = 0;
    std::size_t bytes = 0;
};
MovingFitReport fit_moving(RbfVolume& volume, const FieldSamples& samples, const RbfRefineOptions& options);

}  // namespace subvol::detail
