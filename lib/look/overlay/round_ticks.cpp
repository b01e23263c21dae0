// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/round_ticks.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>

#include "subvol/detail/number_text.h"

namespace subvol::detail {
namespace {

// A multiple of a step below these has fewer than 50 bits: neighbours differ, also after the rounding of `times`.
constexpr double kMostMultiple = 0x1p50;
constexpr double kLeastStep = 1e-300;  // powers of ten down to here have normal inverses

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
    std::array<char, 400> buffer{};  // of %f: 309 digits, and 20
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format, precision).ptr;
    return {buffer.data(), end};
}

std::string sign_of(double value) {
    return value < 0 ? "\u2212" : "";
}

/// The text of a multiple of 10^exponent, without meaningless digits.
std::string label_of(double value, int exponent) {
    if (value == 0) return "0";
    const int magnitude = static_cast<int>(std::floor(std::log10(std::abs(value)) + 1e-9));
    const std::string sign = sign_of(value);
    const bool plain = magnitude < 6 && exponent > -6;
    if (plain) return sign + text_of(std::abs(value), std::chars_format::fixed, std::max(0, -exponent));
    return sign + text_of(std::abs(value), std::chars_format::scientific, std::clamp(magnitude - exponent, 0, 17));
}

Tick exact_tick(double value) {
    return {value, sign_of(value) + exact_text(std::abs(value))};
}

}  // namespace

std::vector<Tick> round_ticks(double min, double max, int most) {
    const double least_step = max / most - min / most;  // max - min may be more than the largest number
    if (!(least_step >= kLeastStep)) return {exact_tick(min), exact_tick(max)};
    Step step{1, static_cast<int>(std::floor(std::log10(least_step)))};
    const auto first = [&] { return std::ceil(min / step.value() - 1e-9); };
    const auto last = [&] { return std::floor(max / step.value() + 1e-9); };
    const auto coarse_enough = [&] {
        return std::max(std::abs(first()), std::abs(last())) < kMostMultiple && last() - first() + 1 <= most;
    };
    while (!coarse_enough()) step = step.next();
    std::vector<Tick> ticks;
    for (double n = first(); n <= last(); ++n) {
        const double value = step.times(n);
        ticks.push_back({value, label_of(value, step.exponent)});
    }
    if (ticks.size() >= 2) return ticks;
    return {exact_tick(min), exact_tick(max)};  // only a few numbers lie between them, and none is round
}

namespace {

/// Powers of ten, and these times `digits`, whose size lies in [least, most], ascending.
std::vector<Tick> decades(double least, double most, std::initializer_list<int> digits) {
    std::vector<Tick> ticks;
    constexpr double kRounding = 1e-9;
    const int first = static_cast<int>(std::floor(std::log10(least) + kRounding));
    for (int exponent = first; exponent <= std::log10(most) + kRounding; ++exponent) {
        for (const int digit : digits) {
            const double value = Step{digit, exponent}.value();
            if (value >= least * (1 - kRounding) && value <= most * (1 + kRounding))
                ticks.push_back({value, label_of(value, exponent)});
        }
    }
    return ticks;
}

/// Every n-th tick, so that there are no more than `most`.
std::vector<Tick> thinned(const std::vector<Tick>& ticks, int most) {
    const std::size_t step = (ticks.size() + static_cast<std::size_t>(most) - 1) / static_cast<std::size_t>(most);
    std::vector<Tick> kept;
    for (std::size_t i = 0; i < ticks.size(); i += step) kept.push_back(ticks[i]);
    return kept;
}

/// The decades of one sign, of at most `most` ticks.
std::vector<Tick> side_ticks(double least, double largest, int most) {
    if (!(least > 0) || !(largest >= least)) return {};
    std::vector<Tick> ticks = decades(least, largest, {1, 2, 5});
    if (ticks.size() > static_cast<std::size_t>(most)) ticks = decades(least, largest, {1});
    return ticks.size() > static_cast<std::size_t>(most) ? thinned(ticks, most) : ticks;
}

}  // namespace

namespace {

/// The bands from one tick to the next, so that there are at most `most` ticks after the first: if possible a divisor of all,
/// so that both ends of the range have a tick.
int band_step(int bands, int most) {
    const int least = (bands + most - 1) / most;
    for (const int step : {least, least + 1}) {
        if (bands % step == 0) return step;
    }
    return least;
}

}  // namespace

std::vector<Tick> bar_ticks(const ColorShape& shape, double min, double max, int most) {
    const ColorScale& scale = shape.scale;
    std::vector<Tick> ticks;
    constexpr int kMostBandsOfTick = 3;  // of more, bands are hardly seen, and round values are read better
    if (shape.bands > 0 && shape.bands <= kMostBandsOfTick * most) {
        for (int end = 0; end <= shape.bands; end += band_step(shape.bands, most + 2)) {
            const double value = end == 0 ? min : end == shape.bands ? max : scale.at(double(end) / shape.bands, min, max);
            ticks.push_back({value, sign_of(value) + number_text(std::abs(value), 4)});
        }
        return ticks;
    }
    if (scale.logarithmic) ticks = side_ticks(min, max, most);
    if (scale.linear_within > 0) {
        const int each = min < 0 && max > 0 ? most / 2 : most;
        for (const Tick& tick : side_ticks(std::max(scale.linear_within, -max), -min, each))
            ticks.insert(ticks.begin(), {-tick.value, sign_of(-1) + tick.label});
        if (min <= 0 && max >= 0) ticks.push_back({0, "0"});
        for (const Tick& tick : side_ticks(std::max(scale.linear_within, min), max, each)) ticks.push_back(tick);
    }
    return ticks.size() >= 2 ? ticks : round_ticks(min, max, most);
}

std::vector<Tick> formatted(std::vector<Tick> ticks, const std::string& format) {
    if (format.empty()) return ticks;
    const std::size_t percent = format.find('%'), kind = format.find_first_of("efg", percent);
    const std::size_t dot = format.find('.', percent);
    int digits = 6;
    if (dot != std::string::npos && dot < kind) std::from_chars(format.data() + dot + 1, format.data() + kind, digits);
    const auto style = format[kind] == 'e'   ? std::chars_format::scientific
                       : format[kind] == 'f' ? std::chars_format::fixed
                                             : std::chars_format::general;
    for (Tick& tick : ticks) {
        tick.label = format.substr(0, percent) + sign_of(tick.value) + text_of(std::abs(tick.value), style, digits) +
                     format.substr(kind + 1);
    }
    return ticks;
}

}  // namespace subvol::detail
