// SPDX-License-Identifier: Apache-2.0
// All corners of a cell side by side, as a fit asks for some hundred million of them.
//
// Compiled once for every instruction set; the best one is chosen where it runs.
#include "distortion.h"

#include "subvol/cell.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "distortion.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<double, 4>;
using Lane = hn::Vec<Lanes>;

struct Vector {
    Lane x, y, z;
};

Lane dot(const Vector& a, const Vector& b) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

Vector cross(const Vector& a, const Vector& b) {
    return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
            hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}

double distortion(const CornerCoordinates& corners, double epsilon, CornerCoordinates& slopes) {
    const Lanes d;
    constexpr std::size_t kStep = hn::MaxLanes(Lanes());
    HWY_ALIGN double edges[3][3][8];  // of each corner, and then the slopes by them
    for (std::size_t e = 0; e < 3; ++e) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            for (std::size_t k = 0; k < 8; ++k) {
                edges[e][axis][k] = corners[axis][kCornerNeighbors[k][e]] - corners[axis][k];
            }
        }
    }
    Lane sum = hn::Zero(d);
    for (std::size_t at = 0; at < 8; at += kStep) {
        const auto edge = [&](std::size_t e) {
            return Vector{hn::Load(d, edges[e][0] + at), hn::Load(d, edges[e][1] + at), hn::Load(d, edges[e][2] + at)};
        };
        const Vector a = edge(0), b = edge(1), c = edge(2);
        const Vector by_a = cross(b, c), by_b = cross(c, a), by_c = cross(a, b);
        const Lane det = dot(a, by_a);
        const Lane root = hn::Sqrt(hn::MulAdd(det, det, hn::Set(d, epsilon * epsilon)));
        const Lane half = hn::Set(d, 0.5), chi = hn::Mul(half, hn::Add(det, root));
        const Lane inverse = hn::Div(hn::Set(d, 1), chi), slope = hn::Div(chi, root);
        const Lane square = hn::Add(dot(a, a), hn::Add(dot(b, b), dot(c, c)));
        const Lane power = hn::Exp(d, hn::Mul(hn::Set(d, -2.0 / 3.0), hn::Log(d, chi)));
        const Lane shape = hn::Mul(square, power), size = hn::Mul(hn::MulAdd(det, det, hn::Set(d, 1)), inverse);
        sum = hn::Add(sum, hn::MulAdd(half, size, shape));
        const Lane by_chi = hn::Mul(hn::MulAdd(hn::Set(d, 2.0 / 3.0), shape, hn::Mul(half, size)), inverse);
        const Lane by_det = hn::NegMulAdd(by_chi, slope, hn::Mul(det, inverse));
        const Lane twice = hn::Add(power, power);
        const auto put = [&](std::size_t e, const Vector& along, const Vector& cofactor) {
            hn::Store(hn::MulAdd(twice, along.x, hn::Mul(by_det, cofactor.x)), d, edges[e][0] + at);
            hn::Store(hn::MulAdd(twice, along.y, hn::Mul(by_det, cofactor.y)), d, edges[e][1] + at);
            hn::Store(hn::MulAdd(twice, along.z, hn::Mul(by_det, cofactor.z)), d, edges[e][2] + at);
        };
        put(0, a, by_a);
        put(1, b, by_b);
        put(2, c, by_c);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        slopes[axis].fill(0);
        for (std::size_t e = 0; e < 3; ++e) {
            for (std::size_t k = 0; k < 8; ++k) {
                slopes[axis][kCornerNeighbors[k][e]] += edges[e][axis][k];
                slopes[axis][k] -= edges[e][axis][k];
            }
        }
    }
    return hn::GetLane(hn::SumOfLanes(d, sum));
}

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace subvol::detail {

HWY_EXPORT(distortion);

double distortion_of(const CornerCoordinates& corners, double epsilon, CornerCoordinates& slopes) {
    return HWY_DYNAMIC_DISPATCH(distortion)(corners, epsilon, slopes);
}

}  // namespace subvol::detail
#endif
