// SPDX-License-Identifier: Apache-2.0
#include "subvol/clamped.h"

#include <cmath>

#include "subvol/error.h"

namespace subvol {

TransferFunction clamped(const TransferFunction& function, double min, double max) {
    validate(function);
    if (!std::isfinite(min) || !std::isfinite(max) || min > max)
        throw Error(ErrorCode::InvalidInput, "the range is not finite, or its ends are exchanged", "clamp");
    TransferFunction result;
    result.color.push_back({min, color_at(function, min)});
    result.opacity.push_back({min, alpha_at(function, min)});
    for (const auto& knot : function.color) {
        if (knot.value > min && knot.value < max) result.color.push_back(knot);
    }
    for (const auto& knot : function.opacity) {
        if (knot.value > min && knot.value < max) result.opacity.push_back(knot);
    }
    if (min < max) {
        result.color.push_back({max, color_at(function, max)});
        result.opacity.push_back({max, alpha_at(function, max)});
    }
    return result;
}

}  // namespace subvol
