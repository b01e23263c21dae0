// SPDX-License-Identifier: Apache-2.0
#include "color_space.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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

}  // namespace subvol::detail
