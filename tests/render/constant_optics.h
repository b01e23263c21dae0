// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "subvol/optics.h"

namespace subvol::test {

/// White with extinction τ = ln 2 per world length, whatever the value.
inline Optics constant_optics() {
    return {{{{0, {1, 1, 1}}}, {{0, 0.5}}}, 1.0};
}

/// Their opacity over a length.
inline double constant_alpha(double length) {
    return -std::expm1(-std::log(2.0) * length);
}

}  // namespace subvol::test
