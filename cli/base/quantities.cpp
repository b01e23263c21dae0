// SPDX-License-Identifier: Apache-2.0
#include "quantities.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "subvol/detail/number_text.h"

namespace subvol::cli {
namespace {

/// Two or three digits: 1.4, 14, 142.
std::string short_number(double value) {
    return detail::fixed_text(value, value < 9.95 ? 1 : 0);
}

}  // namespace

std::string bytes_text(double bytes) {
    constexpr std::array<const char*, 5> kUnits{"bytes", "kB", "MB", "GB", "TB"};
    std::size_t unit = 0;
    for (; bytes >= 999.5 && unit + 1 < kUnits.size(); ++unit) bytes /= 1000;
    return (unit == 0 ? detail::fixed_text(bytes, 0) : short_number(bytes)) + " " + kUnits[unit];
}

std::string seconds_text(double seconds) {
    if (seconds < 1e-3) return "under 1 ms";
    if (seconds < .9995) return short_number(1000 * seconds) + " ms";
    if (seconds < 59.5) return short_number(seconds) + " s";
    const auto whole = static_cast<std::uint64_t>(std::lround(seconds));
    if (whole < 3600) return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
    return std::to_string(whole / 3600) + " h " + std::to_string(whole % 3600 / 60) + " min";
}

std::string count_text(std::uint64_t count) {
    std::string digits = std::to_string(count);
    for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, ",");
    return digits;
}

std::string counted(std::uint64_t count, const std::string& one, const std::string& many) {
    return count_text(count) + " " + (count == 1 ? one : many.empty() ? one + "s" : many);
}

std::string aligned(const Lines& lines) {
    std::size_t width = 0;
    for (const auto& [name, words] : lines) width = std::max(width, name.size());
    std::string all;
    for (const auto& [name, words] : lines) all += name + std::string(width - name.size() + 2, ' ') + words + "\n";
    return all;
}

}  // namespace subvol::cli
