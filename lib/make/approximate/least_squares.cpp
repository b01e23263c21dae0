// SPDX-License-Identifier: Apache-2.0
#include "least_squares.h"

#include <array>
#include <numeric>
#include <span>

#include "subvol/detail/conjugate_gradients.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/parallel_sums.h"
#include "subvol/detail/sparse_rows.h"

namespace subvol::detail {

namespace {

using Vector = std::vector<double>;

double dot(const Vector& a, const Vector& b) {
    return parallel_sums(1, a.size(), [&](std::size_t i, Vector& sum) { sum[0] += a[i] * b[i]; })[0];
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
      transposed_(transpose_of(differences, limit.columns())),
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
    parallel_each(row_count(differences_), [&](std::size_t i) { values[limit_.rows() + i] = row_times(differences_, i, x); });
    return values;
}

std::vector<double> LeastSquares::transposed(const Vector& values, bool with_differences) const {
    Vector x = limit_.transposed(std::span(values).first(limit_.rows()));
    if (!with_differences) return x;
    const auto of_differences = std::span(values).subspan(limit_.rows());
    parallel_each(x.size(), [&](std::size_t p) { x[p] += row_times(transposed_, p, of_differences); });
    return x;
}

LeastSquares::Found LeastSquares::search(const Search& how, const Vector& wanted, Vector& x, Progress* progress) const {
    Vector rest = apply(x, how.with_differences);
    parallel_each(rest.size(), [&](std::size_t i) { rest[i] = (i < wanted.size() ? wanted[i] : 0.0) - rest[i]; });
    constexpr double kSmall = 1e-28;
    double first = 0, squares = 0, product = 0;
    std::array<double, 10> falls;  // of the squares, in the last steps
    int step = 0;
    const int steps = conjugate_gradients(
        x, rest,
        [&](Vector& scaled) {
            const Vector gradient = transposed(rest, how.with_differences);
            parallel_each(scaled.size(), [&](std::size_t i) { scaled[i] = scales_[i] * gradient[i]; });
            return dot(gradient, scaled);
        },
        [&](const Vector& direction, Vector& image) { image = apply(direction, how.with_differences); },
        [&](const Vector&, const Vector& image) {
            const double curvature = dot(image, image);
            falls[static_cast<std::size_t>(step) % falls.size()] = product / curvature * product;
            return curvature;
        },
        [&](int made, double now) {
            step = how.first_step + made;
            product = now;
            squares = dot(rest, rest);
            if (made == 0) first = product, falls.fill(squares);
            if (step >= how.most_steps || !(product > kSmall * first)) return false;
            if (std::accumulate(falls.begin(), falls.end(), 0.0) < how.enough * squares) return false;
            report_progress(progress, "fit", static_cast<double>(step) / how.most_steps);
            return true;
        });
    return {how.first_step + steps, squares};
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
