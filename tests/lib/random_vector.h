// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>

#include "subvol/vec.h"

namespace subvol::test {

/// A vector of random numbers, the same from every compiler: of three calls among the arguments of a constructor each compiler
/// chooses the order.
inline Vec3 random_vector(std::uniform_real_distribution<double>& number, std::mt19937& random) {
    const double z = number(random), y = number(random), x = number(random);
    return {x, y, z};
}

}  // namespace subvol::test
