// SPDX-License-Identifier: Apache-2.0
#include "kernel_origins.h"

#include <algorithm>
#include <cmath>

#include "subvol/detail/place_function.h"

namespace subvol::detail {

TransferFunction less(TransferFunction function, const std::array<double, 2>& origins) {
    for (auto& knot : function.opacity) knot.value -= origins[0];
    for (auto& knot : function.color) knot.value -= origins[1];
    return function;
}

void move_down(HexMesh& mesh, const std::array<double, 2>& origins) {
    const auto move = [](Attribute& field, double origin) {
        change_values(field, [origin](double value) { return value - origin; });
    };
    move(mesh.attributes.front(), origins[0]);
    if (mesh.attributes.size() > 1) move(mesh.attributes.back(), origins[1]);
}

double origin_for(double low, double high) {
    constexpr double kMostRounding = 1e-4, kHalfDigit = 0x1p-25;  // a fortieth of a step of 8 bits
    const double largest = std::max(std::abs(low), std::abs(high));
    return low < high && largest * kHalfDigit > kMostRounding * (high - low) ? low + (high - low) / 2 : 0;
}

}  // namespace subvol::detail
