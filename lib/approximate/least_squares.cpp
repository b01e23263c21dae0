// SPDX-License-Identifier: Apache-2.0
#include "least_squares.h"

#include <span>

#include "subvol/detail/parallel_each.h"
#include "subvol/detail/parallel_sums.h"

namespace subvol::detail {

namespace {

using Vector = std::vector<double>;

double dot(const Vector& a, const Vector& b) {
    return parallel_sums(1, a.size(), [&](std::size_t i, Vector& sum) { sum[0] += a[i] * b[i]; })[0];
}

// a += factor·b
void add(Vector& a, double factor, const Vector& b) {
    parallel_each(a.size(), [&](std::size_t i) { a[i] += factor * b[i]; });
}

}  // namespace

std::vector<double> LeastSquares::apply(const Vector& x) const {
    Vector values = limit_.apply(x);
    for (std::size_t e = 0; e < smoothing_.edges.size(); ++e) {
        const auto& [a, b] = smoothing_.edges[e];
        values.push_back(smoothing_.weights[e] * (x[a] - x[b]));
    }
    return values;
}

std::vector<double> LeastSquares::transposed(const Vector& values) const {
    Vector x = limit_.transposed(std::span(values).first(limit_.rows()));
    for (std::size_t e = 0; e < smoothing_.edges.size(); ++e) {
        const double value = smoothing_.weights[e] * values[limit_.rows() + e];
        x[smoothing_.edges[e][0]] += value;
        x[smoothing_.edges[e][1]] -= value;
    }
    return x;
}

int LeastSquares::solve(const Vector& wanted, Vector& x, int most, Progress* progress) const {
    Vector rest = apply(x);
    parallel_each(rest.size(), [&](std::size_t i) { rest[i] = (i < wanted.size() ? wanted[i] : 0.0) - rest[i]; });
    Vector gradient = transposed(rest);
    Vector direction = gradient;
    double size = dot(gradient, gradient);
    const double first = size;
    constexpr double kSmall = 1e-28;
    int step = 0;
    for (; step < most && size > kSmall * first; ++step) {
        report_progress(progress, "fit", static_cast<double>(step) / most);
        const Vector change = apply(direction);
        const double length = dot(change, change);
        if (!(length > 0)) break;
        add(x, size / length, direction);
        add(rest, -size / length, change);
        gradient = transposed(rest);
        const double next = dot(gradient, gradient);
        const double ratio = next / size;
        parallel_each(direction.size(), [&](std::size_t i) { direction[i] = gradient[i] + ratio * direction[i]; });
        size = next;
    }
    return step;
}

}  // namespace subvol::detail
