// SPDX-License-Identifier: Apache-2.0
#include "subvol/clamp_channel.h"

#include "subvol/error.h"

namespace subvol {

std::size_t clamp_channel(RbfChannel& channel, double min, double max) {
    if (!(min <= max)) throw Error(ErrorCode::InvalidInput, "the ends of the range are exchanged, or no numbers", "clamp");
    const auto low = static_cast<float>(min), high = static_cast<float>(max);
    std::size_t moved = 0;
    for (std::size_t i = 0; i < channel.values.size(); ++i) {
        float& value = channel.values[i];
        if (value >= low && value <= high) continue;
        value = value < low ? low : high;
        if (i < channel.gradients.size()) channel.gradients[i] = {0, 0, 0};
        if (i < channel.moments.size()) channel.moments[i] = 0;
        if (i < channel.hessians.size()) channel.hessians[i] = {};
        ++moved;
    }
    return moved;
}

}  // namespace subvol
