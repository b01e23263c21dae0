// SPDX-License-Identifier: Apache-2.0
#include "curves.h"

#include <algorithm>
#include <cmath>

#include "knot_values.h"
#include "subvol/srgb.h"

namespace subvol::detail {
namespace {

// Appends places in (from, to], the last of them `to`, such that a curve is close to its chord between neighbouring places.
//
// is_close(a, b): whether it is between the places a and b
template <class IsClose>
void add_chord_ends(const IsClose& is_close, double from, double to, std::vector<double>& places, int depth = 0) {
    constexpr int kMaxDepth = 14;  // a kink is located to 1/16384 of the interval
    if (depth == kMaxDepth || is_close(from, to)) {
        places.push_back(to);
        return;
    }
    const double middle = 0.5 * (from + to);
    add_chord_ends(is_close, from, middle, places, depth + 1);
    add_chord_ends(is_close, middle, to, places, depth + 1);
}

// Whether deviation(s, t), at s = a + t (b − a), stays within 1/512 between a and b. It is sampled at seven places only: hence
// the factor .9.
template <class Deviation>
bool deviates_little(const Deviation& deviation, double a, double b) {
    for (int i = 1; i < 8; ++i) {
        const double t = i / 8.0;
        if (!(deviation(a + t * (b - a), t) <= 0.9 / 512)) return false;
    }
    return true;
}

// Appends the knots make(s) at begin + s · (end − begin), except those that rounding puts on or before a neighbour.
template <class Knot, class Make>
void append_between(std::vector<Knot>& knots, const std::vector<double>& places, double begin, double end, const Make& make) {
    for (const double s : places) {
        const double value = begin + s * (end - begin);
        if (value > knots.back().value && value < end) knots.push_back({value, make(s)});
    }
}

using ColorKnot = TransferFunction::ColorKnot;

double largest(const Vec3& difference) {
    const Vec3 d = glm::abs(difference);
    return std::max({d.x, d.y, d.z});
}

Vec3 encoded(const Vec3& linear) {
    return {srgb_from_linear(linear.x), srgb_from_linear(linear.y), srgb_from_linear(linear.z)};
}

void append_piece(const ColorKnot& first, const ColorKnot& second, ColorSpace space, std::vector<ColorKnot>& straight) {
    if (!(first.value < second.value)) return;
    if (space == ColorSpace::Step) {
        straight.push_back({first.value, linear_from_srgb(second.rgb)});
        return;
    }
    const auto color = [&](double s) { return mix_colors(space, first.rgb, second.rgb, s); };
    const auto is_close = [&](double from, double to) {
        const Vec3 a = linear_from_srgb(color(from)), b = linear_from_srgb(color(to));
        const auto deviation = [&](double s, double t) {
            const Vec3 chord = (1 - t) * a + t * b, exact = color(s);
            return std::max(largest(linear_from_srgb(exact) - chord), largest(exact - encoded(chord)));
        };
        return deviates_little(deviation, from, to);
    };
    std::vector<double> places;
    add_chord_ends(is_close, 0, 1, places);
    append_between(straight, places, first.value, second.value, [&](double s) { return linear_from_srgb(color(s)); });
}

constexpr double kStraight = 0.01, kJump = 0.99;

// How far the curve has come from one alpha (0) to the next (1) at the place s in [0,1] between the knots: a cubic with slopes
// (1 − sharpness) at its ends, whose argument changes the faster about the midpoint the sharper the curve.
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

std::vector<ColorKnot> straight_pieces(std::span<const ColorKnot> knots, ColorSpace space) {
    std::vector<ColorKnot> straight{{knots.front().value, linear_from_srgb(knots.front().rgb)}};
    for (std::size_t i = 1; i < knots.size(); ++i) {
        append_piece(knots[i - 1], knots[i], space, straight);
        straight.push_back({knots[i].value, linear_from_srgb(knots[i].rgb)});
    }
    part_equal_values(straight);
    return straight;
}

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
