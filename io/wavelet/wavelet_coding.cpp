// SPDX-License-Identifier: Apache-2.0
// Which details may go. A detail d at a point with the measure m changes the finest level by about d in m of its cells, so that
// it counts d²m in the sum of squares: √m weighs the levels. The wavelets are not orthogonal, so the threshold itself is found
// with the true error of the values put together again.
#include <algorithm>
#include <cmath>

#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"
#include "subvol/wavelet.h"

namespace subvol {

namespace {

using detail::parallel_each;

void check_tolerance(double tolerance) {
    if (!(tolerance > 0 && std::isfinite(tolerance))) {
        throw Error(ErrorCode::InvalidInput, "the tolerance is " + std::to_string(tolerance), "wavelets", "greater than 0");
    }
}

/// The largest x, to 2 %, for which error(x) is within the tolerance, if the error grows with x.
template <class ErrorOf>
double largest_within(double tolerance, const ErrorOf& error) {
    double good = 0, bad = 0, x = 2 * tolerance;
    for (int k = 0; k < 100 && (good == 0 || bad == 0); ++k) {
        if (error(x) <= tolerance) {
            good = x;
            x *= 2;
        } else {
            bad = x;
            x /= 2;
        }
    }
    if (bad == 0) return good;
    while (bad > 1.02 * good) {
        x = std::sqrt(good * bad);
        (error(x) <= tolerance ? good : bad) = x;
    }
    return good;
}

/// √measure of point p, where it is a number to divide by.
double weight_of(std::span<const double> measure, std::size_t p) {
    return measure[p] > 1e-3 ? std::sqrt(measure[p]) : 1;
}

std::span<const double> new_measure(const WaveletStep& step) {
    return std::span<const double>(step.measure).subspan(step.refine.columns());
}

/// Control values all have the same step, so that a constant field stays one; they are few, and have four times more exact
/// ones.
std::vector<double> control_measure(const WaveletBasis& basis) {
    double sum = 0;
    for (const double m : basis.measure) sum += m;
    return std::vector<double>(basis.control_points, 16 * sum / static_cast<double>(basis.control_points));
}

/// Details below half a step and a little more become 0, since they are many and small.
constexpr double kRounding = 0.4;

std::vector<std::int64_t> numbers_of(std::span<const double> values, std::span<const double> measure, std::size_t channels,
                                     double step, double rounding) {
    constexpr double kMost = 4503599627370496.0;  // 2⁵²
    std::vector<std::int64_t> numbers(values.size());
    parallel_each(values.size(), [&](std::size_t i) {
        const double part = std::abs(values[i]) * weight_of(measure, i / channels) / step;
        const double number = std::min(std::floor(part + rounding), kMost);
        numbers[i] = static_cast<std::int64_t>(std::copysign(number, values[i]));
    });
    const auto too_large = [&](std::int64_t n) {
        return n == static_cast<std::int64_t>(kMost) || -n == static_cast<std::int64_t>(kMost);
    };
    if (std::any_of(numbers.begin(), numbers.end(), too_large)) {
        throw Error(ErrorCode::InvalidInput, "the tolerance is too small for values of this size", "wavelets",
                    "at least 1e-12 of them");
    }
    return numbers;
}

std::vector<double> values_of(std::span<const std::int64_t> numbers, std::span<const double> measure, std::size_t channels,
                              double step) {
    std::vector<double> values(numbers.size());
    parallel_each(values.size(), [&](std::size_t i) {
        values[i] = static_cast<double>(numbers[i]) * step / weight_of(measure, i / channels);
    });
    return values;
}

void check_sizes(const WaveletBasis& basis, std::size_t channels, std::size_t coarse, std::size_t levels) {
    if (channels == 0 || coarse != basis.control_points * channels || levels != basis.steps.size()) {
        throw Error(ErrorCode::InvalidInput, "the numbers are not of this basis", "wavelets");
    }
}

}  // namespace

WaveletError difference(std::span<const double> a, std::span<const double> b, std::size_t channels,
                        std::span<const std::uint8_t> counted) {
    const std::size_t points = channels == 0 ? 0 : a.size() / channels;
    if (a.size() != b.size() || points * channels != a.size() || (!counted.empty() && counted.size() != points)) {
        throw Error(ErrorCode::InvalidInput, std::to_string(a.size()) + " and " + std::to_string(b.size()) + " values",
                    "difference", "equal numbers, of all points");
    }
    double sum = 0, most = 0, count = 0;
    for (std::size_t p = 0; p < points; ++p) {
        if (!counted.empty() && counted[p] == 0) continue;
        double square = 0;
        for (std::size_t k = p * channels; k < (p + 1) * channels; ++k) square += (a[k] - b[k]) * (a[k] - b[k]);
        sum += square;
        most = std::max(most, square);
        ++count;
    }
    return {std::sqrt(sum / std::max(count, 1.0)), std::sqrt(most)};
}

DroppedDetails drop_details(const WaveletBasis& basis, WaveletField& field, double tolerance) {
    check_tolerance(tolerance);
    const std::vector<double> exact = synthesize(basis, field);
    DroppedDetails report;
    const auto dropped = [&](double threshold) {
        WaveletField less = field;
        for (std::size_t l = 0; l < less.details.size(); ++l) {
            const auto measure = new_measure(basis.steps[l]);
            parallel_each(measure.size(), [&](std::size_t n) {
                double square = 0;
                for (std::size_t k = n * field.channels; k < (n + 1) * field.channels; ++k) {
                    square += less.details[l][k] * less.details[l][k];
                }
                if (std::sqrt(square) * weight_of(measure, n) >= threshold) return;
                std::fill_n(less.details[l].data() + n * field.channels, field.channels, 0.0);
            });
        }
        return less;
    };
    const auto error = [&](const WaveletField& less) { return difference(synthesize(basis, less), exact, field.channels); };
    field = dropped(largest_within(tolerance, [&](double threshold) { return error(dropped(threshold)).rms; }));
    report.error = error(field);
    for (const auto& details : field.details) {
        for (std::size_t i = 0; i < details.size(); i += field.channels) {
            ++report.details;
            for (std::size_t k = 0; k < field.channels; ++k) {
                if (details[i + k] == 0) continue;
                ++report.kept;
                break;
            }
        }
    }
    return report;
}

QuantizedWavelets quantize(const WaveletBasis& basis, const WaveletField& field, double step) {
    check_tolerance(step);
    check_sizes(basis, field.channels, field.coarse.size(), field.details.size());
    QuantizedWavelets numbers{
        field.channels, step, numbers_of(field.coarse, control_measure(basis), field.channels, step, 0.5), {}};
    for (std::size_t l = 0; l < field.details.size(); ++l) {
        numbers.details.push_back(numbers_of(field.details[l], new_measure(basis.steps[l]), field.channels, step, kRounding));
    }
    return numbers;
}

WaveletField restore(const WaveletBasis& basis, const QuantizedWavelets& numbers) {
    check_sizes(basis, numbers.channels, numbers.coarse.size(), numbers.details.size());
    WaveletField field{numbers.channels, values_of(numbers.coarse, control_measure(basis), numbers.channels, numbers.step), {}};
    for (std::size_t l = 0; l < numbers.details.size(); ++l) {
        if (numbers.details[l].size() != basis.steps[l].new_points() * numbers.channels) {
            throw Error(ErrorCode::InvalidInput, "the numbers are not of this basis", "wavelets");
        }
        field.details.push_back(values_of(numbers.details[l], new_measure(basis.steps[l]), numbers.channels, numbers.step));
    }
    return field;
}

QuantizedWavelets quantize_within(const WaveletBasis& basis, std::span<const double> values, std::size_t channels,
                                  double tolerance, std::span<const std::uint8_t> counted, const Progress* progress) {
    check_tolerance(tolerance);
    const WaveletField field = analyze(basis, values, channels);
    const auto error = [&](double step) {
        if (progress != nullptr && progress->cancelled()) throw Error(ErrorCode::Cancelled, "stopped in wavelets");
        return difference(synthesize(basis, restore(basis, quantize(basis, field, step))), values, channels, counted).rms;
    };
    return quantize(basis, field, largest_within(tolerance, error));
}

}  // namespace subvol
