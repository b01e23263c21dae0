// SPDX-License-Identifier: Apache-2.0
// This file is compiled once for each instruction set (by foreach_target.h); the best of them is chosen at run time.
#include "absorption.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "absorption_vectors.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<double, 8>;
using Doubles = hn::Vec<Lanes>;

// The same limits and rules as in absorption.cpp.
constexpr double kSeriesRatio = 0.05, kLeafDepth = 0.25, kLowDepth = 0.03;
constexpr double kGauss4[][2] = {{-0.43056815579702629, 0.17392742256872693}, {-0.16999052179242813, 0.32607257743127307}};
constexpr double kGauss5[][2] = {{-0.45308992296933200, 0.11846344252809454}, {-0.26923465505284155, 0.23931433524968324}};
constexpr double kGauss5Middle = 0.28444444444444444;

/// x · Σ c_k x^k, highest first.
template <std::size_t kCount>
HWY_ATTR inline Doubles times_polynomial(Doubles x, const double (&c)[kCount]) {
    const Lanes d;
    auto sum = hn::Set(d, c[0]);
    for (std::size_t k = 1; k < kCount; ++k) sum = hn::MulAdd(sum, x, hn::Set(d, c[k]));
    return hn::Mul(x, sum);
}

/// 1 − e^{−x} for x ≤ 0.03, to 1e-15 relative.
HWY_ATTR inline Doubles one_minus_exp_low(Doubles x) {
    return times_polynomial(x, {1.0 / 5040, -1.0 / 720, 1.0 / 120, -1.0 / 24, 1.0 / 6, -1.0 / 2, 1.0});
}

/// For x ≤ 0.25, to 4e-14 relative.
HWY_ATTR inline Doubles one_minus_exp(Doubles x) {
    return times_polynomial(
        x, {-1.0 / 3628800, 1.0 / 362880, -1.0 / 40320, 1.0 / 5040, -1.0 / 720, 1.0 / 120, -1.0 / 24, 1.0 / 6, -1.0 / 2, 1.0});
}

/// The depth T of a piece by the series of absorption.cpp, as a function of the place v in [−½, ½].
struct Depth {
    Doubles length, middle, r, at_front;

    HWY_ATTR Depth(Doubles alpha, Doubles step, Doubles stretch) : length(stretch) {
        const Lanes d;
        middle = hn::Neg(hn::Log1p(d, hn::Neg(alpha)));
        r = hn::Div(step, hn::Sub(hn::Set(d, 1.0), alpha));
        at_front = primitive(hn::Set(d, -0.5));
    }
    HWY_ATTR Doubles primitive(Doubles v) const {
        const auto x = hn::Mul(r, v);
        const auto bend = times_polynomial(x, {1.0 / 30, 1.0 / 20, 1.0 / 12, 1.0 / 6, 1.0 / 2});
        return hn::Mul(v, hn::Add(middle, bend));
    }
    HWY_ATTR Doubles operator()(Doubles v) const { return hn::Mul(length, hn::Sub(primitive(v), at_front)); }
};

template <class OneMinusExp, std::size_t kPairs>
HWY_ATTR inline Doubles mean_absorbed(const Depth& depth, const double (&rule)[kPairs][2], Doubles sum,
                                      const OneMinusExp& absorbed) {
    const Lanes d;
    for (const auto& [v, weight] : rule) {
        const auto two = hn::Add(absorbed(depth(hn::Set(d, v))), absorbed(depth(hn::Set(d, -v))));
        sum = hn::MulAdd(hn::Set(d, weight), two, sum);
    }
    return sum;
}

void absorb(const PieceRows& pieces, std::size_t count, double* HWY_RESTRICT mean, double* HWY_RESTRICT whole) {
    const Lanes d;
    const auto half = hn::Set(d, 0.5);
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
        const auto front = hn::Load(d, pieces.alpha_front + i), back = hn::Load(d, pieces.alpha_back + i);
        const auto alpha = hn::Mul(half, hn::Add(front, back)), step = hn::Sub(back, front);
        const Depth depth(alpha, step, hn::Load(d, pieces.length + i));
        const auto total = depth(half);
        if (hn::AllTrue(d, hn::Le(total, hn::Set(d, kLowDepth)))) {
            const auto absorbed = [](Doubles x) HWY_ATTR { return one_minus_exp_low(x); };
            hn::Store(absorbed(total), d, whole + i);
            hn::Store(mean_absorbed(depth, kGauss4, hn::Zero(d), absorbed), d, mean + i);
        } else {
            const auto absorbed = [](Doubles x) HWY_ATTR { return one_minus_exp(x); };
            hn::Store(absorbed(total), d, whole + i);
            const auto middle = hn::Mul(hn::Set(d, kGauss5Middle), absorbed(depth(hn::Zero(d))));
            hn::Store(mean_absorbed(depth, kGauss5, middle, absorbed), d, mean + i);
        }
        const auto done = hn::And(hn::Le(total, hn::Set(d, kLeafDepth)),
                                  hn::Le(hn::Abs(step), hn::Mul(hn::Set(d, kSeriesRatio), hn::Sub(hn::Set(d, 1.0), alpha))));
        if (hn::AllTrue(d, done)) continue;
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, done, bits);
        for (std::size_t k = i; k < std::min(count, i + hn::Lanes(d)); ++k) {
            if ((bits[0] >> (k - i)) & 1) continue;
            const Absorption one = absorb_piece(pieces.alpha_front[k], pieces.alpha_back[k], pieces.length[k]);
            mean[k] = one.mean;
            whole[k] = one.whole;
        }
    }
}

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace subvol::detail {

HWY_EXPORT(absorb);

void absorb_pieces(const PieceRows& pieces, std::size_t count, double* mean, double* whole) {
    HWY_DYNAMIC_DISPATCH(absorb)(pieces, count, mean, whole);
}

}  // namespace subvol::detail
#endif
