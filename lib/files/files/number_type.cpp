// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/number_type.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstring>
#include <limits>

namespace subvol::detail {

namespace {

template <class T>
T number_at(const char* bytes, std::endian order) {
    std::array<char, sizeof(T)> own;
    std::memcpy(own.data(), bytes, sizeof(T));
    if (order != std::endian::native) std::reverse(own.begin(), own.end());
    return std::bit_cast<T>(own);
}

// Calls `call` with a number of the C++ type that corresponds to `type`.
template <class Call>
auto with_type(NumberType type, const Call& call) {
    switch (type) {
        case NumberType::Int8:
            return call(std::int8_t{});
        case NumberType::UInt8:
            return call(std::uint8_t{});
        case NumberType::Int16:
            return call(std::int16_t{});
        case NumberType::UInt16:
            return call(std::uint16_t{});
        case NumberType::Int32:
            return call(std::int32_t{});
        case NumberType::UInt32:
            return call(std::uint32_t{});
        case NumberType::Int64:
            return call(std::int64_t{});
        case NumberType::UInt64:
            return call(std::uint64_t{});
        case NumberType::Float32:
            return call(float{});
        case NumberType::Float64:
            break;
    }
    return call(double{});
}

template <class Result>
Result number_from(std::string_view bytes, NumberType type, std::endian order) {
    return with_type(type, [&]<class T>(T) { return static_cast<Result>(number_at<T>(bytes.data(), order)); });
}

template <class Result>
std::vector<Result> numbers_from(std::string_view bytes, NumberType type, std::endian order) {
    std::vector<Result> result(bytes.size() / size_of(type));
    with_type(type, [&]<class T>(T) {
        for (std::size_t i = 0; i < result.size(); ++i) {
            // NOLINTNEXTLINE(bugprone-signed-char-misuse): a byte is a number here
            result[i] = static_cast<Result>(number_at<T>(bytes.data() + i * sizeof(T), order));
        }
    });
    return result;
}

}  // namespace

std::string_view name_of(NumberType type) {
    constexpr std::array<std::string_view, 10> kNames{"Int8",   "UInt8", "Int16",  "UInt16",  "Int32",
                                                      "UInt32", "Int64", "UInt64", "Float32", "Float64"};
    return kNames[static_cast<std::size_t>(type)];
}

std::size_t size_of(NumberType type) {
    return with_type(type, [](auto number) { return sizeof number; });
}

bool is_integer(NumberType type) {
    return type != NumberType::Float32 && type != NumberType::Float64;
}

bool can_be(double number, NumberType type) {
    return with_type(type, [&]<class T>(T) {
        using Limits = std::numeric_limits<T>;
        if constexpr (std::integral<T>) {
            // The largest integers of 64 bits are read as the nearest doubles.
            const double beyond = std::ldexp(1.0, Limits::digits);
            const bool low = Limits::digits > std::numeric_limits<double>::digits ? number <= beyond : number < beyond;
            return low && number == std::trunc(number) && number >= (Limits::is_signed ? -beyond : 0.0);
        } else {
            return !std::isfinite(number) || std::abs(number) < std::ldexp(1.0, Limits::max_exponent);
        }
    });
}

double real_from(std::string_view bytes, NumberType type, std::endian order) {
    return number_from<double>(bytes, type, order);
}

std::int64_t integer_from(std::string_view bytes, NumberType type, std::endian order) {
    return number_from<std::int64_t>(bytes, type, order);
}

std::vector<double> reals_from(std::string_view bytes, NumberType type, std::endian order) {
    return numbers_from<double>(bytes, type, order);
}

std::vector<std::int64_t> integers_from(std::string_view bytes, NumberType type, std::endian order) {
    return numbers_from<std::int64_t>(bytes, type, order);
}

}  // namespace subvol::detail
