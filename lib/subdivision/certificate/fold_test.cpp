// SPDX-License-Identifier: Apache-2.0
#include "fold_test.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace subvol::detail {

namespace {

// Rounding: each component of a derivative is a sum of at most 180 products with weights of a sum of magnitudes below 4.5, so
// that it is within 1e-12 of the largest difference in this component; the rest is to spare. H need not be an exact inverse:
// any matrix will do whose determinant is certainly positive, as it is where the condition is not extreme. Points of a window
// may be multiplied by H before their differences are taken: about one of them they are a few differences long, so that this
// rounds by less than 1e-13 of the largest one.
constexpr double kRounding = 3e-12;
constexpr double kMostCondition = 1e8;
constexpr double kOfDeterminants = 1e-9;
// An error of points changes differences by twice, and derivatives by at most eight times as much.
constexpr double kOfPoints = 8;

double largest_row(const Mat3& m) {
    const Vec3 sums = glm::abs(m[0]) + glm::abs(m[1]) + glm::abs(m[2]);
    return std::max({sums.x, sums.y, sums.z});
}

double permanent(const Mat3& m) {
    const auto minor = [&](int r, int s) { return m[1][r] * m[2][s] + m[2][r] * m[1][s]; };
    return m[0][0] * minor(1, 2) + m[0][1] * minor(0, 2) + m[0][2] * minor(0, 1);
}

// Σ_c |Y_ac − δ_ac| + R_ac over all coefficients, the largest of all rows a. Columns of one degree are taken coefficient by
// coefficient.
double norm_of(const BernsteinColumns& y, const Mat3& rest) {
    const bool alike = y[0].degree == y[1].degree && y[1].degree == y[2].degree;
    Vec3 most(0.0), separate(0.0);
    const auto away = [&](int c, std::size_t k) {
        Vec3 value = y[static_cast<std::size_t>(c)].values[k];
        value[c] -= 1;
        return glm::abs(value);
    };
    for (int c = 0; c < 3; ++c) {
        Vec3 largest(0.0);
        for (std::size_t k = 0; k < y[static_cast<std::size_t>(c)].values.size(); ++k) largest = glm::max(largest, away(c, k));
        separate += largest;
    }
    for (std::size_t k = 0; alike && k < y[0].values.size(); ++k) most = glm::max(most, away(0, k) + away(1, k) + away(2, k));
    const Vec3 sums = (alike ? most : separate) + rest[0] + rest[1] + rest[2];
    return std::max({sums.x, sums.y, sums.z});
}

bool has_positive_determinant(const BernsteinColumns& y, const Mat3& rest) {
    Mat3 largest(0.0);
    for (int c = 0; c < 3; ++c) {
        for (const Vec3& value : y[static_cast<std::size_t>(c)].values) largest[c] = glm::max(largest[c], glm::abs(value));
    }
    const double all = permanent(largest + rest);
    const double change = all - permanent(largest) + kOfDeterminants * all;
    // Coefficients at corners are the determinants there: most parts that fail do so at one of them.
    for (std::size_t k = 0; k < 8; ++k) {
        const auto at = [&](std::size_t c) { return y[c].corner(k >> 2 & 1, k >> 1 & 1, k & 1); };
        if (!(glm::determinant(Mat3(at(0), at(1), at(2))) > change)) return false;
    }
    const Bernstein<double> det = determinant(y);
    return *std::ranges::min_element(det.values) > change;
}

}  // namespace

PartDecision witness(const PartJacobians& part, double error) {
    PartDecision decision;
    const double each = kOfPoints * error + kRounding * std::max({part.size.x, part.size.y, part.size.z});  // of a column
    for (std::size_t k = 0; k < part.at.size(); ++k) {
        const Mat3& j = part.at[k];
        const double det = glm::determinant(j);
        if (!(det < 0) || (decision.verdict == PartVerdict::Folded && det >= decision.determinant)) continue;
        const double a = glm::length(j[0]), b = glm::length(j[1]), c = glm::length(j[2]);
        const double margin = each * (a * b + b * c + c * a) + each * each * (a + b + c) + each * each * each;
        if (det < -2 * margin) decision = {PartVerdict::Folded, k, det};
    }
    return decision;
}

std::optional<PartScale> part_scale(const Mat3& center, const Vec3& size, double error) {
    if (!(glm::determinant(center) > 0)) return std::nullopt;
    const Mat3 inverse = glm::inverse(center);
    const double condition = largest_row(center) * largest_row(inverse);
    if (!(condition < kMostCondition)) return std::nullopt;
    const Vec3 of_points(2 * kOfPoints * error + std::numeric_limits<double>::min());
    Vec3 slack(kRounding);
    for (int k = 0; k < 3; ++k) slack += glm::abs(inverse[k]) * (kRounding * size[k] + of_points[k]);
    return PartScale{inverse, slack};
}

bool is_positive(PartDerivatives scaled, const Vec3& slack) {
    for (int c = 0; c < 3; ++c) scaled.rest[c] += slack;
    return norm_of(scaled.columns, scaled.rest) < 1 || has_positive_determinant(scaled.columns, scaled.rest);
}

template <std::size_t kCoefficients>
bool passes_norm(const PartSlopes<kCoefficients>& slopes, double error) {
    // Any matrix will do as G; this one is near the derivatives in the middle.
    Mat3 center;
    Vec3 size(0.0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t c = 0; c < 3; ++c) {
            double sum = 0, most = 0;
            for (const double slope : slopes[axis][c]) {
                sum += slope;
                most = std::max(most, std::abs(slope));
            }
            center[static_cast<int>(axis)][static_cast<int>(c)] = sum / kCoefficients;
            size[static_cast<int>(c)] = std::max(size[static_cast<int>(c)], most);
        }
    }
    const auto scale = part_scale(center, size, error);
    if (!scale) return false;
    Vec3 sums = scale->slack * 3.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (int row = 0; row < 3; ++row) {
            const double h0 = scale->inverse[0][row], h1 = scale->inverse[1][row], h2 = scale->inverse[2][row];
            const double unit = static_cast<int>(axis) == row ? 1 : 0;
            constexpr std::size_t kLanes = std::min<std::size_t>(8, kCoefficients);
            std::array<double, kLanes> most{};
            for (std::size_t k = 0; k < kCoefficients; k += kLanes) {
                for (std::size_t lane = 0; lane < kLanes; ++lane) {
                    const double away = std::abs(h0 * slopes[axis][0][k + lane] + h1 * slopes[axis][1][k + lane] +
                                                 h2 * slopes[axis][2][k + lane] - unit);
                    most[lane] = away > most[lane] ? away : most[lane];
                }
            }
            sums[row] += *std::ranges::max_element(most);
        }
    }
    return sums.x < 1 && sums.y < 1 && sums.z < 1;
}

template bool passes_norm<4>(const PartSlopes<4>&, double);
template bool passes_norm<48>(const PartSlopes<48>&, double);

}  // namespace subvol::detail
