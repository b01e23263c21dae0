// SPDX-License-Identifier: Apache-2.0
#include "absorption.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "subvol/detail/compositor.h"

namespace subvol::detail {

namespace {

// Series of ln(1−x) about the middle up to here: five terms leave x⁶/5000, 3e-12; the closed form would cancel.
constexpr double kSeriesRatio = 0.05;

// The largest piece that is integrated without halving it. The hardest one has T = T₁u² (no extinction at one end): five points
// integrate e^{−T₁u²} to 1e-8 T₁⁵, and q ln q over a ratio of 1.5 to about 1e-12.
constexpr double kLeafDepth = 0.25;
constexpr double kLeafRatio = 1.5;
// Below these depths three points (6e-5 T₁³) or four (8e-7 T₁⁴) suffice, and the exponential is a short polynomial.
constexpr double kThinDepth = 0.002;
constexpr double kLowDepth = 0.03;
// A piece of this depth or more, even infinite, absorbs all light within a rounding error of its front.
constexpr double kBlackDepth = 1e17;

// Thicker pieces up to this depth take ten points, to about 1e-14, where five would need up to sixteen halves.
constexpr double kThickDepth = 4;

struct GaussPoint {
    double u, weight;
};
constexpr std::array<GaussPoint, 3> kGauss3{
    {{0.11270166537925831, 5.0 / 18}, {0.5, 8.0 / 18}, {0.88729833462074169, 5.0 / 18}}};
constexpr std::array<GaussPoint, 4> kGauss4{{{0.06943184420297371, 0.17392742256872693},
                                             {0.33000947820757187, 0.32607257743127307},
                                             {0.66999052179242813, 0.32607257743127307},
                                             {0.93056815579702629, 0.17392742256872693}}};
constexpr std::array<GaussPoint, 5> kGauss5{{{0.04691007703066800, 0.11846344252809454},
                                             {0.23076534494715845, 0.23931433524968324},
                                             {0.5, 0.28444444444444444},
                                             {0.76923465505284155, 0.23931433524968324},
                                             {0.95308992296933200, 0.11846344252809454}}};

constexpr std::array<GaussPoint, 10> kGauss10{{{0.013046735741414128, 0.033335672154344034},
                                               {0.067468316655507732, 0.074725674575290182},
                                               {0.16029521585048778, 0.10954318125799101},
                                               {0.28330230293537639, 0.13463335965499826},
                                               {0.42556283050918442, 0.14776211235737649},
                                               {0.57443716949081558, 0.14776211235737649},
                                               {0.71669769706462361, 0.13463335965499826},
                                               {0.83970478414951222, 0.10954318125799101},
                                               {0.93253168334449232, 0.074725674575290182},
                                               {0.98695326425858587, 0.033335672154344034}}};

// 1 − e^{−x} for x ≤ 0.1. The polynomial is written out: this is the innermost loop of the ray tracers.
double one_minus_exp_low(double x) {
    constexpr double k2 = -1.0 / 2, k3 = 1.0 / 6, k4 = -1.0 / 24, k5 = 1.0 / 120, k6 = -1.0 / 720, k7 = 1.0 / 5040;
    return x * (1 + x * (k2 + x * (k3 + x * (k4 + x * (k5 + x * (k6 + x * k7))))));
}

// For x ≤ kThinDepth.
double one_minus_exp_thin(double x) {
    return x * (1 + x * (-1.0 / 2 + x * (1.0 / 6 + x * (-1.0 / 24))));
}

double one_minus_exp(double x) {
    return x > 0.1 ? 1 - std::exp(-x) : one_minus_exp_low(x);
}

double minus_log_one_minus(double alpha) {
    return alpha < 1e-2 ? -std::log1p(-alpha) : -std::log(1 - alpha);
}

// T(u) where α changes little: −ln(1−α) = −ln q + Σ (r v)^k / k about the middle of the piece, v = u − ½, integrated term by
// term.
struct SeriesDepth {
    double length, middle, r, at_front;

