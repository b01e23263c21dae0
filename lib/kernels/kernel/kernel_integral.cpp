// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "kernel_formulas.h"
#include "subvol/kernel.h"

// Every kernel has an integral in closed form: Gaussians by erf, powers of ρ by a recurrence, tables as piecewise linear
// functions.

namespace subvol {

namespace {

using detail::KernelFormulas;

constexpr int kPowers = 9;

/// A polynomial in s = ρ/scale, from the end of the piece before it to `end`.
struct Piece {
    double end;
    std::array<double, kPowers> coefficients;
};

struct Profile {
    double scale = 1;
    double amplitude = 1;
    std::vector<Piece> pieces;
};

Piece cubic_piece(double end, const glm::dvec4& k) {
    return {end, {k.x, k.y, k.z, k.w}};
}

Profile polynomial(KernelFormulas f) {
    const auto& p = f.parameters;
    switch (f.kind) {
        case KERNEL_COMPACT:
            return {p.x, 1, {{1, {1, 0, -3, 0, 3, 0, -1}}}};
        case KERNEL_WENDLAND_C2:
            return {p.x, p.y, {{1, {1, 0, -10, 20, -15, 4}}}};
        case KERNEL_WENDLAND_C4:
            return {p.x, p.y, {{1, {1, 0, -28.0 / 3, 0, 70, -448.0 / 3, 140, -64, 35.0 / 3}}}};
        default:
            return {
                1, 1, {cubic_piece(p.x / 2, f.kernel_cubic_inner(p.y, p.z)), cubic_piece(p.x, f.kernel_cubic_outer(p.y, p.z))}};
    }
}

/// ∫ Σ c_n sⁿ dz from 0 to z, s² = r² + z²: with Iₙ = ∫ sⁿ dz, (n+1) Iₙ = z sⁿ + n r² Iₙ₋₂.
double antiderivative(const std::array<double, kPowers>& c, double r, double z) {
    const double s = std::hypot(r, z);
    std::array<double, kPowers> integral{};
    integral[0] = z;
    integral[1] = 0.5 * (z * s + (r > 0 ? r * r * std::asinh(z / r) : 0));
    double sum = c[0] * integral[0] + c[1] * integral[1], power = s;
    for (std::size_t n = 2; n < kPowers; ++n) {
        power *= s;
        integral[n] = (z * power + static_cast<double>(n) * r * r * integral[n - 2]) / static_cast<double>(n + 1);
        sum += c[n] * integral[n];
    }
    return sum;
}

/// ∫ from 0 to z, z ≥ 0, at distance r from the kernel's centre.
double from_middle(const Profile& profile, double r, double z) {
    double sum = 0, from = 0;
    for (const Piece& piece : profile.pieces) {
        const double to = std::min(z, std::sqrt(std::max(piece.end * piece.end - r * r, 0.0)));
        if (to > from) sum += antiderivative(piece.coefficients, r, to) - antiderivative(piece.coefficients, r, from);
        from = std::max(from, to);
    }
    return sum;
}

double profile_integral(const Profile& profile, double r, double z0, double z1) {
    const auto signed_integral = [&](double z) {
        const double sum = from_middle(profile, r / profile.scale, std::abs(z) / profile.scale);
        return z < 0 ? -sum : sum;
    };
    return profile.amplitude * profile.scale * (signed_integral(z1) - signed_integral(z0));
}

/// ∫ exp(−z²/2σ²) dz
double gaussian_integral(double sigma, double z0, double z1) {
    const double root = sigma * std::numbers::sqrt2;
    return sigma * std::sqrt(std::numbers::pi / 2) * (std::erf(z1 / root) - std::erf(z0 / root));
}

double gaussians_integral(KernelFormulas f, double r, double z0, double z1) {
    const auto& p = f.parameters;
    const auto one = [&](double sigma) { return f.kernel_gaussian(r, sigma) * gaussian_integral(sigma, z0, z1); };
    if (f.kind == KERNEL_GAUSSIAN) return p.z * one(p.y);
    double sum = 0;
    for (std::size_t i = 0; i < f.second.size(); ++i) sum += f.first[i] * one(f.second[i]);
    return sum;
}

/// ∫ (a + b z²) exp(−z²/2σ²) dz, by parts.
double weighted_gaussian_integral(KernelFormulas f, double z0, double z1) {
    const auto& p = f.parameters;
    const double variance = p.y * p.y;
    const double ends = z1 * f.kernel_gaussian(z1, p.y) - z0 * f.kernel_gaussian(z0, p.y);
    return (p.z + p.w * variance) * gaussian_integral(p.y, z0, z1) - p.w * variance * ends;
}

/// ∫ of a function that is linear between the places of the table, from 0 to |z|, with the sign of z.
template <class Value>
double signed_table_integral(const KernelFormulas& f, const Value& value, double z) {
    const double step = f.parameters.x / (f.parameters.y - 1), end = std::abs(z);
    double sum = 0;
    for (int i = 0; i + 1 < static_cast<int>(f.parameters.y) && i * step < end; ++i) {
        const double part = std::min(end / step - i, 1.0);
        sum += step * part * (value(i) * (1 - part / 2) + value(i + 1) * part / 2);
    }
    return z < 0 ? -sum : sum;
}

template <class Value>
double table_integral(const KernelFormulas& f, const Value& value, double z0, double z1) {
    return signed_table_integral(f, value, z1) - signed_table_integral(f, value, z0);
}

double trilinear_integral(KernelFormulas f, double x, double y, double z0, double z1) {
    const auto& p = f.parameters;
    const int n = static_cast<int>(p.y), i = f.kernel_interval(x, p), j = f.kernel_interval(y, p);
    const double u = f.kernel_place(x, p), v = f.kernel_place(y, p);
    const auto value = [&](int k) {
        const int at = i + n * (j + n * k);
        return (1 - v) * ((1 - u) * f.kernel_table(at) + u * f.kernel_table(at + 1)) +
               v * ((1 - u) * f.kernel_table(at + n) + u * f.kernel_table(at + n + 1));
    };
    return table_integral(f, value, z0, z1);
}

double factor_integral(KernelFormulas f, double z0, double z1) {
    if (f.kind == KERNEL_SEPARABLE_GAUSSIAN) return weighted_gaussian_integral(f, z0, z1);
    if (f.kind == KERNEL_SEPARABLE_CUBIC) return profile_integral(polynomial(f), 0, z0, z1);
    return table_integral(
        f, [&](int i) { return f.kernel_table(i); }, z0, z1);
}

}  // namespace

double slab_integral(const Kernel& kernel, double x, double y, double z0, double z1) {
    auto f = detail::formulas_of(kernel);
    const auto& p = f.parameters;
    const bool radial = f.kind < KERNEL_SEPARABLE_GAUSSIAN;
    const double r = std::hypot(x, y);
    if (radial ? r >= p.x : std::max(std::abs(x), std::abs(y)) >= p.x) return 0;
    const double end = radial ? std::sqrt((p.x - r) * (p.x + r)) : p.x;
    z0 = std::clamp(z0, -end, end);
    z1 = std::clamp(z1, -end, end);
    if (f.kind == KERNEL_GAUSSIAN || f.kind == KERNEL_GAUSSIAN_SUM) return gaussians_integral(f, r, z0, z1);
    if (radial) return profile_integral(polynomial(f), r, z0, z1);
    if (f.kind == KERNEL_TABLE) return trilinear_integral(f, std::abs(x), std::abs(y), z0, z1);
    return f.kernel_factor(f.kind, p, std::abs(x)) * f.kernel_factor(f.kind, p, std::abs(y)) * factor_integral(f, z0, z1);
}

double line_integral(const Kernel& kernel, double x, double y) {
    const double radius = support_radius(kernel);
    return slab_integral(kernel, x, y, -radius, radius);
}

}  // namespace subvol
