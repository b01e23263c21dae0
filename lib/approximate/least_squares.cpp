// SPDX-License-Identifier: Apache-2.0
#include "least_squares.h"

#include <array>
#include <numeric>
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

LeastSquares::LeastSquares(const LimitMatrix& limit, const WeightedDifferences& smoothing, std::vector<double> support)
    : limit_(limit), smoothing_(smoothing), scales_(std::move(support)) {
    for (std::size_t e = 0; e < smoothing_.edges.size(); ++e) {
        for (const Index p : smoothing_.edges[e]) scales_[p] += smoothing_.weights[e] * smoothing_.weights[e];
    }
    for (double& scale : scales_) scale = scale > 0 ? 1 / scale : 1;
}

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
    Vector gradient, scaled(x.size());
    const auto find_gradient = [&] {
        gradient = transposed(rest);
        parallel_each(scaled.size(), [&](std::size_t i) { scaled[i] = scales_[i] * gradient[i]; });
        return dot(gradient, scaled);
    };
    double size = find_gradient(), squares = dot(rest, rest);
    Vector direction = scaled;
    const double first = size;
    constexpr double kSmall = 1e-28, kEnough = 1e-10;
    std::array<double, 10> falls;  // of the squares, in the last steps
    falls.fill(squares);
    int step = 0;
    for (; step < most && size > kSmall * first; ++step) {
        if (std::accumulate(falls.begin(), falls.end(), 0.0) < kEnough * squares) break;
        report_progress(progress, "fit", static_cast<double>(step) / most);
        const Vector change = apply(direction);
        const double length = dot(change, change);
        if (!(length > 0)) break;
        add(x, size / length, direction);
        add(rest, -size / length, change);
        squares = dot(rest, rest);
        falls[static_cast<std::size_t>(step) % falls.size()] = size / length * size;
        const double next = find_gradient(), ratio = next / size;
        parallel_each(direction.size(), [&](std::size_t i) { direction[i] = scaled[i] + ratio * direction[i]; });
        size = next;
    }
    return step;
}

}  // namespace subvol::detail
