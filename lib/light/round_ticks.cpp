// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "subvol/detail/round_ticks.h"

namespace subvol::detail {
namespace {

/// digit · 10^exponent
struct Step {
    int digit = 1;
    int exponent = 0;

    [[nodiscard]] double value() const { return digit * std::pow(10.0, exponent); }
    [[nodiscard]] Step next() const {
        return digit == 1 ? Step{2, exponent} : digit == 2 ? Step{5, exponent} : Step{1, exponent + 1};
    }
    /// n · step, rounded only once where possible.
    [[nodiscard]] double times(double n) const {
        return exponent < 0 ? n * digit / std::pow(10.0, -exponent) : n * digit * std::pow(10.0, exponent);
    }
};

std::string text_of(double value, std::chars_format format, int precision) {
    std::array<char, 64> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format, precision).ptr;
    return {buffer.data(), end};
}

/// The text of a multiple of 10^exponent, without meaningless digits.
std::string label_of(double value, int exponent) {
    if (value == 0) return "0";
    const int magnitude = static_cast<int>(std::floor(std::log10(std::abs(value)) + 1e-9));
    const std::string sign = value < 0 ? "\u2212" : "";
    const bool plain = magnitude < 6 && exponent > -6;
    if (plain) return sign + text_of(std::abs(value), std::chars_format::fixed, std::max(0, -exponent));
    return sign + text_of(std::abs(value), std::chars_format::scientific, std::clamp(magnitude - exponent, 0, 17));
}

}  // namespace

std::vector<Tick> round_ticks(double min, double max, int most) {
    Step step{1, static_cast<int>(std::floor(std::log10((max - min) / most)))};
    const auto first = [&] { return std::ceil(min / step.value() - 1e-9); };
    const auto last = [&] { return std::floor(max / step.value() + 1e-9); };
    while (last() - first() + 1 > most) step = step.next();
    std::vector<Tick> ticks;
    for (double n = first(); n <= last(); ++n) {
        const double value = step.times(n);
        ticks.push_back({value, label_of(value, step.exponent)});
    }
    return ticks;
}

}  // namespace subvol::detail
