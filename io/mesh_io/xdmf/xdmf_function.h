// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace subvol::detail {

/// The values of a data item that is a function of others: sums, products, parentheses, SQRT, ABS, SIN, COS, TAN, EXP, LOG of
/// its arguments $0, $1, …, each of the same length or one number; JOIN($0, $1, …) puts the first values of all side by side,
/// then the second ones.
///
/// fail: throws an Error with a sentence
[[nodiscard]] std::vector<double> value_of_xdmf_function(std::string_view function,
                                                         const std::vector<std::vector<double>>& arguments,
                                                         const std::function<void(const std::string&)>& fail);

}  // namespace subvol::detail
