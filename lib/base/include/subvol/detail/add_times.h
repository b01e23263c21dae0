// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace subvol::detail {

/// Adds a number or a vector, times a factor.
template <class Value>
void add_times(Value& to, double factor, const Value& value) {
    to += factor * value;
}

/// The same for several numbers side by side, with one factor or with a factor for each.
template <std::size_t N>
void add_times(std::array<double, N>& to, double factor, const std::array<double, N>& values) {
    for (std::size_t i = 0; i < N; ++i) to[i] += factor * values[i];
}
template <std::size_t N>
void add_times(std::array<double, N>& to, const std::array<double, N>& factors, const std::array<double, N>& values) {
    for (std::size_t i = 0; i < N; ++i) to[i] += factors[i] * values[i];
}

}  // namespace subvol::detail
