// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace subvol::detail {

/// The type of a number in a binary file.
enum class NumberType { Int8, UInt8, Int16, UInt16, Int32, UInt32, Int64, UInt64, Float32, Float64 };

/// "UInt8"
[[nodiscard]] std::string_view name_of(NumberType type);
[[nodiscard]] std::size_t size_of(NumberType type);
[[nodiscard]] bool is_integer(NumberType type);
/// Whether a number that is written as text may belong to the type: 300 and 1.5 are no UInt8, 1e300 is no Float32.
[[nodiscard]] bool can_be(double number, NumberType type);

/// The number that `bytes` begins with.
[[nodiscard]] double real_from(std::string_view bytes, NumberType type, std::endian order);
/// The same for integer types; a number of 2^63 or more becomes negative, which is not valid as a count or an index.
[[nodiscard]] std::int64_t integer_from(std::string_view bytes, NumberType type, std::endian order);

/// All numbers of a block of bytes.
[[nodiscard]] std::vector<double> reals_from(std::string_view bytes, NumberType type, std::endian order);
[[nodiscard]] std::vector<std::int64_t> integers_from(std::string_view bytes, NumberType type, std::endian order);

}  // namespace subvol::detail
