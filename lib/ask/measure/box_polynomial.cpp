// SPDX-License-Identifier: Apache-2.0
#include "box_polynomial.h"

#include <algorithm>
#include <cmath>

namespace subvol::detail {

namespace {

constexpr std::size_t kMostCoefficients = 5;

/// Calls call(first) for the first coefficient of each of the nine lines along an axis.
template <class Call>
void each_line(std::size_t axis, const Call& call) {
    const std::size_t other = kCoefficientSteps[(axis + 1) % 3], third = kCoefficientSteps[(axis + 2) % 3];
    for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t i = 0; i < 3; ++i) call(i * other + j * third);
    }
}

std::array<double, 3> weights_at(double t) {
    return {(1 - t) * (1 - t), 2 * t * (1 - t), t * t};
}

std::array<double, 3> slopes_at(double t) {
    return {2 * t - 2, 2 - 4 * t, 2 * t};
}

double sum(const BoxPolynomial& f, const std::array<double, 3>& u, const std::array<double, 3>& v,
           const std::array<double, 3>& w) {
    double all = 0;
    for (std::size_t k = 0, n = 0; k < 3; ++k) {
        double plane = 0;
        for (std::size_t j = 0; j < 3; ++j, n += 3) plane += v[j] * (u[0] * f[n] + u[1] * f[n + 1] + u[2] * f[n + 2]);
        all += w[k] * plane;
    }
    return all;
}

/// A polynomial of one variable by its Bézier coefficients.
struct LinePolynomial {
    std::array<double, kMostCoefficients> of{};
    std::size_t count = 0;

    [[nodiscard]] int sign_changes() const {
        int changes = 0;
        double last = 0;
        for (std::size_t k = 0; k < count; ++k) {
            if (of[k] == 0) continue;
            if (last != 0 && (last < 0) != (of[k] < 0)) ++changes;
            last = of[k];
        }
        return changes;
    }
    [[nodiscard]] std::array<LinePolynomial, 2> halves() const {
        std::array<LinePolynomial, 2> both{*this, *this};
        auto& [first, second] = both;
        for (std::size_t k = 1; k < count; ++k) {
            for (std::size_t i = 0; i + k < count; ++i) second.of[i] = (second.of[i] + second.of[i + 1]) / 2;
            first.of[k] = second.of[0];
        }
        return both;
    }
    [[nodiscard]] double at(double t) const {
        std::array<double, kMostCoefficients> row = of;
        for (std::size_t k = 1; k < count; ++k) {
            for (std::size_t i = 0; i + k < count; ++i) row[i] += t * (row[i + 1] - row[i]);
        }
        return row[0];
    }
};

/// The one place where the polynomial changes its sign, by false position that keeps both ends moving (Illinois).
double only_root(const LinePolynomial& f) {
    double a = 0, b = 1, fa = f.of[0], fb = f.of[f.count - 1];
    if (fa == 0) return 0;
    if (fb == 0) return 1;
    constexpr int kRounds = 60;
    constexpr double kNear = 1e-16;
    int last = 0;
    for (int round = 0; round < kRounds && b - a > kNear; ++round) {
        const double t = round % 4 == 3 ? (a + b) / 2 : std::clamp((a * fb - b * fa) / (fb - fa), a, b), ft = f.at(t);
        if (ft == 0) return t;
        if ((ft < 0) == (fa < 0)) {
            a = t;
            fa = ft;
            if (last == -1) fb /= 2;
            last = -1;
        } else {
            b = t;
            fb = ft;
            if (last == 1) fa /= 2;
            last = 1;
        }
    }
    return (a + b) / 2;
}

void add_roots_of(const LinePolynomial& f, double from, double width, std::vector<double>& roots) {
    constexpr double kLeastWidth = 1e-9;  // two roots nearer than this are none
    const int changes = f.sign_changes();
    if (changes == 0) return;
    if (changes == 1) {
        const double root = from + width * only_root(f);
        if (root > 0 && root < 1) roots.push_back(root);
        return;
    }
    if (width < kLeastWidth) return;
    const auto halves = f.halves();
    add_roots_of(halves[0], from, width / 2, roots);
    add_roots_of(halves[1], from + width / 2, width / 2, roots);
}

}  // namespace

BoxPolynomial polynomial_through(const BoxPolynomial& values) {
    BoxPolynomial f = values;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t step = kCoefficientSteps[axis];
        each_line(axis, [&](std::size_t n) { f[n + step] = 2 * f[n + step] - (f[n] + f[n + 2 * step]) / 2; });
    }
    return f;
}

BoxPolynomial restricted(const BoxPolynomial& polynomial, const Vec3& lower, const Vec3& upper) {
    BoxPolynomial f = polynomial;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double s = lower[static_cast<int>(axis)], t = upper[static_cast<int>(axis)];
        if (s == 0 && t == 1) continue;
        const std::size_t step = kCoefficientSteps[axis];
        each_line(axis, [&](std::size_t n) {
            const double a = f[n], b = f[n + step], c = f[n + 2 * step];
            const auto blossom = [&](double x, double y) {
                return (1 - x) * ((1 - y) * a + y * b) + x * ((1 - y) * b + y * c);
            };
            f[n] = blossom(s, s);
            f[n + step] = blossom(s, t);
            f[n + 2 * step] = blossom(t, t);
        });
    }
    return f;
}

std::array<double, 3> on_line(const BoxPolynomial& polynomial, int axis, const Vec3& at) {
    const auto a = static_cast<std::size_t>(axis);
    const std::size_t step = kCoefficientSteps[a], other = kCoefficientSteps[(a + 1) % 3],
                      third = kCoefficientSteps[(a + 2) % 3];
    const auto v = weights_at(at[(axis + 1) % 3]), w = weights_at(at[(axis + 2) % 3]);
    std::array<double, 3> line{};
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t j = 0; j < 3; ++j) {
            const double weight = v[j] * w[k];
            for (std::size_t i = 0; i < 3; ++i) line[i] += weight * polynomial[i * step + j * other + k * third];
        }
    }
    return line;
}

double value_at(const BoxPolynomial& polynomial, const Vec3& at) {
    return sum(polynomial, weights_at(at.x), weights_at(at.y), weights_at(at.z));
}

Vec3 slope_at(const BoxPolynomial& polynomial, const Vec3& at) {
    const auto u = weights_at(at.x), v = weights_at(at.y), w = weights_at(at.z);
    return {sum(polynomial, slopes_at(at.x), v, w), sum(polynomial, u, slopes_at(at.y), w),
            sum(polynomial, u, v, slopes_at(at.z))};
}

std::array<double, 5> product(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return {a[0] * b[0], (a[0] * b[1] + a[1] * b[0]) / 2, (a[0] * b[2] + 4 * a[1] * b[1] + a[2] * b[0]) / 6,
            (a[1] * b[2] + a[2] * b[1]) / 2, a[2] * b[2]};
}

void add_roots(std::span<const double> coefficients, std::vector<double>& roots) {
    LinePolynomial f;
    f.count = coefficients.size();
    std::ranges::copy(coefficients, f.of.begin());
    add_roots_of(f, 0, 1, roots);
}

}  // namespace subvol::detail