    SeriesDepth(double alpha_front, double alpha_back, double stretch) : length(stretch) {
        const double alpha = 0.5 * (alpha_front + alpha_back);
        middle = minus_log_one_minus(alpha);
        r = (alpha_back - alpha_front) / (1 - alpha);
        at_front = primitive(-0.5);
    }
    [[nodiscard]] double primitive(double v) const {
        const double x = r * v;
        return v * (middle + x * (1.0 / 2 + x * (1.0 / 6 + x * (1.0 / 12 + x * (1.0 / 20 + x * (1.0 / 30))))));
    }
    double operator()(double u) const { return length * (primitive(u - 0.5) - at_front); }
};

// T(u) by the closed form ∫ ln q dq = q (ln q − 1), q = 1 − α.
struct LogDepth {
    double q_front, q_step, scale, at_front;

    LogDepth(double alpha_front, double alpha_back, double stretch)
        : q_front(1 - alpha_front), q_step(alpha_front - alpha_back), scale(-stretch / q_step), at_front(primitive(q_front)) {}
    static double primitive(double q) { return q * (std::log(q) - 1); }
    double operator()(double u) const { return scale * (primitive(q_front + u * q_step) - at_front); }
};

template <double (*OneMinusExp)(double) = one_minus_exp, class Depth, class Rule>
double mean_absorbed(const Depth& depth, const Rule& rule) {
    double sum = 0;
    for (const auto& point : rule) sum += point.weight * OneMinusExp(depth(point.u));
    return sum;
}

// NaN counts as constant, so that it is returned instead of being halved for ever.
bool nearly_constant(double alpha_front, double alpha_back) {
    return !(std::abs(alpha_back - alpha_front) > kSeriesRatio * (1 - 0.5 * (alpha_front + alpha_back)));
}

Absorption absorb_halves(double alpha_front, double alpha_back, double length) {
    const double alpha = 0.5 * (alpha_front + alpha_back);
    const Absorption front = absorb_piece(alpha_front, alpha, 0.5 * length);
    const double passed = 1 - front.whole;
    if (passed < kOpaque) return {0.5 * (front.mean + front.whole), front.whole};
    const Absorption back = absorb_piece(alpha, alpha_back, 0.5 * length);
    return {0.5 * (front.mean + front.whole + passed * back.mean), front.whole + passed * back.whole};
}

}  // namespace

double piece_depth(double alpha_front, double alpha_back, double length) {
    if (nearly_constant(alpha_front, alpha_back)) return SeriesDepth(alpha_front, alpha_back, length)(1);
    return LogDepth(alpha_front, alpha_back, length)(1);
}

Absorption absorb_piece(double alpha_front, double alpha_back, double length) {
    if (nearly_constant(alpha_front, alpha_back)) {
        const SeriesDepth depth(alpha_front, alpha_back, length);
        const double total = depth(1);
        if (total <= kThinDepth) return {mean_absorbed<one_minus_exp_thin>(depth, kGauss3), one_minus_exp_thin(total)};
        if (total <= kLowDepth) return {mean_absorbed<one_minus_exp_low>(depth, kGauss4), one_minus_exp_low(total)};
        if (!(total > kLeafDepth)) return {mean_absorbed(depth, kGauss5), one_minus_exp(total)};
        if (alpha_front != alpha_back && total <= kThickDepth) return {mean_absorbed(depth, kGauss10), one_minus_exp(total)};
        if (total > kBlackDepth) return {1, 1};
        if (alpha_front == alpha_back) return {1 - one_minus_exp(total) / total, one_minus_exp(total)};
    } else if (const double q_front = 1 - alpha_front, q_back = 1 - alpha_back;
               std::max(q_front, q_back) <= kLeafRatio * std::min(q_front, q_back)) {
        const LogDepth depth(alpha_front, alpha_back, length);
        const double total = depth(1);
        if (total <= kLeafDepth) return {mean_absorbed(depth, kGauss5), one_minus_exp(total)};
        if (total <= kThickDepth) return {mean_absorbed(depth, kGauss10), one_minus_exp(total)};
    }
    return absorb_halves(alpha_front, alpha_back, length);
}

}  // namespace subvol::detail
