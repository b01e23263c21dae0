// SPDX-License-Identifier: Apache-2.0
#include "sharp_curve.h"

#include <algorithm>
#include <cmath>

#include "knots.h"

namespace subvol::detail {
namespace {

constexpr double kStraight = 0.01, kJump = 0.99;

/// The part of the way from one alpha to the next that is done at s of the interval. A cubic with slopes (1 − sharpness) at its
/// ends, run through ever faster about the midpoint.
double progress_at(double s, double midpoint, double sharpness) {
    double t = s < midpoint ? 0.5 * s / midpoint : 0.5 + 0.5 * (s - midpoint) / (1 - midpoint);
    if (sharpness < kStraight) return t;
    const double power = 1 + 10 * sharpness;
    t = t < 0.5 ? 0.5 * std::pow(2 * t, power) : 1 - 0.5 * std::pow(2 * (1 - t), power);
    const double slope = 1 - sharpness;
    return std::clamp(t * t * (3 - 2 * t) + slope * t * (1 - t) * (1 - 2 * t), 0.0, 1.0);
}

void append_piece(const SharpKnot& a, const SharpKnot& b, std::vector<TransferFunction::OpacityKnot>& straight) {
    const double width = b.value - a.value, midpoint = std::clamp(a.midpoint, 1e-5, 1 - 1e-5);
    if (!(width > 0)) return;
    if (a.sharpness > kJump) {
        straight.push_back({a.value + midpoint * width, a.alpha});
        straight.push_back({a.value + midpoint * width, b.alpha});
        return;
    }
    const auto alpha = [&](double s) { return a.alpha + progress_at(s, midpoint, a.sharpness) * (b.alpha - a.alpha); };
    const auto is_close = [&](double from, double to) {
        const double first = alpha(from), last = alpha(to);
        return deviates_little([&](double s, double t) { return std::abs(alpha(s) - (1 - t) * first - t * last); }, from, to);
    };
    if (is_close(0, 1)) return;
    std::vector<double> places;
    add_chord_ends(is_close, 0, midpoint, places);  // the curve has a kink there
    add_chord_ends(is_close, midpoint, 1, places);
    append_between(straight, places, a.value, b.value, alpha);
}

}  // namespace

std::vector<TransferFunction::OpacityKnot> straight_pieces(std::span<const SharpKnot> knots) {
    std::vector<TransferFunction::OpacityKnot> straight{{knots.front().value, knots.front().alpha}};
    for (std::size_t i = 1; i < knots.size(); ++i) {
        append_piece(knots[i - 1], knots[i], straight);
        straight.push_back({knots[i].value, knots[i].alpha});
    }
    part_equal_values(straight);
    return straight;
}

}  // namespace subvol::detail
