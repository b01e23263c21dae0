// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/number_text.h"

#include <array>
#include <charconv>
#include <limits>
#include <system_error>

namespace subvol::detail {

namespace {

// DBL_MAX has 309 digits before the point; up to 40 digits behind it.
using Buffer = std::array<char, 352>;

template <class... Format>
std::string text_of(double value, Format... format) {
    Buffer buffer;
    const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format...);
    return error == std::errc() ? std::string(buffer.data(), end) : exact_text(value);
}

}  // namespace

std::string number_text(double value, int digits) {
    return text_of(value, std::chars_format::general, digits);
}

std::string fixed_text(double value, int decimals) {
    return text_of(value, std::chars_format::fixed, decimals);
}

std::string exact_text(double value) {
    return text_of(value);
}

std::optional<double> number_from(std::string_view text) {
    while (text.starts_with(' ')) text.remove_prefix(1);
    while (text.ends_with(' ')) text.remove_suffix(1);
    const bool plus = text.size() > 1 && text[0] == '+' && text[1] != '-';  // from_chars does not accept a leading plus
    if (plus) text.remove_prefix(1);
    const char* const end = text.data() + text.size();
    double value = 0;
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error == std::errc::result_out_of_range && stop == end) {
        // The wider exponent of long double distinguishes too small from too large.
        long double wide = std::numeric_limits<long double>::infinity();
        if (std::from_chars(text.data(), end, wide).ec == std::errc()) return static_cast<double>(wide);
        return (text[0] == '-' ? -1 : 1) * std::numeric_limits<double>::infinity();
    }
    if (error != std::errc() || stop != end) return std::nullopt;
    return value;
}

}  // namespace subvol::detail
