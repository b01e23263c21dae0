// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <string_view>
#include <vector>

namespace subvol::detail {

/// A function of the channels of a vector or tensor at one point.
struct TensorFunction {
    std::string_view name;
    std::string_view takes;      ///< which fields it takes, for errors
    std::span<const int> sizes;  ///< the numbers of channels that it takes; none: any
    double (*value)(std::span<const double> channels);
    bool is_linear = false;  ///< its limit is that of its values at the points
    bool is_size = false;    ///< it is never negative

    [[nodiscard]] bool takes_channels(int channels) const {
        return sizes.empty() || std::ranges::find(sizes, channels) != sizes.end();
    }
};

/// Null: there is none of that name.
[[nodiscard]] const TensorFunction* find_tensor_function(std::string_view name);

/// The names of all.
[[nodiscard]] std::vector<std::string_view> tensor_functions();

}  // namespace subvol::detail
