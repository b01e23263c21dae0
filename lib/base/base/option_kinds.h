// SPDX-License-Identifier: Apache-2.0
// What all sources of Option share: numbers among its kinds of values, and the widest ranges.
#pragma once

#include <cstdint>
#include <optional>
#include <type_traits>

namespace subvol::detail {

inline constexpr double kLeastPositive = 1e-100, kMostPositive = 1e100;
inline constexpr double kMostWhole = 18446744073709549568.0;  // the largest double below 2⁶⁴

template <class>
struct Content;
template <class T>
struct Content<T*> {
    using Type = T;
};
template <class T>
struct Content<std::optional<T>*> {
    using Type = T;
};

template <class Pointer>
constexpr bool kIsNumber =
    std::is_same_v<Pointer, int*> || std::is_same_v<Pointer, std::uint64_t*> || std::is_same_v<Pointer, double*> ||
    std::is_same_v<Pointer, std::optional<int>*> || std::is_same_v<Pointer, std::optional<std::uint64_t>*> ||
    std::is_same_v<Pointer, std::optional<double>*>;

}  // namespace subvol::detail
