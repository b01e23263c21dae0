// SPDX-License-Identifier: Apache-2.0
#include "subvol/basis_function.h"

#include <array>
#include <cmath>

#include "subvol/detail/mcq_grid.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace {

constexpr int kMaxLevel = 7;  // 76 MB of values

struct Term {
    std::array<int, 3> offset;  // from the lowest corner of the new point's segment, face or cell, in points of the old level
    double weight;
};

/// The masks of MCQ: bits u + 2v + 4w are set for the axes along which the new point lies half way.
std::array<std::vector<Term>, 8> mcq_terms(double tension) {
    constexpr int kSide = detail::McqGrid::kSide, kShift = 1 + kSide + kSide * kSide;  // offsets are −1 to 2 along each axis
    const detail::McqGrid grid(tension);
    std::array<std::vector<Term>, 8> terms;
    for (std::size_t half = 0; half < 8; ++half) {
        for (const auto& [weight, offsets] : grid.masks()[half]) {
            for (const int packed : offsets) {
                const int o = packed + kShift;
                terms[half].push_back({{o % kSide - 1, o / kSide % kSide - 1, o / (kSide * kSide) - 1}, weight});
            }
        }
    }
    return terms;
}

BasisFunction next_level(const BasisFunction& coarse, const std::array<std::vector<Term>, 8>& masks) {
    BasisFunction fine{.scheme = coarse.scheme, .level = coarse.level + 1, .half_width = coarse.half_width, .values = {}};
    const auto last = static_cast<std::size_t>(fine.last());
    fine.values.reserve(wedge_size(last));
    each_in_wedge(last, [&](std::size_t i, std::size_t j, std::size_t k) {
        const int x = static_cast<int>(i / 2), y = static_cast<int>(j / 2), z = static_cast<int>(k / 2);
        double sum = 0;
        for (const auto& [offset, weight] : masks[(i & 1) + 2 * (j & 1) + 4 * (k & 1)]) {
            sum += weight * coarse.at(x + offset[0], y + offset[1], z + offset[2]);
        }
        fine.values.push_back(sum);
    });
    return fine;
}

BasisFunction mcq_basis(int level, double tension) {
    BasisFunction basis{.scheme = Scheme::Mcq, .level = 0, .half_width = 3, .values = std::vector<double>(wedge_size(3))};
    basis.values[0] = 1;
    const auto masks = mcq_terms(tension);
    while (basis.level < level) basis = next_level(basis, masks);
    return basis;
}

double cubic_spline(double t) {
    const double left = 2 - t;
    return t < 1 ? (4 - 6 * t * t + 3 * t * t * t) / 6 : left * left * left / 6;
}

double hat(double t) {
    return 1 - t;
}

BasisFunction product_basis(Scheme scheme, int level, int half_width, double (*factor)(double)) {
    BasisFunction basis{.scheme = scheme, .level = level, .half_width = half_width, .values = {}};
    std::vector<double> line;
    for (int i = 0; i <= basis.last(); ++i) line.push_back(factor(std::ldexp(i, -level)));
    each_in_wedge(line.size() - 1,
                  [&](std::size_t i, std::size_t j, std::size_t k) { basis.values.push_back(line[i] * line[j] * line[k]); });
    return basis;
}

}  // namespace

BasisFunction sample_basis_function(Scheme scheme, int level, double tension) {
    if (level < 0 || level > kMaxLevel) {
        throw Error(ErrorCode::InvalidInput, "the level of the basis function is " + std::to_string(level), {}, "0 to 7");
    }
    if (!std::isfinite(tension)) throw Error(ErrorCode::InvalidInput, "the tension is not a finite number");
    switch (scheme) {
        case Scheme::CatmullClark:
        case Scheme::Bsxw:
            return product_basis(scheme, level, 2, cubic_spline);
        case Scheme::Linear:
            return product_basis(scheme, level, 1, hat);
        case Scheme::Mcq:
            break;
    }
    return mcq_basis(level, tension);
}

}  // namespace subvol
