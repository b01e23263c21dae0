// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/rbf_volume.h"

namespace subvol {

/// Moves the values of kernels beyond [min, max] to its nearer end, without derivatives there: the clamped field is constant
/// around them. Between kernels their sum can still go beyond by what the derivatives of the others add; whoever draws it
/// clamps that (`clamped`).
///
/// min, max: may be infinite
/// returns:  how many were moved
/// throws:   Error(InvalidInput) unless min ≤ max
std::size_t clamp_channel(RbfChannel& channel, double min, double max);

}  // namespace subvol
