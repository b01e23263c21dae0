// SPDX-License-Identifier: Apache-2.0
// Curves of colours and of opacities become straight lines between knots.
//
// Colours between two knots are mixed in a space: sRGB, HSV by the shorter way round, Lab, or a polar form (m, s, h) of Lab,
// where two saturated colours of different hue meet in white; or the second one fills the interval. Opacities follow a cubic,
// shaped by a midpoint and a sharpness, between a straight line and a jump.
//
// Each interval is bisected until the curve is close to its chord, which is tested at seven places between the ends, for
// colours both in linear light and in sRGB: at most 1/512, with a tenth of that to spare. The bisection ends after 14 halvings
// in any case, so a kink is located to 1/16384 of the interval. Colours of the result are linear light. Knots at one value are
// set apart at the end.
#include "curves.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "subvol/detail/knot_values.h"
#include "subvol/srgb.h"

namespace subvol::detail {

namespace {

constexpr double kPi = std::numbers::pi;

Vec3 clamp_to_unit(const Vec3& c) {
    return glm::min(glm::max(c, Vec3(0.0)), Vec3(1.0));
}

Vec3 lerp(const Vec3& a, const Vec3& b, double s) {
    return (1 - s) * a + s * b;
}

/// Hue, saturation and value, all in [0,1]; grey has hue 0.
Vec3 hsv_from_rgb(const Vec3& c) {
    const double high = std::max({c.x, c.y, c.z}), width = high - std::min({c.x, c.y, c.z});
    if (!(width > 0)) return {0, 0, high};
    double sixth = 0;
    if (c.x == high) {
        sixth = (c.y - c.z) / width;
    } else if (c.y == high) {
        sixth = 2 + (c.z - c.x) / width;
    } else {
        sixth = 4 + (c.x - c.y) / width;
    }
    return {(sixth < 0 ? sixth + 6 : sixth) / 6, width / high, high};
}

Vec3 rgb_from_hsv(const Vec3& hsv) {
    const auto channel = [&](double offset) {
        const double k = std::fmod(offset + 6 * hsv.x, 6.0);
        return hsv.z * (1 - hsv.y * std::clamp(std::min(k, 4 - k), 0.0, 1.0));
    };
    return {channel(5), channel(3), channel(1)};
}

Vec3 mix_hsv(Vec3 a, Vec3 b, double s) {
    if (std::abs(a.x - b.x) > 0.5) (a.x > b.x ? a.x : b.x) -= 1;
    Vec3 mixed = lerp(a, b, s);
    if (mixed.x < 0) mixed.x += 1;
    return rgb_from_hsv(mixed);
}

// VTK's constants for D65, with four digits: more digits would give other colours than ParaView's.
constexpr Vec3 kWhite{0.9505, 1.000, 1.089};

double lab_from_ratio(double t) {
    return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116;
}

double ratio_from_lab(double f) {
    const double cube = f * f * f;
    return cube > 0.008856 ? cube : (f - 16.0 / 116) / 7.787;
}

Vec3 lab_from_rgb(const Vec3& rgb) {
    const Vec3 c = linear_from_srgb(rgb);
    const double x = lab_from_ratio((0.4124 * c.x + 0.3576 * c.y + 0.1805 * c.z) / kWhite.x);
    const double y = lab_from_ratio((0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z) / kWhite.y);
    const double z = lab_from_ratio((0.0193 * c.x + 0.1192 * c.y + 0.9505 * c.z) / kWhite.z);
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Vec3 rgb_from_lab(const Vec3& lab) {
    const double f = (lab.x + 16) / 116;
    const double x = kWhite.x * ratio_from_lab(f + lab.y / 500);
    const double y = kWhite.y * ratio_from_lab(f);
    const double z = kWhite.z * ratio_from_lab(f - lab.z / 200);
    const Vec3 linear(3.2406 * x - 1.5372 * y - 0.4986 * z, -0.9689 * x + 1.8758 * y + 0.0415 * z,
                      0.0557 * x - 0.2040 * y + 1.0570 * z);
    const Vec3 rgb(srgb_from_linear(linear.x), srgb_from_linear(linear.y), srgb_from_linear(linear.z));
    // A colour outside the gamut of sRGB is darkened until it is inside.
    return clamp_to_unit(rgb / std::max({rgb.x, rgb.y, rgb.z, 1.0}));
}

/// Lab in polar coordinates: magnitude, saturation and hue as angles.
struct Msh {
    double m, s, h;
};

constexpr double kUnsaturated = 0.05;

Msh msh_from_rgb(const Vec3& rgb) {
    const Vec3 lab = lab_from_rgb(rgb);
    const double m = glm::length(lab);
    const double s = m > 0.001 ? std::acos(std::clamp(lab.x / m, -1.0, 1.0)) : 0.0;
    return {m, s, s > 0.001 ? std::atan2(lab.z, lab.y) : 0.0};
}

double angle_between(double a, double b) {
    const double d = std::abs(a - b);
    return d > kPi ? 2 * kPi - d : d;
}

/// A hue for an unsaturated colour, such that the hue changes evenly on the way to it.
double hue_towards(const Msh& saturated, double m) {
    if (saturated.m >= m - 0.1) return saturated.h;
    const double spin = saturated.s * std::sqrt(m * m - saturated.m * saturated.m) / (saturated.m * std::sin(saturated.s));
    return saturated.h > -0.3 * kPi ? saturated.h + spin : saturated.h - spin;
}

Vec3 mix_diverging(const Vec3& first, const Vec3& second, double s) {
    Msh a = msh_from_rgb(first), b = msh_from_rgb(second);
    if (a.s > kUnsaturated && b.s > kUnsaturated && angle_between(a.h, b.h) > 0.33 * kPi) {
        const Msh white{std::max({a.m, b.m, 88.0}), 0, 0};
        (s < 0.5 ? b : a) = white;
        s = s < 0.5 ? 2 * s : 2 * s - 1;
    }
    if (a.s < kUnsaturated && b.s > kUnsaturated) {
        a.h = hue_towards(b, a.m);
    } else if (b.s < kUnsaturated && a.s > kUnsaturated) {
        b.h = hue_towards(a, b.m);
    }
    const double m = (1 - s) * a.m + s * b.m, angle = (1 - s) * a.s + s * b.s, hue = (1 - s) * a.h + s * b.h;
    return rgb_from_lab(m * Vec3(std::cos(angle), std::sin(angle) * std::cos(hue), std::sin(angle) * std::sin(hue)));
}

}  // namespace

std::optional<ColorSpace> color_space_named(std::string_view name) {
    if (name == "RGB") return ColorSpace::Rgb;
    if (name == "HSV") return ColorSpace::Hsv;
    if (name == "Lab" || name == "CIELAB" || name == "Lab/CIELAB" || name == "Lab/CIEDE2000") return ColorSpace::Lab;
    if (name == "Diverging") return ColorSpace::Diverging;
    if (name == "Step") return ColorSpace::Step;
    return std::nullopt;
}

Vec3 mix_colors(ColorSpace space, const Vec3& a, const Vec3& b, double s) {
    switch (space) {
        case ColorSpace::Hsv:
            return mix_hsv(hsv_from_rgb(a), hsv_from_rgb(b), s);
        case ColorSpace::Lab:
            return rgb_from_lab(lerp(lab_from_rgb(a), lab_from_rgb(b), s));
        case ColorSpace::Diverging:
            return mix_diverging(a, b, s);
        case ColorSpace::Step:
            return s > 0 ? b : a;
        case ColorSpace::Rgb:
            break;
    }
    return lerp(a, b, s);
}

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
