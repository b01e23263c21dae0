// SPDX-License-Identifier: Apache-2.0
#include "bernstein.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace subvol::detail {

namespace {

constexpr std::size_t kMostDegree = 16;

// Binomial coefficients.
constexpr auto kBinomials = [] {
    std::array<std::array<double, kMostDegree + 1>, kMostDegree + 1> rows{};
    for (std::size_t n = 0; n <= kMostDegree; ++n) {
        rows[n][0] = 1;
        for (std::size_t k = 1; k <= n; ++k) rows[n][k] = rows[n - 1][k - 1] + (k < n ? rows[n - 1][k] : 0);
    }
    return rows;
}();

double binomial(int n, std::size_t k) {
    return kBinomials[static_cast<std::size_t>(n)][k];
}

// Multiplies (or divides) each coefficient by its binomials: in this form products are convolutions.
template <class Value>
void scale(Bernstein<Value>& p, bool divide) {
    const auto n = p.size();
    for (std::size_t i = 0; i < n[0]; ++i) {
        for (std::size_t j = 0; j < n[1]; ++j) {
            for (std::size_t k = 0; k < n[2]; ++k) {
                const double factor = binomial(p.degree[0], i) * binomial(p.degree[1], j) * binomial(p.degree[2], k);
                Value& value = p.values[(i * n[1] + j) * n[2] + k];
                value = divide ? value / factor : value * factor;
            }
        }
    }
}

// The convolution of two polynomials whose coefficients are scaled. multiply(a, b): of two coefficients
template <class Result, class Multiply>
Bernstein<Result> convolve(const Bernstein<Vec3>& a, const Bernstein<Vec3>& b, const Multiply& multiply) {
    Bernstein<Result> product;
    for (std::size_t axis = 0; axis < 3; ++axis) product.degree[axis] = a.degree[axis] + b.degree[axis];
    const auto n = a.size(), m = b.size(), r = product.size();
    product.values.assign(r[0] * r[1] * r[2], Result(0));
    for (std::size_t i = 0; i < n[0] * n[1] * n[2]; ++i) {
        const std::size_t i0 = i / (n[1] * n[2]), i1 = i / n[2] % n[1], i2 = i % n[2];
        for (std::size_t j0 = 0; j0 < m[0]; ++j0) {
            for (std::size_t j1 = 0; j1 < m[1]; ++j1) {
                Result* to = product.values.data() + (((i0 + j0) * r[1] + i1 + j1) * r[2] + i2);
                const Vec3* from = b.values.data() + (j0 * m[1] + j1) * m[2];
                for (std::size_t j2 = 0; j2 < m[2]; ++j2) to[j2] += multiply(a.values[i], from[j2]);
            }
        }
    }
    return product;
}

}  // namespace

Vec3 value_at(const Bernstein<Vec3>& polynomial, const Vec3& uvw) {
    const auto n = polynomial.size();
    std::array<std::array<double, kMostDegree + 1>, 3> basis{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const int degree = polynomial.degree[axis];
        const double t = uvw[static_cast<int>(axis)];
        for (std::size_t i = 0; i < n[axis]; ++i) {
            double& value = basis[axis][i] = binomial(degree, i);
            for (std::size_t k = 0; k < i; ++k) value *= t;
            for (std::size_t k = i; k < static_cast<std::size_t>(degree); ++k) value *= 1 - t;
        }
    }
    Vec3 sum(0.0);
    const Vec3* value = polynomial.values.data();
    for (std::size_t i = 0; i < n[0]; ++i) {
        for (std::size_t j = 0; j < n[1]; ++j) {
            for (std::size_t k = 0; k < n[2]; ++k) sum += *value++ * (basis[0][i] * basis[1][j] * basis[2][k]);
        }
    }
    return sum;
}

std::array<Vec3, 27> values_at_halves(const Bernstein<Vec3>& polynomial) {
    std::vector<Vec3> values = polynomial.values;
    std::size_t before = 1, after = values.size();  // values of the axes before and after the one that is evaluated
    for (std::size_t axis = 0; axis < 3; ++axis, before *= 3) {
        const int degree = polynomial.degree[axis];
        const std::size_t n = polynomial.size()[axis];
        after /= n;
        std::vector<Vec3> evaluated(before * 3 * after, Vec3(0.0));
        for (std::size_t b = 0; b < before; ++b) {
            for (std::size_t a = 0; a < after; ++a) {
                const auto at = [&](std::size_t k) { return values[(b * n + k) * after + a]; };
                Vec3* to = &evaluated[b * 3 * after + a];
                to[0] = at(0);
                for (std::size_t k = 0; k < n; ++k) to[after] += at(k) * std::ldexp(binomial(degree, k), -degree);
                to[2 * after] = at(n - 1);
            }
        }
        values = std::move(evaluated);
    }
    std::array<Vec3, 27> places;
    std::ranges::copy(values, places.begin());
    return places;
}

Bernstein<double> determinant(const BernsteinColumns& columns) {
    BernsteinColumns scaled = columns;
    for (auto& column : scaled) scale(column, false);
    const auto normals = convolve<Vec3>(scaled[1], scaled[2], [](const Vec3& a, const Vec3& b) { return glm::cross(a, b); });
    auto product = convolve<double>(scaled[0], normals, [](const Vec3& a, const Vec3& b) { return glm::dot(a, b); });
    scale(product, true);
    return product;
}

Bernstein<Vec3> half(const Bernstein<Vec3>& polynomial, std::size_t axis, bool upper) {
    Bernstein<Vec3> part = polynomial;
    const auto n = part.size();
    const std::size_t stride = axis == 0 ? n[1] * n[2] : axis == 1 ? n[2] : 1;
    for (std::size_t start = 0; start < part.values.size(); ++start) {
        if (start / stride % n[axis] != 0) continue;
        const auto at = [&](std::size_t k) -> Vec3& { return part.values[start + k * stride]; };
        // De Casteljau: what stays behind at the end where each round begins is the half's coefficient.
        for (std::size_t round = 1; round < n[axis]; ++round) {
            if (upper) {
                for (std::size_t k = 0; k + round < n[axis]; ++k) at(k) = (at(k) + at(k + 1)) * 0.5;
            } else {
                for (std::size_t k = n[axis] - 1; k >= round; --k) at(k) = (at(k - 1) + at(k)) * 0.5;
            }
        }
    }
    return part;
}

}  // namespace subvol::detail
