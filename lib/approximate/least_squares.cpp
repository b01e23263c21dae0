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

std::size_t row_count(const CsrMatrix& matrix) {
    return matrix.offsets.size() - 1;
}

// Row i of the matrix times x.
double row_of(const CsrMatrix& matrix, std::size_t i, std::span<const double> x) {
    double sum = 0;
    for (std::size_t k = matrix.offsets[i]; k < matrix.offsets[i + 1]; ++k) sum += matrix.weights[k] * x[matrix.columns[k]];
    return sum;
}

CsrMatrix by_columns(const CsrMatrix& matrix, std::size_t columns) {
    CsrMatrix made{.offsets = std::vector<std::size_t>(columns + 1, 0),
                   .columns = std::vector<Index>(matrix.columns.size()),
                   .weights = std::vector<double>(matrix.columns.size())};
    for (const Index column : matrix.columns) ++made.offsets[column + std::size_t{1}];
    for (std::size_t c = 0; c < columns; ++c) made.offsets[c + 1] += made.offsets[c];
    std::vector<std::size_t> next(made.offsets.begin(), made.offsets.end() - 1);
    for (std::size_t row = 0; row < row_count(matrix); ++row) {
        for (std::size_t k = matrix.offsets[row]; k < matrix.offsets[row + 1]; ++k) {
            const std::size_t to = next[matrix.columns[k]]++;
            made.columns[to] = static_cast<Index>(row);
            made.weights[to] = matrix.weights[k];
        }
    }
    return made;
}

}  // namespace

/// enough: it ends when ten steps took off less than this part of the sum of squares that is left
struct LeastSquares::Search {
    bool with_differences;
    int first_step, most_steps;
    double enough;
};

/// squares: the sum that is left
struct LeastSquares::Found {
    int steps;
    double squares;
};

LeastSquares::LeastSquares(const LimitMatrix& limit, const CsrMatrix& differences, bool first, std::vector<double> support)
    : limit_(limit),
      differences_(differences),
      transposed_(by_columns(differences, limit.columns())),
      first_(first),
      scales_(std::move(support)) {
    for (std::size_t k = 0; k < differences.columns.size(); ++k)
        scales_[differences.columns[k]] += differences.weights[k] * differences.weights[k];
    for (double& scale : scales_) scale = scale > 0 ? 1 / scale : 1;
}

std::vector<double> LeastSquares::apply(const Vector& x, bool with_differences) const {
    Vector values = limit_.apply(x);
    if (!with_differences) return values;
    values.resize(limit_.rows() + row_count(differences_));
    parallel_each(row_count(differences_), [&](std::size_t i) { values[limit_.rows() + i] = row_of(differences_, i, x); });
    return values;
}

std::vector<double> LeastSquares::transposed(const Vector& values, bool with_differences) const {
    Vector x = limit_.transposed(std::span(values).first(limit_.rows()));
    if (!with_differences) return x;
    const auto of_differences = std::span(values).subspan(limit_.rows());
    parallel_each(x.size(), [&](std::size_t p) { x[p] += row_of(transposed_, p, of_differences); });
    return x;
}

LeastSquares::Found LeastSquares::search(const Search& how, const Vector& wanted, Vector& x, Progress* progress) const {
    Vector rest = apply(x, how.with_differences);
    parallel_each(rest.size(), [&](std::size_t i) { rest[i] = (i < wanted.size() ? wanted[i] : 0.0) - rest[i]; });
    Vector gradient, scaled(x.size());
    const auto find_gradient = [&] {
        gradient = transposed(rest, how.with_differences);
        parallel_each(scaled.size(), [&](std::size_t i) { scaled[i] = scales_[i] * gradient[i]; });
        return dot(gradient, scaled);
    };
    double size = find_gradient(), squares = dot(rest, rest);
    Vector direction = scaled;
    const double first = size;
    constexpr double kSmall = 1e-28;
    std::array<double, 10> falls;  // of the squares, in the last steps
    falls.fill(squares);
    int step = how.first_step;
    for (; step < how.most_steps && size > kSmall * first; ++step) {
        if (std::accumulate(falls.begin(), falls.end(), 0.0) < how.enough * squares) break;
        report_progress(progress, "fit", static_cast<double>(step) / how.most_steps);
        const Vector change = apply(direction, how.with_differences);
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
    return {step, squares};
}

int LeastSquares::solve(const Vector& wanted, Vector& x, int most, Progress* progress) const {
    constexpr double kEnough = 1e-10, kHalved = 0.1, kMet = 1e-20;
    const bool weak = !first_ && row_count(differences_) > 0;
    int steps = 0;
    if (weak) {
        const Found found = search({false, 0, most, kHalved}, wanted, x, progress);
        if (found.squares <= kMet * dot(wanted, wanted)) return found.steps;
        steps = found.steps;
    }
    return search({row_count(differences_) > 0, steps, most, kEnough}, wanted, x, progress).steps;
}

}  // namespace subvol::detail
