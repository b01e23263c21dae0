// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>

#include "subvol/hex_mesh.h"

namespace subvol::test {

/// A field at the points of a mesh whose values are all different, and no short decimals.
inline Attribute field_of_roots(const HexMesh& mesh, const char* name, int channels) {
    Attribute made{name, channels, {}};
    for (std::size_t k = 0; k < mesh.points.size() * static_cast<std::size_t>(channels); ++k) {
        made.values.push_back(std::sqrt(static_cast<double>(k) + 0.1));
    }
    return made;
}

}  // namespace subvol::test
